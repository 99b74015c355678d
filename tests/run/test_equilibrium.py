"""What counts as equilibrium: blocks that come to rest reach it, those that move do not."""

import numpy as np
import pytest

import clast
from clast import Stage
from clast.actions.damping import Kinetic
from clast.results import Run
from scenes.systems import convex

G = 9.81
FRICTION = 30.0


def on_plane(steeper: float, press: float = 0.0) -> clast.ModelBuilder:
    """Return a block on a plane ``steeper`` degrees steeper than its friction angle.

    It is the gravity that is turned.  ``press`` is a force on the plane, in units of the weight.
    """
    angle = np.radians(FRICTION + steeper)
    builder = clast.ModelBuilder(gravity=(G * np.sin(angle), -G * np.cos(angle)))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=FRICTION)
    builder.block(vertices=[(-3, -1), (3, -1), (3, 0), (-3, 0)], name="plane", fixed=True)
    builder.block(vertices=[(-0.5, 0), (0.5, 0), (0.5, 1), (-0.5, 1)], name="block")
    if press:
        # the weight along the plane by which friction is exceeded stays the same
        weight = 2500.0 * G
        force = press * weight * np.array([np.tan(np.radians(FRICTION)), -1.0])
        builder.point_load((0, 0.02), force, block="block")
    return builder


def run_of(builder: clast.ModelBuilder, stage: Stage, **keys: object) -> Run:
    """Return the run of one stage."""
    return clast.simulate(builder.build(), stages=[stage], **keys)


@pytest.mark.parametrize("ratio", [0.0, 1.0])
def test_a_tenth_of_a_degree_too_steep_is_no_equilibrium(ratio: float):
    stage = Stage(name="rest", time=0.08, dynamic_ratio=ratio)
    run = run_of(on_plane(0.1), stage, step=1e-3)
    (record,) = run.stages
    assert record.outcome == ("moving" if ratio else "fails")
    assert record.end <= 0.08 * (1.0 + 1e-9)
    assert record.mover.block == "block"
    assert abs(record.mover.direction) < 3.0
    # the acceleration that is left over
    beyond = np.radians(0.1) / np.cos(np.radians(FRICTION))
    assert record.force_ratio > 0.3 * beyond
    (text,) = (one for one in run.report.warnings if "stage 'rest'" in one)
    assert "'block'" in text and "+x" in text


def test_a_pendulum_is_moving_at_the_end_of_its_swing():
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(
        vertices=[(-0.1, -1), (0.1, -1), (0.1, 0), (-0.1, 0)], name="bob", velocity=(0.3, 0, 0.6)
    )
    builder.fixed_point((0, 0))
    stage = Stage(name="swing", time=1.2, speed=0.05, hold=5)
    speeds = []
    run = run_of(builder, stage, step=2e-3, progress=lambda now: speeds.append(now.speed))
    limit = stage.speed * np.sqrt(G * np.sqrt(0.2))
    slow = np.array(speeds) < limit
    assert slow.sum() > 2 * stage.hold  # it is slow for long enough, twice
    assert run.stages[0].outcome == "moving"


def test_a_block_at_the_top_of_its_flight_is_moving():
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(-3, -1), (3, -1), (3, 0), (-3, 0)], name="floor", fixed=True)
    for x in range(-3, 3):
        builder.block(vertices=[(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)])
    corners = [(0.4, 1.5), (0.41, 1.5), (0.41, 1.51), (0.4, 1.51)]
    builder.block(vertices=corners, name="pebble", velocity=(0, 0.1 * G, 0))
    stage = Stage(name="flight", time=0.2, speed=1.0, hold=10)
    run = run_of(builder, stage, step=1e-3)
    assert run.stages[0].outcome == "moving"
    assert run.stages[0].force_ratio == pytest.approx(1.0)


def stack(count: int) -> clast.ModelBuilder:
    """Return stiff blocks upon each other that are dropped onto the floor by nothing."""
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=FRICTION)
    builder.block(vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], name="floor", fixed=True)
    for row in range(count):
        builder.block(vertices=[(0, row), (1, row), (1, row + 1), (0, row + 1)])
    return builder


@pytest.mark.parametrize(
    ("process", "stiffness", "ratio", "law", "step"),
    [
        ("convex", 20e9, 1.0, "penalty", 1e-3),
        ("convex", 20e9, 0.0, "augmented-lagrangian", 1e-3),
        ("open-close", 20e9, 0.0, "penalty", 1e-3),
        ("open-close", 2e9, 0.0, "augmented-lagrangian", 1e-3),
        ("modified", 5e7, 0.0, "penalty", 1e-2),
        ("modified", 5e7, 0.0, "augmented-lagrangian", 1e-2),
    ],
)
def test_a_stiff_stack_comes_to_rest(
    process: str, stiffness: float, ratio: float, law: str, step: float
):
    run = run_of(
        stack(3),
        Stage(name="rest", time=500 * step, dynamic_ratio=ratio),
        step=step,
        process=process,
        contact_law={"name": law, "normal_stiffness": stiffness},
    )
    (record,) = run.stages
    assert record.outcome == "equilibrium"
    assert record.force_ratio < 1e-4
    assert (20 if ratio else 2) <= record.steps < 500
    weight = 2500.0 * G
    assert run.contacts().normal_force.sum() == pytest.approx(weight * (3 + 2 + 1), rel=1e-3)


def test_a_heap_that_has_fallen_comes_to_rest():
    rng = np.random.default_rng(5)
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=25.0)
    builder.block(vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], name="floor", fixed=True)
    builder.block(vertices=[(-2, 0), (-1.5, 0), (-1.5, 3), (-2, 3)], name="left", fixed=True)
    builder.block(vertices=[(1.5, 0), (2, 0), (2, 3), (1.5, 3)], name="right", fixed=True)
    for k in range(6):
        outline = convex(rng, 5, 0.4) + np.array([0.8 * (k % 3) - 0.8, 0.85 * (k // 3) + 0.5])
        builder.block(vertices=outline)
    run = run_of(builder, Stage(name="fall", time=6.0), step=5e-3)
    (record,) = run.stages
    assert record.outcome == "equilibrium", record
    assert 0.3 < record.end < 6.0


def test_loads_that_still_rise_are_no_equilibrium():
    builder = on_plane(-5.0)
    builder.add_amplitude("slow", time=[0.0, 0.4], value=[0.0, 1.0])
    builder.point_load((0, 1), (0.0, -10.0), amplitude="slow", block="block")
    run = run_of(builder, Stage(name="rest", time=1.0, dynamic_ratio=0.0), step=2e-3)
    assert run.stages[0].outcome == "equilibrium"
    assert run.stages[0].end > 0.4


def on_wet_plane(share: float) -> clast.ModelBuilder:
    """Return a block on a plane of 20 degrees; the water under it has a ``share`` of the head.

    W sin 20 = (W cos 20 - p L) tan phi is where it begins to slide.
    """
    slope, side, density = np.radians(20.0), 1.0, 2500.0
    normal = np.cos(slope) - np.sin(slope) / np.tan(np.radians(FRICTION))
    head = share * normal * density * side / 1000.0
    down, up = np.array([np.cos(slope), -np.sin(slope)]), np.array([np.sin(slope), np.cos(slope)])
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=density)
    builder.add_joint(friction_angle=FRICTION)
    plane = [5.0 * down, -5.0 * down, -5.0 * down - up, 5.0 * down - up]
    builder.block(vertices=plane, name="plane", fixed=True)
    half = 0.5 * side * down
    builder.block(vertices=[half, half + side * up, side * up - half, -half], name="block")
    line = [5.0 * down + (0.0, head), -5.0 * down + (0.0, head)]
    builder.water(line=line, acts_on="joints")
    return builder


@pytest.mark.parametrize(("share", "outcome"), [(1.01, "fails"), (0.98, "equilibrium")])
def test_slow_sliding_on_a_wet_plane_fails(share: float, outcome: str):
    stage = Stage(name="rest", time=0.3, dynamic_ratio=0.0)
    run = run_of(on_wet_plane(share), stage, step=1e-3)
    assert run.stages[0].outcome == outcome
    if outcome == "fails":
        assert run.stages[0].mover.block == "block"
        assert run.stages[0].mover.direction == pytest.approx(-20.0, abs=3.0)


def sinking(**keys: object) -> clast.ModelBuilder:
    """Return a column on dashpots that nothing else holds: it creeps down at W/(rho c_p)."""
    builder = clast.ModelBuilder(gravity=(0.0, -G))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=FRICTION)
    for row in range(3):
        corners = [(0, row), (1, row), (1, row + 1), (0, row + 1)]
        builder.block(vertices=corners, name=f"b{row}")
    builder.viscous_boundary(side="bottom", **keys)
    return builder


@pytest.mark.parametrize("ratio", [0.0, 1.0])
def test_a_column_that_creeps_on_dashpots_is_moving(ratio: float):
    """Its speed is steady and its dashpots bear the weight: what damps counts as no support."""
    stage = Stage(name="rest", time=0.3, dynamic_ratio=ratio, speed=1.0, hold=5)
    run = run_of(sinking(static="none"), stage, step=2e-3)
    (record,) = run.stages
    assert record.outcome == ("moving" if ratio else "fails")
    assert record.force_ratio > 0.1
    # nothing but its force tells: by then it is as slow as the stage allows
    assert record.mover.speed < np.sqrt(G)
    assert abs(record.mover.direction + 90.0) < 5.0


def test_kinetic_stops_are_no_equilibrium():
    """Kinetic damping stops a block that slides, time and again: it is not at rest."""
    stage = Stage(name="rest", time=0.2, damping=Kinetic(), hold=5)
    run = run_of(on_plane(0.5), stage, step=1e-3)
    assert run.stages[0].outcome == "moving"
    run = run_of(stack(3), Stage(name="rest", time=0.5, damping=Kinetic()), step=5e-4)
    assert run.stages[0].outcome == "equilibrium"
