"""Contact memory: found again by vertex and block, renewed after every accepted step.

The memory is sorted by vertex, block and edge.  A contact finds its row by its edge; a vertex that
has slid round to the next edge takes the memory of the old one along.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.contact.contacts import OPEN, ContactResponse, Contacts, Places
from clast.contact.joints.bonds import had_by_faces, torn
from clast.contact.joints.wear import Wear
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactHistory, ContactMemory


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


def pair_keys(one: Ints, other: Ints, width: int) -> Ints:
    """Return a number for each pair of blocks (k,), in any order, below ``width``; it ascends."""
    return np.asarray(np.minimum(one, other) * width + np.maximum(one, other))


# the entrance edge of the last step ------------------------------------------------------------


@kernel()
def remembered_edges(groups, vertex_block, known):
    """Return the entrance edge that each group of candidates had in the last step, or -1, (k,).

    ``groups`` are the first candidate of each, (k + 1,), and vertices and edges (m,) of the
    candidates; ``vertex_block`` (nv,) is the block of each vertex.  ``known`` are the first row of
    each vertex in the memory (nv + 1,), and blocks and edges of its rows.
    """
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


@kernel()
def recall(contacts, known):
    """Return the memory row of each contact (vertex, block of the edge, edge), or -1, (m,).

    The same edge first; else a row of the same (vertex, block) whose edge is no longer in
    contact: the vertex has slid round to the next edge and takes its memory along.  Contacts of
    one (vertex, block) stand together; no row is given twice.  ``known`` as in remembered_edges.
    """
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
def _find_pairs(low, high, pairs, start, vertex_block, vertex, block, pair):
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
        pair[row] = first if there else -1


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
    mode, bonded, rest = response.mode, response.bonded, contacts.rest_force
    is_open, is_near = mode == OPEN, gap <= critdis
    made = ~is_open | (contacts.mode != OPEN) | contacts.bonded | (contacts.slip != 0.0)
    # a spring that rests behind its edge, and carries nothing there, ends in front of it; one
    # that carries tension as long as its bond
    ends = np.where((rest < 0.0) & ~bonded, gap >= 0.0, is_open)
    rows = {
        "vertex": contacts.vertex,
        "block": contacts.edge_block,
        "edge": contacts.edge,
        "point": contacts.point,
        "mode": mode,
        "bonded": bonded & is_near,
        "cohesive": contacts.cohesive & ~torn(contacts, response) & is_near,
        "gap": gap + contacts.rest_gap,  # from the edge, not from the rest of the spring
        "normal_force": response.normal_force,
        "shear_force": np.where(is_open, 0.0, response.shear_force),
        "multiplier": contacts.multiplier,
        "rest_force": np.where(ends, 0.0, rest),
        "slip": np.where(made, contacts.slip + slip, 0.0),
        "slide_length": contacts.slide_length + wear.path,
        "slide": contacts.slide + wear.slid,
        "slide_speed": wear.speed,
        "dilation": wear.dilation,
    }
    order = memory_order(contacts.vertex, contacts.edge_block, contacts.edge, contacts.point)
    return ContactMemory(**{name: one.take(order) for name, one in rows.items()})


@kernel()
def memory_order(vertex, block, edge, point):
    """Return the order of contacts in the memory, shape (m,): vertices, then points of faces."""
    behind = vertex.max() + 1 if len(vertex) else 0
    first, second, third = vertex.copy(), block.copy(), edge.copy()
    for c in range(len(vertex)):
        if point[c] > 0:
            first[c], second[c], third[c] = behind + vertex[c], edge[c], point[c]
    return order_by(first, second, third)


@kernel()
def order_by(first, second, third):
    """Return the order of rows (m,) by three numbers of each, the ``first`` of them from 0 on.

    By counting, then by insertion, for rows with the same first number are few, or nearly in order.
    """
    highest = -1
    for c in range(len(first)):
        highest = max(highest, first[c])
    start = first_rows(first, highest + 1)
    filled, order = start.copy(), np.empty(len(first), np.int64)
    for c in range(len(first)):
        position = filled[first[c]]
        filled[first[c]] += 1
        while position > start[first[c]]:
            other = order[position - 1]
            if second[other] < second[c] or (
                second[other] == second[c] and third[other] <= third[c]
            ):
                break
            order[position] = other
            position -= 1
        order[position] = c
    return order


CARRIED = tuple(one.name for one in fields(ContactHistory))
"""Fields of the memory that a contact takes over as they are."""


def carried_by(
    row: Ints,
    memory: ContactMemory,
    turns: tuple[Ints, Floats],
) -> dict[str, Any]:
    """Return the memory of contacts, (m,) each by its name.

    ``row`` (m,) is the row of a contact in the memory or -1: then it carries nothing, and has
    no bond.  ``turns`` are the edge of each contact (m,) and the directions of all edges (nv, 2).
    """
    known = row >= 0
    new = np.flatnonzero(~known)
    history: dict[str, Any] = {}
    for name in CARRIED:
        values = getattr(memory, name)
        if len(values):
            history[name] = kept = values.take(row, mode="clip")
            if len(new):
                kept[new] = 0
        else:
            history[name] = np.zeros(len(row), values.dtype)
    forces = history["shear_force"], history["normal_force"], history["rest_force"]
    _turn_rest_forces(len(row), row, memory.edge, turns, forces)
    return {**history, "known": known, "friction_base": np.full(len(row), np.nan)}


def taken_along(
    carried: dict[str, Any],
    speed: Floats,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> tuple[dict[str, Any], Floats]:
    """Return the memory of contacts, and speeds of sliding (m,), with those of new ones.

    Where a face slides on, a contact that comes up has slid, opens and slides as the face does.
    """
    new = np.flatnonzero(places.row < 0)
    if not len(new) or not len(memory):
        return carried, speed
    ends = places.vertex[new], places.edge[new]
    kept = memory.slide, memory.dilation, memory.slide_speed
    of_all_faces = had_by_faces(kept, memory, ends, direction, model.block_start)
    taken = [one.copy() for one in (carried["slide"], carried["dilation"], speed)]
    for values, of_faces in zip(taken, of_all_faces, strict=True):
        values[new] = np.nan_to_num(of_faces)
    return {**carried, "slide": taken[0], "dilation": taken[1]}, taken[2]


@shared(CONTACTS)
def _turn_rest_forces(first, last, row, before, turns, forces):
    """Keep the direction of rest forces of contacts ``first`` to ``last`` - 1, whatever the edge.

    A rest force belongs to the face that carried it before the run.  Where its vertex has passed to
    the next edge of the block, the same force has other shares along normal and edge.  ``before``
    are the edges in the memory.
    """
    edge, direction = turns
    shear, normal, rest = forces
    for c in range(first, last):
        if row[c] < 0 or rest[c] <= 0.0 or before[row[c]] == edge[c]:
            continue
        old, new = before[row[c]], edge[c]
        cosine = direction[old, 0] * direction[new, 0] + direction[old, 1] * direction[new, 1]
        sine = direction[old, 0] * direction[new, 1] - direction[old, 1] * direction[new, 0]
        along = shear[c]
        shear[c] = along * cosine - rest[c] * sine
        rest[c] = max(0.0, rest[c] * cosine + along * sine)
        normal[c] = max(0.0, normal[c] * cosine + along * sine)
