"""The contact memory: finding a contact again, and writing the memory of the next step."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def _count_of(vertex):
    """Return one more than the largest vertex, 0 if there is none."""
    count = 0
    for one in vertex:
        count = max(count, one + 1)
    return count


@kernel()
def rows_by_vertex(memory_vertex, count):
    """Return the first row of each of ``count`` vertices in the sorted memory, (count + 1,)."""
    start = np.zeros(count + 1, np.int64)
    for row in range(len(memory_vertex)):
        start[memory_vertex[row] + 1] += 1
    for vertex in range(count):
        start[vertex + 1] += start[vertex]
    return start


@kernel()
def rows_of_key(vertex, block, start, memory_block):
    """Return the first row with this (vertex, block) and the one after the last; equal if none."""
    first, stop = start[vertex], start[vertex + 1]
    while first < stop and memory_block[first] != block:
        first += 1
    last = first
    while last < stop and memory_block[last] == block:
        last += 1
    return first, last


@kernel()
def remembered_edges(
    group_start, vertex, edge, edge_block, memory_vertex, memory_block, memory_edge
):
    """Return the entrance edge of each group in the last step, or -1, shape (groups,)."""
    start = rows_by_vertex(memory_vertex, len(edge_block))
    remembered = np.empty(len(group_start) - 1, np.int64)
    for g in range(len(remembered)):
        c = group_start[g]
        first, last = rows_of_key(vertex[c], edge_block[edge[c]], start, memory_block)
        remembered[g] = memory_edge[first] if first < last else -1
    return remembered


@kernel()
def rows_of(vertex, block, edge, memory_vertex, memory_block, memory_edge):
    """Return the memory row of each contact, or -1, shape (m,).

    The same edge first; else a row of the same (vertex, block) whose edge is no longer in
    contact: the vertex has slid round to the next edge and takes its memory along.  Contacts of
    one (vertex, block) stand together; no row is given twice.
    """
    count = len(vertex)
    by_vertex = rows_by_vertex(memory_vertex, max(_count_of(vertex), _count_of(memory_vertex)))
    taken = np.zeros(len(memory_vertex), np.bool_)
    rows = np.full(count, -1, np.int64)
    start = 0
    while start < count:
        stop = start + 1
        while stop < count and vertex[stop] == vertex[start] and block[stop] == block[start]:
            stop += 1
        first, last = rows_of_key(vertex[start], block[start], by_vertex, memory_block)
        for c in range(start, stop):
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
    return rows


@kernel()
def _order(vertex, block, edge):
    """Return the order of contacts by vertex, then block, then edge, shape (m,).

    By counting, then by insertion: the contacts of one vertex are few.
    """
    start = rows_by_vertex(vertex, _count_of(vertex))
    filled = start[:-1].copy()
    order = np.empty(len(vertex), np.int64)
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


@kernel()
def deepest_by_pair(pairs, vertex_block, block_count, memory_vertex, memory_block, memory_gap):
    """Return the largest remembered penetration of each sorted pair of blocks, m, (q,)."""
    start = rows_by_vertex(pairs[:, 0], block_count)
    depth = np.zeros(len(pairs))
    for row in range(len(memory_vertex)):
        own, other = vertex_block[memory_vertex[row]], memory_block[row]
        lower, higher = min(own, other), max(own, other)
        low, high = start[lower], start[lower + 1]
        while low < high:
            middle = (low + high) // 2
            if pairs[middle, 1] < higher:
                low = middle + 1
            else:
                high = middle
        if low < start[lower + 1] and pairs[low, 1] == higher:
            depth[low] = max(depth[low], -memory_gap[row])
    return depth


@kernel()
def renewed(vertex, block, edge, gap, normal, shear, multiplier, mode, bonded, critdis):
    """Return the columns of the memory (k,), sorted by vertex, block and edge.

    A contact that is open (mode 0) forgets its shear force, one further apart than ``critdis``, m,
    its bond.
    """
    count, order = len(vertex), _order(vertex, block, edge)
    vertices, blocks = np.empty(count, np.int64), np.empty(count, np.int64)
    edges, modes = np.empty(count, np.int64), np.empty(count, np.int64)
    gaps, normals, shears = np.empty(count), np.empty(count), np.empty(count)
    multipliers, intact = np.empty(count), np.empty(count, np.bool_)
    for row in range(count):
        c = order[row]
        vertices[row], blocks[row], edges[row], modes[row] = vertex[c], block[c], edge[c], mode[c]
        gaps[row], normals[row], multipliers[row] = gap[c], normal[c], multiplier[c]
        shears[row] = shear[c] if mode[c] != 0 else 0.0
        intact[row] = bonded[c] and gap[c] <= critdis
    return vertices, blocks, edges, gaps, normals, shears, multipliers, modes, intact
