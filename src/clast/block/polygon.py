"""Polygons of all blocks at once: area, centroid, moments, boxes, edges, neighbours."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, CONTACTS, shared
from clast.model.model import Floats, Ints

SMALL_ANGLE = np.sin(np.radians(3.0))
"""Sine of the angle within which edges count as parallel (Shi 1988: 3 degrees)."""
ROUND_OFF = 1e-9
"""Fraction of an edge's length that is treated as zero along the edge."""


class Polygons(NamedTuple):
    """Outlines of all blocks, as kernels take them; edge e begins at vertex e."""

    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    direction: Floats
    """Unit direction of each edge, shape (nv, 2)."""
    length: Floats
    """Length of each edge, m, shape (nv,)."""
    vertex_block: Ints
    """Block of each vertex, shape (nv,)."""
    block_start: Ints
    """First vertex of each block, shape (n + 1,)."""
    before: Ints
    """Vertex before each one in its block, shape (nv,)."""
    after: Ints
    """Vertex after each one in its block, shape (nv,)."""


def polygon_arrays(vertices: Floats, block_start: Ints, vertex_block: Ints) -> tuple[Any, ...]:
    """Return the arrays of ``Polygons``, as a plain tuple, which numba takes faster."""
    direction, length = edges(vertices, block_start)
    before, after = neighbours(block_start)
    return vertices, direction, length, vertex_block, block_start, before, after


@kernel()
def neighbours(block_start):
    """Return the vertices before and after each one in its block, (nv,) each."""
    before, after = np.arange(-1, block_start[-1] - 1), np.arange(1, block_start[-1] + 1)
    for b in range(len(block_start) - 1):
        before[block_start[b]] = block_start[b + 1] - 1
        after[block_start[b + 1] - 1] = block_start[b]
    return before, after


@kernel()
def vertex_after(k, first, last):
    """Return the vertex after k of the block with vertices first to last - 1."""
    return k + 1 if k + 1 < last else first


@kernel(forceinline=True)
def sine(a, b, direction):
    """Return the sine of the angle from edge a to edge b."""
    return direction[a, 0] * direction[b, 1] - direction[a, 1] * direction[b, 0]


@kernel(forceinline=True)
def cosine(a, b, direction):
    """Return the cosine of the angle between edges a and b."""
    return direction[a, 0] * direction[b, 0] + direction[a, 1] * direction[b, 1]


@kernel(forceinline=True)
def next_edge(e, at_end, outlines):
    """Return the edge next to edge e at its end, or at its start."""
    return outlines.after[e] if at_end else outlines.before[e]


@kernel(forceinline=True)
def end_of(e, at_end, outlines):
    """Return the vertex at the end of edge e, or at its start."""
    return outlines.after[e] if at_end else e


@kernel(forceinline=True)
def turn_at(e, at_end, outlines):
    """Return the sine of the turn at one end of edge e: positive at a convex corner."""
    if at_end:
        return sine(e, outlines.after[e], outlines.direction)
    return sine(outlines.before[e], e, outlines.direction)


@kernel(forceinline=True)
def gap_to(p, e, outlines):
    """Return the signed distance of vertex p to the line of edge e, m, positive in front."""
    vertices, direction = outlines.vertices, outlines.direction
    x, y = vertices[p, 0] - vertices[e, 0], vertices[p, 1] - vertices[e, 1]
    return x * direction[e, 1] - y * direction[e, 0]


@kernel(forceinline=True)
def runs_along(x, y, e, inwards, direction):
    """Return True if the unit vector (x, y) runs along edge e within 3 degrees, or back along it.

    ``inwards`` is 1 or -1 for the two.
    """
    tx, ty = direction[e, 0], direction[e, 1]
    return inwards * (x * tx + y * ty) > 0.0 and abs(x * ty - y * tx) <= SMALL_ANGLE


@kernel()
def moments(vertices, block_start):
    """Return area (n,), centroid (n, 2) and central second moments (n, 3): int x2, y2, xy dA.

    In m2, m and m4, from vertices (nv, 2), m, and the first vertex of each block (n + 1,).  Exact
    for polygons (Shi 1988, simplex integration; Green's theorem).  Each polygon is measured from
    its own first vertex, so that nothing is lost far from the origin; the moments are gathered
    about the centroid in a second sweep for the same reason.
    """
    count = len(block_start) - 1
    area, centroid, second = np.empty(count), np.empty((count, 2)), np.empty((count, 3))
    _moments(count, vertices, block_start, area, centroid, second)
    return area, centroid, second


@shared(BLOCKS)
def _moments(low, high, vertices, block_start, area, centroid, second):
    """Write area, centroid and central second moments of blocks ``low`` to ``high`` - 1."""
    for b in range(low, high):
        first, last = block_start[b], block_start[b + 1]
        x0, y0 = vertices[first, 0], vertices[first, 1]
        a, sx, sy = 0.0, 0.0, 0.0
        for k in range(first + 1, last - 1):
            x1, y1 = vertices[k, 0] - x0, vertices[k, 1] - y0
            x2, y2 = vertices[k + 1, 0] - x0, vertices[k + 1, 1] - y0
            triangle = 0.5 * (x1 * y2 - x2 * y1)
            a += triangle
            sx += triangle * (x1 + x2) / 3.0
            sy += triangle * (y1 + y2) / 3.0
        cx, cy = sx / a, sy / a
        area[b] = a
        centroid[b, 0], centroid[b, 1] = x0 + cx, y0 + cy
        sxx, syy, sxy = 0.0, 0.0, 0.0
        for k in range(first, last):
            following = vertex_after(k, first, last)
            x1, y1 = (vertices[k, 0] - x0) - cx, (vertices[k, 1] - y0) - cy
            x2, y2 = (vertices[following, 0] - x0) - cx, (vertices[following, 1] - y0) - cy
            cross = x1 * y2 - x2 * y1
            sxx += cross * (x1 * x1 + x1 * x2 + x2 * x2) / 12.0
            syy += cross * (y1 * y1 + y1 * y2 + y2 * y2) / 12.0
            sxy += cross * (2.0 * x1 * y1 + x1 * y2 + x2 * y1 + 2.0 * x2 * y2) / 24.0
        second[b, 0], second[b, 1], second[b, 2] = sxx, syy, sxy


def offsets(positions: Floats, block: Ints, centroid: Floats) -> Floats:
    """Return where points (k, 2) of blocks (k,) are beside the centroids (n, 2), m, (k, 2)."""
    result = np.empty_like(positions)
    _offsets(len(positions), positions, block, centroid, result)
    return result


@shared(CONTACTS)
def _offsets(first, last, positions, block, centroid, result):
    """Write the offsets of points ``first`` to ``last`` - 1."""
    for k in range(first, last):
        result[k, 0] = positions[k, 0] - centroid[block[k], 0]
        result[k, 1] = positions[k, 1] - centroid[block[k], 1]


def owners(block_start: Ints) -> Ints:
    """Return the block of each vertex, shape (nv,)."""
    return np.repeat(np.arange(len(block_start) - 1), np.diff(block_start))


@kernel()
def boxes(vertices, block_start):
    """Return the bounding box (xmin, ymin, xmax, ymax) of each block, m, shape (n, 4)."""
    box = np.empty((len(block_start) - 1, 4))
    _boxes(len(box), vertices, block_start, box)
    return box


@shared(BLOCKS)
def _boxes(first, last, vertices, block_start, box):
    """Write the bounding boxes of blocks ``first`` to ``last`` - 1."""
    for b in range(first, last):
        xmin, ymin, xmax, ymax = np.inf, np.inf, -np.inf, -np.inf
        for k in range(block_start[b], block_start[b + 1]):
            x, y = vertices[k, 0], vertices[k, 1]
            xmin, ymin = min(xmin, x), min(ymin, y)
            xmax, ymax = max(xmax, x), max(ymax, y)
        box[b, 0], box[b, 1], box[b, 2], box[b, 3] = xmin, ymin, xmax, ymax


@kernel()
def edges(vertices, block_start):
    """Return unit direction (nv, 2) and length (nv,), m, of the edge that starts at each vertex."""
    direction, length = np.empty((len(vertices), 2)), np.empty(len(vertices))
    _edges(len(block_start) - 1, vertices, block_start, direction, length)
    return direction, length


@shared(BLOCKS)
def _edges(low, high, vertices, block_start, direction, length):
    """Write direction and length of the edges of blocks ``low`` to ``high`` - 1."""
    for b in range(low, high):
        first, last = block_start[b], block_start[b + 1]
        for k in range(first, last):
            following = vertex_after(k, first, last)
            dx = vertices[following, 0] - vertices[k, 0]
            dy = vertices[following, 1] - vertices[k, 1]
            size = np.sqrt(dx * dx + dy * dy)
            length[k] = size
            direction[k, 0], direction[k, 1] = dx / size, dy / size


@kernel()
def travel(before, after):
    """Return the largest distance between two sets of points (k, 2), m; nan where not finite."""
    largest = 0.0
    for k in range(len(before)):
        dx, dy = after[k, 0] - before[k, 0], after[k, 1] - before[k, 1]
        square = dx * dx + dy * dy
        if not square <= np.inf or square == np.inf:
            return np.nan
        largest = max(largest, square)
    return np.sqrt(largest)


def farthest(movement: Floats, block_start: Ints) -> Floats:
    """Return the largest movement of a vertex of each block, m, shape (n,), from (nv, 2)."""
    result = np.empty(len(block_start) - 1)
    _farthest(len(result), movement, block_start, result)
    return result


@shared(BLOCKS)
def _farthest(first, last, movement, block_start, result):
    """Write the largest movements of blocks ``first`` to ``last`` - 1."""
    for b in range(first, last):
        largest = 0.0
        for k in range(block_start[b], block_start[b + 1]):
            dx, dy = movement[k, 0], movement[k, 1]
            largest = max(largest, dx * dx + dy * dy)
        result[b] = np.sqrt(largest)


@kernel()
def depth_inside(px, py, vertices, first, last):
    """Return the distance to the outline of a point inside the polygon, m; 0 outside."""
    inside = False
    nearest = np.inf
    for k in range(first, last):
        following = vertex_after(k, first, last)
        x1, y1 = vertices[k, 0] - px, vertices[k, 1] - py
        x2, y2 = vertices[following, 0] - px, vertices[following, 1] - py
        if (y1 > 0.0) != (y2 > 0.0) and x1 + (x2 - x1) * (-y1) / (y2 - y1) > 0.0:
            inside = not inside
        dx, dy = x2 - x1, y2 - y1
        share = min(1.0, max(0.0, -(x1 * dx + y1 * dy) / (dx * dx + dy * dy)))
        fx, fy = x1 + share * dx, y1 + share * dy
        nearest = min(nearest, fx * fx + fy * fy)
    return np.sqrt(nearest) if inside else 0.0


def thicknesses(vertices: Floats, block_start: Ints) -> Floats:
    """Return the smallest extent of each block, m, across one of its edges, shape (n,)."""
    result = np.empty(len(block_start) - 1)
    _thicknesses(len(result), vertices, block_start, result)
    return result


@shared(BLOCKS)
def _thicknesses(low_block, high_block, vertices, block_start, result):
    """Write the thicknesses of blocks ``low_block`` to ``high_block`` - 1."""
    for b in range(low_block, high_block):
        first, last = block_start[b], block_start[b + 1]
        least = np.inf
        for k in range(first, last):
            after = vertex_after(k, first, last)
            tx, ty = vertices[after, 0] - vertices[k, 0], vertices[after, 1] - vertices[k, 1]
            low, high = 0.0, 0.0
            for p in range(first, last):
                x, y = vertices[p, 0] - vertices[k, 0], vertices[p, 1] - vertices[k, 1]
                low, high = min(low, tx * y - ty * x), max(high, tx * y - ty * x)
            least = min(least, (high - low) / np.hypot(tx, ty))
        result[b] = least
