"""Seams: blocks that lie flush make one surface, and covered faces are no entrance.

A vertex that carries lies below its surface by N/p.  Where the surface goes on over a joint it so
lies in front of the next block's side face, and below its top.  A body that is not pressed in would
pass above the corner there: it can come in through the top, but not through the side.

So edge e is no entrance at its corner C with edge f where the vertex V could come in through f as
well and one of the two blocks stands on a third, facing as f does, on a surface that

- the other block's corner (C or V) does not stand out of by more than the contacts give way, and
- the standing block's own corner (V or C) does not hang below by more than it is pressed in.

The settlement of the contacts is the penetration with which the block stands there, and how far the
block below has been pressed down with it: the sum of the penetrations under it, block by block, and
of the shortening of these blocks.  A higher step is an obstacle.  At a free corner, where no third
block makes a surface, the corner rule alone decides.

Where corners of two blocks coincide, and a face of one lies against a face of the other, the
outline of the two together goes on over the joint between them (``goes_on``), whoever stands on it.
Towards a third block such a corner is one of that outline:

- as a vertex it has the edges on either side of the joint, and where these make no corner, or one
  that cannot come in through an edge, it is none;
- the faces in the joint are no entrance;
- a block that lies on the edge beyond the joint, and overhangs this side by no more than it is
  pressed in and its support has given way, does not stand on this side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clast.block.polygon import (
    ROUND_OFF,
    SMALL_ANGLE,
    Polygons,
    cosine,
    end_of,
    next_edge,
    runs_along,
    sine,
    turn_at,
)
from clast.compute.jit import kernel
from clast.model.model import Floats, Ints

FACES_LIKE, BEND = np.cos(np.radians(45.0)), np.sin(np.radians(45.0))
"""Cosine and sine of the largest bend of a surface at a seam."""
BLOCKS_BELOW_MAX = 64
"""Blocks below one another whose settlement is added up, at most."""
EDGES_ROUND_MAX = 64
"""Edges of an outline between the two sides of a step or a notch, at most."""


class BearingContacts(NamedTuple):
    """Contacts of the last step, by the blocks that stand on them (r of them)."""

    start: Ints
    """First of the ``rows`` of each block, shape (n + 1,)."""
    rows: Ints
    """Contacts of each block, block by block (``rows_by_block``), shape (k,)."""
    vertex: Ints
    """Vertex of each contact, shape (r,)."""
    block: Ints
    """Block of its edge, shape (r,)."""
    edge: Ints
    """Its edge, shape (r,)."""
    gap: Floats
    """Its gap, m, shape (r,)."""
    strain: Floats
    """Strain of each block, shape (n, 3)."""
    beyond: Ints
    """Edges by which outlines go on beyond a joint (``goes_on``), shape (nv, 2)."""
    largest_settlement: Floats
    """Bound on how far each block has been pressed down (``largest_settlements``), m, (n,)."""


@kernel()
def rows_by_block(memory, vertex_block, block_count, critdis):
    """Return the first memory row of each block, (block_count + 1,), and these rows, (2 k,).

    ``memory`` are its vertices, the blocks of its edges, and its gaps (r,), m.  Each row belongs to
    the block of its vertex and to the block of its edge, k rows in all: nothing stands on a block
    farther than ``critdis``, m, away, which is remembered only because blocks are fast.
    """
    vertex, block, gap = memory
    start = np.zeros(block_count + 1, np.int64)
    for row in range(len(vertex)):
        if gap[row] <= critdis:
            start[vertex_block[vertex[row]] + 1] += 1
            start[block[row] + 1] += 1
    for b in range(block_count):
        start[b + 1] += start[b]
    rows, filled = np.empty(start[-1], np.int64), start[:-1].copy()
    for row in range(len(vertex)):
        if gap[row] <= critdis:
            for b in (vertex_block[vertex[row]], block[row]):
                rows[filled[b]] = row
                filled[b] += 1
    return start, rows


@kernel()
def largest_settlements(gap, strain, fixed, box):
    """Return how far blocks may have been pressed down at most, m, (n,): 0 if they are ``fixed``.

    By remembered contacts with gaps (r,), m, and strains (n, 3); ``box`` (n, 4) are the boxes.
    """
    deepest = 0.0
    for row in range(len(gap)):
        deepest = max(deepest, -gap[row])
    shorter = 0.0
    for b in range(len(box)):
        size = (box[b, 2] - box[b, 0]) + (box[b, 3] - box[b, 1])
        strained = abs(strain[b, 0]) + abs(strain[b, 1]) + abs(strain[b, 2])
        shorter = max(shorter, size * strained)
    most = np.zeros(len(box))
    for b in range(len(box)):
        if not fixed[b]:
            most[b] = BLOCKS_BELOW_MAX * (1.01 * (deepest + shorter))
    return most


@kernel()
def _surface(row, block, bearing, vertices, direction, vertex_block):
    """Return the surface on which ``block`` stands by a remembered contact, and its settlement.

    A point of it, its normal (towards the block), the other block, and the penetration, m.
    """
    vertex, of_edge = bearing.vertex, bearing.block
    edge, gap = bearing.edge, bearing.gap
    v, e = vertex[row], edge[row]
    nx, ny = direction[e, 1], -direction[e, 0]
    depth = max(0.0, -gap[row])
    if vertex_block[v] == block:
        return vertices[e, 0], vertices[e, 1], nx, ny, of_edge[row], depth
    return vertices[v, 0], vertices[v, 1], -nx, -ny, vertex_block[v], depth


@kernel()
def _shortening(block, nx, ny, outlines, strain):
    """Return by how much a block has become shorter along a direction, m, >= 0."""
    vertices, block_start = outlines.vertices, outlines.block_start
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
    """Return how far a block has been pressed down against (nx, ny), m: its own and that below.

    From block to block, each by the contact in which it is pressed in most, down to one that cannot
    move.
    """
    vertices, direction, vertex_block = outlines.vertices, outlines.direction, outlines.vertex_block
    start, rows = bearing.start, bearing.rows
    strain, most = bearing.strain, bearing.largest_settlement
    down = 0.0
    for _ in range(BLOCKS_BELOW_MAX):
        if most[block] == 0.0:
            break
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
def _goes_on(g, p, top, outlines):
    """Return True if an outline goes on at its vertex p as at its edge g, beyond a step or a notch.

    From the edge at p that faces as ``top`` does, on over the other one there, it comes to g and
    has turned back as far as it had turned.  Round a convex corner it has not.
    """
    direction = outlines.direction
    k, before = p, outlines.before[p]
    more = (direction[p, 1] - direction[before, 1]) * top[0]
    more -= (direction[p, 0] - direction[before, 0]) * top[1]
    if more < 0.0:
        k = before
    turned = 0.0
    for _ in range(EDGES_ROUND_MAX):
        if k == g:
            return abs(turned) < 0.5 * np.pi
        on = next_edge(k, more < 0.0, outlines)
        turned += np.arctan2(sine(k, on, direction), cosine(k, on, direction))
        k = on
    return False


@kernel()
def _is_flush(block, side, top, own, other, scale, outlines, bearing):
    """Return True if ``block`` stands on a surface that faces as ``top`` does and goes on there.

    The surface is that of a third block, or of the second one beyond a step or a notch of it.
    ``other``, a vertex of the second, does not stand out of it, and ``own``, a vertex of this one,
    does not hang below it, but for the settlement.  An edge that faces as the surface does, with
    normal ``side``, is part of it and no side face.
    """
    vertices, direction, vertex_block = outlines.vertices, outlines.direction, outlines.vertex_block
    start, rows = bearing.start, bearing.rows
    for at in range(start[block], start[block + 1]):
        x, y, mx, my, below, depth = _surface(
            rows[at], block, bearing, vertices, direction, vertex_block
        )
        if mx * top[0] + my * top[1] < FACES_LIKE or mx * side[0] + my * side[1] >= FACES_LIKE:
            continue
        out = (vertices[other, 0] - x) * mx + (vertices[other, 1] - y) * my
        high = (vertices[own, 0] - x) * mx + (vertices[own, 1] - y) * my
        gives = depth + ROUND_OFF * scale
        if max(out, -high - depth) > gives + bearing.largest_settlement[below]:
            continue
        if out > gives or high < -gives - depth:  # it may be flush yet if what is below gives way
            gives += _settlement(below, mx, my, outlines, bearing)
        if out <= gives and high >= -gives - depth:
            if below != vertex_block[other] or _goes_on(
                bearing.edge[rows[at]], other, top, outlines
            ):
                return True
    return False


@kernel()
def is_covered(v, e, at_end, own, outlines, bearing):
    """Return True if edge e is no entrance for vertex v of another block at one of its ends.

    ``own`` (ax, ay, bx, by) are the vertex's two edges, pointing away from it; ``outlines`` are
    ``Polygons``, ``bearing`` the ``BearingContacts``.
    """
    direction, length = outlines.direction, outlines.length
    i, j = outlines.vertex_block[v], outlines.vertex_block[e]
    if turn_at(e, at_end, outlines) <= SMALL_ANGLE:
        at_end = not at_end  # at the foot of a step: its top is the corner
        if turn_at(e, at_end, outlines) <= SMALL_ANGLE:
            return False
    corner, f = end_of(e, at_end, outlines), next_edge(e, at_end, outlines)
    nx, ny = direction[f, 1], -direction[f, 0]
    ax, ay, bx, by = own
    if ax * nx + ay * ny < -BEND or bx * nx + by * ny < -BEND:
        return False  # it could not come in through f, not even where the surface bends
    ex, ey = direction[e, 1], -direction[e, 0]
    scale = min(length[e], length[f])
    return _is_flush(i, (ex, ey), (nx, ny), v, corner, scale, outlines, bearing) or _is_flush(
        j, (-ex, -ey), (-nx, -ny), corner, v, scale, outlines, bearing
    )


# corners of two blocks together -----------------------------------------------------------------


@kernel(forceinline=True)
def _join(p, q, critdis, outlines, beyond):
    """Note where the outlines of two blocks go on over a joint that begins at their p and q.

    The edge that begins at p and the one that ends at q lie in the joint, if any two do.
    """
    vertices, direction = outlines.vertices, outlines.direction
    if np.hypot(vertices[p, 0] - vertices[q, 0], vertices[p, 1] - vertices[q, 1]) > critdis:
        return
    into_p, into_q = outlines.before[p], outlines.before[q]
    if cosine(p, into_q, direction) > 0.0 or abs(sine(p, into_q, direction)) > SMALL_ANGLE:
        return
    if cosine(into_p, q, direction) >= FACES_LIKE:
        beyond[p, 1], beyond[q, 0] = q, into_p


@kernel()
def goes_on(pairs, box, outlines, critdis):
    """Return the edges by which the outline goes on at each vertex beyond a joint, (nv, 2), or -1.

    The one before the vertex, where the edge that ends there lies in a joint; and the one after it,
    where the edge that begins there does.  Of ``pairs`` (q, 2) of blocks whose corners are within
    ``critdis``, m; ``box`` (n, 4) are the boxes of the blocks.
    """
    polygons = Polygons(*outlines)
    vertices, block_start = polygons.vertices, polygons.block_start
    beyond = np.full((len(vertices), 2), -1)
    for at in range(len(pairs)):
        i, k = pairs[at, 0], pairs[at, 1]
        left, low = max(box[i, 0], box[k, 0]), max(box[i, 1], box[k, 1])
        right, high = min(box[i, 2], box[k, 2]), min(box[i, 3], box[k, 3])
        for q in range(block_start[k], block_start[k + 1]):
            x, y = vertices[q, 0], vertices[q, 1]
            if not (
                left - critdis <= x <= right + critdis and low - critdis <= y <= high + critdis
            ):
                continue
            for p in range(block_start[i], block_start[i + 1]):
                if abs(vertices[p, 0] - x) <= critdis and abs(vertices[p, 1] - y) <= critdis:
                    _join(p, q, critdis, polygons, beyond)
                    _join(q, p, critdis, polygons, beyond)
    return beyond


@kernel()
def _is_level(v, e, side, outlines, bearing):
    """Return True if the corner at vertex v is flush with that of the edge e beyond the joint.

    But for the settlement of the blocks of both.  ``side`` is 0 where e comes before v.
    """
    vertices, direction, length = outlines.vertices, outlines.direction, outlines.length
    i, k = outlines.vertex_block[v], outlines.vertex_block[e]
    corner, own = end_of(e, side == 0, outlines), outlines.before[v] if side == 1 else v
    x, y = vertices[v, 0] - vertices[corner, 0], vertices[v, 1] - vertices[corner, 1]
    for edge in (own, e):
        nx, ny = direction[edge, 1], -direction[edge, 0]
        high = abs(x * nx + y * ny) - ROUND_OFF * min(length[own], length[e])
        if high > 0.0 and high > (
            _settlement(i, nx, ny, outlines, bearing) + _settlement(k, nx, ny, outlines, bearing)
        ):
            return False
    return True


@kernel()
def is_no_corner(v, j, nx, ny, own, outlines, bearing):
    """Return True if v, with flush blocks beside it, is no vertex that could enter block j.

    Over an edge with the normal (nx, ny); ``own`` (ax, ay, bx, by) are the vertex's two edges,
    pointing away from it.
    """
    direction, vertex_block = outlines.direction, outlines.vertex_block
    beyond = bearing.beyond
    ax, ay, bx, by = own
    flush = False
    e = beyond[v, 0]
    if e >= 0 and vertex_block[e] != j:
        ax, ay, flush = -direction[e, 0], -direction[e, 1], True
    f = beyond[v, 1]
    if f >= 0 and vertex_block[f] != j:
        bx, by, flush = direction[f, 0], direction[f, 1], True
    if not flush:
        return False
    is_hollow = bx * ay - by * ax < -SMALL_ANGLE
    if not is_hollow and min(ax * nx + ay * ny, bx * nx + by * ny) >= -SMALL_ANGLE:
        return False
    if e >= 0 and vertex_block[e] != j and not _is_level(v, e, 0, outlines, bearing):
        return False
    return f < 0 or vertex_block[f] == j or _is_level(v, f, 1, outlines, bearing)


@kernel()
def is_in_joint(e, at_end, i, outlines, bearing):
    """Return True if edge e lies in a joint at one of its ends, with a block other than i."""
    v, side = end_of(e, at_end, outlines), 0 if at_end else 1
    other = bearing.beyond[v, side]
    if other < 0 or outlines.vertex_block[other] == i:
        return False
    return _is_level(v, other, side, outlines, bearing)


@kernel()
def _pressed_in(p, block, bearing):
    """Return how deep vertex p was in a block at the end of the last step, m."""
    vertex, of_edge, gap = bearing.vertex, bearing.block, bearing.gap
    at = np.searchsorted(vertex, p)
    depth = 0.0
    while at < len(vertex) and vertex[at] == p:
        if of_edge[at] == block:
            depth = max(depth, -gap[at])
        at += 1
    return depth


@kernel()
def _has_given_way(p, block, v, f, outlines, bearing):
    """Return how far the block of edge f has given way under vertex p of another one, m.

    And that one to vertex v of the block of f; with it the blocks below the block of f.
    """
    direction, vertex_block = outlines.direction, outlines.vertex_block
    below = vertex_block[f]
    pressed_in = max(_pressed_in(p, below, bearing), _pressed_in(v, block, bearing))
    return pressed_in + _settlement(below, direction[f, 1], -direction[f, 0], outlines, bearing)


@kernel()
def stands_beyond(p, e, at_end, inside, own, outlines, bearing):
    """Return True if vertex p and edge e overlap only as one block overhangs a joint of the other.

    Near one end of e: p's block lies on the edge beyond the joint there, or the block of e on the
    edge beyond the joint at p.  They overlap by ``inside``, m; it is no more than the settlement of
    that edge and below it.
    """
    direction, vertex_block = outlines.direction, outlines.vertex_block
    i, j = vertex_block[p], vertex_block[e]
    beyond, slack = bearing.beyond, ROUND_OFF * outlines.length[e]
    v, inwards = end_of(e, at_end, outlines), -1.0 if at_end else 1.0
    f = beyond[v, 1 if at_end else 0]
    if f >= 0 and vertex_block[f] != i:
        corner = end_of(f, not at_end, outlines)
        for k in range(2):
            if runs_along(own[2 * k], own[2 * k + 1], f, -inwards, direction) and (
                inside <= slack
                or inside <= slack + _has_given_way(p, i, corner, f, outlines, bearing)
            ):
                return True
    for k in range(2):
        f = beyond[p, k]
        if f < 0 or vertex_block[f] == j:
            continue
        # away from p: the edge beyond the joint, and p's own on this side of it
        x, y = (-1.0 + 2.0 * k) * direction[f, 0], (-1.0 + 2.0 * k) * direction[f, 1]
        ox, oy = own[2 * (1 - k)], own[2 * (1 - k) + 1]
        corner = end_of(f, k == 0, outlines)
        if runs_along(x, y, e, inwards, direction) and runs_along(ox, oy, e, -inwards, direction):
            if inside <= slack + _has_given_way(v, j, corner, f, outlines, bearing):
                return True
    return False
