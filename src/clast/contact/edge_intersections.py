"""Overlap of two blocks that their contacts do not account for, found by edges that cross.

Candidate edges and corner rules look at vertices: a vertex behind an edge.  Two blocks can overlap
without a vertex inside either, or with one that no rule lets in: a sharp corner that has slid off
the end of an edge, or through a thin corner and out again on its far side; two faces whose ends
have passed each other.  Such blocks would go through each other unopposed.  Their edges cross, and
the shorter exit of a crossing, of a vertex over an edge, is a contact as well.

Where two outlines overlap their edges cross.  A crossing is accounted for by a contact whose
penetration, taken back along its normal, takes the two edges apart.  Edges a and e that cross have
one end each, P and Q, behind the other.  They come apart where P is taken back over e or Q over a,
whichever is nearer: that distance is the depth of the crossing.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from clast.block.edge_lists import edges_within, left_to_right
from clast.block.polygon import ROUND_OFF, Polygons, depth_inside, gap_to
from clast.compute.jit import kernel
from clast.compute.parallel import borrowed
from clast.compute.reductions import is_any
from clast.contact.memory import lost_contacts, pair_keys
from clast.model.model import Floats, Ints
from clast.model.state import ContactMemory

PENETRATION_UNDONE = 1.01
"""Part of a contact's penetration that must undo a crossing which it accounts for."""
SHALLOW_CROSSING = 1e-3
"""New crossings less deep than this are left alone, in units of critdis."""
NEIGHBOUR_DEPTH = 1.5
"""A new crossing less deep than this times the penetration of other contacts of one of the blocks
is left alone: a corner that rests on a surface is below the next block's corner before it comes
upon that block."""
HANDED_ON_DEPTH = 2.0
"""How much deeper than the memory of the pair a contact may be that takes over from another."""
COUPLES_TRIED_MAX = 256
"""Edges are tried each against each where that takes no more trials; else by a sweep."""
NEAR_CROSSING = 10.0
"""Contacts within this distance account for a crossing, in units of its depth."""
APART_SINE = 0.1
"""Sine of the angle between two contacts' normals from which they say two different things."""


class EdgeContacts(NamedTuple):
    """Contacts of vertices with edges, (m,) each, in the order of their pairs."""

    vertex: Ints
    edge: Ints
    pair: Ints
    """Pair of blocks."""
    gap: Floats
    """Gap, m."""


class Crossings(NamedTuple):
    """Crossings that no contact accounts for, (k,) each."""

    edges: Ints
    """The two edges, that of the pair's lower block first, (k, 2)."""
    exits: Ints
    """Vertex and edge of the shorter exit, (k, 2)."""
    depth: Floats
    """Length of this exit, m."""
    pair: Ints
    """Pair of the blocks."""


Chosen = tuple[Ints, Ints, Ints, Floats]
"""Vertex, edge, pair and gap, m, of contacts in the order of the pairs of blocks, (m,) each."""


def with_crossings(
    chosen: Chosen,
    pairs: Ints,
    polygons: tuple[Any, ...],
    box: Floats,
    rows: Ints,
    memory: ContactMemory,
    front: Floats,
    critdis: float,
) -> Chosen:
    """Return the contacts, and with them those that crossings ask for which they do not explain.

    ``polygons`` are the arrays of ``Polygons``, ``box`` (n, 4) the boxes of blocks, ``rows``
    (nv + 1,) the first row of each vertex in the memory, ``front`` (n,) how far the vertices of
    each block may have moved in a step, m.  A contact that was closed at the end of the last step
    goes on where it explains a crossing, however shallow that is by now: its spring still carries.
    Else the shorter exit becomes a contact, if a step's motion or the memory of the pair explains
    it.
    """
    vertex, edge, _, gap = chosen
    vertex_block, width = polygons[3], len(polygons[3])
    carried = np.zeros(len(pairs), np.bool_)
    lost = lost_contacts(memory, rows, vertex, vertex_block.take(edge))
    if is_any(lost):
        key = pair_keys(vertex_block[memory.vertex[lost]], memory.block[lost], width)
        carried = np.isin(pair_keys(pairs[:, 0], pairs[:, 1], width), key)
    floor = SHALLOW_CROSSING * critdis
    crossings = unseen(polygons, box, pairs, chosen, (PENETRATION_UNDONE, floor), carried)
    if not len(crossings[0]):
        return chosen
    which, of_pair = np.unique(crossings[3], return_inverse=True)
    key = pair_keys(vertex_block[memory.vertex], memory.block, width)
    keys = pair_keys(pairs[which, 0], pairs[which, 1], width)
    at = np.minimum(np.searchsorted(keys, key), len(which) - 1)
    closed = (keys[at] == key) & (memory.gap < 0.0)
    depth = np.zeros(len(which))
    np.maximum.at(depth, at[closed], -memory.gap[closed])
    closed &= ~np.isin(memory.vertex * width + memory.edge, vertex * width + edge)
    remembered = memory.vertex[closed], memory.edge[closed], which[at[closed]]
    deepest = np.zeros(len(front))
    for blocks in (vertex_block[vertex], vertex_block[edge]):
        np.maximum.at(deepest, blocks, -gap)
    own, other = pairs[which].T
    around = NEIGHBOUR_DEPTH * np.maximum(deepest[own], deepest[other])
    limit = np.stack(
        [
            np.where(depth > 0.0, floor, np.maximum(around, floor)),
            critdis + front[own] + front[other] + HANDED_ON_DEPTH * depth,
        ],
        axis=1,
    )
    added, of_gap = _exits(crossings, remembered, limit[of_pair], polygons)
    if not len(added):
        return chosen
    vertex, edge, pair = (np.concatenate(both) for both in zip(chosen[:3], added.T, strict=True))
    order = np.lexsort((edge, vertex, pair))
    return vertex[order], edge[order], pair[order], np.concatenate((gap, of_gap))[order]


@kernel(forceinline=True)
def _side(ax, ay, bx, by, px, py):
    """Return twice the area of triangle A, B, P: positive where P is left of A to B."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel(forceinline=True)
def _cross(a, e, outlines, dx, dy):
    """Return whether edge a, moved by (dx, dy), and edge e cross properly."""
    vertices, b, f = outlines.vertices, outlines.after[a], outlines.after[e]
    ax, ay = vertices[a, 0] + dx, vertices[a, 1] + dy
    bx, by = vertices[b, 0] + dx, vertices[b, 1] + dy
    ex, ey, fx, fy = vertices[e, 0], vertices[e, 1], vertices[f, 0], vertices[f, 1]
    if (_side(ax, ay, bx, by, ex, ey) > 0.0) == (_side(ax, ay, bx, by, fx, fy) > 0.0):
        return False
    return (_side(ex, ey, fx, fy, ax, ay) > 0.0) != (_side(ex, ey, fx, fy, bx, by) > 0.0)


@kernel(forceinline=True)
def _crossing_point(a, e, outlines):
    """Return where edges a and e cross, m, x and y."""
    vertices, b, f = outlines.vertices, outlines.after[a], outlines.after[e]
    ax, ay, bx, by = vertices[a, 0], vertices[a, 1], vertices[b, 0], vertices[b, 1]
    ex, ey, fx, fy = vertices[e, 0], vertices[e, 1], vertices[f, 0], vertices[f, 1]
    here, there = _side(ex, ey, fx, fy, ax, ay), _side(ex, ey, fx, fy, bx, by)
    if here == there:  # to the last bit in line
        return ax, ay
    share = here / (here - there)
    return ax + share * (bx - ax), ay + share * (by - ay)


@kernel(forceinline=True)
def _exit(a, e, outlines):
    """Return the shorter exit from a crossing: its vertex, the edge to pass, and how far, m."""
    p = a if gap_to(a, e, outlines) < 0.0 else outlines.after[a]
    q = e if gap_to(e, a, outlines) < 0.0 else outlines.after[e]
    of_p, of_q = -gap_to(p, e, outlines), -gap_to(q, a, outlines)
    if of_p <= of_q:
        return p, e, of_p
    return q, a, of_q


@kernel()
def _cross_around(a, e, outlines, dx, dy):
    """Return whether edges a and e, or those next to them, cross when a's block is moved.

    By (dx, dy), m.  A crossing can pass to the next edge: then the blocks still overlap there.
    """
    own = outlines.before[a]
    for _ in range(3):
        other = outlines.before[e]
        for _ in range(3):
            if _cross(own, other, outlines, dx, dy):
                return True
            other = outlines.after[other]
        own = outlines.after[own]
    return False


@kernel()
def _is_at_a_corner(a, e, floor, outlines):
    """Return whether edges cross for no more than ``floor``, m, that one stands out at a corner.

    Where corners of two blocks meet, edges that lie nearly in line cross next to both.  The far end
    of one may lie far behind the other, by as much as they bend, but moved back along an edge by
    the projection there the blocks do not overlap any more.
    """
    vertices, direction = outlines.vertices, outlines.direction
    b, f = outlines.after[a], outlines.after[e]
    x, y = _crossing_point(a, e, outlines)
    # the ends in front of the other edge; that which stands out less moves back along its edge
    p, to = (b, -1.0) if gap_to(a, e, outlines) < 0.0 else (a, 1.0)
    q, fro = (f, 1.0) if gap_to(e, a, outlines) < 0.0 else (e, -1.0)
    of_p = np.hypot(vertices[p, 0] - x, vertices[p, 1] - y)
    of_q = np.hypot(vertices[q, 0] - x, vertices[q, 1] - y)
    back, along, out = (to, a, of_p) if of_p <= of_q else (fro, e, of_q)
    if out > floor:
        return False
    size = np.hypot(vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1])
    distance = 2.0 * out + ROUND_OFF * size
    dx, dy = back * direction[along, 0], back * direction[along, 1]
    return not _cross_around(a, e, outlines, distance * dx, distance * dy)


@kernel()
def _taken_back(c, contacts, a, share, outlines):
    """Return how the block of edge a moves where a contact's penetration is taken back.

    The unit direction, and ``share`` of the penetration, m.
    """
    direction, vertex_block, e = outlines.direction, outlines.vertex_block, contacts.edge[c]
    sign = 1.0 if vertex_block[contacts.vertex[c]] == vertex_block[a] else -1.0
    return sign * direction[e, 1], -sign * direction[e, 0], -share * contacts.gap[c]


@kernel()
def _is_near(c, contacts, point, way_out, vertices):
    """Return whether the vertex of a closed contact is near that of an exit, by its depth.

    Or near the ``point`` of the crossing, by its depth or by the contact's if that is larger.
    """
    p, gap, (vertex, depth) = contacts.vertex[c], contacts.gap[c], way_out
    if gap >= 0.0:
        return False
    x, y = vertices[p, 0] - vertices[vertex, 0], vertices[p, 1] - vertices[vertex, 1]
    if x * x + y * y <= (NEAR_CROSSING * depth) ** 2:
        return True
    x, y = vertices[p, 0] - point[0], vertices[p, 1] - point[1]
    return x * x + y * y <= (NEAR_CROSSING * max(depth, -gap)) ** 2


@kernel()
def _is_accounted_for(a, e, way_out, span, contacts, share, outlines):
    """Return whether contacts of a ``span`` (first, last + 1) end a crossing if taken back.

    One of them, or two of different directions together: a vertex in a re-entrant corner.  Only
    those near the crossing count: a contact at one end of two faces does not hold the other.
    """
    vertices, (low, high) = outlines.vertices, span
    at = _crossing_point(a, e, outlines)
    for c in range(low, high):
        if not _is_near(c, contacts, at, way_out, vertices):
            continue
        x, y, size = _taken_back(c, contacts, a, share, outlines)
        if not _cross_around(a, e, outlines, size * x, size * y):
            return True
        for d in range(low, c):
            if not _is_near(d, contacts, at, way_out, vertices):
                continue
            u, v, other = _taken_back(d, contacts, a, share, outlines)
            sine = x * v - y * u
            if abs(sine) < APART_SINE:
                continue
            dx, dy = (size * v - other * y) / sine, (other * x - size * u) / sine
            if not _cross_around(a, e, outlines, dx, dy):
                return True
    return False


@kernel()
def _couples(own, others, outlines):
    """Return all couples of edges of two blocks that may cross, (k, 2), where there are many.

    A sweep from left to right: only those whose extents in x meet.
    """
    vertices, after = outlines.vertices, outlines.after
    left_a, edge_a, _ = left_to_right(own, vertices, after)
    left_e, edge_e, widest = left_to_right(others, vertices, after)
    count, start, room = 0, 0, np.empty((4 * (len(own) + len(others)), 2), np.int64)
    for x in range(len(own)):
        a = edge_a[x]
        b = after[a]
        right = max(vertices[a, 0], vertices[b, 0])
        low, high = min(vertices[a, 1], vertices[b, 1]), max(vertices[a, 1], vertices[b, 1])
        while start < len(others) and left_e[start] + widest < left_a[x]:
            start += 1
        for y in range(start, len(others)):
            if left_e[y] > right:
                break
            e = edge_e[y]
            f = after[e]
            if (
                max(vertices[e, 1], vertices[f, 1]) < low
                or min(vertices[e, 1], vertices[f, 1]) > high
            ):
                continue
            if count == len(room):
                room = np.concatenate((room, np.empty_like(room)))
            room[count, 0], room[count, 1] = a, e
            count += 1
    return room[:count]


@kernel(inline="always")
def _couples_within(window, i, j, listed, outlines):
    """Return couples of edges of blocks i and j within a window, (k, 2); all that may cross.

    ``listed`` is room for the edges of either, and for few couples.
    """
    vertices, start, after = outlines.vertices, outlines.block_start, outlines.after
    own, others, few = listed
    own = own[: edges_within(window, 0.0, vertices, after, start[i], start[i + 1], own)]
    others = others[: edges_within(window, 0.0, vertices, after, start[j], start[j + 1], others)]
    if len(own) * len(others) > COUPLES_TRIED_MAX:
        return _couples(own, others, outlines)
    for x in range(len(own)):
        for y in range(len(others)):
            few[x * len(others) + y, 0] = own[x]
            few[x * len(others) + y, 1] = others[y]
    return few[: len(own) * len(others)]


@kernel()
def _is_a_contact(vertex, edge, depth, span, contacts):
    """Return whether a contact of a ``span`` is this vertex over this edge as deep."""
    for c in range(span[0], span[1]):
        if contacts.vertex[c] == vertex and contacts.edge[c] == edge:
            return -contacts.gap[c] >= depth
    return False


@kernel(inline="always")
def _of_pair(couples, span, contacts, limits, outlines, room, count):
    """Append the crossings of couples that contacts do not account for; return how many.

    ``count`` are there already; those that exceed the ``room`` are counted only.  ``limits`` are
    those of ``unseen``, and the depth from which a crossing counts in this pair, m.
    """
    share, floor, least = limits
    for k in range(len(couples)):
        a, e = couples[k, 0], couples[k, 1]
        if not _cross(a, e, outlines, 0.0, 0.0):
            continue
        vertex, edge, depth = _exit(a, e, outlines)
        if depth <= least or _is_a_contact(vertex, edge, depth / share, span, contacts):
            continue
        if _is_at_a_corner(a, e, floor, outlines):
            continue
        if _is_accounted_for(a, e, (vertex, depth), span, contacts, share, outlines):
            continue
        if count < len(room.depth):
            room.edges[count, 0], room.edges[count, 1], room.depth[count] = a, e, depth
            room.exits[count, 0], room.exits[count, 1] = vertex, edge
        count += 1
    return count


@kernel()
def _unseen_of_pairs(outlines, box, pairs, contacts, limits, carried, listed, room):
    """Write the crossings that no contact accounts for into ``room``; return their number.

    ``listed`` is that of ``_couples_within``.
    """
    listed, room = borrowed(listed), borrowed(room)
    pair, (share, floor) = contacts.pair, limits
    count, low = 0, 0
    for q in range(len(pairs)):
        while low < len(pair) and pair[low] < q:
            low += 1
        high = low
        while high < len(pair) and pair[high] == q:
            high += 1
        i, j = pairs[q, 0], pairs[q, 1]
        left, right = max(box[i, 0], box[j, 0]), min(box[i, 2], box[j, 2])
        bottom, top = max(box[i, 1], box[j, 1]), min(box[i, 3], box[j, 3])
        least = 0.0 if carried[q] else floor
        # what the two share is no thicker than what their boxes share
        if min(right - left, top - bottom) <= least:
            continue
        first = count
        couples = _couples_within((left, bottom, right, top), i, j, listed, outlines)
        span, deep = (low, high), (share, floor, least)
        count = _of_pair(couples, span, contacts, deep, outlines, room, count)
        room.pair[first : min(count, len(room.pair))] = q
    return count


@kernel()
def unseen(polygons, box, pairs, contacts, limits, carried):
    """Return the crossings of edges that no contact accounts for, as arrays of ``Crossings``.

    Of ``pairs`` (q, 2) of blocks.  ``polygons`` are arrays of ``Polygons``, ``box`` (n, 4) the
    boxes of blocks; ``contacts`` arrays of ``EdgeContacts``.  ``limits`` are the share of a
    contact's penetration that, taken back, undoes the overlap it accounts for, and the depth from
    which a crossing counts, m; where the pair ``carried`` (q,) a force by a contact that has ended,
    any depth does.
    """
    size, outlines, known, most = 64, Polygons(*polygons), EdgeContacts(*contacts), 0
    for b in range(len(outlines.block_start) - 1):
        most = max(most, outlines.block_start[b + 1] - outlines.block_start[b])
    few = np.empty((COUPLES_TRIED_MAX, 2), np.int64)
    listed = np.empty(most, np.int64), np.empty(most, np.int64), few
    while True:
        room = Crossings(
            np.empty((size, 2), np.int64),
            np.empty((size, 2), np.int64),
            np.empty(size),
            np.empty(size, np.int64),
        )
        count = _unseen_of_pairs(outlines, box, pairs, known, limits, carried, listed, room)
        if count <= size:
            return room.edges[:count], room.exits[:count], room.depth[:count], room.pair[:count]
        size = count


@kernel()
def _best_remembered(a, e, pair, remembered, outlines):
    """Return which remembered contact of a pair ends a crossing with the least penetration, or -1.

    Of those whose vertex is still behind its edge.
    """
    direction, vertex_block = outlines.direction, outlines.vertex_block
    vertex, edge, of_pair = remembered
    best, least = -1, np.inf
    for c in range(len(vertex)):
        if of_pair[c] != pair:
            continue
        depth = -gap_to(vertex[c], edge[c], outlines)
        if not 0.0 < depth < least:
            continue
        back = PENETRATION_UNDONE * depth
        back = back if vertex_block[vertex[c]] == vertex_block[a] else -back
        dx, dy = back * direction[edge[c], 1], -back * direction[edge[c], 0]
        if not _cross_around(a, e, outlines, dx, dy):
            best, least = c, depth
    return best


@kernel()
def _exits(crossings, remembered, limit, polygons):
    """Return vertex, edge and pair of contacts that account for crossings, (k, 3), and gaps, m.

    ``remembered`` are vertex, edge and pair (m,) of the contacts that were closed at the end of the
    last step.  The one of these that ends the crossing goes on; where none does it is the shorter
    exit, for crossings deeper than the first and less deep than the second ``limit`` (k, 2), m.
    """
    edges, exits, depths, pairs = crossings
    outlines = Polygons(*polygons)
    added, count, gap = np.empty((len(depths), 3), np.int64), 0, np.empty(len(depths))
    known = EdgeContacts(added[:, 0], added[:, 1], added[:, 2], gap)
    for k in np.argsort(depths):
        a, e, q = edges[k, 0], edges[k, 1], pairs[k]
        is_accounted_for = False
        for c in range(count):
            is_accounted_for |= known.pair[c] == q and _is_accounted_for(
                a, e, (exits[k, 0], depths[k]), (c, c + 1), known, PENETRATION_UNDONE, outlines
            )
        if is_accounted_for:
            continue
        best = _best_remembered(a, e, q, remembered, outlines)
        if best >= 0:
            added[count, 0], added[count, 1] = remembered[0][best], remembered[1][best]
        elif limit[k, 0] < depths[k] < limit[k, 1]:
            added[count, 0], added[count, 1] = exits[k, 0], exits[k, 1]
        else:
            continue
        added[count, 2] = q
        gap[count] = gap_to(added[count, 0], added[count, 1], outlines)
        count += 1
    return added[:count], gap[:count]


@kernel()
def swallowed(vertices, block_start, box, pairs):
    """Return which pairs have a block whose box and first vertex lie inside the other, (q,)."""
    result = np.zeros(len(pairs), np.bool_)
    for q in range(len(pairs)):
        for side in range(2):
            i, j = pairs[q, side], pairs[q, 1 - side]
            if (
                box[i, 0] < box[j, 0]
                or box[i, 1] < box[j, 1]
                or box[i, 2] > box[j, 2]
                or box[i, 3] > box[j, 3]
            ):
                continue
            p, first, last = block_start[i], block_start[j], block_start[j + 1]
            inside = depth_inside(vertices[p, 0], vertices[p, 1], vertices, first, last)
            result[q] |= inside > 0.0
    return result
