"""What stands still, whatever the stiffness of contacts and the step: walls, stacks, slabs, arches.

Some are scenes at which other programs have been reported to fail.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import shapely

from clast.model.model import Floats, Model
from scenes.systems import (
    GRAVITY,
    Finished,
    at_start,
    box,
    by_convex,
    centroids,
    finish,
    heap,
    march,
    overlaps,
    system,
    turned,
    voussoirs,
    wall,
)

YOUNG = 5e9
GROUND = box(-20.0, -1.0, 40.0, 1.0)
SLOPE = 26.565
"""A slope of 1 in 2, degrees."""


def check(done: Finished, drift: float = np.inf) -> None:
    """Assert that no step failed, nothing moved away and no energy came from nowhere."""
    assert done.failed_steps == 0
    assert done.drift < drift
    assert done.created <= 1e-9 * done.turnover
    assert abs(done.run.report.ledger.unaccounted) < 1e-6 * done.turnover


def on_ground(*outlines: Floats, friction_angle: float = 30.0, **more: object) -> Model:
    """Return blocks on a fixed ground."""
    return system([GROUND, *outlines], fixed=[0], friction_angle=friction_angle, **more)


def slabs() -> Model:
    """Return slabs of 5 m x 0.1 m, each a little beside the one below."""
    shift = [0.4 * (k % 2) + 0.1 * (k % 3) for k in range(20)]
    return on_ground(*[box(-2.5 + shift[k], 0.1 * k, 5.0, 0.1) for k in range(20)])


def unequal() -> Model:
    """Return a block of 8 m x 10 m on cubes of 1 cm, and others on it."""
    under = [box(x, 0.0, 0.01, 0.01) for x in (1.0, 5.0, 8.99)]
    upon = [box(2.0 + 0.02 * k, 10.01, 0.01, 0.01) for k in range(5)]
    return on_ground(*under, box(1.0, 0.01, 8.0, 10.0), *upon, young=50e9)


STANDING: dict[str, tuple[Callable[[], Model], float, float, float]] = {
    "fifty storeys": (lambda: on_ground(*[box(0.0, k) for k in range(50)]), 1e-3, 0.2, 1e-4),
    "slabs": (slabs, 1e-3, 0.2, 2e-4),
    "unequal": (unequal, 1e-3, 0.3, 1e-5),
    "leaning": (lambda: on_ground(*[box(0.1 * k, k) for k in range(5)]), 1e-3, 0.3, 5e-3),
    "leaning, large steps": (
        lambda: on_ground(*[box(0.1 * k, k) for k in range(5)]),
        5e-3,
        0.3,
        5e-3,
    ),
    "arch": (lambda: on_ground(*voussoirs(15), friction_angle=35.0), 1e-3, 0.3, 5e-4),
    "105 bricks": (lambda: wall(10, 10), 1e-3, 0.3, 5e-5),
}
"""Model, step and end, s, and the horizontal movement that counts, m."""


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
@pytest.mark.parametrize("name", STANDING)
@pytest.mark.one_in(2)
def test_what_stands_stays(name: str, stiffness: float) -> None:
    build, step, end, drift = STANDING[name]
    small = {"critdis": 5e-4, "max_displacement": 1e-3} if name == "unequal" else {}
    model = build()
    done = finish(model, by_convex(stiffness, **small), step, end)
    check(done, drift if stiffness >= 5e9 or name == "slabs" else 10.0 * drift)
    assert done.moved[:, 1].max() < 1e-5
    if name == "105 bricks":
        assert done.run.report.cut_steps == 0 and done.iterations <= 4.0
    if name == "arch":
        depth = done.run.report.largest_penetration
        assert all(area <= depth for *_, area in overlaps(model, done.run.state.vertices))


@pytest.mark.slow
@pytest.mark.parametrize("step", [2e-4, 1e-3, 5e-3])
@pytest.mark.parametrize("share", [0.01, 0.1, 1.0, 10.0, 50.0])
def test_105_bricks_stand_for_any_stiffness_and_step(share: float, step: float) -> None:
    done = finish(wall(10, 10, friction_angle=26.57), by_convex(share * YOUNG), step, 200 * step)
    check(done, 5e-5 if share >= 1.0 else 2e-3)


@pytest.mark.parametrize("bonded", [True, False], ids=["running bond", "aligned columns"])
@pytest.mark.parametrize("share", [0.1, 1.0, 50.0])
def test_the_base_carries_the_weight(bonded: bool, share: float) -> None:
    """The mean penetration is W/(n_c p), where every corner meets a corner too."""
    model = wall(6, 6, bonded=bonded, friction_angle=26.57)
    done = finish(model, by_convex(share * YOUNG), 5e-3, 0.5)
    weight = float(model.mass[~model.fixed].sum()) * GRAVITY
    memory = done.run.state.memory
    depth = -memory.gap[(memory.block == 0) & (memory.gap < 0.0)]
    check(done, 5e-5)
    assert len(depth) == 12
    assert depth.mean() == pytest.approx(weight / (12 * share * YOUNG), rel=1e-3)
    assert depth.max() <= 1.2 * depth.mean()


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_a_smooth_wedge_drives_two_blocks_apart(stiffness: float) -> None:
    """Without friction the wedge falls with m g/(m + 2 M tan2 a), the blocks give way evenly."""
    slope = np.tan(np.radians(20.0))
    right = np.array([[0.2, 0.0], [4.0, 0.0], [4.0, 2.0], [0.2 + 2.0 * slope, 2.0]])
    low, high = 0.2 + 0.4 * slope, 0.2 + 2.0 * slope
    wedge = np.array([[-low, 0.4], [low, 0.4], [high, 2.0], [-high, 2.0]])
    model = on_ground(right[::-1] * [-1.0, 1.0], right, wedge, friction_angle=0.0, poisson=0.0)
    done = finish(model, by_convex(stiffness), 1e-3, 0.3)
    moved = centroids(model, done.run.state) - centroids(model, at_start(model))
    fall = GRAVITY * model.mass[3] / (model.mass[3] + 2.0 * model.mass[1] * slope**2)
    assert done.failed_steps == 0
    assert moved[3, 1] == pytest.approx(-0.5 * fall * 0.3**2, rel=5e-3)
    assert moved[2, 0] == pytest.approx(0.5 * fall * slope * 0.3**2, rel=5e-3)
    assert moved[1, 0] == pytest.approx(-moved[2, 0], rel=1e-9)


@pytest.mark.parametrize("stiffness", [5e8, 5e10])
def test_a_wedge_of_32_blocks_rests_on_a_slope(stiffness: float) -> None:
    """A flat triangle in running bond, slivers included, at 26.5 degrees with 30 of friction."""
    outline = shapely.Polygon([(0.0, 0.0), (11.0, 0.0), (5.5, 2.0)])
    bricks = []
    for course in range(4):
        for left in np.arange(-0.5 * (course % 2), 11.0):
            brick = shapely.box(left, 0.5 * course, left + 1.0, 0.5 * course + 0.5)
            piece = outline.intersection(brick)
            if piece.area > 1e-3:
                ring = shapely.geometry.polygon.orient(piece).exterior
                bricks.append(np.array(ring.coords)[:-1])
    assert len(bricks) == 32
    slope, angle = box(-2.0, -2.0, 15.0, 2.0), np.radians(26.5)
    model = system([turned(one, angle) for one in (slope, *bricks)], fixed=[0], friction_angle=30.0)
    results = march(model, by_convex(stiffness), 1e-3, 0.5)
    rest, end = results[299].state, results[-1].state
    assert np.abs(end.vertices - model.vertices).max() < 1e-3
    assert np.abs(end.vertices - rest.vertices).max() < 1e-11
    # constant acceleration leaves slivers ringing, v+ = -v with d = 0; it fades and moves nothing
    assert end.ledger.kinetic < rest.ledger.kinetic < 1e-12


def block_on_slope(degrees: float, friction_angle: float) -> Model:
    """Return a block of 1 m on a fixed slope."""
    angle = np.radians(degrees)
    blocks = [turned(box(-5.0, -2.0, 10.0, 2.0), angle), turned(box(0.0, 0.0), angle)]
    return system(blocks, fixed=[0], friction_angle=friction_angle, young=50e9)


@pytest.mark.parametrize("tangent", [0.49, 0.499, 0.50])
@pytest.mark.parametrize("stiffness", [5e9, 5e10])
def test_the_coefficient_of_friction_decides(tangent: float, stiffness: float) -> None:
    """At 0.49 the block slides as it should, at 0.50 it sticks, settled on its springs before."""
    model, how = block_on_slope(SLOPE, np.degrees(np.arctan(tangent))), by_convex(stiffness)
    rest = march(model, replace(how, dynamic_ratio=0.0), 1e-3, 0.05)[-1].state
    start = replace(rest, velocity=np.zeros_like(rest.velocity))
    end = march(model, how, 1e-3, 0.55, start)[-1].state
    along = np.array([np.cos(np.radians(SLOPE)), np.sin(np.radians(SLOPE))])
    slid = -float((centroids(model, end) - centroids(model, rest))[1] @ along)
    exact = 0.5 * 9.8 * max(0.0, along[1] - tangent * along[0]) * 0.5**2
    assert slid == pytest.approx(exact, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("step", "end", "most"),
    [
        (0.02, 10.0, 1e-9),
        *(pytest.param(step, 100.0, 1e-6, marks=pytest.mark.slow) for step in (0.01, 0.02)),
    ],
)
def test_a_block_held_by_friction_does_not_creep(step: float, end: float, most: float) -> None:
    """At 44.9 degrees, held by 45: after its first second."""
    results = march(block_on_slope(44.9, 45.0), by_convex(5e9), step, end)
    first = next(one.state for one in results if one.state.time > 1.0 - 1e-9)
    assert np.abs(results[-1].state.vertices - first.vertices).max() < most


@pytest.mark.parametrize("held", [True, False])
def test_a_block_that_touches_nothing_changes_nothing(held: bool) -> None:
    leaning = [GROUND, *[box(0.1 * k, k) for k in range(5)], box(3.0, 0.2)]
    extra = box(10.0, 0.5 if held else 0.0)
    alone = system(leaning, fixed=[0], friction_angle=30.0)
    both = system([*leaning, extra], fixed=[0, 7] if held else [0], friction_angle=30.0)
    for stiffness in (5e9, 5e10):
        one = march(alone, by_convex(stiffness), 1e-3, 0.2)[-1].state
        other = march(both, by_convex(stiffness), 1e-3, 0.2)[-1].state
        assert np.abs(other.vertices[: len(one.vertices)] - one.vertices).max() <= 1e-12


@pytest.mark.parametrize(
    ("share", "step", "end"),
    [
        *((share, 5e-3, 3.5) for share in (0.01, 1.0, 10.0)),
        *(pytest.param(share, 1e-3, 1.5, marks=pytest.mark.slow) for share in (0.01, 0.1, 10.0)),
    ],
)
@pytest.mark.one_in(3)
def test_a_heap_settles(share: float, step: float, end: float) -> None:
    """Random polygons, convex and not, fall into a trough; nothing passes through."""
    done = finish(heap(30, 6), by_convex(share * YOUNG, max_displacement=0.05), step, end)
    check(done)
    deepest = done.run.report.largest_penetration
    pairs = overlaps(done.run.model, done.run.state.vertices)
    assert all(area <= 1.1 * deepest for *_, area in pairs)
    # a block may lean for long before it topples: one did from 2.0 to 2.9 s
    assert end < 3.0 or done.run.report.ledger.kinetic < 1e-3 * done.turnover
