"""The edges of blocks that lie on the outline of the whole system."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from clast.model.water.facing_edges import Edges, facing_edges, outer_parts

Floats = NDArray[np.float64]
Ints = NDArray[Any]

NEAR = 1e-6
"""An edge lies on a line where both of its ends are nearer to it than this share of the system."""


def outline_edges(vertices: Floats, block_start: Ints, sides: tuple[str, ...] = ()) -> Ints:
    """Return the ends of edges on the hull of all blocks, or on ``sides`` of their box, (k, 2).

    ``vertices`` (nv, 2) in m, ``block_start`` (n + 1,).  A slope
    with a bench before it has its face within the hull: that is free.
    """
    after = np.arange(1, len(vertices) + 1)
    after[block_start[1:] - 1] = block_start[:-1]
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    near = NEAR * float(np.hypot(*(high - low)))
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
    near = NEAR * float(np.hypot(*np.ptp(vertices, axis=0)))
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
    near = NEAR * float(np.hypot(*np.ptp(vertices, axis=0)))
    lines = shapely.union_all([shapely.linearrings(ring) for ring in rings])
    at = shapely.distance(shapely.points(vertices), lines) <= near
    middle = shapely.points(0.5 * (vertices + vertices[after]))
    return np.flatnonzero(at & at[after] & (shapely.distance(middle, lines) <= near))


def _on_hull(vertices: Floats, after: Ints, start: Floats, along: Floats, near: float) -> Any:
    """Return which edges (nv,) run along an edge of the hull."""
    found = np.zeros(len(vertices), np.bool_)
    # vertices of the hull are many only where the outline is round
    for corner, direction in zip(start, along, strict=True):
        offset = vertices - corner
        at = np.abs(offset[:, 0] * direction[1] - offset[:, 1] * direction[0]) <= near
        found |= at & at[after]
    return found
