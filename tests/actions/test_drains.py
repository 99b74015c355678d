"""Drains in a network of joints: the lowering of the head, against a dense solution and by hand."""

import numpy as np
import pytest

from clast.model.drainage import distances, lowering, parts_between
from clast.model.model import Floats

NEAR = 1e-6


def lowered(
    joints: list[tuple[float, ...]], level: float, drains: list[tuple[float, float]]
) -> Floats:
    """Lowering at the ends of joints (x1, y1, x2, y2) below a level."""
    ends = np.array(joints, float).reshape(-1, 2, 2)
    near, surface = np.full(len(ends), NEAR), np.array([[0.0, level]])
    return lowering(ends, near, surface, np.array(drains, float).reshape(-1, 2))


def test_without_drains_nothing_is_lowered():
    assert not lowered([(0, 0, 1, 0), (1, 0, 2, 1), (1, 0, 1, 3)], 2.0, []).any()


def test_a_plane_cut_by_the_level_and_drained_at_its_toe_bears_no_pressure():
    (first, last) = lowered([(0, 0, 6, 3)], 2.0, [(0, 0)])[0]
    depth = 2.0 - np.array([0.0, 3.0])
    np.testing.assert_allclose([first, last], depth, rtol=1e-12)


def test_a_stepped_path_below_a_crack_loses_head_by_its_length():
    """Crack from y = 5 to 2; steps of 2, 1 and 3 m to the drain at y = 1."""
    path = [(4, 5, 4, 2), (4, 2, 2, 2), (2, 2, 2, 1), (2, 1, -1, 1)]
    found = lowered(path, 4.0, [(-1, 1)])
    at_drain = 4.0 - 1.0
    exact = np.array([[0, 0], [0, 2], [2, 3], [3, 6]]) / 6.0 * at_drain
    np.testing.assert_allclose(found, exact, atol=1e-12)


def test_a_crack_goes_on_where_it_hardly_bends_and_stands_full_to_its_foot():
    path = [(4, 5, 4.1, 3), (4.1, 3, 4, 1), (4, 1, 0, 0)]
    found = lowered(path, 4.0, [(0, 0)])
    np.testing.assert_allclose(found, [[0, 0], [0, 0], [0, 4]], atol=1e-12)


def test_nothing_feeds_a_drained_part_that_the_level_does_not_reach():
    """A closed ring of joints: water stands in it at the height of the drain."""
    ring = [(0, 0, 2, 0), (2, 0, 2, 1), (2, 1, 0, 1), (0, 1, 0, 0)]
    np.testing.assert_allclose(lowered(ring, 9.0, [(2, 0)]), 9.0, rtol=1e-12)
    # of two drains the lower one decides; the higher one has nothing to take
    np.testing.assert_allclose(lowered(ring, 9.0, [(2, 0), (0, 1)]), 9.0, rtol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_the_head_in_a_grid_is_that_of_the_dense_equations(seed: int):
    """A grid of joints with random spacing under water: free where joints meet, fed at its ends."""
    rng = np.random.default_rng(seed)
    x, y = np.cumsum(rng.uniform(0.5, 2.0, 6)), np.cumsum(rng.uniform(0.5, 2.0, 5))
    joints = [(x[i], y[j], x[i + 1], y[j]) for i in range(5) for j in range(1, 4)]
    joints += [(x[i], y[j], x[i], y[j + 1]) for i in range(1, 5) for j in range(4)]
    level = float(y[-1]) + 3.0
    drain = (float(x[2]), float(y[1]))
    found = lowered(joints, level, [drain])
    points = sorted({(a, b) for x1, y1, x2, y2 in joints for a, b in ((x1, y1), (x2, y2))})
    number = {point: k for k, point in enumerate(points)}
    matrix, right = np.zeros((len(points), len(points))), np.zeros(len(points))
    for x1, y1, x2, y2 in joints:
        one, other = number[x1, y1], number[x2, y2]
        conducts = 1.0 / np.hypot(x2 - x1, y2 - y1)
        matrix[[one, other], [one, other]] += conducts
        matrix[[one, other], [other, one]] -= conducts
    for point, k in number.items():
        inner = x[0] < point[0] < x[-1] and y[0] < point[1] < y[-1]
        if not inner or point == drain:
            matrix[k] = 0.0
            matrix[k, k], right[k] = 1.0, level - drain[1] if point == drain else 0.0
    exact = np.linalg.solve(matrix, right)
    for joint, ends in zip(joints, found, strict=True):
        np.testing.assert_allclose(
            ends, [exact[number[joint[:2]]], exact[number[joint[2:]]]], atol=1e-9
        )


def test_joints_are_divided_at_drains_within_them():
    ends = np.array([[[0.0, 0.0], [4.0, 0.0]], [[4.0, 0.0], [4.0, 3.0]]])
    drains = np.array([[1.0, 0.0], [4.0, 0.0], [3.0, 0.0]])
    part, share = parts_between(ends, np.full(2, NEAR), drains)
    assert part.tolist() == [0, 0, 0, 1]
    np.testing.assert_allclose(share, [[0, 0.25], [0.25, 0.75], [0.75, 1], [0, 1]])
    np.testing.assert_allclose(distances(ends, np.array([[2.0, 0.5], [5.0, 4.0]])), [0.5, 2**0.5])


@pytest.mark.parametrize("seed", range(5))
def test_drains_take_water_or_have_no_pressure(seed: int):
    """A wall of drains beside a grid: water leaves where it presses, and none comes in (by hand).

    Each drain takes water and has no pressure, or takes none and would have a suction.
    """
    rng = np.random.default_rng(seed)
    x, y = np.cumsum(rng.uniform(0.5, 2.0, 5)), np.cumsum(rng.uniform(0.5, 2.0, 9))
    joints = [(x[i], y[j], x[i + 1], y[j]) for i in range(4) for j in range(1, 8)]
    joints += [(x[i], y[j], x[i], y[j + 1]) for i in range(1, 4) for j in range(8)]
    wall = [(float(x[0]), float(y[j])) for j in range(1, 8)]
    level = float(y[-1]) + 1.0
    found = lowered(joints, level, wall)
    ends = np.array(joints).reshape(-1, 2, 2)
    pressure = level - ends[..., 1] - found
    flow = (found[:, 0] - found[:, 1]) / np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    on_wall = ends[:, 0, 0] == x[0]
    assert on_wall.sum() == 7
    assert (pressure[on_wall, 0] < 1e-9).all() and (flow[on_wall] > -1e-9).all()
    assert (np.abs(pressure[on_wall, 0] * flow[on_wall]) < 1e-9).all()
    assert (flow[on_wall] > 1e-3).any()
