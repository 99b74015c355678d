"""From the chosen candidates to the contacts of a step: geometry, strength, memory."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def chosen(keep, vertex, edge, pair, gap, pairs, vertex_block):
    """Return the candidates that are kept: vertex, edge, their blocks, pair, gap, each (m,).

    The pairs of blocks are numbered anew, without those that share no contact; they come last,
    shape (q, 2).  Candidates are in order of their pairs.
    """
    count = 0
    for c in range(len(keep)):
        count += keep[c]
    vertices, edges = np.empty(count, np.int64), np.empty(count, np.int64)
    i, j = np.empty(count, np.int64), np.empty(count, np.int64)
    number, gaps = np.empty(count, np.int64), np.empty(count)
    touching = np.empty((min(count, len(pairs)), 2), np.int64)
    at, q, last = 0, -1, -1
    for c in range(len(keep)):
        if not keep[c]:
            continue
        if pair[c] != last:
            last = pair[c]
            q += 1
            touching[q, 0], touching[q, 1] = pairs[last, 0], pairs[last, 1]
        vertices[at], edges[at], gaps[at], number[at] = vertex[c], edge[c], gap[c], q
        i[at], j[at] = vertex_block[vertex[c]], vertex_block[edge[c]]
        at += 1
    return vertices, edges, i, j, number, gaps, touching[: q + 1]


@kernel()
def places(vertex, edge, i, j, gap, vertices, direction, centroid):
    """Return normal and foot of the contacts, and the offsets of vertex and foot, each (m, 2).

    Offsets, m, are from the centroids of the blocks of vertex and edge.
    """
    count = len(vertex)
    normal, foot = np.empty((count, 2)), np.empty((count, 2))
    at_vertex, at_edge = np.empty((count, 2)), np.empty((count, 2))
    for c in range(count):
        p, e = vertex[c], edge[c]
        normal[c, 0], normal[c, 1] = direction[e, 1], -direction[e, 0]
        for x in range(2):
            foot[c, x] = vertices[p, x] - gap[c] * normal[c, x]
            at_vertex[c, x] = vertices[p, x] - centroid[i[c], x]
            at_edge[c, x] = foot[c, x] - centroid[j[c], x]
    return normal, foot, at_vertex, at_edge


@kernel()
def strengths(joint, pair, bonded, tangent, cohesion, tensile_strength):
    """Return tan(phi), cohesion and tensile strength of the contacts, each (m,), 0 once broken.

    ``joint`` (q,) is the joint of each pair of blocks; the strengths are those of the joints.
    """
    count = len(pair)
    friction = np.empty(count)
    c_left, t_left = np.zeros(count), np.zeros(count)
    for c in range(count):
        one = joint[pair[c]]
        friction[c] = tangent[one]
        if bonded[c]:
            c_left[c], t_left[c] = cohesion[one], tensile_strength[one]
    return friction, c_left, t_left


@kernel()
def remembered(row, gap, bond_reach, bonded, shear_force, normal_force, multiplier, mode):
    """Return known, bonded, shear force, normal force, multiplier and mode of contacts, each (m,).

    ``row`` (m,) is the memory row of a contact or -1: then it carries nothing, and it is bonded
    where the gap is within ``bond_reach``, m.
    """
    count = len(row)
    known, intact = np.empty(count, np.bool_), np.empty(count, np.bool_)
    shear, normal, lagrange = np.zeros(count), np.zeros(count), np.zeros(count)
    modes = np.zeros(count, np.int64)
    for c in range(count):
        r = row[c]
        known[c] = r >= 0
        if known[c]:
            intact[c], modes[c] = bonded[r], mode[r]
            shear[c], normal[c], lagrange[c] = shear_force[r], normal_force[r], multiplier[r]
        else:
            intact[c] = abs(gap[c]) <= bond_reach
    return known, intact, shear, normal, lagrange, modes
