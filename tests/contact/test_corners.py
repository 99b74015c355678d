"""Corners: the bisector, exact ties, flat vertices, sliding across and round a corner."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenes import oracle
from scenes.corners import RIGHT, TOP, remembering
from scenes.systems import REACH, box, touches_of, turned


def needle(tip, way):
    """Return a slender triangle whose tip (vertex 0) points against the direction ``way``."""
    way = np.asarray(way, float) / np.hypot(*way)
    across = 0.02 * np.array([way[1], -way[0]])
    return np.asarray(tip, float) + np.array([[0.0, 0.0], way + across, way - across])


def edges_of_tip(outlines, **kwargs):
    """Return the edges of the first outline that the second outline's vertex 0 touches."""
    return [one.edge[1] for one in touches_of(outlines, **kwargs) if one.vertex == (1, 0)]


# --- the bisector --------------------------------------------------------------------------


@given(
    opening=st.floats(20.0, 170.0),
    share=st.floats(0.02, 0.98),
    distance=st.floats(1e-6, 4e-3),
    angle=st.floats(0.0, 6.28),
)
def test_vertex_belongs_to_the_edge_on_its_side_of_the_bisector(opening, share, distance, angle):
    """Inside a convex corner of any opening; ``share`` is where the vertex lies between its edges.

    The vertex is judged by its angle at the corner, which the code never computes.
    """
    if abs(share - 0.5) < 1e-3:
        return
    half = np.radians(0.5 * opening)
    corner = (
        3.0
        * np.array([[0.0, 0.0], [-np.sin(half), -np.cos(half)], [np.sin(half), -np.cos(half)]])[
            [0, 1, 2]
        ]
    )
    # edge 0 leaves the corner on its left side, edge 2 arrives on its right side
    off = np.radians((share - 0.5) * opening)
    tip = distance * np.array([-np.sin(off), -np.cos(off)])
    outlines = [turned(corner, angle), turned(needle(tip, [0.0, 1.0]), angle)]
    assert edges_of_tip(outlines) == [0 if share > 0.5 else 2]


def test_on_the_bisector_the_remembered_edge_stays():
    corner = [box(0.0, 0.0), needle([1.0 - 2.0**-9, 1.0 - 2.0**-9], [1.0, 1.0])]
    assert edges_of_tip(corner) == [RIGHT]  # the lower index where nothing is remembered
    for edge in (RIGHT, TOP):
        assert edges_of_tip(corner, memory=remembering(edge)) == [edge]
    # memory of another vertex, another block or an edge that is not a candidate does not count
    for other in (remembering(TOP, vertex=5), remembering(TOP, block=1), remembering(3)):
        assert edges_of_tip(corner, memory=other) == [RIGHT]


@pytest.mark.parametrize("angle", np.linspace(0.1, 6.2, 9))
def test_on_the_bisector_up_to_round_off_the_remembered_edge_stays(angle):
    """Turned to any angle, or far away, the tie is no longer exact to the last bit."""
    tip = needle([1.0 - 1.0 / 500.0, 1.0 - 1.0 / 500.0], [1.0, 1.0])
    outlines = [turned(one, angle) for one in (box(0.0, 0.0), tip)]
    for edge in (RIGHT, TOP):
        assert edges_of_tip(outlines, memory=remembering(edge)) == [edge]


@pytest.mark.parametrize("remembered", [RIGHT, TOP])
def test_off_the_bisector_memory_does_not_count(remembered):
    for x, y, edge in ((2e-3, 2e-3 + 1e-6, RIGHT), (2e-3 + 1e-6, 2e-3, TOP)):
        corner = [box(0.0, 0.0), needle([1.0 - x, 1.0 - y], [1.0, 1.0])]
        assert edges_of_tip(corner, memory=remembering(remembered)) == [edge]


def test_both_edges_of_a_re_entrant_corner_are_kept():
    notch = np.array([[0, 0], [2, 0], [2, 2], [1, 1], [0, 2]], float)  # bottom at (1, 1)
    for x in (-1e-3, 0.0, 1e-3):
        tip = needle([1.0 + x, 1.0 + 2e-3], [0.0, 1.0])
        assert edges_of_tip([notch, tip]) == [2, 3]


# --- sliding -------------------------------------------------------------------------------


def kinked(angle):
    """Return a block whose top has a corner at (1, 1) that is ``angle`` degrees from straight."""
    drop = np.tan(np.radians(0.5 * angle))
    return np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0 - drop], [1.0, 1.0], [0.0, 1.0 - drop]])


@pytest.mark.parametrize("angle", [0.0, 1e-10, 0.5, 2.9, -0.5, -2.9])
@pytest.mark.parametrize("depth", [1e-12, 1e-6, 1e-3, 0.02])
def test_vertex_slides_across_a_flat_corner(angle, depth):
    """One contact all along, before the corner on edge 3, after it on edge 2."""
    block = kinked(angle)
    for x in [*np.linspace(0.9, 1.1, 21), 1.0 - 1e-12, 1.0 + 1e-12, 1.0 - 1e-6, 1.0 + 1e-6]:
        surface = 1.0 - abs(x - 1.0) * np.tan(np.radians(0.5 * angle))
        found = edges_of_tip([block, needle([x, surface - depth], [0.0, 1.0])])
        assert len(found) == 1
        if abs(x - 1.0) > depth:
            assert found == [2 if x > 1.0 else 3]


@pytest.mark.parametrize("depth", [1e-6, 1e-3])
def test_vertex_slides_round_a_convex_corner(depth):
    """Along the inside of the corner there is one contact at every place; the edge changes once."""
    along_top = np.linspace([0.9, 1.0 - depth], [1.0 - depth, 1.0 - depth], 40)
    down_the_side = np.linspace([1.0 - depth, 1.0 - depth], [1.0 - depth, 0.9], 40)
    seen = []
    for tip in np.concatenate([along_top, down_the_side]):
        found = edges_of_tip([box(0.0, 0.0), needle(tip, [1.0, 1.0])])
        assert len(found) == 1
        seen += found
    changes = np.flatnonzero(np.diff(seen))
    assert (seen[0], seen[-1], len(changes)) == (TOP, RIGHT, 1)
    assert abs(changes[0] - 39) <= 1  # where the two stretches meet


# --- two corners ---------------------------------------------------------------------------


def corner_to_corner(dx, dy, lean=0.0):
    """Return a box, and a square on its tip that is (dx, dy) inside the box's corner (1, 1)."""
    square = turned(box(0.0, 0.0), np.pi / 4.0 + lean - np.pi / 2.0)
    return [box(0.0, 0.0), square + np.array([1.0 - dx, 1.0 - dy])]


@pytest.mark.parametrize("lean", [0.0, 0.3, -0.3])
@pytest.mark.parametrize(("dx", "dy"), [(3e-3, 1e-3), (1e-3, 3e-3), (-2e-3, 5e-3), (4e-3, -1e-3)])
def test_two_corners_inside_each_other_make_one_contact(dx, dy, lean):
    """The one with the shortest exit of both vertices from both corners."""
    outlines = corner_to_corner(dx, dy, lean)
    both = oracle.every_candidate(outlines, REACH)
    exits = {key: one.gap for key, one in both.items() if key[1] in (0, 2) and one.gap < 0.0}
    closed = [one for one in touches_of(outlines) if one.gap < 0.0]
    if not exits:
        assert closed == []
        return
    assert len(closed) == 1
    found = (*closed[0].vertex, *closed[0].edge)
    assert exits[found] == max(exits.values())


@pytest.mark.slow  # 4,001 positions
def test_passing_corners_hand_the_contact_over_where_both_exits_are_equal():
    """Along the way the penetration of the one contact never jumps."""
    gaps, who = [], []
    for x in np.linspace(-8e-3, 8e-3, 4001):
        closed = [one for one in touches_of(corner_to_corner(x, 4e-3, 0.2)) if one.gap < 0.0]
        assert len(closed) <= 1
        gaps.append(closed[0].gap if closed else 0.0)
        who.append(closed[0].vertex[0] if closed else -1)
    assert np.abs(np.diff(gaps)).max() < 1e-5
    assert min(gaps) < -1e-3
    assert {0, 1} <= set(who)
