"""Points that nearly lie on a line, or on each other, moved onto it: they are meant to be there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from clast.model.model import Bools, Floats, Ints

ROUND_OFF = 1e-3
"""Points that moved by less than this share of the reach have not been moved, to a reader."""


@dataclass(frozen=True, kw_only=True)
class Snapped:
    """Lines whose ends lie on lines within reach of them."""

    ends: Floats
    """Lines, shape (n, 2, 2)."""
    moved: Floats
    """Points that were moved by more than round-off, shape (k, 2)."""
    carrier: Ints
    """Line that the end of another one lies on: below n one of ``ends``, else an edge, (m,)."""
    on: Floats
    """That end, shape (m, 2)."""


def snapped(ends: Floats, edges: Floats, reach: float, still: Bools | None = None) -> Snapped:
    """Return lines (n, 2, 2) whose ends lie on lines within ``reach``.

    Ends go to corners of ``edges`` (k, 2, 2) first, then to each other, then onto edges and lines.
    Those marked by ``still`` (n, 2) stay where they are.
    """
    corners = len(edges)
    point = np.concatenate([edges[:, 0], ends.reshape(-1, 2)])
    fixed = np.zeros(len(point), np.bool_)
    if still is not None:
        fixed[corners:] = still.reshape(-1)
    place, member = point.copy(), _joined(point, reach, fixed)
    lines = shapely.linestrings(np.concatenate([edges, point[member[corners:]].reshape(-1, 2, 2)]))
    free = np.unique(member[(member >= corners) & ~fixed])
    at, line = shapely.STRtree(lines).query(
        shapely.points(point[free]), predicate="dwithin", distance=reach
    )
    gap = shapely.distance(shapely.points(point[free[at]]), lines[line])
    # Not onto a line that ends in the same point.
    ends_of = np.concatenate([np.full((corners, 2), -1), member[corners:].reshape(-1, 2)])
    usable = (ends_of[line] != free[at][:, None]).all(axis=1)
    at, line, gap = at[usable], line[usable], gap[usable]
    order = np.lexsort((line, gap, at))
    nearest = order[np.r_[True, np.diff(at[order]) > 0][: len(order)]]
    line = line[nearest]
    off = gap[nearest] > 0.0
    moving, onto = free[at[nearest][off]], lines[line[off]]
    along = shapely.line_locate_point(onto, shapely.points(point[moving]))
    place[moving] = shapely.get_coordinates(shapely.line_interpolate_point(onto, along))
    result = place[member[corners:]]
    moved = np.hypot(*(result - point[corners:]).T) > ROUND_OFF * reach
    return Snapped(
        ends=result.reshape(-1, 2, 2),
        moved=np.unique(point[corners:][moved], axis=0),
        carrier=np.where(line < corners, line + len(ends), line - corners),
        on=place[free[at[nearest]]],
    )


def _joined(point: Floats, reach: float, fixed: Bools) -> Ints:
    """Return for each point (k, 2) the first one that it is joined to, itself for most, (k,).

    Points that are ``fixed`` (k,) join none.
    """
    count = len(point)
    which = np.flatnonzero(~fixed)
    pairs = which[cKDTree(point[which]).query_pairs(reach, output_type="ndarray")]
    ones = np.ones(len(pairs), np.int8)
    links = coo_array((ones, (pairs[:, 0], pairs[:, 1])), shape=(count,) * 2)
    group = connected_components(links, directed=False)[1]
    first = np.full(group.max() + 1, count)
    np.minimum.at(first, group, np.arange(count))
    # A chain of points may be longer than the reach: only points near its first one move to it.
    near = np.hypot(*(point[first[group]] - point).T) <= reach
    return np.where(near, first[group], np.arange(count))


def through(corners: Floats, others: Floats, reach: float) -> tuple[Floats, Floats]:
    """Return a loop (k, 2) that runs through the points next to its edges, and these, (n, 2)."""
    after = np.roll(corners, -1, axis=0)
    edge, point = shapely.STRtree(shapely.points(others)).query(
        shapely.linestrings(np.stack([corners, after], axis=1)), predicate="dwithin", distance=reach
    )
    way = after[edge] - corners[edge]
    length = np.hypot(*way.T)
    share = ((others[point] - corners[edge]) * way).sum(axis=1) / np.maximum(length, 1e-300) ** 2
    inner = (share * length > reach) & ((1.0 - share) * length > reach)
    edge, point, share = edge[inner], point[inner], share[inner]
    # Corners that several outlines have in common are met once.
    _, once = np.unique(
        np.concatenate([edge[:, None], others[point]], axis=1), axis=0, return_index=True
    )
    edge, point, share = edge[once], point[once], share[once]
    place = np.concatenate([np.arange(len(corners)), edge + share])
    every = np.concatenate([corners, others[point]])
    return every[np.argsort(place, kind="stable")], others[point]
