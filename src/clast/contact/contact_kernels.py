"""From the chosen candidates to the contacts of a step: geometry, strength, memory."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do


@kernel()
def _kept(keep, pair, pairs):
    """Return the candidates that are kept, their pairs numbered anew, and these pairs, (q, 2)."""
    count = 0
    for c in range(len(keep)):
        count += keep[c]
    kept, number = np.empty(count, np.int64), np.empty(count, np.int64)
    touching = np.empty((min(count, len(pairs)), 2), np.int64)
    at, q, last = 0, -1, -1
    for c in range(len(keep)):
        if not keep[c]:
            continue
        if pair[c] != last:
            last = pair[c]
            q += 1
            touching[q, 0], touching[q, 1] = pairs[last, 0], pairs[last, 1]
        kept[at], number[at] = c, q
        at += 1
    return kept, number, touching[: q + 1]


@kernel()
def _describe(first, last, kept, found, outlines, centroid, names, gaps, foot, levers):
    """Write down where contacts ``first`` to ``last`` - 1 are."""
    vertex, edge, gap = found
    vertices, direction, vertex_block = outlines
    points, edges, i, j = names
    for at in range(first, last):
        c = kept[at]
        p, e = vertex[c], edge[c]
        points[at], edges[at], gaps[at] = p, e, gap[c]
        i[at], j[at] = vertex_block[p], vertex_block[e]
        levers[at, 0], levers[at, 1] = direction[e, 1], -direction[e, 0]
        for x in range(2):
            foot[at, x] = vertices[p, x] - gap[c] * levers[at, x]
            levers[at, 2 + x] = vertices[p, x] - centroid[i[at], x]
            levers[at, 4 + x] = foot[at, x] - centroid[j[at], x]


@kernel(parallel=True)
def _describe_shared(kept, found, outlines, centroid, names, gaps, foot, levers):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(kept))):
            first, last = bounds(part, len(kept))
            _describe(first, last, kept, found, outlines, centroid, names, gaps, foot, levers)


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
    kept, number, touching = _kept(keep, pair, pairs)
    count = len(kept)
    points, edges = np.empty(count, np.int64), np.empty(count, np.int64)
    i, j = np.empty(count, np.int64), np.empty(count, np.int64)
    gaps, foot, levers = np.empty(count), np.empty((count, 2)), np.empty((count, 6))
    names, found = (points, edges, i, j), (vertex, edge, gap)
    if count >= MANY:
        _describe_shared(kept, found, outlines, centroid, names, gaps, foot, levers)
    else:
        _describe(0, count, kept, found, outlines, centroid, names, gaps, foot, levers)
    return points, edges, i, j, number, gaps, foot, levers, touching


@kernel()
def _carry(first, last, row, gap, bond_reach, memory, pair, joint, strengths, old, new):
    """Write down what contacts ``first`` to ``last`` - 1 remember, and their strength."""
    bonded, shear_force, normal_force, multiplier, mode = memory
    tangent, cohesion, tensile_strength = strengths
    known, intact, shear, normal, lagrange, modes = old
    friction, c_left, t_left = new
    for c in range(first, last):
        r = row[c]
        known[c] = r >= 0
        if known[c]:
            intact[c], modes[c] = bonded[r], mode[r]
            shear[c], normal[c], lagrange[c] = shear_force[r], normal_force[r], multiplier[r]
        else:
            intact[c], modes[c] = abs(gap[c]) <= bond_reach, 0
            shear[c], normal[c], lagrange[c] = 0.0, 0.0, 0.0
        one = joint[pair[c]]
        friction[c] = tangent[one]
        c_left[c] = cohesion[one] if intact[c] else 0.0
        t_left[c] = tensile_strength[one] if intact[c] else 0.0


@kernel(parallel=True)
def _carry_shared(row, gap, bond_reach, memory, pair, joint, strengths, old, new):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(row))):
            first, last = bounds(part, len(row))
            _carry(first, last, row, gap, bond_reach, memory, pair, joint, strengths, old, new)


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
    count = len(row)
    known, intact = np.empty(count, np.bool_), np.empty(count, np.bool_)
    shear, normal, lagrange = np.empty(count), np.empty(count), np.empty(count)
    old = known, intact, shear, normal, lagrange, np.empty(count, np.int64)
    new = np.empty(count), np.empty(count), np.empty(count)
    if count >= MANY:
        _carry_shared(row, gap, bond_reach, memory, pair, joint, strengths, old, new)
    else:
        _carry(0, count, row, gap, bond_reach, memory, pair, joint, strengths, old, new)
    return *old, *new
