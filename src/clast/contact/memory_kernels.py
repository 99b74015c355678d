"""The contact memory: finding a contact again, and writing the memory of the next step."""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, bounds, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do


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
def _remember(low, high, groups, edge_block, start, memory_block, memory_edge, remembered):
    group_start, vertex, edge = groups
    for g in range(low, high):
        c = group_start[g]
        first, last = rows_of_key(vertex[c], edge_block[edge[c]], start, memory_block)
        remembered[g] = memory_edge[first] if first < last else -1


@kernel(parallel=True)
def _remember_shared(groups, edge_block, start, memory_block, memory_edge, remembered):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(remembered))):
            low, high = bounds(part, len(remembered))
            _remember(low, high, groups, edge_block, start, memory_block, memory_edge, remembered)


@kernel()
def remembered_edges(
    group_start, vertex, edge, edge_block, memory_vertex, memory_block, memory_edge
):
    """Return the entrance edge of each group in the last step, or -1, shape (groups,)."""
    start = rows_by_vertex(memory_vertex, len(edge_block))
    count, groups = len(group_start) - 1, (group_start, vertex, edge)
    remembered = np.empty(count, np.int64)
    if count >= MANY:
        _remember_shared(groups, edge_block, start, memory_block, memory_edge, remembered)
    else:
        _remember(0, count, groups, edge_block, start, memory_block, memory_edge, remembered)
    return remembered


@kernel()
def _same_group(c, vertex, block):
    """Return True if contact c is of the same vertex and block as the one before it."""
    return c > 0 and vertex[c] == vertex[c - 1] and block[c] == block[c - 1]


@kernel()
def _find_rows(low, high, contacts, by_vertex, memory_block, memory_edge, taken, rows):
    """Find the rows of contacts whose (vertex, block) begins with one of ``low`` to ``high`` - 1.

    ``taken`` are the rows that are given away: of one (vertex, block), whose contacts are found by
    one thread.
    """
    vertex, block, edge = contacts
    start = low
    while start < high and _same_group(start, vertex, block):
        start += 1
    while start < high:
        stop = start + 1
        while stop < len(vertex) and _same_group(stop, vertex, block):
            stop += 1
        first, last = rows_of_key(vertex[start], block[start], by_vertex, memory_block)
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


@kernel(parallel=True)
def _find_rows_shared(contacts, by_vertex, memory_block, memory_edge, taken, rows):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(rows))):
            low, high = bounds(part, len(rows))
            _find_rows(low, high, contacts, by_vertex, memory_block, memory_edge, taken, rows)


@kernel()
def rows_of(vertex, block, edge, memory_vertex, memory_block, memory_edge):
    """Return the memory row of each contact, or -1, shape (m,).

    The same edge first; else a row of the same (vertex, block) whose edge is no longer in
    contact: the vertex has slid round to the next edge and takes its memory along.  Contacts of
    one (vertex, block) stand together; no row is given twice.
    """
    count, contacts = len(vertex), (vertex, block, edge)
    by_vertex = rows_by_vertex(memory_vertex, max(_count_of(vertex), _count_of(memory_vertex)))
    taken, rows = np.zeros(len(memory_vertex), np.bool_), np.empty(count, np.int64)
    if count >= MANY:
        _find_rows_shared(contacts, by_vertex, memory_block, memory_edge, taken, rows)
    else:
        _find_rows(0, count, contacts, by_vertex, memory_block, memory_edge, taken, rows)
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
def _find_pairs(low, high, pairs, start, vertex_block, memory_vertex, memory_block, found):
    """Write the pair of blocks of the rows ``low`` to ``high`` - 1 of the memory, or -1."""
    for row in range(low, high):
        own, other = vertex_block[memory_vertex[row]], memory_block[row]
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


@kernel(parallel=True)
def _find_pairs_shared(pairs, start, vertex_block, memory_vertex, memory_block, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(found))):
            low, high = bounds(part, len(found))
            _find_pairs(low, high, pairs, start, vertex_block, memory_vertex, memory_block, found)


@kernel()
def deepest_by_pair(pairs, vertex_block, block_count, memory_vertex, memory_block, memory_gap):
    """Return the largest remembered penetration of each sorted pair of blocks, m, (q,)."""
    start = rows_by_vertex(pairs[:, 0], block_count)
    count = len(memory_vertex)
    found = np.empty(count, np.int64)
    if count >= MANY:
        _find_pairs_shared(pairs, start, vertex_block, memory_vertex, memory_block, found)
    else:
        _find_pairs(0, count, pairs, start, vertex_block, memory_vertex, memory_block, found)
    depth = np.zeros(len(pairs))
    for row in range(count):
        if found[row] >= 0:
            depth[found[row]] = max(depth[found[row]], -memory_gap[row])
    return depth


@kernel()
def _renew(first, last, order, keys, state, forces, critdis, names, ends, results):
    """Write rows ``first`` to ``last`` - 1 of the new memory."""
    vertex, block, edge = keys
    mode, bonded = state
    gap, normal, shear, multiplier = forces
    vertices, blocks, edges = names
    modes, intact = ends
    gaps, normals, shears, multipliers = results
    for row in range(first, last):
        c = order[row]
        vertices[row], blocks[row], edges[row], modes[row] = vertex[c], block[c], edge[c], mode[c]
        gaps[row], normals[row], multipliers[row] = gap[c], normal[c], multiplier[c]
        shears[row] = shear[c] if mode[c] != 0 else 0.0
        intact[row] = bonded[c] and gap[c] <= critdis


@kernel(parallel=True)
def _renew_shared(order, keys, state, forces, critdis, names, ends, results):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(order))):
            first, last = bounds(part, len(order))
            _renew(first, last, order, keys, state, forces, critdis, names, ends, results)


@kernel()
def renewed(vertex, block, edge, gap, normal, shear, multiplier, mode, bonded, critdis):
    """Return the columns of the memory (k,), sorted by vertex, block and edge.

    A contact that is open (mode 0) forgets its shear force, one further apart than ``critdis``, m,
    its bond.
    """
    count, order = len(vertex), _order(vertex, block, edge)
    keys, state, forces = (vertex, block, edge), (mode, bonded), (gap, normal, shear, multiplier)
    names = np.empty(count, np.int64), np.empty(count, np.int64), np.empty(count, np.int64)
    ends = np.empty(count, np.int64), np.empty(count, np.bool_)
    results = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    if count >= MANY:
        _renew_shared(order, keys, state, forces, critdis, names, ends, results)
    else:
        _renew(0, count, order, keys, state, forces, critdis, names, ends, results)
    return *names, *results, *ends
