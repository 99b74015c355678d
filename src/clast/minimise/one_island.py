"""What a region of blocks is minimised with, copied together, and how its point is put back.

A problem is (system, pairs, graph, contacts, springs): B, B^-1 (n, 6, 6), the load (n, 6) and which
blocks are fixed (n,); the pairs (q, 2) and their graph (linear/assembly.py); vertex_block and
edge_block (m,) and levers of the contacts; multipliers, shear forces (m,), p, k, tension and
strength (m,) of their springs.

A point is d (n, 6), gap, slip, N, T and the stiffnesses against them (m,), r (n, 6) and r.B^-1 r
(n,).

In what is copied the blocks are numbered in their order, and all fixed ones are one, the last.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.vec6 import line, put_line, put_row, row, zeros
from clast.linear.block_matrix import row_pointers


@kernel()
def _size(blocks, pairs, graph, fixed):
    """Return how many pairs and contacts a region has."""
    start, right, left, listed = graph
    links, contacts = 0, 0
    for i in blocks:
        links += right[i + 1] - right[i]
        contacts += start[right[i + 1]] - start[right[i]]
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            if fixed[pairs[q, 0]]:
                links += 1
                contacts += start[q + 1] - start[q]
    return links, contacts


@kernel()
def _add_pair(q, k, other, start, at, own, first, source):
    """Write pair q as that of the blocks k and ``other`` of the region, and its contacts."""
    own[at, 0], own[at, 1] = k, other
    place = first[at]
    for c in range(start[q], start[q + 1]):
        source[place] = c
        place += 1
    first[at + 1] = place


@kernel()
def _pairs_of(blocks, place, pairs, graph, fixed):
    """Return a region's pairs (q, 2), the first contact of each, and where its contacts are.

    ``place`` (n,) are the numbers that blocks have in their regions.
    """
    start, right, left, listed = graph
    count = len(blocks)
    links, contacts = _size(blocks, pairs, graph, fixed)
    own, first = np.empty((links, 2), np.int64), np.zeros(links + 1, np.int64)
    source, at = np.empty(contacts, np.int64), 0
    for k in range(count):
        i = blocks[k]
        for q in range(right[i], right[i + 1]):
            j = pairs[q, 1]
            _add_pair(q, k, count if fixed[j] else place[j], start, at, own, first, source)
            at += 1
        for e in range(left[i], left[i + 1]):
            if fixed[pairs[listed[e], 0]]:
                _add_pair(listed[e], k, count, start, at, own, first, source)
                at += 1
    return own, first, source


@kernel()
def _taken(values, source):
    """Return of numbers (m,) those of the contacts ``source``."""
    found = np.empty(len(source))
    for c in range(len(source)):
        found[c] = values[source[c]]
    return found


@kernel()
def _rows_of(values, blocks):
    """Return of rows (n, 6) those of ``blocks``, and one of zeros."""
    found = np.empty((len(blocks) + 1, 6))
    for k in range(len(blocks)):
        put_row(found, k, row(values, blocks[k]))
    put_row(found, len(blocks), zeros())
    return found


@kernel()
def _blocks_of(values, blocks):
    """Return of blocks (n, 6, 6) those of ``blocks``, and one of zeros."""
    found = np.empty((len(blocks) + 1, 6, 6))
    for k in range(len(blocks)):
        for a in range(6):
            put_line(found, k, a, line(values, blocks[k], a))
    for a in range(6):
        put_line(found, len(blocks), a, zeros())
    return found


@kernel()
def _levers_of(levers, source):
    """Return of levers (m, 6) or (m, 4, 6) those of the contacts ``source``."""
    rows = levers.size // (6 * len(levers))
    found = np.empty((len(source), *levers.shape[1:]))
    values, into = levers.reshape((-1, rows, 6)), found.reshape((-1, rows, 6))
    for c in range(len(source)):
        for a in range(rows):
            put_line(into, c, a, line(values, source[c], a))
    return found


@kernel()
def _ends_of(ends, source, place, fixed, last):
    """Return the numbers that the blocks of contacts ``source`` have in the region."""
    found = np.empty(len(source), np.int64)
    for c in range(len(source)):
        i = ends[source[c]]
        found[c] = last if fixed[i] else place[i]
    return found


@kernel()
def _point_of(blocks, source, point):
    """Return a region's point."""
    d, gap, slip, normal, shear, kn, ks, residual, left = point
    own_left = np.zeros(len(blocks) + 1)
    for k in range(len(blocks)):
        own_left[k] = left[blocks[k]]
    return (
        _rows_of(d, blocks),
        _taken(gap, source),
        _taken(slip, source),
        _taken(normal, source),
        _taken(shear, source),
        _taken(kn, source),
        _taken(ks, source),
        _rows_of(residual, blocks),
        own_left,
    )


@kernel()
def copied(blocks, place, problem, point):
    """Return the problem and the point of the region of ``blocks``, and where its contacts are."""
    system, pairs, graph, contacts, springs = problem
    base, inverse, load, fixed = system
    vertex_block, edge_block, levers = contacts
    multiplier, shear_force, p, k, tension, strength = springs
    count = len(blocks)
    own_pairs, first, source = _pairs_of(blocks, place, pairs, graph, fixed)
    held = np.zeros(count + 1, np.bool_)
    held[count] = True
    own_problem = (
        (_blocks_of(base, blocks), _blocks_of(inverse, blocks), _rows_of(load, blocks), held),
        own_pairs,
        (first, *row_pointers(count + 1, own_pairs)),
        (
            _ends_of(vertex_block, source, place, fixed, count),
            _ends_of(edge_block, source, place, fixed, count),
            _levers_of(levers, source),
        ),
        (
            _taken(multiplier, source),
            _taken(shear_force, source),
            p,
            k,
            _taken(tension, source),
            _taken(strength, source),
        ),
    )
    return own_problem, _point_of(blocks, source, point), source


@kernel()
def put_back(blocks, source, found, point):
    """Write a region's point where it belongs."""
    d, gap, slip, normal, shear, kn, ks, residual, left = point
    own_d, own_gap, own_slip, own_normal, own_shear, own_kn, own_ks, own_residual, own_left = found
    for k in range(len(blocks)):
        put_row(d, blocks[k], row(own_d, k))
        put_row(residual, blocks[k], row(own_residual, k))
        left[blocks[k]] = own_left[k]
    for k in range(len(source)):
        c = source[k]
        gap[c], slip[c] = own_gap[k], own_slip[k]
        normal[c], shear[c] = own_normal[k], own_shear[k]
        kn[c], ks[c] = own_kn[k], own_ks[k]
