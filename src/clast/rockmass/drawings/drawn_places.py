"""The blocks on which lines and points of a drawing lie, once these are cut.

A fixed line holds every block that it crosses at one point, a material line gives every block that
it crosses its rock, the block with a hole point in it is removed (Shi 1988): all three need blocks.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from clast.rockmass.drawings.block_arrays import Ints
from clast.rockmass.drawings.drawing import Floats

TOUCHED = 1e-6
"""Length in a block below which a line only touches it, as a share of the line's length."""


def crossed_blocks(ends: Any, vertices: Any, block_start: Any) -> tuple[Ints, Floats]:
    """Return the blocks that a line crosses (k,), rising, and a point of it in each (k, 2), m.

    ``ends`` are (2, 2), m, vertices (nv, 2), m, block_start (nb + 1,).
    The point is the middle of the longest part of the line in the block; a part along an edge
    counts, a corner does not.
    """
    line = shapely.LineString(np.asarray(ends, float))
    polygons = _polygons(vertices, block_start)
    near = np.sort(shapely.STRtree(polygons).query(line, predicate="intersects"))
    blocks, points = [], []
    for block in near:
        within = shapely.intersection(line, polygons[block])
        part = max(shapely.get_parts(within), key=lambda one: one.length)
        if part.length > TOUCHED * line.length:
            blocks.append(int(block))
            points.append(part.interpolate(0.5, normalized=True).coords[0])
    return np.array(blocks, np.int64), np.array(points, float).reshape(-1, 2)


def blocks_with(points: Any, vertices: Any, block_start: Any) -> Ints:
    """Return the block that each point lies in, -1 for none, shape (k,).

    Points are (k, 2), vertices (nv, 2), m, block_start (nb + 1,).  A point on an edge lies in
    the block of the lower number.
    """
    places = shapely.points(np.asarray(points, float).reshape(-1, 2))
    found = np.full(len(places), -1, np.int64)
    tree = shapely.STRtree(_polygons(vertices, block_start))
    point, block = tree.query(places, predicate="intersects")
    order = np.argsort(block, kind="stable")[::-1]
    found[point[order]] = block[order]  # the lowest comes last
    return found


def _polygons(vertices: Any, block_start: Any) -> Any:
    """Return the blocks as polygons, shape (nb,)."""
    at, start = np.asarray(vertices, float), np.asarray(block_start, np.int64)
    ring = np.repeat(np.arange(len(start) - 1), np.diff(start))
    return shapely.polygons(shapely.linearrings(at, indices=ring))
