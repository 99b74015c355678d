"""Blocks drawn one by one, put together: what the repair promises, by brute force."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from clast.errors import ModelError
from clast.inputs.builder import InputBuilder
from clast.rockmass.block_loops import sound
from clast.rockmass.repair import Repaired, repaired
from clast.rockmass.shared_places import corners_of
from scenes.common_areas import area_in_common
from scenes.drawn_blocks import area, following, jointed, rounded, wall

CORNER = np.array([0.1234, 0.0567])
"""Lower left corner of walls, which is on no grid."""


def loops_of(found: Repaired) -> list[np.ndarray]:
    return [found.polygon(block) for block in range(len(found.start) - 1)]


def assert_no_overlap(loops: list[np.ndarray]) -> None:
    """Every pair of blocks whose boxes meet has no area in common but round-off."""
    low = np.array([loop.min(axis=0) for loop in loops])
    high = np.array([loop.max(axis=0) for loop in loops])
    for k, loop in enumerate(loops):
        near = ((low <= high[k]) & (high >= low[k])).all(axis=1)
        for other in np.flatnonzero(near):
            if other > k:
                assert area_in_common(loop, loops[other]) < 1e-9


def beside(found: Repaired, outer: float) -> np.ndarray:
    """Return the vertices nearer than ``outer`` to an edge of another block, and not on it, (k,).

    All vertices against all edges, those of a block with the edge left out.
    """
    at, start = found.vertices, found.start
    owner = np.repeat(np.arange(len(start) - 1), np.diff(start))
    a, b = at, at[following(start)]
    way = b - a
    length = np.hypot(*way.T)
    close = []
    for k, point in enumerate(at):
        to = point - a
        share = np.clip((to * way).sum(axis=1) / length**2, 0.0, 1.0)
        gap = np.hypot(*(a + share[:, None] * way - point).T)
        same = (at == point).all(axis=1)
        foreign = ~np.isin(owner, owner[same])
        if ((gap < outer) & (gap > 1e-8) & foreign).any():
            close.append(k)
    return np.array(close, np.int64)


def cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]


def outer_edges(found: Repaired) -> np.ndarray:
    """Return the vertices whose edge lies on no edges of other blocks, all the way, (k,)."""
    at, start = found.vertices, found.start
    owner = np.repeat(np.arange(len(start) - 1), np.diff(start))
    a, b = at, at[following(start)]
    alone = []
    for k in range(len(at)):
        way, length = b[k] - a[k], np.hypot(*(b[k] - a[k]))
        one, other = a - a[k], b - a[k]
        off = np.maximum(np.abs(cross(way, one)), np.abs(cross(way, other))) / length
        s, t = one @ way / length, other @ way / length
        along = (owner != owner[k]) & (off < 1e-8) & (t < s)
        covered = np.minimum(s[along], length) - np.maximum(t[along], 0.0)
        if covered[covered > 0.0].sum() < length - 1e-7:
            alone.append(k)
    return np.array(alone, np.int64)


def neck(at: np.ndarray, start: np.ndarray) -> float:
    """Return the least distance of a corner from an edge of its own block that it does not end."""
    least = np.inf
    for first, last in pairwise(start):
        loop = at[first:last]
        way = np.roll(loop, -1, axis=0) - loop
        for k, point in enumerate(loop):
            share = np.clip(((point - loop) * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
            gap = np.hypot(*(loop + share[:, None] * way - point).T)
            gap[[k, k - 1]] = np.inf
            least = min(least, gap.min())
    return least


def built(found: Repaired):
    builder = InputBuilder()
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.blocks(vertices=found.vertices, start=found.start)
    return builder.build()


@pytest.mark.parametrize("shift", [(0.0, 0.0), (1_234_567.0, -987_654.0)])
def test_a_wall_rounded_to_millimetres(shift):
    """Every brick rounded by itself, and 0.4 mm beside that: corners up to 2.6 mm apart."""
    columns, rows, tolerance = 12, 14, 3e-3
    exact, start = wall(columns, rows)
    rng = np.random.default_rng(3)
    drawn = rounded(exact + CORNER, rng, 0.4e-3) + shift
    found = repaired(drawn, start, tolerance)
    loops = loops_of(found)
    assert_no_overlap([loop - shift for loop in loops])
    assert len(beside(found, tolerance)) == 0
    outer = outer_edges(found)
    middle = 0.5 * (found.vertices + found.vertices[following(found.start)])[outer]
    low = CORNER + shift
    to_rim = np.abs(np.concatenate([middle - low, middle - low - (columns, 0.5 * rows)], axis=1))
    assert (to_rim.min(axis=1) < 1.5e-3).all()
    assert len(outer) == pytest.approx(2 * (columns + rows), abs=rows)
    # what the rim moved by is all that the area differs by
    total = sum(area(loop) for loop in loops)
    assert abs(total - 0.5 * columns * rows) < 1.5e-3 * 2 * (columns + 0.5 * rows)
    assert found.report.largest_movement <= tolerance
    assert not found.report.left.count and not found.report.closed.count
    assert found.report.joined.count > 400 and found.report.put_in.count > 50
    assert len(built(found).overlaps.pair) == 0


def test_what_touches_already_stays_as_it_is():
    for vertices, start in (wall(5, 4), jointed(2)):
        for shift in ((0.0, 0.0), (1e6 / 3.0, -2e6 / 7.0)):
            found = repaired(vertices + shift, start, 1e-3)
            np.testing.assert_array_equal(found.vertices, vertices + shift)
            np.testing.assert_array_equal(found.start, start)
            assert found.report.changes == {} and found.report.largest_movement == 0.0


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.2e-3, 0.4e-3, 2e-3]))
@pytest.mark.one_in(3)
def test_rounded_rock_masses_touch_again(seed, noise):
    exact, start = jointed(seed)
    tolerance = 2.0 * np.sqrt(2.0) * (0.5e-3 + noise) * 1.01
    # two sides of a neck cannot be put together
    assume(neck(exact, start) > 3.0 * tolerance)
    found = repaired(rounded(exact, np.random.default_rng(seed), noise), start, tolerance)
    loops = loops_of(found)
    assert len(loops) == len(start) - 1
    assert_no_overlap(loops)
    assert len(beside(found, tolerance)) == found.report.left.count == 0
    assert found.report.largest_movement <= tolerance * (1.0 + 1e-8)
    total = sum(area(loop) for loop in loops)
    rim = 2 * (14 + 9) + 2 * (2.2 + 1.7)
    assert abs(total - (14 * 9 - 2.2 * 1.7)) < 2.0 * tolerance * rim
    again = repaired(found.vertices, found.start, tolerance)
    assert again.report.changes == {}
    np.testing.assert_array_equal(again.vertices, found.vertices)
    built(found)


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 60))
def test_no_vertex_moves_further_than_the_tolerance(seed, count):
    """Chains and clouds: every vertex within the tolerance, all places further apart than it."""
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 12, (count, 2)) * 0.3 + rng.choice([0.0, 0.05], (count, 2))
    node, at = corners_of(points, 1.0)
    moved = np.hypot(*(at[node] - points).T)
    assert moved.max() <= 1.0 + 1e-9
    for k, one in enumerate(at):
        others = np.delete(at, k, axis=0)
        assert (np.hypot(*(others - one).T) > 1.0 - 1e-12).all()
    # a vertex by itself stays where it is
    apart = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    lone = (apart <= 1.0).sum(axis=1) == 1
    np.testing.assert_array_equal(at[node[lone]], points[lone])


def test_a_place_is_where_most_of_its_vertices_are():
    points = np.array([(0.0, 0.0), (0.0, 0.0), (0.6, 0.0), (5.0, 0.0), (5.4, 0.0)])
    node, at = corners_of(points, 1.0)
    np.testing.assert_allclose(at[node], [(0, 0)] * 3 + [(5.2, 0)] * 2)


def test_a_floor_stays_straight():
    """Bricks that hover over a floor and sink into it are put onto it."""
    floor = [(-1.0, -1.0), (6.0, -1.0), (6.0, 0.0), (-1.0, 0.0)]
    gaps = [4e-4, -3e-4, 2e-4, -5e-4]
    bricks = [[(k, g), (k + 0.9, g), (k + 0.9, 1), (k, 1)] for k, g in enumerate(gaps)]
    found = repaired(np.concatenate([floor, *bricks]), np.arange(0, 21, 4), 1e-3)
    np.testing.assert_array_equal(found.polygon(0), floor)
    for k in range(1, 5):
        assert (found.polygon(k)[:2, 1] == 0.0).all()
    assert found.report.onto_edges.count == 8 and found.report.put_in.count == 0
    assert_no_overlap(loops_of(found))


def test_short_edges_become_points_and_edges_keep_their_joints():
    """Edge 1 of the first block is shorter than the tolerance; others say which edge they were."""
    one = [(0.0, 0.0), (1.0, 0.0), (1.0, 5e-4), (1.0, 1.0), (0.0, 1.0)]
    other = [(1.0, 2e-4), (2.0, 0.0), (2.0, 1.0), (1.0003, 1.0)]
    found = repaired(np.array(one + other), [0, 5, 9], 1e-3)
    assert found.start.tolist() == [0, 4, 8]
    assert found.edge.tolist() == [0, 2, 3, 4, 5, 6, 7, 8]
    assert found.report.closed.count == 1
    np.testing.assert_array_equal(found.polygon(0)[1], found.polygon(1)[0])


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(st.integers(0, 100_000), st.integers(2, 9))
def test_whatever_is_drawn_stays_sound_or_is_refused(seed, count):
    """Triangles and boxes thrown on a grid of half the tolerance: clusters chain in all ways."""
    rng = np.random.default_rng(seed)
    tolerance = 0.1
    loops = []
    while len(loops) < count:
        loop = rng.integers(0, 8, (rng.integers(3, 5), 2)) * 0.9 + rng.integers(-2, 3, 2) * 0.05
        loop = loop + rng.integers(-1, 2, loop.shape) * 0.05
        if area(loop) > 0.2 and sound(loop, np.array([0, len(loop)]))[0]:
            loops.append(loop)
    drawn, start = np.concatenate(loops), np.cumsum([0, *(len(loop) for loop in loops)])
    try:
        found = repaired(drawn, start, tolerance)
    except ModelError as error:
        assert "block" in str(error) and "(" in str(error)
        return
    assert sound(found.vertices, found.start).all()
    assert found.report.largest_movement <= tolerance * (1.0 + 1e-8)
    # every vertex is one that was drawn, or lies within the tolerance of one
    apart = np.hypot(*(found.vertices[:, None] - drawn[None]).transpose(2, 0, 1))
    assert apart.min(axis=1).max() <= tolerance * (1.0 + 1e-8)
    left = beside(found, tolerance * (1.0 - 1e-6))
    assert len(np.unique(found.vertices[left], axis=0)) <= found.report.left.count
    for one, other in zip(loops, loops_of(found), strict=True):
        rim = np.hypot(*(np.roll(one, -1, axis=0) - one).T).sum()
        assert abs(area(other) - area(one)) <= 2.0 * tolerance * rim + 4.0 * np.pi * tolerance**2
    # the grid has distances that are the tolerance to round-off
    again = repaired(found.vertices, found.start, tolerance * (1.0 - 1e-6))
    assert again.report.joined.count == 0


SLAB = [(0, 0), (4, 0), (4, 0.05), (0, 0.05)]
NOTCHED = [(0, 0), (4, 0), (4, 2), (2.03, 2), (2.01, 1), (1.99, 2), (0, 2)]
TIP = [(0, 0), (4, 0), (4.0, 0.08), (0, 0.2), (-0.04, 0.1)]
BESIDE = [(10, 0), (14, 0), (14, 4), (10, 4)]


@pytest.mark.parametrize(
    ("loops", "tolerance", "said"),
    [
        ([BESIDE, SLAB], 0.06, r"block 2: would vanish .*: block 2 at \(0, 0\)"),
        ([NOTCHED, BESIDE], 0.05, None),
        (
            [[*NOTCHED[:3], (2.03, 2), (1.5, 1), (1.0, 1.9), (1.5, 1.5), (1.99, 2), (0, 2)]],
            0.05,
            "cross or touch itself",
        ),
        ([BESIDE], 0.5, "median edge"),
        ([BESIDE], 0.0, "not a valid distance"),
        ([BESIDE], np.nan, "not a valid distance"),
    ],
)
def test_what_cannot_be_put_together(loops, tolerance, said):
    start = np.cumsum([0, *(len(loop) for loop in loops)])
    if said is None:
        found = repaired(np.concatenate(loops), start, tolerance)
        assert found.report.closed.count == 1
        return
    with pytest.raises(ModelError, match=said) as caught:
        repaired(np.concatenate(loops), start, tolerance)
    assert "repair, tolerance" in caught.value.where
