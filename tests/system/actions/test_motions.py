"""Prescribed motions and reactions in whole runs, against closed forms and against themselves."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.case.api import ModelBuilder
from clast.errors import ModelError
from scenes.restarts import differences, pressed_at

DENSITY, GRAVITY = 2500.0, 9.8
STIFF = {"name": "penalty", "normal_stiffness": 1e8}
METHODS: dict[str, dict[str, Any]] = {
    "convex": {},
    "open-close": {"process": "open-close"},
    "modified": {
        "process": {"name": "modified", "passes": 6},
        "contact_law": STIFF,
    },
    "augmented": {"contact_law": "augmented-lagrangian"},
}


def turned(points: Any, angle: float, mirrored: bool = False) -> Any:
    """Return points turned about the origin by degrees, and mirrored before where wanted."""
    points = np.array(points, float)
    if mirrored:
        points = points * [-1.0, 1.0]
        points = points[::-1] if points.ndim > 1 else points
    a = np.radians(angle)
    return points @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])


def box(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def stones(title: str = "moved", angle: float = 0.0) -> ModelBuilder:
    builder = ModelBuilder(title=title, gravity=tuple(turned((0.0, -GRAVITY), angle)))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=DENSITY)
    builder.add_joint(friction_angle=30.0)
    return builder


def drawn(angle: float = 0.0, mirrored: bool = False, pieces: int = 1) -> ModelBuilder:
    """Return a block that is drawn over a floor of so many pieces at 0.5 m/s, after 0.1 s."""
    builder = stones(angle=angle)
    for k in range(pieces):
        width = 12.0 / pieces
        floor = box(-4.0 + k * width, -1.0, width, 1.0)
        builder.block(name=f"floor {k}", vertices=turned(floor, angle, mirrored), fixed=True)
    builder.block(name="box", vertices=turned(box(0.0, 0.0, 2.0, 1.0), angle, mirrored))
    builder.measured_reaction("ground", blocks=[f"floor {k}" for k in range(pieces)])
    return builder


NORMAL = 2.0 * DENSITY * GRAVITY
FRICTION = NORMAL * np.tan(np.radians(30.0))


@pytest.mark.parametrize(("method", "step"), [(m, 1e-3) for m in METHODS] + [("convex", 2.5e-3)])
def test_a_block_that_is_drawn_resists_by_friction_and_inertia(method: str, step: float):
    builder = drawn(pieces=3)
    builder.motion(name="winch", block="box", x=0.5, ease=0.1)
    keys: dict[str, Any] = {**METHODS[method], "damping": "adaptive"}  # of no effect on the winch
    run = clast.simulate(builder.build(), step=step, end=0.3, **keys)
    winch, ground = run.reaction("winch"), run.reaction("ground")
    eased = (winch.time > 0.5 * step) & (winch.time < 0.1 - 0.5 * step)
    later = winch.time > 0.1 + 0.5 * step
    # of each instant: reactions = mass x acceleration
    along = winch.force[:, 0] + ground.force[:, 0]
    assert along[eased] == pytest.approx(2.0 * DENSITY * 5.0, rel=1e-9)
    assert np.abs(along[later]).max() < 1e-9 * NORMAL
    # where the friction bound lags behind, the block still bounces on its springs
    still = {"modified": 1e-2, "augmented": 3e-4}.get(method, 1e-6)
    assert winch.force[-1, 0] == pytest.approx(FRICTION, rel=still)
    assert ground.force[-1] == pytest.approx([-FRICTION, NORMAL], rel=still)
    centre = run.vertices()[-4:].mean(axis=0)
    assert abs(centre[0] - (1.0 + 0.5 * 0.25)) < 2e-12
    assert abs(run.state.velocity[-1, 0] - 0.5) < 1e-12
    ledger = run.state.ledger
    assert abs(ledger.unaccounted) < 1e-9 * ledger.motions


@pytest.mark.parametrize("fixed", [True, False])
@pytest.mark.parametrize("method", ["convex", "open-close"])
@pytest.mark.one_in(3)
def test_a_body_goes_where_it_is_led_to_the_last_digit(fixed: bool, method: str):
    builder = stones()
    builder.block(name="gate", vertices=box(0.0, 0.0, 2.0, 1.0), fixed=fixed)
    builder.block(name="other", vertices=box(50.0, 0.0, 1.0, 1.0), fixed=True)
    builder.motion(block="gate", x=1.0, y=-0.5, rotation=90.0, about=(0.0, 0.0), ease=0.1)
    keys: dict[str, Any] = {**METHODS[method], "max_displacement": 0.1}
    run = clast.simulate(builder.build(), step=1e-3, end=0.55, **keys)
    corner = run.vertices()[0]
    assert np.abs(corner - [0.5, -0.25]).max() < (1e-12 if fixed else 1e-6)
    assert abs(run.state.rotation[0] - np.radians(45.0)) < 1e-12
    if fixed:
        exact = turned(box(0.0, 0.0, 2.0, 1.0), 45.0) + np.array([0.5, -0.25])
        assert np.abs(run.vertices()[:4] - exact).max() < 1e-12
    assert abs(run.state.ledger.unaccounted) < 1e-8 * abs(run.state.ledger.motions)


@pytest.mark.parametrize("fixed", [True, False])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.one_in(3)
def test_a_wall_that_is_driven_throws_what_it_hits(fixed: bool, restitution: float):
    builder = stones()
    builder.gravity = (0.0, 0.0)
    builder.block(name="wall", vertices=box(0.0, 0.0, 1.0, 2.0), fixed=fixed)
    builder.block(name="ball", vertices=box(1.5, 0.5, 1.0, 1.0))
    builder.motion(name="ram", block="wall", x=2.0, y=0.0, rotation=0.0)
    process = {"name": "convex", "restitution": restitution}
    run = clast.simulate(builder.build(), step=1e-3, end=0.5, process=process)
    thrown = 2.0 * (1.0 + restitution)
    assert run.state.velocity[1, 0] == pytest.approx(thrown, rel=1e-5)
    assert run.state.velocity[0, 0] == 2.0
    ram = run.reaction("ram")
    struck = 1e-3 * ram.force[5:, 0].sum()  # after the start of a free wall
    assert struck == pytest.approx(DENSITY * thrown, rel=1e-5)
    ledger = run.state.ledger
    assert abs(ledger.unaccounted) < 1e-8 * ledger.motions
    # seen from the wall, the ball comes at 2 m/s
    lost = 0.5 * DENSITY * 4.0 * (1.0 - restitution**2)
    assert ledger.impacts == pytest.approx(lost, rel=1e-4)


def piers(turn: float = 0.0, second: str = "R") -> ModelBuilder:
    """Return a lintel on two knife edges 5 m apart, one of which settles by 30 mm."""
    builder = stones(angle=turn)
    builder.add_joint("smooth", friction_angle=0.0, between=[("lintel", "L"), ("lintel", "R")])
    for name, x in (("L", 0.0), ("R", 5.0)):
        edge = [(x, 0.0), (x - 0.3, -1.0), (x + 0.3, -1.0)]
        builder.block(name=name, vertices=turned(edge, turn), fixed=True)
    builder.block(name="lintel", vertices=turned(box(-0.5, 0.0, 6.0, 0.5), turn))
    return builder


def test_reactions_on_piers_that_settle():
    builder = piers()
    builder.add_amplitude("settlement", time=[0.0, 1.0], value=[0.0, -1.0])
    course = {"displacement": "settlement", "scale": 0.03}
    builder.motion(name="right", block="R", y=course, ease=0.2)
    builder.measured_reaction("left", block="L")
    keys: dict[str, Any] = {"damping": "adaptive", "dynamic_ratio": 0.9}
    run = clast.simulate(builder.build(), step=2e-3, end=1.5, **keys)
    weight = 6.0 * 0.5 * DENSITY * GRAVITY
    assert run.reaction("right").force[-1, 1] == pytest.approx(0.5 * weight, rel=1e-3)
    assert run.reaction("left").force[-1, 1] == pytest.approx(0.5 * weight, rel=1e-3)
    assert run.state.rotation[2] == pytest.approx(-0.03 / 5.0, rel=1e-3)
    # its line of action goes through the edge
    (x, y), (across, up) = run.reaction("left").position[-1], run.reaction("left").force[-1]
    assert abs(x - y * across / up) < 1e-6
    assert abs(run.block("R").displacement[-1, 1] + 0.03) < 1e-14


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.one_in(3)
def test_a_fixed_point_is_led(method: str):
    builder = stones()
    builder.block(name="beam", vertices=box(0.0, 0.0, 4.0, 1.0))
    builder.fixed_point((0.0, 0.0))
    builder.fixed_point((4.0, 0.0))
    builder.motion(name="jack", fixed_point=(4.0, 0.0), y=0.05, ease=0.1, until=1.0)
    run = clast.simulate(builder.build(), step=2e-3, end=1.2, damping="adaptive", **METHODS[method])
    assert np.abs(run.vertices()[1] - [4.0, 0.05]).max() < 4e-12
    total, weight = run.reaction("fixed points"), 4.0 * DENSITY * GRAVITY
    assert total.force[-1] == pytest.approx([0.0, weight], abs=1e-3 * weight)
    jack, centre = run.reaction("jack").force[-1], run.vertices().mean(axis=0)
    assert 4.0 * jack[1] - 0.05 * jack[0] == pytest.approx(weight * centre[0], rel=1e-3)
    assert abs(run.state.ledger.unaccounted) < 1e-6 * run.state.ledger.motions


@pytest.mark.parametrize("method", ["convex", "open-close"])
def test_a_servo_presses_with_its_force(method: str):
    builder = stones()
    builder.block(name="base", vertices=box(0.0, -1.0, 2.0, 1.0), fixed=True)
    builder.block(name="sample", vertices=box(0.0, 0.0, 2.0, 1.0))
    builder.block(name="platen", vertices=box(0.0, 1.0, 2.0, 0.5))
    stress, ramp = (0.0, -1e6), {"time": [0.0, 0.1], "value": [0.0, 1.0]}
    builder.add_amplitude("ramp", **ramp)
    builder.motion(
        name="press",
        block="platen",
        x=0.0,
        rotation=0.0,
        stress=stress,
        limit_speed=0.5,
        amplitude="ramp",
    )
    keys: dict[str, Any] = {**METHODS[method], "contact_law": STIFF}
    run = clast.simulate(builder.build(), step=2e-3, end=0.4, **keys)
    press = run.reaction("press")
    assert press.force[-1, 1] == pytest.approx(-2e6, rel=1e-2)
    assert np.abs(run.state.velocity[:, 1]).max() < 1e-2
    ledger = run.state.ledger
    assert abs(ledger.unaccounted) < 1e-6 * ledger.motions


STAGES = [
    {"name": "rest", "time": 0.1, "until": "time"},
    {"name": "push", "time": 0.1, "until": "time"},
    {"name": "slide", "time": 0.02, "until": "time"},
]


def pushed() -> ModelBuilder:
    builder = drawn()
    builder.motion(name="push", block="box", x=0.5, stage="push", until="slide")
    return builder


def test_motions_begin_and_end_with_stages():
    stages = [clast.Stage(**keys) for keys in STAGES]
    run = clast.simulate(pushed().build(), step=1e-3, end=1.0, stages=stages)
    push = run.reaction("push")
    at = np.searchsorted(push.time, [0.0995, 0.199, 0.2195])
    assert push.force[at[0]].tolist() == [0.0, 0.0]
    assert push.force[at[1], 0] == pytest.approx(FRICTION, rel=1e-6)
    assert push.force[at[2]].tolist() == [0.0, 0.0]
    slows = 0.5 - 0.02 * GRAVITY * np.tan(np.radians(30.0))
    assert run.state.velocity[1, 0] == pytest.approx(slows, rel=1e-3)


@pytest.mark.parametrize("step", [50, 150, 205])
@pytest.mark.one_in(3)
def test_a_run_goes_on_to_the_bit(tmp_path: Path, step: int):
    text = pushed().to_toml(
        step=1e-3, end=1.0, every=0.05, stages=[clast.Stage(**keys) for keys in STAGES]
    )
    case = clast.Case.from_toml(text, ["output.checkpoint_every=1e6"])
    whole, part = tmp_path / "whole.vtkhdf", tmp_path / "part.vtkhdf"
    case.run(output=whole)
    stopped = case.run(output=part, progress=pressed_at(step))
    assert stopped.report.steps == step
    assert clast.resume(stopped.checkpoint).report.finished
    assert differences(whole, part) == []


def test_what_cannot_be_moved_is_refused():
    builder = pushed()
    builder.fixed_point((1.0, 0.5))
    with pytest.raises(ModelError, match="block 'box' is held by a fixed point, too"):
        builder.build()
    builder = pushed()
    builder.motion(name="pull", block="box", x=-1.0)
    with pytest.raises(ModelError, match="x of block 'box' is moved by motion 'push', too"):
        builder.build()
    builder = pushed()
    with pytest.raises(ModelError, match="there is no stage 'push'"):
        clast.simulate(builder.build(), step=1e-3, end=1.0)


def far_led(
    step: float, ends: str, *, fixed: bool = True, ease: float | None = None, **keys: Any
) -> clast.Run:
    """Return the run of a wall that is led at 1 m/s and 50 degrees/s for 0.2 s, then 0.3 s more."""
    builder = stones()
    builder.gravity = (0.0, 0.0)
    builder.block(name="wall", vertices=box(0.0, 0.0, 1.0, 1.0), fixed=fixed)
    builder.block(name="other", vertices=box(9.0, 0.0, 1.0, 1.0))
    moves: dict[str, Any] = {"x": 1.0, "rotation": 50.0}
    if ends == "course":
        builder.add_amplitude("ramp", time=[0.0, 0.2], value=[0.0, 0.2])
        moves = {
            "x": {"displacement": "ramp"},
            "rotation": {"displacement": "ramp", "scale": 50.0},
        }
    elif ends == "time":
        moves["until"] = 0.2
    else:
        moves["until"] = "after"
        each = {"until": "time", "dynamic_ratio": keys.pop("dynamic_ratio", 1.0)}
        first, last = (
            clast.Stage(name="led", time=0.2, **each),
            clast.Stage(name="after", time=0.3, **each),
        )
        keys["stages"] = [first, last]
    builder.motion(block="wall", **moves, **({} if ease is None else {"ease": ease}))
    builder.measured_point("middle", (0.5, 0.5), block="wall")
    whole = {"end": 0.5, "max_displacement": 2.0, **keys}
    return clast.simulate(builder.build(), step=step, **whole)


@pytest.mark.parametrize("ends", ["time", "stage", "course"])
@pytest.mark.parametrize(("fixed", "ratio"), [(True, 1.0), (True, 0.0), (False, 0.0)])
@pytest.mark.parametrize("ease", [None, 0.06])
@pytest.mark.parametrize("step", [0.1, 0.035, 0.01])
@pytest.mark.one_in(6)
def test_a_motion_goes_as_far_as_it_says(
    ends: str, fixed: bool, ratio: float, ease: float | None, step: float
):
    run = far_led(step, ends, fixed=fixed, ease=ease, dynamic_ratio=ratio)
    middle, ledger = run.history("middle"), run.state.ledger
    assert middle.displacement[-1] == pytest.approx([0.2, 0.0], abs=1e-12)
    assert np.degrees(middle.rotation[-1]) == pytest.approx(10.0, abs=1e-10)
    assert np.abs(run.state.velocity[0]).max() < 1e-30
    # what the support gave the wall at the start it takes out of it at the end
    most = float(np.max(run.energy.kinetic))
    for entry in (ledger.kinetic, ledger.motions, ledger.numerical, ledger.unaccounted):
        assert abs(entry) <= 1e-9 * max(most, 1.0)


@pytest.mark.parametrize("step", [0.1, 0.035])
@pytest.mark.parametrize("ends", ["time", "stage"])
def test_a_free_block_is_let_go_as_fast_as_it_is(ends: str, step: float):
    run = far_led(step, ends, fixed=False)
    middle, ledger = run.history("middle"), run.state.ledger
    assert middle.displacement[-1] == pytest.approx([0.5, 0.0], abs=1e-9)
    # a step of free flight turns a block by r + r^3/6
    assert np.degrees(middle.rotation[-1]) == pytest.approx(25.0, rel=(step * 0.9) ** 2 / 6.0)
    energy = 0.5 * DENSITY * (1.0 + np.radians(50.0) ** 2 / 6.0)
    assert [ledger.motions, ledger.kinetic] == pytest.approx([energy, energy], rel=1e-9)
    assert abs(ledger.numerical) < 1e-9 * energy


def test_one_motion_goes_on_where_another_has_ended():
    builder = stones()
    builder.gravity = (0.0, 0.0)
    builder.block(name="wall", vertices=box(0.0, 0.0, 1.0, 1.0), fixed=True)
    builder.block(name="other", vertices=box(9.0, 0.0, 1.0, 1.0))
    builder.motion(name="on", block="wall", x=2.0, stage="second")
    builder.motion(name="off", block="wall", x=1.0, until="second", ease=0.05)
    builder.motion(name="up", block="wall", y=1.0, until=0.33)
    each = {"time": 0.2, "until": "time"}
    stages = [clast.Stage(name="first", **each), clast.Stage(name="second", **each)]
    run = clast.simulate(builder.build(), step=0.03, stages=stages, max_displacement=2.0)
    moved = run.block("wall").displacement[-1]
    # the first lags by half of its ease, and is cut off by the second
    assert moved == pytest.approx([0.2 - 0.025 + 0.4, 0.33], abs=1e-12)
    assert abs(run.state.ledger.unaccounted) < 1e-9 * run.state.ledger.motions


def squeezed(step: float, restitution: float, blocks: int = 1, **of: Any) -> Any:
    """Return the run of a press of 1 mm/s that squeezes blocks against a wall, without weight."""
    builder = stones(angle=of.pop("angle", 0.0))
    builder.gravity = (0.0, 0.0)
    turn = of.pop("turn", 0.0)
    builder.block(name="press", vertices=turned(box(-1.0, 0.0, 1.0, 1.0), turn), fixed=of["fixed"])
    for k in range(blocks):
        corners = box(of["gap"] + k / blocks, 0.0, 1.0 / blocks, 1.0)
        builder.block(name=f"{k}", vertices=turned(corners, turn))
    builder.block(name="wall", vertices=turned(box(1.0 + of["gap"], 0, 1, 1), turn), fixed=True)
    x, y = turned((1e-3, 0.0), turn)
    builder.motion(name="ram", block="press", x=float(x), y=float(y), rotation=0.0, ease=of["ease"])
    process = {"name": "convex", "restitution": restitution}
    return clast.simulate(builder.build(), step=step, end=0.08, process=process)


@pytest.mark.parametrize("step", [5e-4, 2e-3, 2e-2])
@pytest.mark.parametrize("restitution", [0.0, 0.6])
@pytest.mark.parametrize("blocks", [1, 3])
@pytest.mark.parametrize(
    ("fixed", "gap", "ease", "turn"),
    [(True, 0.0, 0.02, 0.0), (False, 0.0, 0.02, 37.0), (True, 2e-5, None, 0.0)],
    ids=["touching", "free and turned", "from afar, with a jolt"],
)
@pytest.mark.one_in(6)
def test_a_slow_press_strikes_nothing(
    step: float, restitution: float, blocks: int, fixed: bool, gap: float, ease: Any, turn: float
):
    of = {"fixed": fixed, "gap": gap, "ease": ease, "turn": turn}
    run = squeezed(step, restitution, blocks, **of)
    ledger, way = run.state.ledger, turned((1.0, 0.0), turn)
    ram, wall = run.reaction("ram").force[-1] @ way, run.reaction("fixed blocks").force[-1] @ way
    assert ram == pytest.approx(-wall, rel=1e-3)
    assert ledger.impacts == 0.0
    spent = ledger.stored + ledger.numerical + ledger.friction
    assert ledger.motions == pytest.approx(spent, rel=1e-6)
    assert np.abs(run.reaction("ram").force[1:] @ way).max() < 1.1 * ram


def test_a_press_strikes_no_harder_than_its_block_can_be_thrown():
    run = squeezed(2e-4, 0.5, 3, fixed=True, gap=0.0, ease=None)
    impulse = 2e-4 * float(np.abs(run.reaction("ram").force[:5, 0]).max())
    assert impulse < 4.0 * DENSITY * 1e-3
