"""Where lines meet: pieces of lines that touch in common nodes only, on a grid of whole numbers.

All nodes are multiples of the tolerance, as whole numbers, so that areas and directions are
exact.  The nodes are found by snap rounding (Hobby 1999, Comput. Geom. 13): every end and crossing
moves to the centre of its cell of the grid, and so does every line that passes through that cell.
No piece then lies further than sqrt(1/2) of a cell from the line that it comes from.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from clast.errors import ModelError
from clast.model.arrays import connected
from clast.model.model import Bools, Floats, Ints
from clast.rockmass.planar import Graph

CELLS_OFF_LINE = 0.7072
"""Pieces lie this near to their line: sqrt(1/2) and round-off."""
CELLS_SHORT_OF = 10.0
"""Ends that are so near to a line are taken to be intended to lie on it."""


@dataclass(frozen=True, kw_only=True)
class Noded:
    """Pieces between nodes, and the lines that they come from."""

    xy: Ints
    """Coordinates of the nodes, cells, shape (nn, 2)."""
    edge: Ints
    """The two nodes of each piece, shape (ne, 2)."""
    of: Ints
    """Pairs of piece and line, each once, by piece, shape (k, 2)."""


def noded(ends: Floats, carrier: Ints | None = None, on: Floats | None = None) -> Noded:
    """Return the pieces of lines (n, 2, 2), in cells, that are not shorter than a cell.

    The line ``carrier`` (k,) runs through the point ``on`` (k, 2), where another line ends: both
    then share the cell, and the node, of that point.  Lines are not rounded before they meet: the
    end of one and the line that it lies on would drift apart by up to a cell, and a line only moves
    to the nodes whose cell it passes.

    ModelError where a piece belongs to no line, which does not happen.
    """
    if carrier is None or on is None:
        carrier, on = np.zeros(0, np.int64), np.zeros((0, 2))
    # Halves are rounded up, as GEOS does.
    whole = np.floor(ends + 0.5)
    longer = (whole[:, 0] != whole[:, 1]).any(axis=1)
    united = shapely.unary_union(_lines(ends, longer, carrier, on), grid_size=1.0)
    parts = shapely.get_parts(united)
    parts = parts[shapely.get_type_id(parts) == 1]
    at, part = shapely.get_coordinates(parts, return_index=True)
    # Each point once, and which one every point is.
    at = np.rint(at).astype(np.int64)
    low = at.min(axis=0, initial=0)
    key, node = np.unique((at[:, 0] - low[0]) << 32 | (at[:, 1] - low[1]), return_inverse=True)
    xy = np.stack([(key >> 32) + low[0], (key & 0xFFFFFFFF) + low[1]], axis=1)
    along = np.flatnonzero(part[1:] == part[:-1])
    pairs = once(np.sort(np.stack([node[along], node[along + 1]], axis=1), axis=1))
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    of = _sources(xy[pairs].astype(float), ends, whole, np.flatnonzero(longer))
    return Noded(xy=xy, edge=pairs, of=of)


def _lines(ends: Floats, used: Bools, carrier: Ints, on: Floats) -> Any:
    """Return those lines (n, 2, 2) that are used (n,) as linestrings through points on them."""
    count = len(ends)
    along = ends[carrier, 1] - ends[carrier, 0]
    length2 = np.maximum((along**2).sum(axis=1), 1e-300)
    share = ((on - ends[carrier, 0]) * along).sum(axis=1) / length2
    line = np.concatenate([np.arange(count), carrier, np.arange(count)])
    place = np.concatenate([np.full(count, -np.inf), share, np.full(count, np.inf)])
    points = np.concatenate([ends[:, 0], on, ends[:, 1]])
    order = np.lexsort((place, line))
    order = order[used[line[order]]]
    return shapely.linestrings(points[order], indices=(np.cumsum(used) - 1)[line[order]])


def once(pairs: Ints) -> Ints:
    """Return each pair of numbers (k, 2), 0 or more, once and in order, shape (n, 2)."""
    key = np.unique(pairs[:, 0] << 32 | pairs[:, 1])
    return np.stack([key >> 32, key & 0xFFFFFFFF], axis=1)


def _sources(piece: Floats, line: Floats, whole: Floats, used: Ints) -> Ints:
    """Return pairs of piece (ne, 2, 2) and line (n, 2, 2) on which it lies, shape (k, 2).

    ``whole`` are the lines between the cells of their ends.
    """
    if len(piece) == 0:
        return np.zeros((0, 2), np.int64)
    middle = piece.mean(axis=1)
    length = np.hypot(*(piece[:, 1] - piece[:, 0]).T)
    # Long lines are looked up in parts: the boxes of whole ones would hold all pieces.
    part = max(4.0 * float(length.mean()), 8.0)
    size = np.hypot(*(line[used, 1] - line[used, 0]).T)
    count = np.maximum(np.ceil(size / part), 1.0).astype(np.int64)
    of = np.repeat(used, count)
    step = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    share = np.stack([step, step + 1], axis=1) / np.repeat(count, count)[:, None]
    corner = line[of, 0][:, None] + share[:, :, None] * (line[of, 1] - line[of, 0])[:, None]
    low, high = corner.min(axis=1) - 3.0, corner.max(axis=1) + 3.0
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    box, at = shapely.STRtree(shapely.points(middle)).query(boxes)
    number = of[box]
    apart = _apart(piece[at], line[number])
    apart[~_beside(middle[at], whole[number])] = np.inf
    near = apart <= CELLS_OFF_LINE
    # A piece that lies on no line belongs to those that are within two cells.
    without = np.ones(len(piece), np.bool_)
    without[at[near]] = False
    near |= without[at] & (apart <= 2.0)
    pairs = once(np.stack([at[near], number[near]], axis=1))
    lacking = np.setdiff1d(np.arange(len(piece)), pairs[:, 0])
    if len(lacking):
        where = middle[lacking[0]]
        what = f"a piece near cell ({where[0]:.9g}, {where[1]:.9g}) belongs to no line"
        remedy = "this is a fault of clast: another tolerance may get round it; please report it"
        raise ModelError(what, where="domain, tolerance", remedy=remedy)
    return pairs


def _apart(piece: Floats, line: Floats) -> Floats:
    """Return how far pieces lie from lines (k, 2, 2): the further of both ends, cells, (k,)."""
    start, unit = line[:, 0], line[:, 1] - line[:, 0]
    length = np.maximum(np.hypot(*unit.T), 1e-300)
    unit = unit / length[:, None]
    to = piece - start[:, None]
    aside = to[:, :, 0] * unit[:, None, 1] - to[:, :, 1] * unit[:, None, 0]
    along = (to * unit[:, None]).sum(axis=2)
    beyond = np.maximum(np.maximum(-along, along - length[:, None]), 0.0)
    return np.asarray(np.hypot(aside, beyond).max(axis=1))


def _beside(middle: Floats, line: Floats) -> Bools:
    """Return whether points (k, 2) lie beside lines (k, 2, 2), and beyond neither end, (k,)."""
    vector = line[:, 1] - line[:, 0]
    along = ((middle - line[:, 0]) * vector).sum(axis=1)
    return np.asarray((along > 0.0) & (along < (vector**2).sum(axis=1)))


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
    moved = np.hypot(*(result - point[corners:]).T) > 1e-3 * reach
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
    group = connected(pairs[:, 0], pairs[:, 1], count)
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
    vector = after[edge] - corners[edge]
    length = np.hypot(*vector.T)
    share = ((others[point] - corners[edge]) * vector).sum(axis=1) / np.maximum(length, 1e-300) ** 2
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


def loose_ends(net: Noded, dangling: Graph, ends: Floats, free: Bools) -> Floats:
    """Return the ends of lines, in cells, that were taken out just short of another line, (k, 2).

    ``dangling`` are the pieces that were taken out, ``ends`` (n, 2, 2) all lines, ``free`` (n,)
    those that are not outlines.  An end that has crossed the line beside it has reached it.
    """
    degree = np.bincount(net.edge.reshape(-1), minlength=len(net.xy))
    line = np.repeat(dangling.line, 2)
    node = dangling.edge.reshape(-1)
    alone = (degree[node] == 1) & free[line]
    line, node = line[alone], node[alone]
    if len(line) == 0:
        return np.zeros((0, 2))
    away = np.abs(np.floor(ends[line] + 0.5) - net.xy[node][:, None]).max(axis=2)
    ends_there = away.min(axis=1) <= 1.0
    line, at = line[ends_there], ends[line, np.argmin(away, axis=1)][ends_there]
    lines = shapely.linestrings(ends)
    which, near = shapely.STRtree(lines).query(
        shapely.points(at), predicate="dwithin", distance=CELLS_SHORT_OF
    )
    reached = shapely.dwithin(lines[line[which]], lines[near], 1.0)
    return np.unique(at[which[~reached]], axis=0)
