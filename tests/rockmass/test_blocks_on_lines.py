"""Lines and points against a wall of unit squares, where the answers are plain."""

from __future__ import annotations

import numpy as np
import pytest

from clast.rockmass.drawings.block_arrays import blocks_with, crossed_blocks

COLUMNS, ROWS = 4, 3
CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
VERTICES = np.vstack([CORNERS + np.array([c, r]) for r in range(ROWS) for c in range(COLUMNS)])
START = np.arange(0, 4 * COLUMNS * ROWS + 1, 4)


def test_a_line_through_a_row_holds_each_block_in_its_middle():
    blocks, points = crossed_blocks([(-1, 0.25), (9, 0.25)], VERTICES, START)
    assert blocks.tolist() == [0, 1, 2, 3]
    np.testing.assert_allclose(points, [(0.5, 0.25), (1.5, 0.25), (2.5, 0.25), (3.5, 0.25)])


def test_a_line_along_the_base_holds_the_lowest_row():
    blocks, points = crossed_blocks([(0.5, 0), (3.5, 0)], VERTICES, START)
    assert blocks.tolist() == [0, 1, 2, 3]
    np.testing.assert_allclose(points[:, 0], [0.75, 1.5, 2.5, 3.25])


def test_the_diagonal_passes_corners_and_holds_what_it_crosses():
    blocks, points = crossed_blocks([(0, 0), (3, 3)], VERTICES, START)
    assert blocks.tolist() == [0, 5, 10]
    np.testing.assert_allclose(points, [(0.5, 0.5), (1.5, 1.5), (2.5, 2.5)])


@pytest.mark.parametrize("seed", range(5))
def test_lines_at_random_against_sampling(seed):
    random = np.random.default_rng(seed)
    ends = random.uniform(-1, 5, (2, 2))
    blocks, points = crossed_blocks(ends, VERTICES, START)
    sampled = ends[0] + np.linspace(0, 1, 20001)[:, None] * (ends[1] - ends[0])
    cells = np.floor(sampled).astype(int)
    inside = ((cells >= 0) & (cells < (COLUMNS, ROWS))).all(axis=1)
    assert set(blocks) == {c + COLUMNS * r for c, r in cells[inside]}
    assert [int(x) + COLUMNS * int(y) for x, y in points] == blocks.tolist()


def test_points_lie_in_blocks_or_in_none():
    found = blocks_with([(0.5, 0.5), (3.5, 2.5), (9, 9), (1.0, 0.5)], VERTICES, START)
    assert found.tolist() == [0, 11, -1, 0]
    assert blocks_with(np.zeros((0, 2)), VERTICES, START).shape == (0,)


def test_a_line_beside_all_blocks_crosses_none():
    blocks, points = crossed_blocks([(-2, -2), (-1, 5)], VERTICES, START)
    assert blocks.shape == (0,) and points.shape == (0, 2)
