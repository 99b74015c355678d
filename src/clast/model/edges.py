"""Edges of blocks that lie along each other, and those on the outline of the whole system."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from clast.model.arrays import Floats, Ints, following

CORNER_FRACTION = 1e-9
"""A point nearer to a corner than this share of the edge is at the corner."""


@dataclass(frozen=True, kw_only=True)
class Edges:
    """The edges of all blocks; edge e goes from vertex e to ``after[e]``."""

    vertices: Floats
    """Vertices, m, counter-clockwise by block, shape (nv, 2)."""
    after: Ints
    """Vertex after each one in its block, shape (nv,)."""
    owner: Ints
    """Block of each edge, shape (nv,)."""
    near: Floats
    """How far beside each one another lies along it, m, shape (nv,)."""


@dataclass(frozen=True)
class Facing:
    """Parts of two edges that lie along each other, k of them."""

    edge: Ints
    """Edges of both blocks, the lower block first, shape (k, 2)."""
    share: Floats
    """Where either edge (k, side) has the ends of the part, as the first one runs, (k, 2, 2)."""


def edges_of(vertices: Floats, after: Ints, owner: Ints, area: Floats) -> Edges:
    """Return the edges of blocks with their areas, m2, (n,)."""
    # Edges lie along each other within this share of the smaller block's size
    near = 1e-3 * np.sqrt(np.abs(area))[owner]
    return Edges(vertices=vertices, after=after, owner=owner, near=near)


def facing_edges(edges: Edges) -> Facing:
    """Return where edges of two blocks lie along each other, T-joints included."""
    here, there = edges.vertices, edges.vertices[edges.after]
    one, other = _met(edges)
    length = np.hypot(*(there - here).T)
    along = (there - here) / length[:, None]
    near = np.minimum(edges.near[one], edges.near[other])
    a = along[one]
    # the other edge seen from the first: it runs against it
    low = ((there[other] - here[one]) * a).sum(axis=1)
    high = ((here[other] - here[one]) * a).sum(axis=1)
    long = np.minimum(high, length[one]) - np.maximum(low, 0.0) > near
    one, other, near, low, high = one[long], other[long], near[long], low[long], high[long]
    ends = np.stack([np.maximum(low, 0.0), np.minimum(high, length[one])], axis=1)
    at = (high[:, None] - ends) / (high - low)[:, None]  # share of the other edge
    place = here[other, None] + at[..., None] * (there - here)[other, None]
    foot = here[one, None] + ends[..., None] * along[one, None]
    beside = np.hypot(*np.moveaxis(place - foot, -1, 0)).max(axis=1) <= near
    one, other = one[beside], other[beside]
    shares = np.stack([ends[beside] / length[one, None], at[beside]], axis=1)
    # what ends at a corner ends there to the last digit
    shares = np.where(
        shares < CORNER_FRACTION, 0.0, np.where(shares > 1.0 - CORNER_FRACTION, 1.0, shares)
    )
    return Facing(np.stack([one, other], axis=1).astype(np.int64), shares)


TOGETHER = 8192
"""Edges looked up at once: edges askew have boxes that overlap by the thousand."""


def _met(edges: Edges) -> tuple[Ints, Ints]:
    """Return pairs of edges that run against each other with boxes that meet, in their order.

    That of the lower block is first.  Boxes: distances of lines cost ten times as much.
    """
    here, there, owner = edges.vertices, edges.vertices[edges.after], edges.owner
    low, high, wide = np.minimum(here, there), np.maximum(here, there), edges.near[:, None]
    tree = shapely.STRtree(shapely.box(*low.T, *high.T))
    boxes = shapely.box(*(low - wide).T, *(high + wide).T)
    pairs = [np.zeros((2, 0), np.int64)]
    for first in range(0, len(boxes), TOGETHER):
        one, other = tree.query(boxes[first : first + TOGETHER])
        one = one + first
        lower = owner[one] < owner[other]
        one, other = one[lower], other[lower]
        a, b = (there - here)[one], (there - here)[other]
        against = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] < 0.0
        pairs.append(np.stack([one[against], other[against]]))
    one, other = np.concatenate(pairs, axis=1)
    order = np.lexsort((other, one))
    return one[order], other[order]


def outer_parts(edges: Edges, facing: Facing) -> tuple[Ints, Floats]:
    """Return the parts of edges that no other block covers: edge (k,), share (k, 2)."""
    count = len(edges.vertices)
    every = np.arange(count)
    covered = np.sort(facing.share, axis=2)
    edge = np.concatenate([every, facing.edge[:, 0], facing.edge[:, 1], every])
    zero, one = np.zeros(count), np.ones(count)
    start = np.concatenate([zero, covered[:, 0, 0], covered[:, 1, 0], one])
    end = np.concatenate([zero, covered[:, 0, 1], covered[:, 1, 1], one])
    order = np.lexsort((end, start, edge))
    edge, start, end = edge[order], start[order], end[order]
    # edges one after the other on a line, with a gap between them
    reached = np.maximum.accumulate(2.0 * edge + end)[:-1]
    before = np.clip(reached - 2.0 * edge[:-1], 0.0, 1.0)
    length = np.hypot(*(edges.vertices[edges.after] - edges.vertices).T)
    free = (edge[1:] == edge[:-1]) & (
        (start[1:] - before) * length[edge[1:]] > edges.near[edge[1:]]
    )
    return edge[1:][free], np.stack([before, start[1:]], axis=1)[free]


OUTLINE_DISTANCE = 1e-6
"""An edge lies on a line where both of its ends are nearer to it than this share of the system."""


def outline_edges(vertices: Floats, block_start: Ints, sides: tuple[str, ...] = ()) -> Ints:
    """Return the ends of edges on the hull of all blocks, or on ``sides`` of their box, (k, 2).

    ``vertices`` (nv, 2) in m, ``block_start`` (n + 1,).  A slope
    with a bench before it has its face within the hull: that is free.
    """
    after = following(block_start)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    near = OUTLINE_DISTANCE * float(np.hypot(*(high - low)))
    if sides:
        on = np.zeros(len(vertices), np.bool_)
        for axis, bound, name in (
            (0, low[0], "left"),
            (0, high[0], "right"),
            (1, low[1], "bottom"),
            (1, high[1], "top"),
        ):
            if name in sides:
                at = np.abs(vertices[:, axis] - bound) <= near
                on |= at & at[after]
        return np.stack([np.flatnonzero(on), after[on]], axis=1)
    hull = np.asarray(shapely.convex_hull(shapely.multipoints(vertices)).exterior.coords)[:-1]
    if shapely.is_ccw(shapely.linearrings(hull)):
        hull = hull[::-1]
    # by hull edge: clockwise, so that blocks lie to the right of it
    start, end = hull, np.roll(hull, -1, axis=0)
    along = (end - start) / np.hypot(*(end - start).T)[:, None]
    on = _on_hull(vertices, after, start, along, near)
    return np.stack([np.flatnonzero(on), after[on]], axis=1)


def outer_boundary(edges: Edges, block_start: Ints) -> tuple[Ints, Floats]:
    """Return the parts of edges on the outer boundary of all blocks: edge (k,), share (k, 2).

    Notches of the boundary belong to it, openings within it do not.  ``block_start`` (n + 1,) is
    the first vertex of each block.
    """
    vertices = edges.vertices
    edge, share = outer_parts(edges, facing_edges(edges))
    rings = shapely.linearrings(vertices, indices=edges.owner)
    near = OUTLINE_DISTANCE * float(np.hypot(*np.ptp(vertices, axis=0)))
    # what is no wider than rounding closes
    whole = shapely.union_all(shapely.buffer(shapely.polygons(rings), near, join_style="mitre"))
    filled = [shapely.polygons(one.exterior) for one in shapely.get_parts(whole)]
    middle = share.mean(axis=1)[:, None]
    at = (1.0 - middle) * vertices[edge] + middle * vertices[edges.after[edge]]
    boundary = shapely.boundary(shapely.union_all(filled))
    outside = shapely.distance(shapely.points(at), boundary) <= 2.0 * near
    return edge[outside], share[outside]


def edges_on(rings: Iterable[Floats], vertices: Floats, after: Ints) -> Ints:
    """Return the edges that lie on one of some closed lines (c, 2), m, by their first vertices."""
    near = OUTLINE_DISTANCE * float(np.hypot(*np.ptp(vertices, axis=0)))
    lines = shapely.union_all([shapely.linearrings(ring) for ring in rings])
    at = shapely.distance(shapely.points(vertices), lines) <= near
    middle = shapely.points(0.5 * (vertices + vertices[after]))
    return np.flatnonzero(at & at[after] & (shapely.distance(middle, lines) <= near))


def _on_hull(vertices: Floats, after: Ints, start: Floats, along: Floats, near: float) -> Any:
    """Return which edges (nv,) run along an edge of the hull."""
    on_hull = np.zeros(len(vertices), np.bool_)
    # vertices of the hull are many only where the outline is round
    for corner, direction in zip(start, along, strict=True):
        offset = vertices - corner
        at = np.abs(offset[:, 0] * direction[1] - offset[:, 1] * direction[0]) <= near
        on_hull |= at & at[after]
    return on_hull
