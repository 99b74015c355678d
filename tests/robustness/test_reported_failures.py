"""Simple scenes at which other programs have been reported to fail."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from clast.model.model import Floats, Model
from scenes.systems import (
    box,
    by_convex,
    centroids,
    finish,
    march,
    overlaps,
    system,
    turned,
    voussoirs,
)

GROUND = box(-20.0, -1.0, 40.0, 1.0)
SLOPE = 26.565
"""A slope of 1 in 2, degrees."""


def wedge_of_bricks(length: float = 11.0, height: float = 2.0) -> list[Floats]:
    """Return a flat triangle in running bond, cut along its sides: 32 blocks, slivers included."""
    outline = shapely.Polygon([(0.0, 0.0), (length, 0.0), (length / 2.0, height)])
    pieces = []
    for course in range(int(height / 0.5)):
        for left in np.arange(-0.5 * (course % 2), length):
            brick = shapely.box(left, 0.5 * course, left + 1.0, 0.5 * course + 0.5)
            piece = outline.intersection(brick)
            if piece.area > 1e-3:
                ring = shapely.geometry.polygon.orient(piece).exterior
                pieces.append(np.array(ring.coords)[:-1])
    return pieces


@pytest.mark.parametrize("stiffness", [5e8, 5e10])
def test_a_wedge_of_32_blocks_rests_on_a_slope(stiffness: float) -> None:
    """At 26.5 degrees with a friction angle of 30 it comes to rest and does not creep."""
    angle = np.radians(26.5)
    bricks = wedge_of_bricks()
    assert len(bricks) == 32
    slope = box(-2.0, -2.0, 15.0, 2.0)
    model = system([turned(one, angle) for one in (slope, *bricks)], fixed=[0], friction_angle=30.0)
    results = march(model, by_convex(stiffness), 1e-3, 0.5)
    rest, end = results[299].state, results[-1].state
    assert np.abs(end.vertices - model.vertices).max() < 1e-3
    assert np.abs(end.vertices - rest.vertices).max() < 1e-11
    # constant acceleration leaves slivers ringing, v+ = -v with d = 0; it fades and moves nothing
    assert end.ledger.kinetic < rest.ledger.kinetic < 1e-12


def block_on_slope(tangent: float) -> Model:
    """Return a block on a fixed slope of 1 in 2 with this coefficient of friction."""
    angle = np.radians(SLOPE)
    return system(
        [turned(box(-5.0, -2.0, 10.0, 2.0), angle), turned(box(0.0, 0.0), angle)],
        fixed=[0],
        friction_angle=np.degrees(np.arctan(tangent)),
        young=50e9,
    )


@pytest.mark.parametrize("tangent", [0.49, 0.499, 0.50])
@pytest.mark.parametrize("stiffness", [5e9, 5e10])
def test_the_coefficient_of_friction_decides(tangent: float, stiffness: float) -> None:
    """At 0.49 the block slides as it should, at 0.50 it sticks; it starts settled on its springs.

    (Dropped on unloaded springs it would gain some speed before the friction is there, and at
    0.50, where slope and friction are in balance, nothing would take that away.)
    """
    model, how = block_on_slope(tangent), by_convex(stiffness)
    rest = march(model, replace(how, dynamic_ratio=0.0), 1e-3, 0.05)[-1].state
    start = replace(rest, velocity=np.zeros_like(rest.velocity))
    end = march(model, how, 1e-3, 0.55, start)[-1].state
    along = np.array([np.cos(np.radians(SLOPE)), np.sin(np.radians(SLOPE))])
    slid = -float((centroids(model, end) - centroids(model, rest))[1] @ along)
    exact = 0.5 * 9.8 * max(0.0, along[1] - tangent * along[0]) * 0.5**2
    assert slid == pytest.approx(exact, rel=1e-6, abs=1e-9)


def test_a_block_dropped_on_the_slope_stops_where_friction_wins() -> None:
    """With 0.51 the little speed from the unloaded springs is gone at once."""
    end = march(block_on_slope(0.51), by_convex(5e9), 1e-3, 0.3)[-1].state
    assert np.abs(end.velocity[:, :3]).max() < 1e-9
    assert np.abs(end.vertices - block_on_slope(0.51).vertices).max() < 1e-4


LEANING = [GROUND, *[box(0.1 * k, k) for k in range(5)], box(3.0, 0.2)]
"""A leaning stack, and a block that falls a little beside it."""


@pytest.mark.parametrize(
    ("extra", "held"),
    [(box(10.0, 0.5), True), (box(10.0, 0.0), False)],
    ids=["fixed in the air", "resting far away"],
)
def test_a_block_that_touches_nothing_changes_nothing(extra: Floats, held: bool) -> None:
    alone = system(LEANING, fixed=[0], friction_angle=30.0)
    both = system([*LEANING, extra], fixed=[0, 7] if held else [0], friction_angle=30.0)
    for stiffness in (5e9, 5e10):
        one = march(alone, by_convex(stiffness), 1e-3, 0.2)[-1].state
        other = march(both, by_convex(stiffness), 1e-3, 0.2)[-1].state
        assert np.abs(other.vertices[: len(one.vertices)] - one.vertices).max() <= 1e-12


@pytest.mark.parametrize("step", [1e-3, 5e-3])
@pytest.mark.parametrize("stiffness", [5e8, 5e10, 5e12])
def test_stacked_boxes_are_not_ejected(stiffness: float, step: float) -> None:
    model = system([GROUND, *[box(0.1 * k, k) for k in range(5)]], fixed=[0], friction_angle=30.0)
    done = finish(model, by_convex(stiffness), step, 0.3)
    assert done.failed_steps == 0
    assert done.moved[:, 1].max() < 1e-9
    assert done.drift < 5e-3


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10, 5e11])
def test_an_arch_stands(stiffness: float) -> None:
    model = system([box(-4.0, -1.0, 8.0, 1.0), *voussoirs(15)], fixed=[0], friction_angle=35.0)
    done = finish(model, by_convex(stiffness), 1e-3, 0.3)
    assert done.failed_steps == 0
    assert np.abs(done.moved).max() < 5e-4
    assert np.abs(done.run.state.velocity[:, :3]).max() < 1e-3
    depth = done.run.report.largest_penetration
    assert all(area <= depth for *_, area in overlaps(model, done.run.state.vertices))
