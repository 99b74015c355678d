"""A run in stages: what begins with each, how it goes on from any step, what it leaves."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast import Stage
from clast.errors import CaseError
from clast.model.ground_motion import InStages
from clast.run.run_state import RunState
from clast.run.schedule import Progress, Schedule
from clast.run.simulate import simulate
from clast.step.method import Method
from scenes.restarts import same

G = 9.81
STEP = 2e-3


def wall() -> clast.ModelBuilder:
    """Return bricks on a floor that is shaken, with loads of later stages."""
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("brick", young=5e9, poisson=0.2, density=2000.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(vertices=[(-2, -1), (3, -1), (3, 0), (-2, 0)], name="floor")
    builder.fixed_point((-2, -1))
    builder.fixed_point((3, -1))
    for row in range(2):
        for column in range(2):
            # not by half: a brick whose centroid is over its edge stands or falls by rounding
            x, y = column + 0.4 * (row % 2) - 0.5, 0.5 * row
            corners = [(x, y), (x + 1, y), (x + 1, y + 0.5), (x, y + 0.5)]
            builder.block(vertices=corners, name=f"{row}-{column}")
    builder.add_amplitude("ramp", [0.0, 0.02], [0.0, 1.0])
    builder.point_load((0.0, 0.75), (1e3, 0.0), block="1-0", name="push", amplitude="ramp")
    builder.pressure((0.0, 1.0), (1.9, 1.0), 1e3, name="snow")
    builder.measured_point("top", (1.0, 1.0), block="1-1")
    time = np.linspace(0.0, 0.04, 21)
    record = np.stack([2.0 * np.sin(2.0 * np.pi * time / 0.04), 0.0 * time], axis=1)
    builder.ground_motion = clast.MovingBase(clast.Accelerogram(time, record))
    return builder


STAGES = (
    Stage(name="gravity", time=0.2, dynamic_ratio=0.0, reset_displacement=True, hold=5),
    Stage(name="loads", until="time", time=0.05, loads=("push", "snow"), step=1.7e-3),
    Stage(
        name="quake",
        until="time",
        time=0.05,
        ground_motion=True,
        joints={"default": {"friction_angle": 25.0}},
    ),
    Stage(name="after", time=0.03),
)


def prepared(process: str = "convex", law: str = "penalty") -> tuple[clast.Model, Method, Schedule]:
    """Return the model, the method and the schedule of the wall."""
    stiffness = {"modified": 2e7, "open-close": 2e7, "convex": 5e9}[process]
    case = wall().case(
        step=STEP,
        end=1.0,
        every=0.013,
        process=process,
        contact_law={"name": law, "normal_stiffness": stiffness},
        stages=STAGES,
    )
    model = case.model()
    return model, case.method(model), case.schedule()


@pytest.mark.parametrize(
    ("process", "law"),
    [
        ("convex", "penalty"),
        ("convex", "augmented-lagrangian"),
        ("open-close", "penalty"),
        ("modified", "augmented-lagrangian"),
    ],
)
@pytest.mark.one_in(3)
def test_a_run_in_stages_goes_on_from_any_of_its_steps(process: str, law: str):
    model, method, schedule = prepared(process, law)
    carried: list[RunState] = []
    whole = simulate(model, method, schedule, keep=carried.append)
    position = [one.position.number for one in carried]
    ends = [at for at in range(len(carried) - 1) if position[at] != position[at + 1]]
    assert [at for at, one in enumerate(carried) if one.position.over] == [*ends, len(carried) - 1]
    chosen = sorted({0, 3, *ends, *(at + 1 for at in ends), ends[-1] - 3, len(carried) - 2})
    for at in chosen:
        last: list[RunState] = []
        rest = simulate(model, method, schedule, begin=carried[at], keep=last.append)
        assert same(last[-1], carried[-1]), at
        assert same(rest.final, whole.final)
        assert same(rest.stages, whole.stages)
        assert same(rest.events, whole.events)
        later = whole.history("top").rows[-len(last) :]
        assert np.array_equal(rest.history("top").rows[1:], later)
        assert list(rest.times[1:]) == list(whole.times[-len(rest.times) + 1 :])


def test_each_stage_does_what_it_says():
    model, method, schedule = prepared()
    carried: list[RunState] = []
    run = simulate(model, method, schedule, keep=carried.append)
    assert [one.name for one in run.stages] == ["gravity", "loads", "quake", "after"]
    assert run.stages[0].outcome == "equilibrium"
    assert [one.outcome for one in run.stages[1:3]] == ["time over"] * 2
    for before, after in zip(run.stages, run.stages[1:], strict=False):
        assert before.end == after.start
    # every stage ends with a frame that has its name
    for record in run.stages:
        frame = run.frame(stage=record.name)
        assert frame.time == record.end
        assert frame.stage == record.name
    assert run.block("1-1").stage[-1] == "after"
    # the length of its steps is that of the stage; pseudo time steps of static ones grow
    assert run.steps["step"][: run.stages[0].steps].max() > STEP
    in_loads = (run.steps["time"] > run.stages[1].start + 1e-9) & (
        run.steps["time"] < run.stages[1].end - 1e-9
    )
    assert run.steps["step"][in_loads].max() == pytest.approx(1.7e-3)
    # loads do no work before their stage, and the ledger closes over all changes
    energy = run.energy
    before = energy["time"] <= run.stages[0].end
    assert not energy["loads"][before].any()
    assert energy["loads"][-1] != 0.0
    turned_over = np.ptp(energy["elastic"]) + np.ptp(energy["kinetic"])
    assert abs(energy["unaccounted"][-1]) < 1e-6 * turned_over
    kinds = [one.kind for one in run.events]
    assert kinds.count("stage begins") == kinds.count("stage ends") == 4
    assert {"load begins", "ground motion begins", "joint changes"} <= set(kinds)
    assert "displacements reset" in kinds


def test_displacements_count_from_the_end_of_a_stage():
    model, method, schedule = prepared()
    run = simulate(model, method, schedule)
    history, gravity = run.history("top"), run.stages[0]
    at = int(np.flatnonzero(history.time == gravity.end)[-1])
    sunk = history.displacement[at]
    assert abs(sunk[1]) > 1e-8  # the brick that hangs over is at its limit, and may tip a little
    assert gravity.reset == (tuple(sunk),)
    point = model.point_slices.measured
    moved = run.state.points[point] - model.measured_points.at
    np.testing.assert_allclose(history.displacement[-1] + sunk, moved[0], atol=1e-15)
    # fields of the blocks, too, and positions stay as they are
    number = run.frame(stage="gravity").number
    last = run.field("displacement", -1) + run.field("displacement", number)
    moved = run.vertices(-1) - run.vertices(0)
    start = run.block_start[:-1]
    mean = np.add.reduceat(moved, start, axis=0) / np.diff(run.block_start)[:, None]
    np.testing.assert_allclose(last, mean, atol=1e-9)


def test_a_base_that_has_moved_stays_where_it_is():
    model, method, schedule = prepared()
    run = simulate(model, method, schedule)
    quake = run.stages[2]
    motion = InStages(motion=model.ground_motion, parts=((quake.start, quake.end),))
    last = model.ground_motion.anchor_displacement(quake.end - quake.start)
    assert np.hypot(*last) > 1e-5
    np.testing.assert_array_equal(motion.anchor_displacement(quake.start), np.zeros(2))
    np.testing.assert_array_equal(motion.anchor_displacement(quake.end + 7.0), last)
    floor = run.block("floor")
    at = np.flatnonzero(floor.time <= quake.start)[-1]
    gone = floor.displacement[-1] - floor.displacement[at]
    np.testing.assert_allclose(gone, last, atol=2e-5)


def test_a_table_that_a_stage_names_begins_with_it():
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=1000.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], name="free")
    builder.add_amplitude("push", [0.0, 0.1], [0.0, 1.0])
    builder.point_load((0.5, 0.5), (500.0, 0.0), block="free", amplitude="push")
    stages = [Stage(name=name, until="time", time=0.2) for name in ("wait", "go")]
    stages[1] = dataclasses.replace(stages[1], loads=("push",))
    run = clast.simulate(builder.build(), step=1e-3, stages=stages)
    velocity = run.block("free").velocity[:, 0]
    times = run.block("free").time
    assert not velocity[times <= 0.2].any()
    # impulse of a ramp of 0.1 s and a load of 0.1 s; steps have the load at their ends
    impulse = 500.0 * (0.5 * 0.1 + 0.1)
    assert velocity[-1] == pytest.approx(impulse / 1000.0, rel=5e-3)


def test_weaker_joints_let_a_block_slide():
    angle = np.radians(20.0)
    builder = clast.ModelBuilder(gravity=(G * np.sin(angle), -G * np.cos(angle)))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], name="plane", fixed=True)
    builder.block(vertices=[(0, 0), (1, 0), (1, 0.5), (0, 0.5)], name="block")
    weak = {"default": {"friction_angle": 10.0}}
    stages = [
        Stage(name="rest", time=1.0, dynamic_ratio=0.0, reset_displacement=True),
        Stage(name="slide", until="time", time=0.3, joints=weak),
    ]
    run = clast.simulate(builder.build(), step=1e-3, stages=stages)
    assert run.stages[0].outcome == "equilibrium"
    exact = 0.5 * G * (np.sin(angle) - np.cos(angle) * np.tan(np.radians(10.0))) * 0.3**2
    slid = run.block("block").displacement[-1, 0]
    assert slid == pytest.approx(exact, rel=2e-2)
    assert run.report.ledger.friction > 0.0


def test_stages_are_read_again_from_the_file(tmp_path: Path):
    model, method, schedule = prepared()
    recorder = clast.RunRecorder(model, output=tmp_path / "wall.vtkhdf")
    run = simulate(model, method, schedule, recorder=recorder)
    read = clast.read(tmp_path / "wall.vtkhdf")
    assert read.stages == run.stages
    assert read.events == run.events
    assert read.frame_stages == run.frame_stages
    assert read.frame(stage="quake").time == run.stages[2].end
    assert read.about["stages"] == [one.name for one in run.stages]
    with pytest.raises(CaseError, match="did you mean 'quake'"):
        read.frame(stage="quak")
    kept = simulate(model, method, schedule)
    assert kept.frame_stages == run.frame_stages
    for name in ("displacement", "rotation", "vertices"):
        assert np.array_equal(kept.field(name), read.field(name))


def test_a_stage_that_is_broken_off_says_so():
    model, method, schedule = prepared()

    def interrupt(now: Progress) -> None:
        if now.stage == "loads" and now.time > now.start + 0.02:
            raise KeyboardInterrupt

    run = simulate(model, method, schedule, watch=interrupt)
    assert not run.report.finished
    assert [one.outcome for one in run.stages] == ["equilibrium", "broken off"]
    assert run.stages[1].steps == 12
    assert run.frame(stage="loads").time == run.state.time


def slab(process: str, time: float, **keys: Any) -> clast.Run:
    """Return a slab of 1 m by 0.5 m that a static stage sets on a joint of 0.1 GPa/m."""
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=1e12, poisson=0.0, density=2500.0)
    builder.add_joint(friction_angle=30.0, normal_stiffness=1e8, shear_stiffness=1e8)
    builder.block(vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], name="floor", fixed=True)
    builder.block(vertices=[(0, 0), (1, 0), (1, 0.5), (0, 0.5)], name="slab")
    stage = Stage(name="set", until="time", time=time, **{"dynamic_ratio": 0.0, **keys})
    rest = Stage(name="rest", time=1.0, dynamic_ratio=0.0)
    stages = [stage, rest]
    return clast.simulate(builder.build(), step=2e-3, process=process, stages=stages)


def unbalanced_by_hand(steps: int) -> float:
    """Return the share of forces that static steps leave unbalanced on the slab.

    A step of h from rest solves (2 m/h2 + k) d = r W: it leaves r/(1 + k h2/(2 m)) of the weight W,
    and floor and weight together press with (1 - r) W + W.
    """
    left = (1.0 + 1e8 * 2e-3**2 / (2.0 * 1250.0)) ** -steps
    return left / (2.0 - left)


@pytest.mark.parametrize("steps", [5, 20])
def test_a_static_stage_that_its_time_ends_out_of_balance_is_warned_of(steps: int):
    run = slab("open-close", steps * 2e-3)
    share = unbalanced_by_hand(steps)
    assert run.stages[0].outcome == "time over"
    assert run.stages[0].force_ratio == pytest.approx(share, rel=1e-4)
    (said,) = run.report.warnings
    assert "stage 'set'" in said
    assert f"block 'slab' is {share:.3g} of the forces" in said
    assert 'process = "convex"' in said
    # the paper's first step has no spring yet
    paper = slab("modified", steps * 2e-3)
    assert paper.stages[0].force_ratio == pytest.approx(share, rel=0.05)
    assert any("stage 'set'" in one for one in paper.report.warnings)
