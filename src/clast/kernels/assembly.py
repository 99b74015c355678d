"""Contact contributions to the block system, in the order of the contacts (repeatable)."""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.block_rows import CHUNK, SHARED, chunks, row_pointers, times
from clast.kernels.compiled import kernel
from clast.kernels.levers import couple, finish_own, force_on, gather_own, relative_motion
from clast.kernels.shares import MANY, PART, parts
from clast.kernels.six import (
    line,
    plus,
    plus_product,
    plus_scaled,
    put_line,
    put_row,
    row,
    total,
    with_number,
    zeros,
)


@kernel()
def add_contacts(
    diagonal,
    upper,
    lower,
    force,
    pair,
    vertex_block,
    edge_block,
    rows,
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
            n[first, k], n[1 - first, k] = rows[c, 0, k], rows[c, 1, k]
            t[first, k], t[1 - first, k] = rows[c, 2, k], rows[c, 3, k]
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
def graph(count, pairs, pair):
    """Return the first contact of each pair, shape (q + 1,), and the rows of the ``pairs`` (q, 2).

    ``pair`` (m,) is the pair of each contact, in ascending order.  The rows are right, left and
    listed of ``count`` blocks (kernels/block_rows.py).
    """
    start = np.zeros(len(pairs) + 1, np.int64)
    for q in pair:
        start[q + 1] += 1
    for q in range(len(pairs)):
        start[q + 1] += start[q]
    right, left, listed = row_pointers(count, pairs)
    return start, right, left, listed


@kernel()
def _hold(i, base, own):
    """Write the equations d = 0 of a fixed block, of its own size, into block i."""
    scale = 0.0
    for a in range(6):
        scale = max(scale, base[i, a, a])
    for a in range(6):
        put_line(own, i, a, with_number(zeros(), a, scale))


@kernel()
def _assemble_rows(low, high, base, fixed, pairs, graph, vertex_block, levers, kn, ks, own, upper):
    """Assemble blocks ``low`` to ``high`` - 1 and the pairs that begin with them."""
    start, right, left, listed = graph
    moments = np.empty((1, 3, 6))
    for i in range(low, high):
        upper[right[i] : right[i + 1]] = 0.0
        if fixed[i]:
            _hold(i, base, own)
            continue
        for a in range(6):
            put_line(own, i, a, line(base, i, a))
        moments[:] = 0.0
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            gather_own(levers, i, start[q], start[q + 1], vertex_block, kn, ks, moments, own)
        # the pairs that begin with a block follow each other, and so do their contacts
        first, last = start[right[i]], start[right[i + 1]]
        gather_own(levers, i, first, last, vertex_block, kn, ks, moments, own)
        finish_own(levers, moments, own, i)
        for q in range(right[i], right[i + 1]):
            if not fixed[pairs[q, 1]]:
                couple(levers, i, q, start[q], start[q + 1], vertex_block, kn, ks, upper)


@kernel(parallel=True)
def _assemble_shared(base, fixed, pairs, graph, vertex_block, levers, kn, ks, own, upper):
    for c in prange(chunks(len(base))):
        last = min((c + 1) * CHUNK, len(base))
        _assemble_rows(
            c * CHUNK, last, base, fixed, pairs, graph, vertex_block, levers, kn, ks, own, upper
        )


@kernel()
def assemble(base, fixed, pairs, graph, vertex_block, levers, kn, ks, own, upper):
    """Write K with the contact springs in it: diagonal ``own`` (n, 6, 6), ``upper`` (q, 6, 6).

    ``base`` (n, 6, 6) is K without contacts; ``graph`` the first contact of each pair and
    the pairs of each block (see block_rows.row_pointers); ``levers`` what contacts are in the
    equations (kernels/levers.py).
    Blocks held fixed keep a diagonal of their own size and no couplings.  Every block sums up its
    own contacts in their order: threads can share the work.
    """
    if len(base) >= SHARED:
        _assemble_shared(base, fixed, pairs, graph, vertex_block, levers, kn, ks, own, upper)
    else:
        _assemble_rows(
            0, len(base), base, fixed, pairs, graph, vertex_block, levers, kn, ks, own, upper
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


@kernel()
def _motions(first, last, vertex_block, edge_block, levers, displacement, normal, tangent):
    """Write n.d and t.d of contacts ``first`` to ``last`` - 1."""
    for c in range(first, last):
        normal[c], tangent[c] = relative_motion(
            levers, c, displacement, vertex_block[c], edge_block[c]
        )


@kernel(parallel=True)
def _motions_shared(vertex_block, edge_block, levers, displacement, normal, tangent):
    count = len(normal)
    for part in prange(parts(count)):
        last = min((part + 1) * PART, count)
        _motions(part * PART, last, vertex_block, edge_block, levers, displacement, normal, tangent)


@kernel()
def contact_motions(vertex_block, edge_block, levers, displacement):
    """Return n.d and t.d of every contact: how far it opens and slips by d (n, 6), m, (m,) each."""
    count = len(vertex_block)
    normal, tangent = np.empty(count), np.empty(count)
    if count >= MANY:
        _motions_shared(vertex_block, edge_block, levers, displacement, normal, tangent)
    else:
        _motions(0, count, vertex_block, edge_block, levers, displacement, normal, tangent)
    return normal, tangent


@kernel(forceinline=True)
def _forces_on(i, first, last, vertex_block, levers, normal, shear):
    """Return the sum of N n + T t on block i of contacts ``first`` to ``last`` - 1."""
    s = zeros()
    for c in range(first, last):
        if normal[c] != 0.0 or shear[c] != 0.0:
            s = plus(s, force_on(levers, c, vertex_block[c] == i, normal[c], shear[c]))
    return s


@kernel()
def _balance_rows(low, high, base, d, load, fixed, graph, vertex_block, levers, normal, shear, out):
    """Write load - B d + sum of N n + T t of blocks ``low`` to ``high`` - 1; 0 where fixed."""
    start, right, left, listed = graph
    for i in range(low, high):
        if fixed[i]:
            put_row(out, i, zeros())
            continue
        s = plus_scaled(row(load, i), -1.0, times(base, i, d, i))
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            f = _forces_on(i, start[q], start[q + 1], vertex_block, levers, normal, shear)
            s = plus(s, f)
        # the pairs that begin with a block follow each other, and so do their contacts
        first, last = start[right[i]], start[right[i + 1]]
        f = _forces_on(i, first, last, vertex_block, levers, normal, shear)
        put_row(out, i, plus(s, f))


@kernel(parallel=True)
def _balance_shared(base, d, load, fixed, graph, vertex_block, levers, normal, shear, out):
    for c in prange(chunks(len(d))):
        last = min((c + 1) * CHUNK, len(d))
        _balance_rows(
            c * CHUNK, last, base, d, load, fixed, graph, vertex_block, levers, normal, shear, out
        )


@kernel()
def unbalanced(base, d, load, fixed, graph, vertex_block, levers, normal, shear):
    """Return load - B d + sum of N n + T t (n, 6): what is out of balance; 0 for fixed blocks."""
    out = np.empty_like(d)
    if len(d) >= SHARED:
        _balance_shared(base, d, load, fixed, graph, vertex_block, levers, normal, shear, out)
    else:
        _balance_rows(
            0, len(d), base, d, load, fixed, graph, vertex_block, levers, normal, shear, out
        )
    return out


@kernel()
def form(blocks, d):
    """Return the sum of d_i.B_i d_i over symmetric blocks B (n, 6, 6)."""
    product = 0.0
    for c in range(chunks(len(d))):
        s = zeros()
        for i in range(c * CHUNK, min((c + 1) * CHUNK, len(d))):
            s = plus_product(s, times(blocks, i, d, i), row(d, i))
        product += total(s)
    return product
