"""From the chosen candidates to the contacts of a step: geometry, strength, memory."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def chosen(keep, found, pairs, outlines, centroid):
    """Return the candidates that are kept, and the pairs of blocks that share contacts, (q, 2).

    Vertex, edge, their blocks, pair, gap, (m,) each; foot of the vertex (m, 2); normal and offsets,
    m, of vertex and foot from the centroids of their blocks, (m, 6).  The pairs of blocks are
    numbered anew, without those that share no contact.

    ``found`` are vertex, edge, pair and gap of the candidates, in order of their pairs;
    ``outlines`` the vertices, directions of the edges and block of each vertex.
    """
    vertex, edge, pair, gap = found
    vertices, direction, vertex_block = outlines
    count = 0
    for c in range(len(keep)):
        count += keep[c]
    points, edges = np.empty(count, np.int64), np.empty(count, np.int64)
    i, j = np.empty(count, np.int64), np.empty(count, np.int64)
    number, gaps = np.empty(count, np.int64), np.empty(count)
    foot, levers = np.empty((count, 2)), np.empty((count, 6))
    touching = np.empty((min(count, len(pairs)), 2), np.int64)
    at, q, last = 0, -1, -1
    for c in range(len(keep)):
        if not keep[c]:
            continue
        if pair[c] != last:
            last = pair[c]
            q += 1
            touching[q, 0], touching[q, 1] = pairs[last, 0], pairs[last, 1]
        p, e = vertex[c], edge[c]
        points[at], edges[at], gaps[at], number[at] = p, e, gap[c], q
        i[at], j[at] = vertex_block[p], vertex_block[e]
        levers[at, 0], levers[at, 1] = direction[e, 1], -direction[e, 0]
        for x in range(2):
            foot[at, x] = vertices[p, x] - gap[c] * levers[at, x]
            levers[at, 2 + x] = vertices[p, x] - centroid[i[at], x]
            levers[at, 4 + x] = foot[at, x] - centroid[j[at], x]
        at += 1
    return points, edges, i, j, number, gaps, foot, levers, touching[: q + 1]


@kernel()
def carried(row, gap, bond_reach, memory, pair, joint, strengths):
    """Return what contacts remember, and the strength that they have left, each (m,).

    Whether they are known and bonded, shear force, normal force, multiplier, mode; tan(phi),
    cohesion and tensile strength, the last two 0 once broken.

    ``row`` (m,) is the row of a contact in ``memory`` (bonded, shear force, normal force,
    multiplier, mode) or -1: then it carries nothing, and it is bonded where the gap is within
    ``bond_reach``, m.  ``joint`` (q,) is the joint of each pair of blocks, ``strengths`` tan(phi),
    cohesion and tensile strength of the joints.
    """
    bonded, shear_force, normal_force, multiplier, mode = memory
    tangent, cohesion, tensile_strength = strengths
    count = len(row)
    known, intact = np.empty(count, np.bool_), np.empty(count, np.bool_)
    shear, normal, lagrange = np.zeros(count), np.zeros(count), np.zeros(count)
    modes, friction = np.zeros(count, np.int64), np.empty(count)
    c_left, t_left = np.zeros(count), np.zeros(count)
    for c in range(count):
        r = row[c]
        known[c] = r >= 0
        if known[c]:
            intact[c], modes[c] = bonded[r], mode[r]
            shear[c], normal[c], lagrange[c] = shear_force[r], normal_force[r], multiplier[r]
        else:
            intact[c] = abs(gap[c]) <= bond_reach
        one = joint[pair[c]]
        friction[c] = tangent[one]
        if intact[c]:
            c_left[c], t_left[c] = cohesion[one], tensile_strength[one]
    return known, intact, shear, normal, lagrange, modes, friction, c_left, t_left
