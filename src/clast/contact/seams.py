"""Seams: blocks that lie flush make one surface, and what they cover is no entrance.

A vertex that bears lies below its surface by N/p.  Where the surface goes on over a joint it so
lies in front of the next block's side face, and below its top.  A body that is not pressed in would
pass above the corner there: it can come in through the top, but not through the side.

So edge e is no entrance at its corner C with edge f where the vertex V could come in through f as
well and one of the two blocks stands on a third, facing as f does, on a surface that

- the other block's corner (C or V) does not stand out of by more than the contacts give way, and
- the standing block's own corner (V or C) does not hang below by more than it is pressed in.

What the contacts give way is the penetration with which the block stands there, and how far the
block below has been pressed down with it: the sum of the penetrations under it, block by block, and
of the shortening of these blocks.  A higher step is an obstacle.  At a free corner, where no third
block makes a surface, the corner rule alone decides.
"""

from __future__ import annotations

import numpy as np

from clast.block.polygon import ROUND_OFF, SMALL_ANGLE, turn_at, vertex_after, vertex_before
from clast.compute.jit import kernel

FACES_LIKE, BEND = np.cos(np.radians(45.0)), np.sin(np.radians(45.0))
"""Cosine and sine of the largest bend of a surface at a seam."""
BLOCKS_BELOW = 64
"""Blocks below one another whose settlement is added up, at most."""


@kernel()
def rows_by_block(memory_vertex, memory_block, vertex_block, block_count):
    """Return the first memory row of each block, (block_count + 1,), and these rows, (2 k,).

    Each row belongs to the block of its vertex and to the block of its edge.
    """
    start = np.zeros(block_count + 1, np.int64)
    for row in range(len(memory_vertex)):
        start[vertex_block[memory_vertex[row]] + 1] += 1
        start[memory_block[row] + 1] += 1
    for block in range(block_count):
        start[block + 1] += start[block]
    rows, filled = np.empty(2 * len(memory_vertex), np.int64), start[:-1].copy()
    for row in range(len(memory_vertex)):
        for block in (vertex_block[memory_vertex[row]], memory_block[row]):
            rows[filled[block]] = row
            filled[block] += 1
    return start, rows


@kernel()
def _surface(row, block, bearing, vertices, direction, vertex_block):
    """Return the surface on which ``block`` stands by a remembered contact, and what gives way.

    A point of it, its normal (towards the block), the other block, and the penetration, m.
    """
    _, _, vertex, of_edge, edge, gap, _ = bearing
    v, e = vertex[row], edge[row]
    nx, ny = direction[e, 1], -direction[e, 0]
    depth = max(0.0, -gap[row])
    if vertex_block[v] == block:
        return vertices[e, 0], vertices[e, 1], nx, ny, of_edge[row], depth
    return vertices[v, 0], vertices[v, 1], -nx, -ny, vertex_block[v], depth


@kernel()
def _shortening(block, nx, ny, outlines, strain):
    """Return by how much a block has become shorter along a direction, m, >= 0."""
    vertices, _, _, _, block_start = outlines
    exx, eyy, gxy = strain[block]
    along = exx * nx * nx + eyy * ny * ny + gxy * nx * ny
    if along >= 0.0:
        return 0.0
    low, high = np.inf, -np.inf
    for k in range(block_start[block], block_start[block + 1]):
        at = vertices[k, 0] * nx + vertices[k, 1] * ny
        low, high = min(low, at), max(high, at)
    return -along * (high - low)


@kernel()
def _settlement(block, nx, ny, outlines, bearing):
    """Return how far a block has been pressed down against (nx, ny), m: its own and what is below.

    From block to block, each by the contact in which it is pressed in most.
    """
    vertices, direction, _, vertex_block, _ = outlines
    start, rows, _, _, _, _, strain = bearing
    down = 0.0
    for _ in range(BLOCKS_BELOW):
        deepest, below = 0.0, -1
        for at in range(start[block], start[block + 1]):
            _, _, mx, my, other, depth = _surface(
                rows[at], block, bearing, vertices, direction, vertex_block
            )
            if mx * nx + my * ny >= FACES_LIKE and depth > deepest:
                deepest, below = depth, other
        if below < 0:
            break
        down += deepest + _shortening(block, nx, ny, outlines, strain)
        block = below
    return down


@kernel()
def _is_flush(block, side, top, own, other, scale, outlines, bearing):
    """Return True if ``block`` stands on a surface that faces as ``top`` does and goes on there.

    The surface is that of a third block.  ``other``, a vertex of the second, does not stand out of
    it, and ``own``, a vertex of this one, does not hang below it, but for what gives way.  An edge
    that faces as the surface does, with normal ``side``, is part of it and no side face.
    """
    vertices, direction, _, vertex_block, _ = outlines
    start, rows = bearing[0], bearing[1]
    for at in range(start[block], start[block + 1]):
        x, y, mx, my, below, depth = _surface(
            rows[at], block, bearing, vertices, direction, vertex_block
        )
        if below == vertex_block[other]:
            continue
        if mx * top[0] + my * top[1] < FACES_LIKE or mx * side[0] + my * side[1] >= FACES_LIKE:
            continue
        out = (vertices[other, 0] - x) * mx + (vertices[other, 1] - y) * my
        high = (vertices[own, 0] - x) * mx + (vertices[own, 1] - y) * my
        gives = depth + ROUND_OFF * scale
        if out > gives or high < -gives - depth:  # it may be flush yet if what is below gives way
            gives += _settlement(below, mx, my, outlines, bearing)
        if out <= gives and high >= -gives - depth:
            return True
    return False


@kernel()
def is_covered(v, e, at_end, own, outlines, bearing):
    """Return True if edge e is no entrance for vertex v of another block at one of its ends.

    ``own`` (ax, ay, bx, by) are the vertex's two edges, pointing away from it.  ``outlines`` are
    the vertices, direction and length of the edges that start there, block of each vertex, first
    vertex of each block; ``bearing`` are the first row of the memory of each block and these rows
    (``rows_by_block``), the memory's vertex, block, edge and gap (k,), and the strain (n, 3)
    of the blocks.
    """
    _, direction, length, vertex_block, block_start = outlines
    i, j = vertex_block[v], vertex_block[e]
    first, last = block_start[j], block_start[j + 1]
    if turn_at(e, at_end, direction, first, last) <= SMALL_ANGLE:
        return False
    corner = vertex_after(e, first, last) if at_end else e
    f = corner if at_end else vertex_before(e, first, last)
    nx, ny = direction[f, 1], -direction[f, 0]
    ax, ay, bx, by = own
    if ax * nx + ay * ny < -BEND or bx * nx + by * ny < -BEND:
        return False  # it could not come in through f, not even where the surface bends
    ex, ey = direction[e, 1], -direction[e, 0]
    scale = min(length[e], length[f])
    return _is_flush(i, (ex, ey), (nx, ny), v, corner, scale, outlines, bearing) or _is_flush(
        j, (-ex, -ey), (-nx, -ny), corner, v, scale, outlines, bearing
    )
