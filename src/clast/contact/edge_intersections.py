"""Overlap of two blocks that their contacts do not account for, found by edges that cross.

Candidate edges and corner rules look at vertices: a vertex behind an edge.  Two blocks can overlap
without a vertex inside either, or with one that no rule lets in: a sharp corner that has slid off
the end of an edge, or through a thin corner and out again on its far side; two faces whose ends
have passed each other.  Such blocks would go through each other unopposed.  Their edges cross, and
the shorter way out of a crossing, of a vertex over an edge, is a contact as well.

Where two outlines overlap their edges cross.  A crossing is accounted for by a contact whose
penetration, taken back along its normal, takes the two edges apart.  Edges a and e that cross have
one end each, P and Q, behind the other.  They come apart where P is taken back over e or Q over a,
whichever is nearer: that distance is the depth of the crossing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clast.block.edge_lists import (
    behind,
    cross,
    crossing_point,
    edges_within,
    left_to_right,
    sideways,
)
from clast.block.polygon import ROUND_OFF, depth_inside, vertex_after, vertex_before
from clast.compute.jit import kernel
from clast.compute.reductions import is_any
from clast.contact.memory import lost_contacts
from clast.model.model import Bools, Floats, Ints
from clast.model.state import ContactMemory

TAKEN_BACK = 1.01
"""Share of a contact's penetration that must undo a crossing which it accounts for."""
SHALLOW = 1e-3
"""New crossings less deep than this are left alone, in units of critdis."""
NEIGHBOUR = 1.5
"""A new crossing less deep than this times the penetration of other contacts of one of the blocks
is left alone: a corner that rests on a surface is below the next block's corner before it comes
upon that block."""
HANDED_ON = 2.0
"""How much deeper than the memory of the pair a contact may be that takes over from another."""
PAIRWISE = 256
"""Edges are tried each against each where that takes no more trials; else by a sweep."""
NEAR = 10.0
"""Contacts within this distance account for a crossing, in units of its depth."""
APART = 0.1
"""Sine of the angle between two contacts' normals from which they say two different things."""


class EdgeLines(NamedTuple):
    """Outlines of all blocks, by their edges."""

    vertices: Floats
    """Vertices, m, shape (nv, 2)."""
    direction: Floats
    """Unit direction of the edge that starts at each vertex, shape (nv, 2)."""
    block_start: Ints
    """First vertex of each block, shape (n + 1,)."""


class VertexRanges(NamedTuple):
    """Vertices of two blocks i and j: the first, and the last + 1."""

    first_i: int
    last_i: int
    first_j: int
    last_j: int


class EdgeContacts(NamedTuple):
    """Contacts of vertices with edges, in the order of their pairs."""

    vertex: Ints
    """Vertex of each contact, shape (m,)."""
    edge: Ints
    """Its edge, shape (m,)."""
    gap: Floats
    """Its gap, m, shape (m,)."""
    vertex_block: Ints
    """Block of each vertex, shape (nv,)."""


class RememberedContacts(NamedTuple):
    """Contacts that were closed at the end of the last step."""

    vertex: Ints
    """Vertex of each contact, shape (m,)."""
    edge: Ints
    """Its edge, shape (m,)."""
    pair: Ints
    """Its pair of blocks, shape (m,)."""
    vertex_block: Ints
    """Block of each vertex, shape (nv,)."""


class Crossing(NamedTuple):
    """Two edges of two blocks that cross."""

    edge: int
    """Edge of the first block of the pair."""
    other: int
    """Edge of the second block."""
    bounds: VertexRanges
    """Vertices of the two blocks."""
    lower: int
    """The first block."""


class CrossingLimits(NamedTuple):
    """Limits of the crossings that count."""

    share: float
    """Share of a contact's penetration that must undo a crossing which it accounts for."""
    floor: float
    """Depth from which a crossing counts in any pair, m."""
    least: float
    """Depth from which one counts in this pair, m."""


class Crossings(NamedTuple):
    """Room for the crossings that no contact accounts for."""

    crossing: Ints
    """The two edges, shape (k, 2)."""
    exits: Ints
    """Vertex and edge of the shorter way out, shape (k, 2)."""
    depths: Floats
    """Its length, m, shape (k,)."""
    pair: Ints
    """Pair of the blocks, shape (k,)."""


Chosen = tuple[Ints, Ints, Ints, Floats]
"""Vertex, edge, pair and gap, m, of contacts in the order of the pairs of blocks, (m,) each."""


def with_crossings(
    chosen: Chosen,
    pairs: Ints,
    polygons: tuple[Floats, Floats, Ints, Floats],
    of_vertices: tuple[Ints, Ints],
    memory: ContactMemory,
    front: Floats,
    critdis: float,
) -> Chosen:
    """Return the contacts, and with them those that crossings ask for which they do not explain.

    ``polygons`` are vertices (nv, 2), directions of edges, the first vertex and the box of each
    block, ``of_vertices`` the block of each vertex (nv,) and its first row in the memory (nv + 1,),
    ``front`` (n,) how far the vertices of each block may have moved in a step, m.  A contact that
    was closed at the end of the last step goes on where it explains a crossing, however shallow
    that is by now: its spring still carries.  Else the shorter way out of it becomes a contact, if
    a step's motion or the memory of the pair explains it.
    """
    vertex, edge, pair, gap = chosen
    outlines, box = polygons[:3], polygons[3]
    vertex_block, rows = of_vertices
    contacts = (vertex, edge, gap, vertex_block)
    lost = lost_contacts(memory, rows, vertex, vertex_block.take(edge))
    carried = _have(memory, lost, pairs, vertex_block)
    floor = SHALLOW * critdis
    found = unseen(outlines, box, pairs, contacts, pair, (TAKEN_BACK, floor), carried)
    if not len(found[0]):
        return chosen
    which, of_pair = np.unique(found[3], return_inverse=True)
    remembered, depth = _remembered(memory, chosen, pairs, which, vertex_block)
    deepest = np.zeros(len(front))
    for blocks in (vertex_block[vertex], vertex_block[edge]):
        np.maximum.at(deepest, blocks, -gap)
    own, other = pairs[which].T
    around = NEIGHBOUR * np.maximum(deepest[own], deepest[other])
    limit = np.stack(
        [
            np.where(depth > 0.0, floor, np.maximum(around, floor)),
            critdis + front[own] + front[other] + HANDED_ON * depth,
        ],
        axis=1,
    )
    at, of_gap = _ways_out(found, pairs, remembered, limit[of_pair], TAKEN_BACK, outlines)
    return _merged(chosen, at, of_gap)


def _have(memory: ContactMemory, rows: Bools, pairs: Ints, vertex_block: Ints) -> Bools:
    """Return which pairs of blocks have one of some ``rows`` (r,) of the memory, (q,)."""
    have = np.zeros(len(pairs), np.bool_)
    if is_any(rows):
        width = len(vertex_block)
        own, other = vertex_block[memory.vertex[rows]], memory.block[rows]
        key = np.minimum(own, other) * width + np.maximum(own, other)
        have |= np.isin(pairs[:, 0] * width + pairs[:, 1], key)
    return have


def _remembered(
    memory: ContactMemory, chosen: Chosen, pairs: Ints, wanted: Ints, vertex_block: Ints
) -> tuple[tuple[Ints, Ints, Ints, Ints], Floats]:
    """Return vertex, edge and pair of closed contacts of ``wanted`` pairs (k,), and the depth.

    Those (m,) that are not ``chosen`` any more, with the block of each vertex; the largest
    penetration of each pair, m, (k,).
    """
    width = len(vertex_block)
    own, other = vertex_block[memory.vertex], memory.block
    key = np.minimum(own, other) * width + np.maximum(own, other)
    keys = pairs[wanted, 0] * width + pairs[wanted, 1]
    at = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
    rows = (keys[at] == key) & (memory.gap < 0.0)
    depth = np.zeros(len(wanted))
    np.maximum.at(depth, at[rows], -memory.gap[rows])
    there = chosen[0] * width + chosen[1]
    rows &= ~np.isin(memory.vertex * width + memory.edge, there)
    return (memory.vertex[rows], memory.edge[rows], wanted[at[rows]], vertex_block), depth


def _merged(chosen: Chosen, added: Ints, gap: Floats) -> Chosen:
    """Return contacts with those ``added`` (k, 3): vertex, edge, pair; with ``gap`` (k,), m."""
    if not len(added):
        return chosen
    vertex, edge, pair = (np.concatenate(both) for both in zip(chosen[:3], added.T, strict=True))
    order = np.lexsort((edge, vertex, pair))
    gaps = np.concatenate((chosen[3], gap))
    return vertex[order], edge[order], pair[order], gaps[order]


@kernel()
def _exit(a, b, e, f, vertices, direction):
    """Return the shorter way out of a crossing: its vertex, the edge to pass, and how far, m."""
    p = a if behind(a, e, vertices, direction) > 0.0 else b
    q = e if behind(e, a, vertices, direction) > 0.0 else f
    of_p, of_q = behind(p, e, vertices, direction), behind(q, a, vertices, direction)
    if of_p <= of_q:
        return p, e, of_p
    return q, a, of_q


@kernel()
def _cross_around(a, e, bounds, vertices, dx, dy):
    """Return whether edges a and e, or those next to them, cross when a's block is moved.

    By (dx, dy), m.  A crossing can pass to the next edge: then the blocks still overlap there.
    """
    first_i, last_i = bounds.first_i, bounds.last_i
    first_j, last_j = bounds.first_j, bounds.last_j
    own = vertex_before(a, first_i, last_i)
    for _ in range(3):
        own_end = vertex_after(own, first_i, last_i)
        other = vertex_before(e, first_j, last_j)
        for _ in range(3):
            other_end = vertex_after(other, first_j, last_j)
            if cross(own, own_end, other, other_end, vertices, dx, dy):
                return True
            other = other_end
        own = own_end
    return False


@kernel()
def _edge_ends(a, e, bounds):
    """Return the vertices at which edge a of the first block and edge e of the second end."""
    return (
        vertex_after(a, bounds.first_i, bounds.last_i),
        vertex_after(e, bounds.first_j, bounds.last_j),
    )


@kernel()
def _is_at_a_corner(a, e, bounds, floor, vertices, direction):
    """Return whether edges cross for no more than ``floor``, m, that one stands out at a corner.

    Where corners of two blocks meet, edges that lie nearly in line cross next to both.  The far end
    of one may lie far behind the other, by as much as they bend, but moved back along an edge by
    the projection there the blocks do not overlap any more.
    """
    b, f = _edge_ends(a, e, bounds)
    out, x, y = sideways(a, b, e, f, vertices, direction)
    if out > floor:
        return False
    long = np.hypot(vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1])
    way = 2.0 * out + ROUND_OFF * long
    return not _cross_around(a, e, bounds, vertices, way * x, way * y)


@kernel()
def _taken_back(c, contacts, lower, share, direction):
    """Return how the pair's ``lower`` block moves where a contact's penetration is taken back.

    The unit direction, and ``share`` of the penetration, m.
    """
    vertex, edge = contacts.vertex, contacts.edge
    gap, vertex_block = contacts.gap, contacts.vertex_block
    sign = 1.0 if vertex_block[vertex[c]] == lower else -1.0
    return sign * direction[edge[c], 1], -sign * direction[edge[c], 0], -share * gap[c]


@kernel()
def _is_near(p, gap, point, way_out, vertices):
    """Return whether the vertex p of a contact is near the vertex of a way out, by its depth.

    Or near the ``point`` of the crossing, by its depth or by the contact's if that is larger.
    """
    vertex, depth = way_out
    x, y = vertices[p, 0] - vertices[vertex, 0], vertices[p, 1] - vertices[vertex, 1]
    if x * x + y * y <= (NEAR * depth) ** 2:
        return True
    x, y = vertices[p, 0] - point[0], vertices[p, 1] - point[1]
    return x * x + y * y <= (NEAR * max(depth, -gap)) ** 2


@kernel()
def _is_accounted_for(crossing, way_out, span, contacts, share, outlines):
    """Return whether contacts of a ``span`` (first, last + 1) end a crossing if taken back.

    One of them, or two of different directions together: a vertex in a re-entrant corner.  Only
    those near the crossing count: a contact at one end of two faces does not hold the other.
    """
    a, e = crossing.edge, crossing.other
    bounds, lower = crossing.bounds, crossing.lower
    vertices, direction = outlines.vertices, outlines.direction
    gap, (low, high) = contacts.gap, span
    b, f = _edge_ends(a, e, bounds)
    at = crossing_point(a, b, e, f, vertices)
    for c in range(low, high):
        if gap[c] >= 0.0 or not _is_near(contacts.vertex[c], gap[c], at, way_out, vertices):
            continue
        x, y, way = _taken_back(c, contacts, lower, share, direction)
        if not _cross_around(a, e, bounds, vertices, way * x, way * y):
            return True
        for d in range(low, c):
            if gap[d] >= 0.0 or not _is_near(contacts.vertex[d], gap[d], at, way_out, vertices):
                continue
            u, v, other = _taken_back(d, contacts, lower, share, direction)
            sine = x * v - y * u
            if abs(sine) < APART:
                continue
            dx, dy = (way * v - other * y) / sine, (other * x - way * u) / sine
            if not _cross_around(a, e, bounds, vertices, dx, dy):
                return True
    return False


@kernel()
def _window(box, i, j):
    """Return the overlap of the boxes of two blocks: xmin, ymin, xmax, ymax, m."""
    return (
        max(box[i, 0], box[j, 0]),
        max(box[i, 1], box[j, 1]),
        min(box[i, 2], box[j, 2]),
        min(box[i, 3], box[j, 3]),
    )


@kernel()
def _couples(own, of_own, others, of_others, vertices, bounds):
    """Return all couples of edges of two blocks that may cross, (k, 2), where there are many.

    A sweep from left to right: only those whose extents in x meet.
    """
    first_i, last_i = bounds.first_i, bounds.last_i
    first_j, last_j = bounds.first_j, bounds.last_j
    left_a, edge_a, _ = left_to_right(own[:of_own], vertices, first_i, last_i)
    left_e, edge_e, widest = left_to_right(others[:of_others], vertices, first_j, last_j)
    count, start, room = 0, 0, np.empty((4 * (of_own + of_others), 2), np.int64)
    for x in range(of_own):
        a = edge_a[x]
        b = vertex_after(a, first_i, last_i)
        right = max(vertices[a, 0], vertices[b, 0])
        low, high = min(vertices[a, 1], vertices[b, 1]), max(vertices[a, 1], vertices[b, 1])
        while start < of_others and left_e[start] + widest < left_a[x]:
            start += 1
        for y in range(start, of_others):
            if left_e[y] > right:
                break
            e = edge_e[y]
            f = vertex_after(e, first_j, last_j)
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


@kernel()
def _each_with_each(own, of_own, others, of_others):
    """Return all couples of edges of two blocks, (k, 2)."""
    couples = np.empty((of_own * of_others, 2), np.int64)
    for x in range(of_own):
        for y in range(of_others):
            couples[x * of_others + y, 0] = own[x]
            couples[x * of_others + y, 1] = others[y]
    return couples


@kernel(inline="always")
def _couples_within(window, listed, bounds, vertices):
    """Return couples of edges of two blocks within a window, (k, 2); all that may cross.

    ``listed`` is room for the edges of either.
    """
    own, others = listed
    of_own = edges_within(window, 0.0, vertices, bounds.first_i, bounds.last_i, own)
    of_others = edges_within(window, 0.0, vertices, bounds.first_j, bounds.last_j, others)
    if of_own * of_others <= PAIRWISE:
        return _each_with_each(own, of_own, others, of_others)
    return _couples(own, of_own, others, of_others, vertices, bounds)


@kernel()
def _is_a_contact(vertex, edge, depth, span, contacts):
    """Return whether a contact of a ``span`` is this vertex over this edge as deep."""
    for c in range(span[0], span[1]):
        if contacts.vertex[c] == vertex and contacts.edge[c] == edge:
            return -contacts.gap[c] >= depth
    return False


@kernel(inline="always")
def _of_pair(couples, crossed, span, contacts, limits, outlines, room, found):
    """Append the crossings of couples that contacts do not account for; return how many.

    ``crossed`` are the vertices of the pair's blocks and the lower block.  ``found`` are there
    already; those that exceed the ``room`` are counted only.
    """
    vertices, direction = outlines.vertices, outlines.direction
    bounds, lower = crossed
    share, floor, least = limits.share, limits.floor, limits.least
    crossing, exits, depths = room.crossing, room.exits, room.depths
    for k in range(len(couples)):
        a, e = couples[k, 0], couples[k, 1]
        b, f = _edge_ends(a, e, bounds)
        if not cross(a, b, e, f, vertices, 0.0, 0.0):
            continue
        vertex, edge, depth = _exit(a, b, e, f, vertices, direction)
        if depth <= least or _is_a_contact(vertex, edge, depth / share, span, contacts):
            continue
        if _is_at_a_corner(a, e, bounds, floor, vertices, direction):
            continue
        one, way_out = Crossing(a, e, bounds, lower), (vertex, depth)
        if _is_accounted_for(one, way_out, span, contacts, share, outlines):
            continue
        if found < len(depths):
            crossing[found, 0], crossing[found, 1], depths[found] = a, e, depth
            exits[found, 0], exits[found, 1] = vertex, edge
        found += 1
    return found


@kernel()
def _most_vertices(block_start):
    """Return the largest number of vertices of a block."""
    most = 0
    for b in range(len(block_start) - 1):
        most = max(most, block_start[b + 1] - block_start[b])
    return most


@kernel(inline="always")
def _unseen_of_pairs(outlines, box, pairs, contacts, pair, limits, carried, room):
    """Write the crossings that no contact accounts for into ``room``; return their number."""
    vertices, block_start = outlines.vertices, outlines.block_start
    most = _most_vertices(block_start)
    share, floor = limits
    listed = np.empty(most, np.int64), np.empty(most, np.int64)
    found, low = 0, 0
    for q in range(len(pairs)):
        while low < len(pair) and pair[low] < q:
            low += 1
        high = low
        while high < len(pair) and pair[high] == q:
            high += 1
        i, j = pairs[q, 0], pairs[q, 1]
        window = _window(box, i, j)
        least = 0.0 if carried[q] else floor
        # what the two share is no thicker than what their boxes share
        if min(window[2] - window[0], window[3] - window[1]) <= least:
            continue
        before = found
        bounds = VertexRanges(
            block_start[i], block_start[i + 1], block_start[j], block_start[j + 1]
        )
        couples = _couples_within(window, listed, bounds, vertices)
        crossed, span, deep = (bounds, i), (low, high), CrossingLimits(share, floor, least)
        found = _of_pair(couples, crossed, span, contacts, deep, outlines, room, found)
        room.pair[before : min(found, len(room.pair))] = q
    return found


@kernel()
def unseen(outlines, box, pairs, contacts, pair, limits, carried):
    """Return the crossings of edges that no contact accounts for.

    Of ``pairs`` (q, 2) of blocks: the two edges, that of the pair's lower block first, (k, 2);
    vertex and edge of the shorter way out, (k, 2); its length, m, and the pair, (k,).  ``outlines``
    are vertices (nv, 2), directions of the edges that start there and the first vertex of each
    block, ``box`` (n, 4) their boxes; ``contacts`` vertex, edge and gap (m,), m, in the order of
    their ``pair`` (m,), and the block of each vertex.  ``limits`` are the share of a contact's
    penetration that, taken back, undoes the overlap it accounts for, and the depth from which a
    crossing counts, m; where the pair ``carried`` (q,) a force by a contact that has ended,
    any depth does.
    """
    size, lines, known = 64, EdgeLines(*outlines), EdgeContacts(*contacts)
    while True:
        room = Crossings(
            np.empty((size, 2), np.int64),
            np.empty((size, 2), np.int64),
            np.empty(size),
            np.empty(size, np.int64),
        )
        found = _unseen_of_pairs(lines, box, pairs, known, pair, limits, carried, room)
        if found <= size:
            return (
                room.crossing[:found],
                room.exits[:found],
                room.depths[:found],
                room.pair[:found],
            )
        size = found


@kernel()
def _best_remembered(crossing, pair, remembered, share, outlines):
    """Return which remembered contact of a pair ends a crossing with the least penetration, or -1.

    Of those whose vertex is still behind its edge.
    """
    a, e = crossing.edge, crossing.other
    bounds, lower = crossing.bounds, crossing.lower
    vertices, direction = outlines.vertices, outlines.direction
    vertex, edge = remembered.vertex, remembered.edge
    of_pair, vertex_block = remembered.pair, remembered.vertex_block
    best, least = -1, np.inf
    for c in range(len(vertex)):
        if of_pair[c] != pair:
            continue
        depth = behind(vertex[c], edge[c], vertices, direction)
        if not 0.0 < depth < least:
            continue
        way = share * depth if vertex_block[vertex[c]] == lower else -share * depth
        dx, dy = way * direction[edge[c], 1], -way * direction[edge[c], 0]
        if not _cross_around(a, e, bounds, vertices, dx, dy):
            best, least = c, depth
    return best


@kernel()
def _ways_out(crossings, pairs, remembered, limit, share, outlines):
    """Return vertex, edge and pair of contacts that account for crossings, (k, 3), and gaps, m.

    ``crossings`` as ``unseen`` gives them; ``remembered`` are vertex, edge and pair (m,) of
    the contacts that were closed at the end of the last step, and the block of each vertex.  The
    one of these that ends the crossing goes on; where none does it is the shorter way out, for
    crossings that are deeper than the first and less deep than the second ``limit`` (k, 2), m.
    """
    of, lines, known = Crossings(*crossings), EdgeLines(*outlines), RememberedContacts(*remembered)
    crossing, exits, depths, of_pair = of.crossing, of.exits, of.depths, of.pair
    vertices, direction, block_start = lines.vertices, lines.direction, lines.block_start
    at, on, vertex_block = known.vertex, known.edge, known.vertex_block
    found, count = np.empty((len(depths), 3), np.int64), 0
    gap = np.empty(len(depths))
    for k in np.argsort(depths):
        a, e, q = crossing[k, 0], crossing[k, 1], of_pair[k]
        i, j = pairs[q, 0], pairs[q, 1]
        bounds = VertexRanges(
            block_start[i], block_start[i + 1], block_start[j], block_start[j + 1]
        )
        one, is_accounted_for = Crossing(a, e, bounds, i), False
        added = EdgeContacts(found[:count, 0], found[:count, 1], gap[:count], vertex_block)
        for c in range(count):
            is_accounted_for |= found[c, 2] == q and _is_accounted_for(
                one, (exits[k, 0], depths[k]), (c, c + 1), added, share, lines
            )
        if is_accounted_for:
            continue
        best = _best_remembered(one, q, known, share, lines)
        if best >= 0:
            found[count, 0], found[count, 1] = at[best], on[best]
        elif limit[k, 0] < depths[k] < limit[k, 1]:
            found[count, 0], found[count, 1] = exits[k, 0], exits[k, 1]
        else:
            continue
        found[count, 2] = q
        gap[count] = -behind(found[count, 0], found[count, 1], vertices, direction)
        count += 1
    return found[:count], gap[:count]


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
