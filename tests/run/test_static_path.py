"""A static run is a path of equilibria: the step plays no part in it, and what fails says so."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clast
from benchmarks.scenes import SCENES, BenchSettings, method_for
from clast import Stage
from clast.model.ground_motion import Accelerogram, MovingBase
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from scenes.restarts import differences, pressed_at

G = 9.81


def on_base(friction: float, peak: float = 0.8, **joint: float) -> clast.ModelBuilder:
    """Return a block on a base that its supports move by peak/8 m in 1 s."""
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=friction, **joint)
    builder.block(vertices=[(-2, -1), (3, -1), (3, 0), (-2, 0)], name="base")
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], name="b")
    builder.fixed_point((-2, -1), block="base")
    builder.fixed_point((3, -1), block="base")
    builder.measured_point("b", (0.5, 0.5), block="b")
    record = np.array([[0.0, 0.0], [peak, 0.0], [-peak, 0.0], [0.0, 0.0]])
    builder.ground_motion = MovingBase(
        Accelerogram(time=np.array([0.0, 0.25, 0.75, 1.0]), acceleration=record)
    )
    return builder


@pytest.mark.parametrize("step", [2e-2, 5e-2])
def test_a_block_goes_with_the_base_that_carries_it(step: float):
    run = clast.simulate(on_base(45.0).build(), end=1.0, step=step, dynamic_ratio=0.0)
    assert run.history("b").displacement[-1, 0] == pytest.approx(0.1, abs=1e-7)
    # what the equations leave open does work over the 0.1 m of way
    assert abs(run.report.ledger.unaccounted) < 1e-9 * 2500.0 * G * 0.1


def on_plane(angle: float, **joint: float) -> clast.ModelBuilder:
    """Return a block on a plane of friction 30 degrees that is inclined by ``angle``."""
    builder = clast.ModelBuilder(gravity=(G * np.sin(angle), -G * np.cos(angle)))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0, **joint)
    builder.block(vertices=[(-3, -1), (3, -1), (3, 0), (-3, 0)], name="plane", fixed=True)
    builder.block(vertices=[(-0.5, 0), (0.5, 0), (0.5, 1), (-0.5, 1)], name="block")
    return builder


@pytest.mark.parametrize("step", [1e-3, 5e-2])
def test_what_slides_fails_at_any_step_and_says_which_way(step: float):
    model = on_plane(np.radians(31.0)).build()
    run = clast.simulate(model, stages=[Stage(name="rest")], end=1.0, step=step, dynamic_ratio=0.0)
    (record,) = run.stages
    assert (record.outcome, record.mechanism) == ("fails", ("block",))
    assert abs(record.mover.direction) < 1.0
    assert record.steps < 30
    (text,) = [one for one in run.report.warnings if "fails" in one]
    assert "block 'block' moves" in text and "dynamic_ratio" not in text
    assert [event.what for event in run.report.events if event.kind == "fails"] == ["block"]


def test_what_stands_does_not_depend_on_the_step():
    ends = []
    for step in (1e-3, 5e-2):
        model = on_plane(np.radians(29.0)).build()
        stages = [Stage(name="rest")]
        run = clast.simulate(model, stages=stages, end=1.0, step=step, dynamic_ratio=0.0)
        assert run.stages[0].outcome == "equilibrium"
        assert run.stages[0].steps <= 8
        ends.append(run.state.vertices)
    assert np.array_equal(*ends)


def test_a_run_without_stages_says_that_it_fails_and_goes_on():
    model = on_plane(np.radians(31.0)).build()
    run = clast.simulate(model, end=0.05, step=1e-3, dynamic_ratio=0.0)
    assert run.report.finished
    assert run.state.time == pytest.approx(0.05)
    assert any("the static run fails" in one for one in run.report.warnings)


def test_bonds_that_break_are_counted_and_may_be_held():
    weight = 2500.0 * G
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0, cohesion=weight, tensile_strength=weight / 1.5)
    builder.block(vertices=[(-2, 0), (2, 0), (2, 1), (-2, 1)], name="roof", fixed=True)
    builder.block(vertices=[(0, -1), (1, -1), (1, 0), (0, 0)], name="block")
    for bonds in ("break", "hold"):
        stages = [Stage(name="rest", bonds=bonds)]
        run = clast.simulate(builder.build(), stages=stages, end=1.0, step=1e-2, dynamic_ratio=0.0)
        (record,) = run.stages
        assert (record.outcome, record.mechanism) == ("fails", ("block",)), bonds
        assert record.broken == 15  # the points of the face (decision 82)
        (event,) = [one for one in run.report.events if one.kind == "bonds break"]
        assert "'block'" in event.text
        # 1/1.5 of the weight is what they bear, in increments of 1/32
        load = float(event.text.split("under ")[1].split(" %")[0])
        assert load == pytest.approx(100.0) if bonds == "hold" else 66.6 < load < 69.9


def test_a_slope_settles_in_few_steps_and_passes():
    """2,000 blocks; it once took 8 steps, four of them there and back between two lengths."""
    model = SCENES["slope"].build(2000)
    method = replace(method_for(model, BenchSettings()), dynamic_ratio=0.0)
    schedule = Schedule(step=1e-3, end=1.0, every=1.0, stages=(Stage(name="settle"),))
    run = simulate(model, method, schedule)
    assert run.stages[0].outcome == "equilibrium"
    assert run.report.steps <= 4
    assert run.steps["passes"].sum() <= 95


WEDGE = """
schema = 1
[time]
step = 4e-3
end = 1.0
[rock.gneiss]
young = 2e10
poisson = 0.25
density = 2600.0
[joint.default]
friction_angle = 40.0
[joint.fault]
friction_angle = 35.0
cohesion = 12e3
[domain]
boundary = [[0, 0], [40, 0], [40, 8], [26, 8], [17, 26], [0, 26]]
fixed_sides = ["left", "bottom", "right"]
seed = 1
[[trace]]
points = [[2.5, 28], [27.5, 8]]
joint = "fault"
[[region]]
name = "above"
polygon = [[27.5, 8], [27.5, 28], [2.5, 28]]
[[joint_set]]
name = "cross joints"
angle = 95.0
spacing = 3.0
within = "above"
[[joint_set]]
name = "bedding"
angle = 0.0
spacing = 3.0
within = "above"
[[measured_point]]
name = "crest"
at = [16.0, 25.0]
[[stage]]
name = "weight"
dynamic_ratio = 0.0
"""
"""A wedge of blocks above a fault, which cohesion holds with F = 1.08."""


def test_how_far_a_wedge_moves_does_not_depend_on_the_first_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """By bounds renewed once its crest moves as far as the step lets it: by 0.07 to 5 mm."""
    (tmp_path / "wedge.toml").write_text(WEDGE)
    moved = []
    for first in (0.004, 0.5, 5.0, 300.0):
        monkeypatch.setattr("clast.run.stages.static_path.FIRST_FALL", first)
        run = clast.Case.from_toml(tmp_path / "wedge.toml").run()
        assert run.stages[0].outcome == "equilibrium"
        moved.append(float(np.hypot(*run.history("crest").displacement[-1])))
    # where mass bears nearly all at first (0.004), other joints slip before they are pressed
    assert moved == pytest.approx([moved[-1]] * 4, rel=0.05)
    assert moved[1:] == pytest.approx([moved[-1]] * 3, rel=0.012)
    assert moved[-1] < 1e-4


def column(young: float, blocks: int, above: float = 0.0) -> clast.ModelBuilder:
    """Return a pile of soft blocks of 1 m x 1 m, ``above`` m over its floor."""
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("soil", young=young, poisson=0.2, density=2000.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], name="floor", fixed=True)
    for k in range(blocks):
        low, high = above + k, above + k + 1
        builder.block(vertices=[(0, low), (1, low), (1, high), (0, high)], name=f"b{k}")
    builder.measured_point("top", (0.5, above + blocks), block=f"b{blocks - 1}")
    return builder


@pytest.mark.parametrize("reach", [5e-4, 5e-3, 2e-2])
def test_the_verdict_does_not_depend_on_max_displacement(reach: float):
    def rested(builder: clast.ModelBuilder) -> clast.Run:
        stages = [Stage(name="rest")]
        how = {"step": 1e-2, "dynamic_ratio": 0.0, "max_displacement": reach}
        return clast.simulate(builder.build(), stages=stages, end=1.0, **how)

    # settles by 17 mm, many times what a step may move blocks by; and falls by 8 mm
    for builder, down in ((column(2e7, 5), 0.01706), (column(1e9, 1, above=8e-3), 8.02e-3)):
        run = rested(builder)
        assert run.stages[0].outcome == "equilibrium"
        assert run.history("top").displacement[-1, 1] == pytest.approx(-down, rel=5e-3)
    for angle, outcome in ((29.9, "equilibrium"), (30.2, "fails")):
        assert rested(on_plane(np.radians(angle))).stages[0].outcome == outcome


def test_what_would_take_for_ever_advises_max_displacement(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("clast.run.stages.convergence.STEPS_MAX", 30)
    builder, stages = column(2e7, 5), [Stage(name="rest")]
    how = {"step": 1e-2, "dynamic_ratio": 0.0, "max_displacement": 1e-4}
    run = clast.simulate(builder.build(), stages=stages, end=1.0, **how)
    assert run.stages[0].outcome == "fails"
    assert any("raise time.max_displacement" in one for one in run.report.warnings)


@pytest.mark.parametrize("staged", [False, True])
def test_it_goes_on_to_the_same_bits_from_the_middle_of_its_path(tmp_path: Path, staged: bool):
    """While a base moves, and while a weight comes on by increments."""
    builder = on_base(45.0, cohesion=1e4, tensile_strength=1e4)
    stages = (Stage(name="weight"), Stage(name="moves", ground_motion=True)) if staged else ()
    how = {"stages": stages, "end": 1.0, "step": 2.5e-2, "dynamic_ratio": 0.0}
    whole = clast.simulate(builder.build(), output=tmp_path / "whole.vtkhdf", **how)
    part = clast.simulate(
        builder.build(), output=tmp_path / "part.vtkhdf", progress=pressed_at(2), **how
    )
    for step in (5, 20):
        part = clast.resume(part.checkpoint, progress=pressed_at(step), model=builder.build())
    rest = clast.resume(part.checkpoint, model=builder.build())
    assert rest.report.steps == whole.report.steps > 20
    assert np.array_equal(rest.state.vertices, whole.state.vertices)
    assert differences(tmp_path / "whole.vtkhdf", tmp_path / "part.vtkhdf") == []


@pytest.mark.parametrize("process", ["modified", "open-close"])
def test_processes_that_keep_the_mass_term_warn_of_supports_that_move(process: str):
    def warnings(peak: float) -> list[str]:
        model = on_base(45.0, peak).build()
        how = {"step": 2e-3, "end": 0.01, "dynamic_ratio": 0.0, "process": process}
        found = clast.simulate(model, **how).report.warnings
        return [one for one in found if "supports move" in one]

    (text,) = warnings(0.8)
    assert "0.2 m/s" in text
    assert 'method.process = "convex"' in text
    assert warnings(0.02) == []
