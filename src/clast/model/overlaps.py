"""How deep blocks lie in each other at the start.

Blocks of a wall or of a jointed rock share edges and corners up to round-off, which is where
overlays of polygons go wrong: the intersection of two polygons that touch to 1e-16 of their size
may come back as one of the two.  So most pairs are separated by a line between them, and the others
are overlaid on a grid that is far coarser than round-off and far finer than any overlap that
matters. decision 43 gives the measurements.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from clast.model.model import Floats, Ints

GRID = 1e-9
"""Overlays are rounded to this share of the larger block's size."""
MANY_CORNERS = 200
"""Blocks of more corners are overlaid at once: no line along an edge is likely to part them."""
CHUNK = 1_000_000
"""Vertices that are projected at once."""


def touching_at_most(
    vertices: Floats, start: Ints, first: Ints, second: Ints, thickness: Floats
) -> NDArray[np.bool_]:
    """Return True for pairs whose common area lies in a strip thinner than ``thickness`` (m,).

    The strips tried run along the edges of both blocks: of convex blocks that touch, one fits.
    ``vertices`` (nv, 2) by block in m; ``first`` and ``second`` (m,) are blocks.
    """
    count = np.diff(start)
    normal = _normals(vertices, start)
    apart = np.zeros(len(first), np.bool_)
    few = np.maximum(count[first], count[second]) <= MANY_CORNERS
    for one, other in ((first, second), (second, first)):
        left = np.flatnonzero(few & ~apart)
        if len(left) == 0:
            break
        edges = count[one[left]]
        row_start = np.concatenate([[0], np.cumsum(edges)[:-1]])
        edge = np.repeat(start[one[left]] - row_start, edges) + np.arange(edges.sum())
        _, far = _span(normal[edge], np.repeat(one[left], edges), vertices, start)
        near, _ = _span(normal[edge], np.repeat(other[left], edges), vertices, start)
        apart[left] = np.maximum.reduceat(near - far, row_start) >= -thickness[left]
    return apart


def _normals(vertices: Floats, start: Ints) -> Floats:
    """Return the unit outward normal of each edge of counter-clockwise loops, shape (nv, 2)."""
    after = np.arange(1, len(vertices) + 1)
    after[start[1:] - 1] = start[:-1]
    edge = vertices[after] - vertices
    return np.stack([edge[:, 1], -edge[:, 0]], axis=1) / np.hypot(*edge.T)[:, None]


def _span(direction: Floats, block: Ints, vertices: Floats, start: Ints) -> tuple[Floats, Floats]:
    """Return how far blocks (m,) reach along directions (m, 2): smallest and largest, m, (m,)."""
    count = np.diff(start)[block]
    low, high = np.zeros(len(block)), np.zeros(len(block))
    ends = np.cumsum(count)
    begin = 0
    while begin < len(block):
        done = ends[begin] - count[begin]
        end = max(begin + 1, int(np.searchsorted(ends, done + CHUNK)))
        some, of = count[begin:end], block[begin:end]
        row_start = np.concatenate([[0], np.cumsum(some)[:-1]])
        vertex = np.repeat(start[of] - row_start, some) + np.arange(some.sum())
        along = np.repeat(direction[begin:end], some, axis=0)
        place = along[:, 0] * vertices[vertex, 0] + along[:, 1] * vertices[vertex, 1]
        low[begin:end] = np.minimum.reduceat(place, row_start)
        high[begin:end] = np.maximum.reduceat(place, row_start)
        begin = end
    return low, high


def common_parts(
    vertices: Floats, start: Ints, first: Ints, second: Ints
) -> tuple[Ints, Floats, Floats]:
    """Return the areas that pairs (m,) of blocks have in common: pair, width, middle.

    One entry for each connected area: the number of its pair (k,), its width in m (k,), which is
    about how far the two must be moved apart, and a point in it (k, 2).
    """
    # About a point between the two and in units of their size, so that one grid fits all pairs.
    low = np.minimum.reduceat(vertices, start[:-1])
    high = np.maximum.reduceat(vertices, start[:-1])
    extent = np.hypot(*(high - low).T)
    unit = np.maximum(extent[first], extent[second])
    lower, upper = np.maximum(low[first], low[second]), np.minimum(high[first], high[second])
    middle = 0.5 * (lower + upper)
    one = _polygons(vertices, start, first, middle, unit)
    other = _polygons(vertices, start, second, middle, unit)
    shared = shapely.intersection(one, other, grid_size=GRID)
    # A pair that only touches shares lines and points; only shared areas overlap.
    parts, pair = shapely.get_parts(shared, return_index=True)
    areal = shapely.area(parts) > 0.0
    parts, pair = parts[areal], pair[areal]
    width = widths(parts) * unit[pair]
    inside = shapely.get_coordinates(shapely.point_on_surface(parts)).reshape(-1, 2)
    return pair, width, inside * unit[pair][:, None] + middle[pair]


def _polygons(
    vertices: Floats, start: Ints, block: Ints, middle: Floats, unit: Floats
) -> NDArray[Any]:
    """Return blocks (m,) as shapely polygons about points (m, 2), in units (m,) of length."""
    count = np.diff(start)[block]
    row_start = np.concatenate([[0], np.cumsum(count)[:-1]])
    pair = np.repeat(np.arange(len(block)), count)
    vertex = np.repeat(start[block] - row_start, count) + np.arange(count.sum())
    rings = shapely.linearrings(
        (vertices[vertex] - middle[pair]) / unit[pair][:, None], indices=pair
    )
    return np.asarray(shapely.polygons(rings))


def widths(areas: NDArray[Any]) -> Floats:
    """Return the width of the rectangle that has area and perimeter of each polygon, shape (k,).

    That is the thickness of a sliver, straight or bent, and the side of a square.
    """
    half = 0.5 * shapely.length(areas)
    return np.asarray(0.5 * (half - np.sqrt(np.maximum(0.0, half**2 - 4.0 * shapely.area(areas)))))
