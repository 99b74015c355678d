"""Which joint a contact lies along, how much of it, and the springs that this gives it.

A pair of blocks that a joint names goes before the joints of edges, and these before a pair of
rocks and the default.  Two blocks can touch along several joints, at a step in a fault for example:
a pair cannot say that, their edges can.
"""

from __future__ import annotations

import numpy as np

from clast.block.polygon import SMALL_ANGLE, Polygons, end_of, next_edge, sine, turn_at
from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.model.model import Floats, Ints, Model

SPRING_LENGTH_MIN = 1e-3
"""Least length of joint that springs stand for, in units of critdis: corners that only coincide."""
CORNER_DISTANCE_MAX = 1.01
"""Distance along an edge up to which corners coincide, in units of critdis.

A little more than that up to which they are contacts: seen from either side the distance differs
by rounding and by the cosine of the angle between the faces, and both must say the same.
"""


def joints_of(
    model: Model, ends: tuple[Ints, Ints, Ints, Ints, Ints], pairs: Ints, direction: Floats
) -> Ints:
    """Return the joint of each contact, an index into those of the model, shape (m,).

    ``ends`` are vertex, edge, their blocks and pair of contacts (m,) each, ``pairs`` (q, 2) the
    blocks of pairs, ``direction`` (nv, 2) the unit vectors of edges.
    """
    table = model.joint_table
    of_pairs, named = table.of_pairs(model.block_rock, pairs)
    joint = of_pairs[ends[4]]
    if model.edges_name_joints:
        places = ends[0], ends[1], model.vertex_before
        _along_edges(len(joint), places, model.edge_joint, direction, named[ends[4]], joint)
    return joint


@shared(CONTACTS)
def _along_edges(first, last, places, edge_joint, direction, named, joint):
    """Write the joints of contacts ``first`` to ``last`` - 1 that their edges name.

    That of the entrance edge, else that of the vertex's own edge more nearly parallel to it.
    """
    vertex, edge, before = places
    for c in range(first, last):
        if named[c]:
            continue
        p, e = vertex[c], edge[c]
        named_by = edge_joint[e]
        if named_by < 0:
            a = before[p]
            is_nearer = abs(sine(a, e, direction)) < abs(sine(p, e, direction))
            named_by = edge_joint[a if is_nearer else p]
        if named_by >= 0:
            joint[c] = named_by


# how much of it ----------------------------------------------------------------------------------


@kernel(inline="always")
def _overlap(p, w, e, others, outlines, critdis):
    """Return the length that own edge from p to w shares with edge e, m, as seen by vertex p.

    Each shared piece has two ends, and each end is a vertex of one block, or a vertex of both
    (coinciding corners, which then count half each where both are among the contacts of the two
    blocks, ``others``); every end stands for half of the piece.
    """
    vertices, direction, length = outlines.vertices, outlines.direction, outlines.length
    vertex, start, stop = others
    tx, ty = direction[e, 0], direction[e, 1]
    here = (vertices[p, 0] - vertices[e, 0]) * tx + (vertices[p, 1] - vertices[e, 1]) * ty
    there = (vertices[w, 0] - vertices[e, 0]) * tx + (vertices[w, 1] - vertices[e, 1]) * ty
    low, high = max(0.0, min(here, there)), min(length[e], max(here, there))
    if high <= low:
        return 0.0
    at_end = here > there
    coincide = abs(here - (length[e] if at_end else 0.0)) <= CORNER_DISTANCE_MAX * critdis
    if coincide:
        corner = end_of(e, at_end, outlines)
        for c in range(start, stop):
            if vertex[c] == corner:
                return 0.25 * (high - low)
    return 0.5 * (high - low)


@kernel(inline="always")
def edge_along(p, w, e, outlines, critdis):
    """Return the edge that own edge from p to w runs along: e, or the next one at a flat corner."""
    vertices, direction, length = outlines.vertices, outlines.direction, outlines.length
    tx, ty = direction[e, 0], direction[e, 1]
    here = (vertices[p, 0] - vertices[e, 0]) * tx + (vertices[p, 1] - vertices[e, 1]) * ty
    at_end = (vertices[w, 0] - vertices[p, 0]) * tx + (vertices[w, 1] - vertices[p, 1]) * ty > 0.0
    left = length[e] - here if at_end else here
    if left > critdis or abs(turn_at(e, at_end, outlines)) > SMALL_ANGLE:
        return e
    return next_edge(e, at_end, outlines)


@shared(CONTACTS)
def _lengths(low, high, contacts, polygons, critdis, result, bearing):
    """Write the lengths of joint, and of their springs, of contacts ``low`` to ``high`` - 1."""
    vertex, edge, _, _, pair = contacts
    outlines = Polygons(*polygons)
    direction = outlines.direction
    start = low
    while start > 0 and start < len(pair) and pair[start - 1] == pair[start]:
        start -= 1
    stop = start
    for c in range(low, high):
        while stop <= c:  # the contacts of the next pair of blocks
            start = stop
            while stop < len(vertex) and pair[stop] == pair[start]:
                stop += 1
        result[c], tip, is_flush = 0.0, 0.0, False
        p, e = vertex[c], edge[c]
        before, after = outlines.before[p], outlines.after[p]
        nx, ny = direction[e, 1], -direction[e, 0]
        sines = (
            direction[before, 0] * nx + direction[before, 1] * ny,
            direction[p, 0] * nx + direction[p, 1] * ny,
        )
        # the two edges of a thin wedge run in one direction: only one of them lies along e
        along = direction[before, 1] * nx - direction[before, 0] * ny
        is_wedge = along * (direction[p, 1] * nx - direction[p, 0] * ny) < 0.0
        for side in range(2):
            w = before if side == 0 else after
            others, across = (vertex, start, stop), sines[side]
            if is_wedge and abs(across) > abs(sines[1 - side]):
                continue
            if abs(across) > SMALL_ANGLE:
                tip += (1.0 - across * across) * _overlap(p, w, e, others, outlines, critdis)
                continue
            beside, is_flush = edge_along(p, w, e, outlines, critdis), True
            result[c] += _overlap(p, w, beside, others, outlines, critdis)
        bearing[c] = max(result[c] if is_flush else tip, SPRING_LENGTH_MIN * critdis)


@kernel()
def contact_lengths(contacts, polygons, critdis):
    """Return the length of joint that each contact stands for, and that of its springs, m, (m,).

    Where a vertex's own edge lies along the entrance edge (within 3 degrees) the two share a
    piece of joint, and each of its ends takes half; the sum over the contacts of two faces is
    their common length.  A vertex that touches with its tip alone stands for none; its springs
    do for as much as its own edges have in front of the entrance edge, times the squared cosine of
    the angle between them, so that a block that tilts keeps the springs that it tilts about.
    No spring stands for less than a thousandth of critdis.
    ``contacts`` are vertex, edge, their blocks and pair (m,) each; ``polygons`` the arrays of
    ``Polygons``; corners within ``critdis``, m, coincide.
    """
    count = len(contacts[0])
    result, bearing = np.empty(count), np.empty(count)
    _lengths(count, contacts, polygons, critdis, result, bearing)
    return result, bearing


# its springs -----------------------------------------------------------------------------------


def springs_of_joints(model: Model, joint: Ints, length: Floats) -> tuple[Floats, Floats, Floats]:
    """Return k_n L and k_s L of contacts, N/m per m, and their shares of the springs of the law.

    The first two are nan where their joint leaves them to the law.  The springs p of the law stand
    for a corner, whatever it stands for; where a face is to be integrated they are taken as 2 p
    over the size of the smallest block, per area.  ``joint`` (m,) are their joints, ``length`` (m,)
    those of their springs, m.
    """
    table = model.joint_table
    normal, shear = table.stiffnesses
    if table.integrates:
        share = np.where(table.integrated.take(joint), per_area(1.0, model) * length, 1.0)
    else:
        share = np.empty(len(length))
        share.fill(1.0)
    return normal.take(joint) * length, shear.take(joint) * length, share


def per_area(stiffness: float, model: Model) -> float:
    """Return the stiffness of the law, N/m per m, as one per area, Pa/m.

    Such that a face as long as the smallest block has as much of it as two corners.
    """
    return 2.0 * stiffness / float(np.sqrt(model.smallest))


def range_of_springs(model: Model, stiffness: float) -> tuple[float, float]:
    """Return the softest and the stiffest normal spring that contacts may have, N/m per m.

    ``stiffness`` is that of the contact law.  Those of joints are k_n L with L between half the
    size of the smallest block and the longest edge.
    """
    table = model.joint_table
    if not table.integrates:
        return stiffness, stiffness
    normal = table.stiffnesses[0]
    own = np.where(np.isnan(normal), per_area(stiffness, model), normal)[table.integrated]
    softest = float(own.min()) * _shortest(model)
    stiffest = float(own.max()) * model.longest_edge
    return min(stiffness, softest), max(stiffness, stiffest)


def softest_beside_welds(model: Model) -> float:
    """Return the softest spring of a joint, N/m per m, where only welds have that of the law.

    0 where a joint leaves its stiffness to the law, and where there is no joint but welds.
    """
    table = model.joint_table
    normal = table.stiffnesses[0][~table.welds]
    if len(normal) == 0 or np.isnan(normal).any():
        return 0.0
    return float(normal.min()) * _shortest(model)


def _shortest(model: Model) -> float:
    """Return the length that a contact of the smallest block stands for, m: half of its size."""
    return 0.5 * float(np.sqrt(model.smallest))
