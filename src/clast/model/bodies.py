"""Fixed blocks that lie flush are one body: its outline runs on over the joints between them.

Nothing that meets the ground can tell in how many pieces it was drawn.  So contacts are looked for
on outlines in which faces that fixed blocks share are left out: the inside of the body is no
entrance, corners that coincide are one, with the edges on either side of the joint, and where the
surface goes straight on there is none.  A contact then belongs to the block on whose edge it stands
(contact/detection.py).

Where a joint has a stiffness or a bond, or carries a stress from the start, each piece of the
ground has its share of that; those models keep their outlines.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from clast.model.arrays import Bools, Floats, Ints, connected, owners
from clast.read_only import kept_property

FLUSH_DISTANCE = 1e-5
"""Distance within which fixed blocks are flush, in units of the size of the smallest of them."""


@dataclass(frozen=True, kw_only=True)
class Outlines:
    """Outlines on which contacts are looked for: free blocks as they are, fixed ones joined.

    A body with a hole has two.  An edge of an outline may run along edges of several blocks.
    """

    vertex: Ints
    """Vertex of the model at which each edge begins, shape (k,)."""
    start: Ints
    """First edge of each outline, shape (o + 1,)."""
    block: Ints
    """Block of each outline; of a body the first, shape (o,)."""
    run_start: Ints
    """First of the pieces of each edge, shape (k + 1,)."""
    run_edge: Ints
    """Edge of the model that each piece is, or is part of, shape (r,)."""
    run_place: Floats
    """Where it begins, m along all edges one after the other, shape (r,)."""
    of_vertex: Ints
    """Place of each vertex of the model in ``vertex``, -1 where it is not a corner, shape (nv,)."""
    of_edge: Ints
    """Edge of an outline along which each edge of the model runs, -1 where none, shape (nv,)."""
    body: Ints
    """Body of each block of the model, shape (n,)."""
    area: Floats
    """Area of that body, m2, shape (n,)."""
    fixed: Bools
    """Outlines that cannot move, shape (o,)."""
    absent: Bools
    """Outlines of excavated blocks, shape (o,)."""

    @kept_property
    def owners(self) -> Ints:
        """Outline of each vertex, shape (k,)."""
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


def joined_outlines(
    vertices: Floats, block_start: Ints, area: Floats, fixed: Bools, absent: Bools
) -> Outlines | None:
    """Return outlines in which fixed blocks that lie flush are one; None if that changes nothing.

    Of blocks with ``vertices`` (nv, 2), m, first vertices (n + 1,) and areas (n,), m2, which are
    ``fixed`` or ``absent`` (n,).
    """
    ground = np.flatnonzero(fixed & ~absent)
    if not len(ground):
        return None
    tolerance = FLUSH_DISTANCE * float(np.sqrt(area[ground].min()))
    sides = _sides(vertices, block_start, ground, tolerance)
    loops = [_straightened(loop, sides, vertices, tolerance) for loop in _loops(sides)]
    if len(loops) == len(ground) and all(len(run) == 1 for loop in loops for run in loop):
        return None
    # Which body each of `count` blocks belongs to, (n,).
    shared = np.flatnonzero(sides.twin >= 0)
    of_side = sides.block_of[sides.edge]
    of_body = connected(of_side[shared], of_side[sides.twin[shared]], len(area))
    outlines: list[tuple[int, list[list[tuple[int, int]]]]] = []
    for block, (first, last) in enumerate(pairwise(block_start)):
        if not fixed[block] or absent[block]:
            outlines.append((block, [[(k, k)] for k in range(first, last)]))
        else:
            outlines += [(block, loop) for loop in loops if sides.block_of[loop[0][0][1]] == block]
    return _assembled(vertices, outlines, (area, fixed, absent), of_body)


def loops_round(vertices: Floats, block_start: Ints, area: Floats) -> list[Floats]:
    """Return the outlines of blocks that lie flush, m, (c, 2) each, with the blocks to their left.

    Corners are those of blocks, to the last bit: where joints come out there are some, too.  The
    arguments are those of ``joined_outlines``.
    """
    tolerance = FLUSH_DISTANCE * float(np.sqrt(area.min()))
    sides = _sides(vertices, block_start, np.arange(len(area)), tolerance)
    return [vertices[[vertex for vertex, _ in loop]] for loop in _loops(sides)]


# faces that blocks share ----------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Sides:
    """Edges of fixed blocks, cut where a corner of another one lies on them."""

    begin: Ints
    """Vertex of the model at which each begins, shape (s,)."""
    edge: Ints
    """Edge of the model of which it is a part, shape (s,)."""
    following: Ints
    """The next one of its block, shape (s,)."""
    twin: Ints
    """The one of another block that runs back along it, -1 where none does, shape (s,)."""
    block_of: Ints
    """Block of each edge of the model, shape (nv,)."""


def _sides(vertices: Floats, block_start: Ints, ground: Ints, tolerance: float) -> _Sides:
    """Return the sides of the blocks ``ground``; corners within ``tolerance``, m, coincide."""
    corners = np.concatenate([np.arange(*block_start[one : one + 2]) for one in ground])
    block_of = owners(block_start)
    point = np.full(len(vertices), -1)
    point[corners] = _points(vertices[corners], tolerance)
    by_x = corners[np.argsort(vertices[corners, 0], kind="stable")]
    begin: list[int] = []
    edge: list[int] = []
    following: list[int] = []
    for one in ground:
        first, last = block_start[one : one + 2]
        own = len(begin)
        for k in range(first, last):
            end = k + 1 if k + 1 < last else first
            for start in (k, *_corners_on(k, end, vertices, by_x, tolerance)):
                if len(begin) == own or point[start] != point[begin[-1]]:
                    begin.append(int(start))
                    edge.append(int(k))
        following += [*range(own + 1, len(begin)), own]
    ends = [begin[k] for k in following]
    return _Sides(
        begin=np.array(begin),
        edge=np.array(edge),
        following=np.array(following),
        twin=_twins(point[begin], point[ends], block_of[edge]),
        block_of=block_of,
    )


def _points(places: Floats, tolerance: float) -> Ints:
    """Return a number for each place (c, 2), m, the same for those that coincide, (c,)."""
    from scipy.spatial import KDTree  # slow to load

    first, second = KDTree(places).query_pairs(tolerance, output_type="ndarray").T
    return connected(first, second, len(places))


def _corners_on(begin: int, end: int, vertices: Floats, by_x: Ints, tolerance: float) -> list[int]:
    """Return the corners that lie on an edge between its ends, one after the other.

    ``by_x`` are the corners that may, from left to right.
    """
    a, b = vertices[begin], vertices[end]
    (left, low), (right, high) = np.minimum(a, b) - tolerance, np.maximum(a, b) + tolerance
    x = vertices[by_x, 0]
    near = by_x[np.searchsorted(x, left) : np.searchsorted(x, right, side="right")]
    near = near[(vertices[near, 1] >= low) & (vertices[near, 1] <= high)]
    length = float(np.hypot(*(b - a)))
    (tx, ty), (x, y) = (b - a) / length, (vertices[near] - a).T
    along, away = x * tx + y * ty, np.abs(x * ty - y * tx)
    on = (away <= tolerance) & (along > tolerance) & (along < length - tolerance)
    return [int(k) for k in near[on][np.argsort(along[on], kind="stable")]]


def _twins(begin: Ints, end: Ints, block: Ints) -> Ints:
    """Return for each side that of another block which runs from its end to its begin, or -1."""
    twin = np.full(len(begin), -1)
    open_sides: dict[tuple[int, int], int] = {}
    for k, ends in enumerate(zip(begin.tolist(), end.tolist(), strict=True)):
        other = open_sides.pop((ends[1], ends[0]), -1)
        if other >= 0 and block[other] != block[k]:
            twin[k], twin[other] = other, k
        else:
            open_sides[ends] = k
    return twin


# the outlines that are left ---------------------------------------------------------------------


def _loops(sides: _Sides) -> list[list[tuple[int, int]]]:
    """Return the loops round the parts that no two blocks share: vertex and edge of each side.

    Where a face that is shared begins the outline goes on along the block beyond it.
    """
    done, loops = sides.twin >= 0, []
    for first in range(len(done)):
        loop, k = [], first
        while not done[k]:
            done[k] = True
            loop.append((int(sides.begin[k]), int(sides.edge[k])))
            k = sides.following[k]
            while sides.twin[k] >= 0:
                k = sides.following[sides.twin[k]]
        if loop:
            loops.append(loop)
    return loops


def _straightened(
    loop: list[tuple[int, int]], sides: _Sides, vertices: Floats, tolerance: float
) -> list[list[tuple[int, int]]]:
    """Return the straight runs of sides that a loop consists of."""
    count = len(loop)
    places = vertices[[vertex for vertex, _ in loop]]

    def is_straight(first: int, last: int) -> bool:
        """Return whether all corners after side ``first`` up to ``last`` lie on one line."""
        chord = places[(last + 1) % count] - places[first]
        length = float(np.hypot(*chord))
        if length <= tolerance:
            return False
        between = places[[k % count for k in range(first + 1, last + 1)]] - places[first]
        along = between @ chord / length
        away = np.abs(between[:, 0] * chord[1] - between[:, 1] * chord[0]) / length
        return bool((away <= tolerance).all() and (np.diff([0.0, *along, length]) > 0.0).all())

    starts = [k for k in range(count) if not is_straight((k - 1) % count, (k - 1) % count + 1)]
    if len(starts) < 3:
        return [[one] for one in loop]
    loop, places = [*loop[starts[0] :], *loop[: starts[0]]], np.roll(places, -starts[0], axis=0)
    runs: list[list[tuple[int, int]]] = []
    begin = 0
    for k in range(count):
        if k > begin and is_straight(begin, k):
            runs[-1].append(loop[k])
        else:
            runs.append([loop[k]])
            begin = k
    return runs


def _assembled(
    vertices: Floats,
    outlines: list[tuple[int, list[list[tuple[int, int]]]]],
    of_blocks: tuple[Floats, Bools, Bools],
    of_body: Ints,
) -> Outlines:
    """Return outlines of blocks and their straight runs as one record."""
    area, fixed, absent = of_blocks
    runs = [run for _, loop in outlines for run in loop]
    block = np.array([one for one, _ in outlines])
    pieces = [piece for run in runs for piece in run]
    begin, edge = np.ascontiguousarray(np.array(pieces).T)
    corner = np.array([run[0][0] for run in runs])
    run_start = np.concatenate([[0], np.cumsum([len(run) for run in runs])])
    start = np.concatenate([[0], np.cumsum([len(loop) for _, loop in outlines])])
    # pieces one after the other; an edge's own begin at the same place whatever comes before
    steps = np.hypot(*(vertices[np.roll(begin, -1)] - vertices[begin]).T)
    of_vertex, of_edge = np.full(len(vertices), -1), np.full(len(vertices), -1)
    of_vertex[corner] = np.arange(len(corner))
    number = np.repeat(np.arange(len(runs)), np.diff(run_start))
    of_edge[edge[::-1]] = number[::-1]
    return Outlines(
        vertex=corner,
        start=start,
        block=block,
        run_start=run_start,
        run_edge=edge,
        run_place=np.concatenate([[0.0], np.cumsum(steps)[:-1]]),
        of_vertex=of_vertex,
        of_edge=of_edge,
        body=of_body,
        area=np.asarray(np.bincount(of_body, area), np.float64)[of_body],
        fixed=fixed[block],
        absent=absent[block],
    )
