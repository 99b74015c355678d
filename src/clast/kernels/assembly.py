"""Contact contributions to the block system, in the order of the contacts (repeatable)."""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.block_rows import CHUNK, FMA, SHARED, chunks
from clast.kernels.compiled import kernel

PIECE, MANY = 2048, 8000
"""Contacts that a thread takes at a time, and number from which threads share them."""


@kernel()
def add_contacts(
    diagonal,
    upper,
    lower,
    force,
    pair,
    vertex_block,
    edge_block,
    normal_vertex,
    normal_edge,
    tangent_vertex,
    tangent_edge,
    normal_stiffness,
    shear_stiffness,
    coupling,
    normal_load,
    shear_load,
):
    """Add contact springs and forces to K and F in place.

    With rows n = (n_i, n_j) and t = (t_i, t_j) of a contact, K gets
    k_n n n^T + k_s t t^T - c k_n ... (friction solved inside the step): the normal force is
    N = N0 - k_n n.d, the shear force T = T0 - k_s t.d + c (N - N0), and F gets N0 n + T0 t.
    ``upper`` holds K_ij of each pair (lower index first), ``lower`` K_ji.
    """
    n = np.empty((2, 6))
    t = np.empty((2, 6))
    for c in range(len(pair)):
        i, j, q = vertex_block[c], edge_block[c], pair[c]
        first = 0 if i < j else 1
        for k in range(6):
            n[first, k], n[1 - first, k] = normal_vertex[c, k], normal_edge[c, k]
            t[first, k], t[1 - first, k] = tangent_vertex[c, k], tangent_edge[c, k]
        low, high = min(i, j), max(i, j)
        kn, ks, cross = normal_stiffness[c], shear_stiffness[c], coupling[c]
        for a in range(6):
            force[low, a] += normal_load[c] * n[0, a] + shear_load[c] * t[0, a]
            force[high, a] += normal_load[c] * n[1, a] + shear_load[c] * t[1, a]
            left0 = kn * (n[0, a] + cross * t[0, a])
            left1 = kn * (n[1, a] + cross * t[1, a])
            for b in range(6):
                diagonal[low, a, b] += left0 * n[0, b] + ks * t[0, a] * t[0, b]
                diagonal[high, a, b] += left1 * n[1, b] + ks * t[1, a] * t[1, b]
                value = left0 * n[1, b] + ks * t[0, a] * t[1, b]
                upper[q, a, b] += value
                if cross == 0.0:  # the same to the last bit, so that K is symmetric
                    lower[q, b, a] += value
                else:
                    lower[q, b, a] += kn * (n[1, b] + cross * t[1, b]) * n[0, a]
                    lower[q, b, a] += ks * t[1, b] * t[0, a]


@kernel()
def first_of_pairs(pair, count):
    """Return the first contact of each of ``count`` pairs, shape (count + 1,); contacts by pair."""
    start = np.zeros(count + 1, np.int64)
    for q in pair:
        start[q + 1] += 1
    for q in range(count):
        start[q + 1] += start[q]
    return start


@kernel(fastmath=FMA)
def _add_dyads(i, first, last, vertex_block, n_own, n_other, t_own, t_other, kn, ks, block):
    """Add k_n n n^T + k_s t t^T of contacts ``first`` to ``last`` - 1, as block i has a part in."""
    for c in range(first, last):
        if kn[c] == 0.0 and ks[c] == 0.0:
            continue
        n, t = (n_own, t_own) if vertex_block[c] == i else (n_other, t_other)
        for a in range(6):
            na, ta = kn[c] * n[c, a], ks[c] * t[c, a]
            for b in range(6):
                block[a, b] += na * n[c, b] + ta * t[c, b]


@kernel(fastmath=FMA)
def _couple(i, first, last, vertex_block, n_own, n_other, t_own, t_other, kn, ks, block):
    """Write K_ij of a pair (i, j), i < j, from its contacts ``first`` to ``last`` - 1."""
    block[:] = 0.0
    for c in range(first, last):
        if kn[c] == 0.0 and ks[c] == 0.0:
            continue
        own = vertex_block[c] == i
        ni, nj = (n_own, n_other) if own else (n_other, n_own)
        ti, tj = (t_own, t_other) if own else (t_other, t_own)
        for a in range(6):
            na, ta = kn[c] * ni[c, a], ks[c] * ti[c, a]
            for b in range(6):
                block[a, b] += na * nj[c, b] + ta * tj[c, b]


@kernel()
def _assemble_rows(low, high, base, fixed, pairs, graph, vertex_block, rows, kn, ks, own, upper):
    """Assemble blocks ``low`` to ``high`` - 1 and the pairs that begin with them."""
    start, right, left, listed = graph
    n_own, n_other, t_own, t_other = rows
    for i in range(low, high):
        own[i] = base[i]
        if fixed[i]:
            scale = 0.0
            for a in range(6):
                scale = max(scale, base[i, a, a])
            own[i] = 0.0
            for a in range(6):
                own[i, a, a] = scale
        for at in range(left[i] if not fixed[i] else left[i + 1], left[i + 1]):
            q = listed[at]
            _add_dyads(
                i,
                start[q],
                start[q + 1],
                vertex_block,
                n_own,
                n_other,
                t_own,
                t_other,
                kn,
                ks,
                own[i],
            )
        for q in range(right[i], right[i + 1]):
            if not fixed[i]:
                _add_dyads(
                    i,
                    start[q],
                    start[q + 1],
                    vertex_block,
                    n_own,
                    n_other,
                    t_own,
                    t_other,
                    kn,
                    ks,
                    own[i],
                )
            if fixed[i] or fixed[pairs[q, 1]]:
                upper[q] = 0.0
            else:
                _couple(
                    i,
                    start[q],
                    start[q + 1],
                    vertex_block,
                    n_own,
                    n_other,
                    t_own,
                    t_other,
                    kn,
                    ks,
                    upper[q],
                )


@kernel(parallel=True)
def _assemble_shared(base, fixed, pairs, graph, vertex_block, rows, kn, ks, own, upper):
    for c in prange(chunks(len(base))):
        last = min((c + 1) * CHUNK, len(base))
        _assemble_rows(
            c * CHUNK, last, base, fixed, pairs, graph, vertex_block, rows, kn, ks, own, upper
        )


@kernel()
def assemble(base, fixed, pairs, graph, vertex_block, rows, kn, ks, own, upper):
    """Write K with the contact springs in it: diagonal ``own`` (n, 6, 6), ``upper`` (q, 6, 6).

    ``base`` (n, 6, 6) is K without contacts; ``graph`` the first contact of each pair and
    the pairs of each block (see block_rows.row_pointers); ``rows`` the four sets of contact rows.
    Blocks held fixed keep a diagonal of their own size and no couplings.  Every block sums up its
    own contacts in their order: threads can share the work.
    """
    if len(base) >= SHARED:
        _assemble_shared(base, fixed, pairs, graph, vertex_block, rows, kn, ks, own, upper)
    else:
        _assemble_rows(
            0, len(base), base, fixed, pairs, graph, vertex_block, rows, kn, ks, own, upper
        )


@kernel()
def hold_blocks(diagonal, upper, lower, force, pairs, fixed):
    """Remove the degrees of freedom of fixed blocks: their equations become d = 0, in place."""
    for b in range(len(fixed)):
        if fixed[b]:
            scale = 0.0
            for a in range(6):
                scale = max(scale, diagonal[b, a, a])
            for a in range(6):
                force[b, a] = 0.0
                for c in range(6):
                    diagonal[b, a, c] = 0.0
                diagonal[b, a, a] = scale
    for q in range(len(pairs)):
        if fixed[pairs[q, 0]] or fixed[pairs[q, 1]]:
            for a in range(6):
                for c in range(6):
                    upper[q, a, c] = 0.0
                    lower[q, a, c] = 0.0


@kernel(fastmath=FMA)
def _motions(first, last, vertex_block, edge_block, rows, displacement, normal, tangent):
    """Write n.d and t.d of contacts ``first`` to ``last`` - 1."""
    n_own, n_other, t_own, t_other = rows
    for c in range(first, last):
        i, j = vertex_block[c], edge_block[c]
        along_n, along_t = 0.0, 0.0
        for k in range(6):
            own, other = displacement[i, k], displacement[j, k]
            along_n += n_own[c, k] * own + n_other[c, k] * other
            along_t += t_own[c, k] * own + t_other[c, k] * other
        normal[c], tangent[c] = along_n, along_t


@kernel(parallel=True)
def _motions_shared(vertex_block, edge_block, rows, displacement, normal, tangent):
    count = len(normal)
    for c in prange((count + PIECE - 1) // PIECE):
        last = min((c + 1) * PIECE, count)
        _motions(c * PIECE, last, vertex_block, edge_block, rows, displacement, normal, tangent)


@kernel()
def contact_motions(vertex_block, edge_block, rows, displacement):
    """Return n.d and t.d of every contact: how far it opens and slips by d (n, 6), m, (m,) each."""
    count = len(vertex_block)
    normal, tangent = np.empty(count), np.empty(count)
    if count >= MANY:
        _motions_shared(vertex_block, edge_block, rows, displacement, normal, tangent)
    else:
        _motions(0, count, vertex_block, edge_block, rows, displacement, normal, tangent)
    return normal, tangent


@kernel(fastmath=FMA)
def _balance_rows(low, high, base, d, load, fixed, graph, vertex_block, rows, normal, shear, out):
    """Write load - B d + sum of N n + T t of blocks ``low`` to ``high`` - 1; 0 where fixed."""
    start, right, left, listed = graph
    n_own, n_other, t_own, t_other = rows
    for i in range(low, high):
        for a in range(6):
            out[i, a] = 0.0
        if fixed[i]:
            continue
        for a in range(6):
            total = load[i, a]
            for b in range(6):
                total -= base[i, a, b] * d[i, b]
            out[i, a] = total
        for at in range(left[i], left[i + 1] + right[i + 1] - right[i]):
            of_left = at < left[i + 1]
            q = listed[at] if of_left else right[i] + at - left[i + 1]
            for c in range(start[q], start[q + 1]):
                if normal[c] == 0.0 and shear[c] == 0.0:
                    continue
                n, t = (n_own, t_own) if vertex_block[c] == i else (n_other, t_other)
                for a in range(6):
                    out[i, a] += normal[c] * n[c, a] + shear[c] * t[c, a]


@kernel(parallel=True)
def _balance_shared(base, d, load, fixed, graph, vertex_block, rows, normal, shear, out):
    for c in prange(chunks(len(d))):
        last = min((c + 1) * CHUNK, len(d))
        _balance_rows(
            c * CHUNK, last, base, d, load, fixed, graph, vertex_block, rows, normal, shear, out
        )


@kernel()
def unbalanced(base, d, load, fixed, graph, vertex_block, rows, normal, shear):
    """Return load - B d + sum of N n + T t (n, 6): what is out of balance; 0 for fixed blocks."""
    out = np.empty_like(d)
    if len(d) >= SHARED:
        _balance_shared(base, d, load, fixed, graph, vertex_block, rows, normal, shear, out)
    else:
        _balance_rows(
            0, len(d), base, d, load, fixed, graph, vertex_block, rows, normal, shear, out
        )
    return out


@kernel(fastmath=FMA)
def form(blocks, d):
    """Return the sum of d_i.B_i d_i over blocks B (n, 6, 6)."""
    total = 0.0
    for c in range(chunks(len(d))):
        part = 0.0
        for i in range(c * CHUNK, min((c + 1) * CHUNK, len(d))):
            for a in range(6):
                line = 0.0
                for b in range(6):
                    line += blocks[i, a, b] * d[i, b]
                part += line * d[i, a]
        total += part
    return total
