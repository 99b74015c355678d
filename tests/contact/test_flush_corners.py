"""Blocks that meet corner to corner, flush with each other's faces, do not bear on each other."""

import numpy as np
import pytest

from scenes.systems import (
    BISECTOR,
    box,
    by_convex,
    candidates_of,
    courses_of_bricks,
    flat,
    march,
    system,
    touches_of,
)

UPPER_LEFT, UPPER_RIGHT = box(-1.0, 0.0), box(0.0, 0.0)
LOWER_LEFT, LOWER_RIGHT = box(-1.0, -1.0), box(0.0, -1.0)
FOUR = [UPPER_LEFT, UPPER_RIGHT, LOWER_LEFT, LOWER_RIGHT]


def moved(outline, x, y):
    """Return an outline shifted by (x, y), m."""
    return outline + np.array([x, y])


def pairs_of(outlines):
    """Return the pairs of blocks that have contacts."""
    return {tuple(sorted((one.vertex[0], one.edge[0]))) for one in touches_of(outlines)}


def test_four_blocks_around_a_point_bear_on_their_neighbours_only():
    assert pairs_of(FOUR) == {(0, 1), (2, 3), (0, 2), (1, 3)}


@pytest.mark.parametrize("lift", [1e-9, 1e-7, 1e-4])
def test_a_block_just_above_the_corner_beside_it_is_not_held(lift):
    outlines = [moved(UPPER_LEFT, 0.0, lift), LOWER_RIGHT]
    assert pairs_of(outlines) == set()


@pytest.mark.parametrize("overhang", [1e-6, 1e-3])
def test_a_block_that_overhangs_the_corner_is_held(overhang):
    held = touches_of([moved(UPPER_LEFT, overhang, 1e-4), LOWER_RIGHT])
    assert {one.edge for one in held} == {(1, 2), (0, 0)}, "its corner, and the corner below it"


def test_a_block_that_moves_over_the_corner_is_held():
    """The step's motion is what tells a block that slides past from one that runs in."""
    outlines = [moved(UPPER_LEFT, 0.0, 1e-4), LOWER_RIGHT]
    shift = np.zeros_like(flat(outlines).vertices)
    for across, expected in ((0.0, False), (1e-4, True), (-1e-4, False)):
        shift[:4] = (across, -2e-4)
        found = candidates_of(outlines, shift=shift)
        kept = BISECTOR.choose(found)
        tops = kept & (found.edge == 6)  # the top of the lower block
        assert tops.any() == expected


def test_a_tip_that_can_only_land_on_the_corner_is_held():
    """A square on its tip, exactly above the corner: the face beside it could not stop it."""
    tip = np.array([[0.0, 1e-4], [0.7, 0.7], [0.0, 1.4], [-0.7, 0.7]])
    assert pairs_of([tip, LOWER_RIGHT]) == {(0, 1)}


def test_columns_side_by_side_settle_as_one_column_does():
    """Aligned columns that bounce: held by corners beside them, they would sway within steps."""
    courses, columns, step = 8, 3, 2e-4
    base = box(-1.0, -1.0, columns + 2.0, 1.0)
    bricks = courses_of_bricks(courses, columns, bonded=False)
    model = system([base, *bricks], fixed=[0], friction_angle=26.57, poisson=0.0, density=2600.0)
    results = march(model, by_convex(5e9), step, 60 * step)
    sideways = max(np.abs(result.state.velocity[:, [0, 2]]).max() for result in results)
    bounce = max(np.abs(result.state.velocity[:, 1]).max() for result in results)
    assert bounce > 0.01
    assert sideways < 1e-9 * bounce
