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

from clast.errors import ModelError
from clast.model.model import Bools, Floats, Ints

NEAR = 0.7072
"""Pieces lie this near to their line, in cells: sqrt(1/2) and round-off."""
NEARER_THAN = 2.0
"""A piece that lies on no line belongs to those that are so near, in cells."""
PIECE = 4.0
"""Lines are looked up in parts as long as this many pieces."""


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
    xy, node = _unique_points(np.rint(at).astype(np.int64))
    along = np.flatnonzero(part[1:] == part[:-1])
    pairs = np.stack([node[along], node[along + 1]], axis=1)
    pairs = once(np.sort(pairs, axis=1))
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    of = _sources(xy[pairs].astype(float), ends, whole, np.flatnonzero(longer))
    return Noded(xy=xy, edge=pairs, of=of)


def _lines(ends: Floats, used: Bools, carrier: Ints, on: Floats) -> Any:
    """Return those lines (n, 2, 2) that are used (n,) as linestrings through points on them."""
    count = len(ends)
    way = ends[carrier, 1] - ends[carrier, 0]
    share = ((on - ends[carrier, 0]) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-300)
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


def _unique_points(at: Ints) -> tuple[Ints, Ints]:
    """Return each point once (n, 2), and which one every point (k, 2) is (k,)."""
    low = at.min(axis=0, initial=0)
    key = (at[:, 0] - low[0]) << 32 | (at[:, 1] - low[1])
    unique, index = np.unique(key, return_inverse=True)
    points = np.stack([(unique >> 32) + low[0], (unique & 0xFFFFFFFF) + low[1]], axis=1)
    return points, index.reshape(-1)


def _sources(piece: Floats, line: Floats, whole: Floats, used: Ints) -> Ints:
    """Return pairs of piece (ne, 2, 2) and line (n, 2, 2) on which it lies, shape (k, 2).

    ``whole`` are the lines between the cells of their ends.
    """
    if len(piece) == 0:
        return np.zeros((0, 2), np.int64)
    middle = piece.mean(axis=1)
    length = np.hypot(*(piece[:, 1] - piece[:, 0]).T)
    # Long lines are looked up in parts: the boxes of whole ones would hold all pieces.
    part = max(PIECE * float(length.mean()), 8.0)
    size = np.hypot(*(line[used, 1] - line[used, 0]).T)
    count = np.maximum(np.ceil(size / part), 1.0).astype(np.int64)
    of = np.repeat(used, count)
    step = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    share = np.stack([step, step + 1], axis=1) / np.repeat(count, count)[:, None]
    corner = line[of, 0][:, None] + share[:, :, None] * (line[of, 1] - line[of, 0])[:, None]
    low, high = corner.min(axis=1) - 3.0, corner.max(axis=1) + 3.0
    boxes = shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1])
    box, found = shapely.STRtree(shapely.points(middle)).query(boxes)
    found, number = found, of[box]
    apart = _apart(piece[found], line[number])
    apart[~_beside(middle[found], whole[number])] = np.inf
    near = apart <= NEAR
    without = np.ones(len(piece), np.bool_)
    without[found[near]] = False
    near |= without[found] & (apart <= NEARER_THAN)
    pairs = once(np.stack([found[near], number[near]], axis=1))
    lacking = np.setdiff1d(np.arange(len(piece)), pairs[:, 0])
    if len(lacking):
        where = middle[lacking[0]]
        raise ModelError(
            f"a piece near cell ({where[0]:.9g}, {where[1]:.9g}) belongs to no line",
            where="domain, tolerance",
            remedy="this is a fault of clast: another tolerance may get round it; please report it",
        )
    return pairs


def _apart(piece: Floats, line: Floats) -> Floats:
    """Return how far pieces lie from lines (k, 2, 2): the further of both ends, cells, (k,)."""
    start, way = line[:, 0], line[:, 1] - line[:, 0]
    length = np.maximum(np.hypot(*way.T), 1e-300)
    way = way / length[:, None]
    to = piece - start[:, None]
    aside = to[:, :, 0] * way[:, None, 1] - to[:, :, 1] * way[:, None, 0]
    along = (to * way[:, None]).sum(axis=2)
    beyond = np.maximum(np.maximum(-along, along - length[:, None]), 0.0)
    return np.asarray(np.hypot(aside, beyond).max(axis=1))


def _beside(middle: Floats, line: Floats) -> Bools:
    """Return whether points (k, 2) lie beside lines (k, 2, 2), and beyond neither end, (k,)."""
    way = line[:, 1] - line[:, 0]
    along = ((middle - line[:, 0]) * way).sum(axis=1)
    return np.asarray((along > 0.0) & (along < (way**2).sum(axis=1)))
