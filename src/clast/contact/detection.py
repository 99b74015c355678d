"""From the blocks' outlines to the contacts of a step, and jumps past all contacts.

Broad phase (boxes) -> candidate edges (signed gap to the lengthened edge, entrance test) ->
corner rule -> contacts with their memory, strength and arms.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.block import polygon
from clast.block.displacement import displacements_of
from clast.block.edge_lists import EDGES_TRIED_MAX, edges_around, first_at_least
from clast.block.equations import strains
from clast.block.polygon import depth_inside
from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.contact.broad_phase import VerletList, near_pairs
from clast.contact.candidates import SearchDistance, find_candidates
from clast.contact.contacts import Contacts, Places
from clast.contact.corner_rules import CornerRule
from clast.contact.edge_intersections import Chosen, with_crossings
from clast.contact.joints.along_joint import contact_lengths, joints_of, springs_of_joints
from clast.contact.joints.barton_bandis import with_roughness
from clast.contact.joints.bonds import Bonds, bonded_at_start, bonds_of, without_points_in_bonds
from clast.contact.joints.faces import with_faces
from clast.contact.memory import (
    carried_by,
    first_rows,
    order_by,
    pair_keys,
    pair_penetration,
    recall,
    taken_along,
)
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory, State
from clast.read_only import changed


def detect(
    model: Model,
    corner_rule: CornerRule,
    state: State,
    centroid: Floats,
    reach: SearchDistance,
    drift: Floats | None = None,
    near: VerletList | None = None,
) -> Contacts:
    """Return the contacts of a step that starts at ``state``; ``centroid`` (n, 2) in m.

    ``drift`` (n, 6) is the displacement that the velocities would bring in the step: with it, a
    tip that would cross an edge beside which it stands now is a contact already.
    """
    if model.joint_table.opens:
        # a joint that has opened as it slid still carries
        front = reach.front + float(state.memory.dilation.max(initial=0.0))
        reach = changed(reach, front=front)
    sought = _sought(model, state)
    around = reach.front + max(reach.critdis, reach.tip)
    travel = reach.travel_of(model.block_count)
    if model.outlines is not None:
        travel = travel[sought.block]
        reach = changed(reach, travel=travel)
    near = near or VerletList()
    pairs = near_pairs(
        near, sought.vertices, sought.start, sought.fixed, around, travel, sought.absent
    )
    pairs = model.meeting(pairs, sought.block)
    owners = sought.owners
    shift = None
    if drift is not None:
        of_all = displacements_of(state.vertices, model.vertex_block, centroid, drift)
        shift = of_all if model.outlines is None else of_all.take(sought.vertex, axis=0)
    strain = strains(model.compliance, state.stress)
    if model.outlines is not None:
        strain = strain.take(sought.block, axis=0)
    of_vertices = owners, first_rows(sought.memory.vertex, len(owners))
    candidates = find_candidates(
        sought.vertices,
        sought.start,
        pairs,
        sought.memory,
        reach,
        shift,
        (strain, sought.fixed),
        of_vertices,
    )
    keep, polygons = corner_rule.choose(candidates), candidates.polygons
    chosen = with_crossings(
        (
            candidates.vertex[keep],
            candidates.edge[keep],
            candidates.pair[keep],
            candidates.gap[keep],
        ),
        pairs,
        polygons,
        candidates.box,
        of_vertices[1],
        sought.memory,
        travel,
        reach.critdis,
    )
    known = of_vertices[1], sought.memory.block, sought.memory.edge
    row = recall((chosen[0], owners.take(chosen[1]), chosen[1]), known)
    if model.outlines is not None:
        one, looked_at = model.outlines, (sought.vertices, polygons[1])
        polygons = _polygons(model, state)
        chosen, pairs, order = _of_blocks(
            chosen[:2],
            looked_at,
            (one.vertex, one.run_start, one.run_edge, one.run_place),
            (model.vertex_block, *polygons[:2]),
        )
        row = np.append(sought.row, -1).take(row.take(order))
    return _contacts(model, state, centroid, pairs, polygons, (chosen, row), reach.critdis)


def _polygons(model: Model, state: State) -> tuple[Any, ...]:
    """Return the arrays of ``Polygons`` of all blocks."""
    return polygon.polygon_arrays(state.vertices, model.block_start, model.vertex_block)


def remembered(model: Model, state: State, centroid: Floats, critdis: float) -> Contacts:
    """Return the contacts that a state remembers, as its last step left them.

    Their gaps are those of the memory, those inside faces between them; ``centroid`` (n, 2) in m.
    """
    memory, count = state.memory.corners, model.block_count
    key = pair_keys(model.vertex_block[memory.vertex], memory.block, count)
    order = np.argsort(key, kind="stable")
    keys, pair = np.unique(key[order], return_inverse=True)
    pairs = np.stack([keys // count, keys % count], axis=1)
    chosen = memory.vertex[order], memory.edge[order], pair, memory.gap[order]
    return _contacts(
        model, state, centroid, pairs, _polygons(model, state), (chosen, order), critdis
    )


# where fixed blocks are one body (model/bodies.py) ----------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Sought:
    """Outlines on which contacts are looked for, with numbers of their own."""

    vertices: Floats
    """Where they are, m, shape (k, 2)."""
    start: Ints
    """First vertex of each, shape (o + 1,)."""
    block: Ints | slice
    """Block of each, shape (o,)."""
    vertex: Ints | slice
    """The model's vertex that each vertex is, shape (k,)."""
    fixed: Bools
    """Those that cannot move, shape (o,)."""
    absent: Bools
    """Those of excavated blocks, shape (o,)."""
    memory: ContactMemory
    """Memory of contacts, by these numbers."""
    row: Ints
    """Row of the state's memory that each row of it is, shape (r,), where these differ."""
    owners: Ints
    """Outline of each vertex, shape (k,)."""


_NO_ROWS = np.zeros(0, np.int64)


def _sought(model: Model, state: State) -> _Sought:
    """Return the outlines on which the contacts of a state are looked for."""
    one, memory = model.outlines, state.memory.corners
    if one is None:
        return _Sought(
            vertices=state.vertices,
            start=model.block_start,
            block=slice(None),
            vertex=slice(None),
            fixed=model.fixed,
            absent=model.absent,
            memory=memory,
            row=_NO_ROWS,
            owners=model.vertex_block,
        )
    vertex, edge = one.of_vertex.take(memory.vertex), one.of_edge.take(memory.edge)
    row = ((vertex >= 0) & (edge >= 0)).nonzero()[0]
    vertex, edge = vertex.take(row), edge.take(row)
    block = one.owners.take(edge)
    order: Ints = order_by(vertex, block, edge)
    row = row.take(order)
    return _Sought(
        vertices=state.vertices.take(one.vertex, axis=0),
        start=one.start,
        block=one.block,
        vertex=one.vertex,
        fixed=one.fixed,
        absent=one.absent,
        memory=ContactMemory(
            vertex=vertex.take(order),
            block=block.take(order),
            edge=edge.take(order),
            gap=memory.gap.take(row),
        ),
        row=row,
        owners=one.owners,
    )


@kernel()
def _of_blocks(contacts, outlines, runs, blocks):
    """Return contacts found on outlines as those of blocks, the pairs of these, and their order.

    Each belongs to the block on whose edge its foot is.  ``contacts`` are vertex and edge (m,),
    ``outlines`` vertices and directions of edges; ``runs`` the vertex, run_start, run_edge and
    run_place of ``Outlines``, ``blocks`` the block of each vertex of the model, the vertices and
    the directions of edges.
    """
    (of_vertex, of_edge), (corners, along), (corner, start, pieces, place) = (
        contacts,
        outlines,
        runs,
    )
    vertex_block, vertices, direction = blocks
    count = len(of_edge)
    vertex, edge = np.empty(count, np.int64), np.empty(count, np.int64)
    lower, higher = np.empty(count, np.int64), np.empty(count, np.int64)
    number = np.empty(count, np.int64)
    for c in range(count):
        p, e = of_vertex[c], of_edge[c]
        first, last = start[e], start[e + 1]
        if last - first > 1:
            way = (corners[p, 0] - corners[e, 0]) * along[e, 0]
            way += (corners[p, 1] - corners[e, 1]) * along[e, 1]
            way = place[first] + max(way, 0.0)
            while last - first > 1:
                middle = (first + last) // 2
                if place[middle] <= way:
                    first = middle
                else:
                    last = middle
        vertex[c], edge[c] = corner[p], pieces[first]
        i, j = vertex_block[vertex[c]], vertex_block[edge[c]]
        lower[c], higher[c] = min(i, j), max(i, j)
        number[c] = vertex[c] * len(vertex_block) + edge[c]
    order = order_by(lower, higher, number)
    pairs, pair, gap, q = (
        np.empty((count, 2), np.int64),
        np.empty(count, np.int64),
        np.empty(count),
        -1,
    )
    for k in range(count):
        c = order[k]
        if q < 0 or pairs[q, 0] != lower[c] or pairs[q, 1] != higher[c]:
            q += 1
            pairs[q, 0], pairs[q, 1] = lower[c], higher[c]
        p, e = vertex[c], edge[c]
        x, y = vertices[p, 0] - vertices[e, 0], vertices[p, 1] - vertices[e, 1]
        pair[k], gap[k] = q, x * direction[e, 1] - y * direction[e, 0]
    return (vertex[order], edge[order], pair, gap), pairs[: q + 1], order


def _contacts(
    model: Model,
    state: State,
    centroid: Floats,
    pairs: Ints,
    polygons: tuple[Any, ...],
    chosen: tuple[Chosen, Ints],
    critdis: float,
) -> Contacts:
    """Return the contacts of vertex, edge, pair and gap (m,) with memory, strength and arms.

    ``chosen`` has them, and the rows (m,) of the state's memory that are theirs, -1 where none is.
    ``polygons`` are the arrays of ``Polygons`` of all blocks.
    """
    direction = polygons[1]
    (vertex, edge, pair, gap), row = chosen
    pair, which = _numbered(pair)
    touching = pairs.take(which, axis=0)
    ends = vertex, edge, model.vertex_block.take(vertex), model.vertex_block.take(edge), pair
    foot, arms = _geometry(ends[:4], gap, polygons[:2], centroid)
    length, spring_length = contact_lengths(ends, polygons, critdis)
    corners = Places(
        vertex=vertex,
        edge=edge,
        vertex_block=ends[2],
        edge_block=ends[3],
        pair=pair,
        point=np.zeros(len(gap), np.int64),
        along=np.zeros(len(gap)),
        gap=gap,
        foot=foot,
        arms=arms,
        joint=joints_of(model, ends, touching, direction),
        length=length,
        spring_length=spring_length,
        row=row,
    )
    joints = model.joint_table
    if joints.binds:
        bonded = np.append(state.memory.bonded, False)[row]
        if state.time == 0.0:
            bonded |= bonded_at_start(corners, model, direction)
        corners = without_points_in_bonds(corners, bonded, state.vertices, critdis)
    places = with_faces(corners, model, state, centroid, polygons)
    carried = _memory_and_strength(model, state, places, direction)
    fields = {**vars(places), **carried}
    if joints.opens:
        fields["gap"] = places.gap - carried["rest_gap"]
    return Contacts(**fields, pairs=touching, normal=places.arms[:, :2])


def _memory_and_strength(
    model: Model, state: State, places: Places, direction: Floats
) -> dict[str, Any]:
    """Return what contacts remember, their strengths and springs, by the fields of Contacts.

    ``direction`` (nv, 2) is that of edges.
    """
    memory, joints = state.memory, model.joint_table
    carried = carried_by(places.row, memory, (places.edge, direction))
    if state.time == 0.0:
        fresh = bonded_at_start(places, model, direction)
        whole = {name: carried[name] | fresh for name in ("bonded", "cohesive")}
        carried = {**carried, **whole}
    bonds = Bonds(bonded=carried["bonded"], cohesive=carried["cohesive"])
    slid, speed = carried["slide_length"], carried["slide_speed"]
    if joints.opens or joints.has_kinetic_friction:
        carried, speed = taken_along(carried, speed, places, memory, direction, model)
    strengths = bonds_of(bonds, slid, speed, places, memory, direction, model)
    normal, shear, share = springs_of_joints(model, places.joint, places.spring_length)
    fields = {
        "rest_gap": carried["dilation"],
        "normal_stiffness": normal,
        "shear_stiffness": shear,
        "spring_share": share,
        "mobilises": np.zeros(len(places.joint), np.bool_),
        **carried,
        **strengths,
        "slide_speed": speed,
    }
    if not joints.opens:
        return fields
    return with_roughness(joints, places, strengths["slide_length"], fields)


@kernel()
def _numbered(pair):
    """Return the numbers of pairs (m,) counted among those that have contacts, and these, (k,)."""
    of_contacts, which = np.empty(len(pair), np.int64), np.empty(len(pair), np.int64)
    count = 0
    for c in range(len(pair)):
        if count == 0 or pair[c] != which[count - 1]:
            which[count] = pair[c]
            count += 1
        of_contacts[c] = count - 1
    return of_contacts, which[:count]


@kernel()
def _geometry(ends, gap, outlines, centroid):
    """Return foot (m, 2) and arms (m, 6) of contacts (contact/jacobian.py)."""
    foot, arms = np.empty((len(gap), 2)), np.empty((len(gap), 6))
    _measure(len(gap), ends, gap, outlines, centroid, foot, arms)
    return foot, arms


@shared(CONTACTS)
def _measure(first, last, ends, gap, outlines, centroid, foot, arms):
    """Write foot and arms of contacts ``first`` to ``last`` - 1."""
    vertex, edge, i, j = ends
    vertices, direction = outlines
    for c in range(first, last):
        p, e = vertex[c], edge[c]
        arms[c, 0], arms[c, 1] = direction[e, 1], -direction[e, 0]
        for x in range(2):
            foot[c, x] = vertices[p, x] - gap[c] * arms[c, x]
            arms[c, 2 + x] = vertices[p, x] - centroid[i[c], x]
            arms[c, 4 + x] = foot[c, x] - centroid[j[c], x]


# jumps past all contacts -----------------------------------------------------------------------


@kernel()
def _have_moved_against(pairs, start, shift, least):
    """Return the pairs (q, 2) whose vertices may have moved against each other by ``least``, m.

    By the mean motion of the vertices of each, whose motions are ``shift`` (nv, 2), m, and by how
    far one of them departs from it.
    """
    count = len(start) - 1
    mean, own = np.zeros((count, 2)), np.zeros(count)
    for b in range(count):
        vertices = range(start[b], start[b + 1])
        for v in vertices:
            mean[b, 0] += shift[v, 0] / len(vertices)
            mean[b, 1] += shift[v, 1] / len(vertices)
        for v in vertices:
            own[b] = max(own[b], np.hypot(shift[v, 0] - mean[b, 0], shift[v, 1] - mean[b, 1]))
    moved = np.empty(len(pairs), np.bool_)
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        between = np.hypot(mean[i, 0] - mean[j, 0], mean[i, 1] - mean[j, 1])
        moved[q] = between + own[i] + own[j] > least
    return moved


def find_tunnelled(
    model: Model,
    before: Floats,
    vertices: Floats,
    memory: ContactMemory,
    near: VerletList,
    least: float = 0.0,
) -> tuple[float, int, int]:
    """Return depth beyond that of contacts, m, vertex and block of the deepest jump.

    From where the vertices (nv, 2) were ``before`` the step.  (0, -1, -1) where no vertex has got
    deeper into a block than the contacts of the two have, or where no two blocks have moved against
    each other by more than ``least``, m.
    """
    pairs = near_pairs(near, vertices, model.block_start, model.fixed, 0.0, absent=model.absent)
    pairs = model.meeting(pairs)
    moved = _have_moved_against(pairs, model.block_start, vertices - before, least)
    pairs = pairs.compress(moved, axis=0)
    box = polygon.boxes(vertices, model.block_start)
    known = pair_penetration(model.vertex_block, pairs, memory)
    if model.outlines is not None:  # what is known of one block of a body is known of all
        bodies = np.sort(model.body[pairs], axis=1)
        _, of_bodies = np.unique(bodies, axis=0, return_inverse=True)
        deepest = np.zeros(len(pairs))
        np.maximum.at(deepest, of_bodies.ravel(), known)
        known = deepest[of_bodies.ravel()]
    jump, vertex, block = np.zeros(len(pairs)), np.full(len(pairs), -1), np.full(len(pairs), -1)
    outlines = before, vertices, model.block_start, model.vertex_after, box
    _jumps(len(pairs), outlines, pairs, known, (jump, vertex, block))
    if not len(pairs):
        return 0.0, -1, -1
    at = int(np.argmax(jump))
    return float(jump[at]), int(vertex[at]), int(block[at])


@kernel()
def _is_inside(px, py, left, edges, widest, vertices, after):
    """Return whether a point lies inside a polygon, by its edges from left to right."""
    inside = False
    for k in range(first_at_least(left, px - widest), len(left)):
        if left[k] > px:
            break
        e = edges[k]
        f = after[e]
        x1, y1 = vertices[e, 0] - px, vertices[e, 1] - py
        x2, y2 = vertices[f, 0] - px, vertices[f, 1] - py
        if (x1 > 0.0) != (x2 > 0.0) and y1 + (y2 - y1) * (-x1) / (x2 - x1) > 0.0:
            inside = not inside
    return inside


@shared(CONTACTS)
def _jumps(low, high, outlines, pairs, known, deepest):
    """Write the deepest jump of each of pairs ``low`` to ``high`` - 1: how deep, vertex, block.

    ``known`` (q,) is the penetration of each pair that the contacts know of, m.  A vertex that is
    much deeper, and was not as deep ``before`` the step, has jumped there within it.
    """
    before, vertices, block_start, after, box = outlines
    jump, of_vertex, into = deepest
    left, listed, widest = np.empty(0), np.empty(0, np.int64), 0.0
    for q in range(low, high):
        worst = 0.0
        for side in range(2):
            i, j = pairs[q, side], pairs[q, 1 - side]
            first, last = block_start[j], block_start[j + 1]
            few = last - first <= EDGES_TRIED_MAX
            if not few:
                window = (box[i, 0], box[j, 1], box[i, 2], box[j, 3])
                left, listed, widest = edges_around(window, 0.0, vertices, after, first, last)
            for p in range(block_start[i], block_start[i + 1]):
                px, py = vertices[p, 0], vertices[p, 1]
                # the outline is nearer than the sides of the box around it
                most = min(px - box[j, 0], box[j, 2] - px, py - box[j, 1], box[j, 3] - py)
                if most - 2.0 * known[q] <= worst:
                    continue
                if not (few or _is_inside(px, py, left, listed, widest, vertices, after)):
                    continue
                depth = depth_inside(px, py, vertices, first, last) - 2.0 * known[q]
                if depth <= worst:
                    continue
                depth -= depth_inside(before[p, 0], before[p, 1], before, first, last)
                if depth > worst:
                    worst, of_vertex[q], into[q] = depth, p, j
        jump[q] = worst
