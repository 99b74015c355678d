"""Areas, centroids, moments and edges of polygons (simplex integration), all blocks at once."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do


@kernel()
def _measure(b, vertices, block_start, area, centroid, second):
    """Write down area, centroid and central second moments of block b."""
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
        following = k + 1 if k + 1 < last else first
        x1, y1 = (vertices[k, 0] - x0) - cx, (vertices[k, 1] - y0) - cy
        x2, y2 = (vertices[following, 0] - x0) - cx, (vertices[following, 1] - y0) - cy
        cross = x1 * y2 - x2 * y1
        sxx += cross * (x1 * x1 + x1 * x2 + x2 * x2) / 12.0
        syy += cross * (y1 * y1 + y1 * y2 + y2 * y2) / 12.0
        sxy += cross * (2.0 * x1 * y1 + x1 * y2 + x2 * y1 + 2.0 * x2 * y2) / 24.0
    second[b, 0], second[b, 1], second[b, 2] = sxx, syy, sxy


@kernel(parallel=True)
def _measure_shared(vertices, block_start, area, centroid, second):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(area))):
            first, last = bounds(part, len(area))
            for b in range(first, last):
                _measure(b, vertices, block_start, area, centroid, second)


@kernel()
def moments(vertices, block_start):
    """Return area (n,), centroid (n, 2) and central second moments (n, 3): int x2, y2, xy dA.

    Exact for polygons (Shi 1988, simplex integration; Green's theorem).  Each polygon is measured
    from its own first vertex, so that nothing is lost far from the origin; the moments are
    gathered about the centroid in a second sweep for the same reason.
    """
    count = len(block_start) - 1
    area, centroid, second = np.zeros(count), np.zeros((count, 2)), np.zeros((count, 3))
    if count >= MANY:
        _measure_shared(vertices, block_start, area, centroid, second)
    else:
        for b in range(count):
            _measure(b, vertices, block_start, area, centroid, second)
    return area, centroid, second


@kernel()
def _offsets(first, last, positions, block, centroid, result):
    for k in range(first, last):
        result[k, 0] = positions[k, 0] - centroid[block[k], 0]
        result[k, 1] = positions[k, 1] - centroid[block[k], 1]


@kernel(parallel=True)
def _offsets_shared(positions, block, centroid, result):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(positions))):
            first, last = bounds(part, len(positions))
            _offsets(first, last, positions, block, centroid, result)


@kernel()
def offsets(positions, block, centroid):
    """Return where points (k, 2) of blocks (k,) are beside the centroids (n, 2), m, (k, 2)."""
    result = np.empty_like(positions)
    if len(positions) >= MANY:
        _offsets_shared(positions, block, centroid, result)
    else:
        _offsets(0, len(positions), positions, block, centroid, result)
    return result


@kernel()
def owners(block_start):
    """Return the block of each vertex, shape (nv,)."""
    result = np.empty(block_start[-1], np.int64)
    for b in range(len(block_start) - 1):
        for vertex in range(block_start[b], block_start[b + 1]):
            result[vertex] = b
    return result


@kernel()
def _boxes(first, last, vertices, block_start, box):
    for b in range(first, last):
        xmin, ymin, xmax, ymax = np.inf, np.inf, -np.inf, -np.inf
        for k in range(block_start[b], block_start[b + 1]):
            x, y = vertices[k, 0], vertices[k, 1]
            xmin, ymin = min(xmin, x), min(ymin, y)
            xmax, ymax = max(xmax, x), max(ymax, y)
        box[b, 0], box[b, 1], box[b, 2], box[b, 3] = xmin, ymin, xmax, ymax


@kernel(parallel=True)
def _boxes_shared(vertices, block_start, box):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(box))):
            first, last = bounds(part, len(box))
            _boxes(first, last, vertices, block_start, box)


@kernel()
def boxes(vertices, block_start):
    """Return the bounding box (xmin, ymin, xmax, ymax) of each block, m, shape (n, 4)."""
    box = np.empty((len(block_start) - 1, 4))
    if len(box) >= MANY:
        _boxes_shared(vertices, block_start, box)
    else:
        _boxes(0, len(box), vertices, block_start, box)
    return box


@kernel()
def _edges(low, high, vertices, block_start, direction, length):
    for b in range(low, high):
        first, last = block_start[b], block_start[b + 1]
        for k in range(first, last):
            following = k + 1 if k + 1 < last else first
            dx = vertices[following, 0] - vertices[k, 0]
            dy = vertices[following, 1] - vertices[k, 1]
            size = np.sqrt(dx * dx + dy * dy)
            length[k] = size
            direction[k, 0], direction[k, 1] = dx / size, dy / size


@kernel(parallel=True)
def _edges_shared(vertices, block_start, direction, length):
    count = len(block_start) - 1
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(count)):
            low, high = bounds(part, count)
            _edges(low, high, vertices, block_start, direction, length)


@kernel()
def edges(vertices, block_start):
    """Return unit direction (nv, 2) and length (nv,) of the edge that starts at each vertex."""
    direction, length = np.empty((len(vertices), 2)), np.empty(len(vertices))
    if len(block_start) > MANY:
        _edges_shared(vertices, block_start, direction, length)
    else:
        _edges(0, len(block_start) - 1, vertices, block_start, direction, length)
    return direction, length


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


@kernel()
def farthest(movement, block_start):
    """Return the largest movement of a vertex of each block, m, shape (n,), from (nv, 2)."""
    result = np.empty(len(block_start) - 1)
    for b in range(len(result)):
        largest = 0.0
        for k in range(block_start[b], block_start[b + 1]):
            dx, dy = movement[k, 0], movement[k, 1]
            largest = max(largest, dx * dx + dy * dy)
        result[b] = np.sqrt(largest)
    return result
