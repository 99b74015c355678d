"""Contact memory: found again by vertex and block, renewed after every accepted step.

The memory is sorted by vertex, block and edge.  A contact finds its row by its edge; a vertex that
has slid round to the next edge takes the memory of the old one along.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.compute.reductions import is_any
from clast.contact.contacts import OPEN, ContactResponse, Contacts
from clast.contact.joints.bonds import torn
from clast.contact.joints.wear import Wear
from clast.model.model import Bools, Floats, Ints
from clast.model.state import ContactMemory


@kernel()
def first_rows(vertices, count):
    """Return the first row of each of ``count`` vertices in sorted rows (k,), (count + 1,)."""
    start = np.zeros(count + 1, np.int64)
    for row in range(len(vertices)):
        start[vertices[row] + 1] += 1
    for vertex in range(count):
        start[vertex + 1] += start[vertex]
    return start


@kernel()
def _rows_of_key(vertex, block, start, memory_block):
    """Return the first row with this (vertex, block) and the one after the last; equal if none."""
    first, stop = start[vertex], start[vertex + 1]
    while first < stop and memory_block[first] != block:
        first += 1
    last = first
    while last < stop and memory_block[last] == block:
        last += 1
    return first, last


# the entrance edge of the last step ------------------------------------------------------------


def remembered_edges(
    groups: tuple[Ints, Ints, Ints], vertex_block: Ints, memory: ContactMemory, start: Ints
) -> Ints:
    """Return the entrance edge that each group of candidates had in the last step, or -1, (k,).

    ``groups`` are the first candidate of each, (k + 1,), and vertices and edges (m,) of the
    candidates; ``vertex_block`` (nv,) is the block of each vertex, ``start`` (nv + 1,) the first
    row of each vertex in the memory.
    """
    remembered: Ints = _remembered(groups, vertex_block, (start, memory.block, memory.edge))
    return remembered


@kernel()
def _remembered(groups, vertex_block, known):
    """Return the entrance edges of groups, (k,); ``known`` are rows, blocks and edges."""
    remembered = np.empty(len(groups[0]) - 1, np.int64)
    _remember(len(remembered), groups, vertex_block, known, remembered)
    return remembered


@shared(CONTACTS)
def _remember(low, high, groups, vertex_block, known, remembered):
    """Write the entrance edges of groups ``low`` to ``high`` - 1."""
    group_start, vertex, edge = groups
    start, memory_block, memory_edge = known
    for g in range(low, high):
        c = group_start[g]
        first, last = _rows_of_key(vertex[c], vertex_block[edge[c]], start, memory_block)
        remembered[g] = memory_edge[first] if first < last else -1


# the row of each contact -----------------------------------------------------------------------


def recall(memory: ContactMemory, start: Ints, vertex: Ints, block: Ints, edge: Ints) -> Ints:
    """Return the memory row of each contact (vertex, block of the edge, edge), or -1, (m,).

    The same edge first; else a row of the same (vertex, block) whose edge is no longer in
    contact: the vertex has slid round to the next edge and takes its memory along.  Contacts of
    one (vertex, block) stand together; no row is given twice.  ``start`` (nv + 1,) is the first row
    of each vertex.
    """
    rows: Ints = _rows_of((vertex, block, edge), (start, memory.block, memory.edge))
    return rows


@kernel()
def _rows_of(contacts, known):
    """Return the memory rows of contacts, (m,); ``known`` are first rows, blocks and edges."""
    taken, rows = np.zeros(len(known[1]), np.bool_), np.empty(len(contacts[0]), np.int64)
    _find_rows(len(rows), contacts, known, taken, rows)
    return rows


@kernel()
def _same_group(c, vertex, block):
    """Return True if contact c is of the same vertex and block as the one before it."""
    return c > 0 and vertex[c] == vertex[c - 1] and block[c] == block[c - 1]


@shared(CONTACTS)
def _find_rows(low, high, contacts, known, taken, rows):
    """Find the rows of contacts whose (vertex, block) begins with one of ``low`` to ``high`` - 1.

    ``taken`` are the rows that are given away: of one (vertex, block), whose contacts are found by
    one thread.
    """
    vertex, block, edge = contacts
    by_vertex, memory_block, memory_edge = known
    start = low
    while start < high and _same_group(start, vertex, block):
        start += 1
    while start < high:
        stop = start + 1
        while stop < len(vertex) and _same_group(stop, vertex, block):
            stop += 1
        first, last = _rows_of_key(vertex[start], block[start], by_vertex, memory_block)
        for c in range(start, stop):
            rows[c] = -1
            for row in range(first, last):
                if memory_edge[row] == edge[c]:
                    rows[c] = row
                    taken[row] = True
        for c in range(start, stop):
            if rows[c] >= 0:
                continue
            for row in range(first, last):
                if not taken[row]:
                    rows[c] = row
                    taken[row] = True
                    break
        start = stop


def lost_contacts(memory: ContactMemory, start: Ints, vertex: Ints, block: Ints) -> Bools:
    """Return which closed contacts of the memory have none of the same vertex and block, (r,).

    ``vertex`` and ``block`` (m,) are those of the contacts of now, ``start`` (nv + 1,) the first
    row of each vertex.
    """
    lost = memory.gap < 0.0
    _take_off(vertex, block, start, memory.block, lost)
    return lost


@kernel()
def _take_off(vertex, block, start, memory_block, lost):
    """Write False into the rows whose vertex and block are those of a contact (m,)."""
    for c in range(len(vertex)):
        for row in range(start[vertex[c]], start[vertex[c] + 1]):
            if memory_block[row] == block[c]:
                lost[row] = False


# the penetration of each pair ------------------------------------------------------------------


def pair_penetration(vertex_block: Ints, pairs: Ints, memory: ContactMemory) -> Floats:
    """Return the largest remembered penetration of each sorted pair (q, 2) of blocks, m, (q,).

    It belongs to the pair, not to the vertex: as blocks roll over each other a deep (soft) contact
    is handed from a vertex of one to a vertex of the other.  ``vertex_block`` (nv,) is the block of
    each vertex.
    """
    rows = memory.vertex, memory.block, memory.gap
    depth: Floats = _depths(pairs, vertex_block, rows)
    return depth


@shared(CONTACTS)
def _find_pairs(low, high, pairs, start, vertex_block, vertex, block, found):
    """Write the pair of blocks of the rows ``low`` to ``high`` - 1 of the memory, or -1."""
    for row in range(low, high):
        own, other = vertex_block[vertex[row]], block[row]
        lower, higher = min(own, other), max(own, other)
        first, last = start[lower], start[lower + 1]
        while first < last:
            middle = (first + last) // 2
            if pairs[middle, 1] < higher:
                first = middle + 1
            else:
                last = middle
        there = first < start[lower + 1] and pairs[first, 1] == higher
        found[row] = first if there else -1


@kernel()
def _depths(pairs, vertex_block, memory):
    """Return the largest penetration among the remembered contacts of each pair (q,), m."""
    vertex, block, gap = memory
    depth = np.zeros(len(pairs))
    if len(vertex) == 0:
        return depth
    start = np.zeros(vertex_block[-1] + 2, np.int64)
    for q in range(len(pairs)):
        start[pairs[q, 0] + 1] += 1
    for lower in range(len(start) - 1):
        start[lower + 1] += start[lower]
    pair = np.empty(len(vertex), np.int64)
    _find_pairs(len(pair), pairs, start, vertex_block, vertex, block, pair)
    for row in range(len(pair)):
        if pair[row] >= 0:
            depth[pair[row]] = max(depth[pair[row]], -gap[row])
    return depth


# the memory of the next step -------------------------------------------------------------------


def renew(
    contacts: Contacts,
    response: ContactResponse,
    gap: Floats,
    slip: Floats,
    critdis: float,
    wear: Wear,
) -> ContactMemory:
    """Return the memory after a step; ``gap`` (m,) at its end and ``slip`` (m,) in it, m.

    ``wear`` is that by sliding in the step.

    Slip adds up from the step on in which a contact is made, also while it is open for a while; the
    length of sliding only while it slides, without the elastic part of its shear spring.  A contact
    that has opened forgets its shear force, and its force at the start; one that is open further
    than critdis loses its bond and all cohesion.
    """
    count = len(gap)
    cohesive = contacts.cohesive & ~torn(contacts, response)
    order = _order_of(contacts)
    bonds = response.bonded, cohesive
    keys = contacts.vertex, contacts.edge_block, contacts.edge, response.mode, *bonds
    forces = (
        gap,
        response.normal_force,
        response.shear_force,
        contacts.multiplier,
        contacts.rest_force,
    )
    numbers, bonds_left, values = (
        np.empty((5, count), np.int64),
        np.empty((2, count), np.bool_),
        np.empty((10, count)),
    )
    # nobody writes into a state; kernels fill what they are given
    for one in (numbers, bonds_left, values):
        one.flags.writeable = False
    vertex, block, edge, mode, point = numbers
    bonded, holding = bonds_left
    new_gap, normal, shear, multiplier, rest, slips, ways, slides, speeds, dilation = values
    new_keys = vertex, block, edge, mode, bonded, holding
    new_forces = new_gap, normal, shear, multiplier, rest
    _renew(count, order, keys, forces, critdis, new_keys, new_forces)
    before = contacts.slip, contacts.slide_length, contacts.slide, contacts.mode, contacts.bonded
    step = slip, response.mode, wear.way, wear.slid
    _add_ways(count, order, before, step, (slips, ways, slides))
    taken = contacts.point, contacts.rest_gap, wear.speed, wear.dilation
    _take_along(count, order, taken, (point, new_gap, speeds, dilation))
    return ContactMemory(
        vertex=vertex,
        block=block,
        edge=edge,
        point=point,
        mode=mode,
        bonded=bonded,
        cohesive=holding,
        gap=new_gap,
        normal_force=normal,
        shear_force=shear,
        multiplier=multiplier,
        rest_force=rest,
        slip=slips,
        slide_length=ways,
        slide=slides,
        slide_speed=speeds,
        dilation=dilation,
    )


@shared(CONTACTS)
def _add_ways(first, last, order, before, step, ways):
    """Write slip, length of sliding and slide of rows ``first`` to ``last`` - 1, m."""
    slip_before, length_before, slide_before, mode_before, bonded = before
    slip, mode, way, slid = step
    slips, lengths, slides = ways
    for row in range(first, last):
        c = order[row]
        made = mode[c] != OPEN or mode_before[c] != OPEN or bonded[c] or slip_before[c] != 0.0
        slips[row] = slip_before[c] + slip[c] if made else 0.0
        lengths[row] = length_before[c] + way[c]
        slides[row] = slide_before[c] + slid[c]


@shared(CONTACTS)
def _take_along(first, last, order, taken, rows):
    """Write points, speeds and openings of rows ``first`` to ``last`` - 1; count gaps from edges.

    A gap counts from the rest of its spring before.
    """
    point, rest_gap, speed, dilation = taken
    points, gaps, speeds, dilations = rows
    for row in range(first, last):
        c = order[row]
        points[row], speeds[row], dilations[row] = point[c], speed[c], dilation[c]
        gaps[row] += rest_gap[c]


def _order_of(contacts: Contacts) -> Ints:
    """Return the order of contacts in the memory, shape (m,): vertices, then points of faces."""
    keys = contacts.vertex, contacts.edge_block, contacts.edge
    if not is_any(contacts.point):
        order: Ints = _order(*keys)
        return order
    corners, inside = (np.flatnonzero(one) for one in (contacts.corners, ~contacts.corners))
    of_corners = _order(*(np.ascontiguousarray(key[corners]) for key in keys))
    of_inside = np.lexsort((contacts.point[inside], keys[2][inside], keys[0][inside]))
    return np.concatenate([corners[of_corners], inside[of_inside]])


@kernel()
def _order(vertex, block, edge):
    """Return the order of contacts by vertex, then block, then edge, shape (m,).

    By counting, then by insertion, for the contacts of one vertex are few.
    """
    highest = -1
    for c in range(len(vertex)):
        highest = max(highest, vertex[c])
    start = first_rows(vertex, highest + 1)
    filled, order = start.copy(), np.empty(len(vertex), np.int64)
    for c in range(len(vertex)):
        position = filled[vertex[c]]
        filled[vertex[c]] += 1
        while position > start[vertex[c]]:
            other = order[position - 1]
            if block[other] < block[c] or (block[other] == block[c] and edge[other] <= edge[c]):
                break
            order[position] = other
            position -= 1
        order[position] = c
    return order


@shared(CONTACTS)
def _renew(first, last, order, keys, forces, critdis, new_keys, new_forces):
    """Write rows ``first`` to ``last`` - 1 of the new memory."""
    vertex, block, edge, mode, bonded, cohesive = keys
    gap, normal, shear, multiplier, rest = forces
    vertices, blocks, edges, modes, intact, holding = new_keys
    gaps, normals, shears, multipliers, rests = new_forces
    for row in range(first, last):
        c = order[row]
        vertices[row], blocks[row], edges[row], modes[row] = vertex[c], block[c], edge[c], mode[c]
        gaps[row], normals[row], multipliers[row] = gap[c], normal[c], multiplier[c]
        shears[row] = shear[c] if mode[c] != OPEN else 0.0
        # a spring that rests behind its edge, and carries nothing there, ends in front of it; one
        # that carries tension as long as its bond
        ends = gap[c] >= 0.0 if rest[c] < 0.0 and not bonded[c] else mode[c] == OPEN
        rests[row] = 0.0 if ends else rest[c]
        intact[row] = bonded[c] and gap[c] <= critdis
        holding[row] = cohesive[c] and gap[c] <= critdis
