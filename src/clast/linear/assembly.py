"""Contact contributions to the block system, in the order of the contacts (repeatable)."""

from __future__ import annotations

import numpy as np

from clast.block.displacement import weighted_squares
from clast.compute.chunks import CHUNK, MANY, PART, SHARED, chunks, parts
from clast.compute.jit import kernel
from clast.compute.mat6 import lines, put_lines, times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import plus, plus_product, put_line, row, total, with_number, zeros
from clast.contact.jacobian import couple, plus_moments, relative_motion, stiffness_of
from clast.linear.block_matrix import row_pointers


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
    listed of ``count`` blocks (linear/block_matrix.py).
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
def _find_stiff(first, last, fixed, pairs, start, kn, ks, stiff):
    """Write whether the pairs ``first`` to ``last`` - 1 have a contact with any stiffness."""
    for q in range(first, last):
        stiff[q] = False
        if not fixed[pairs[q, 0]] and not fixed[pairs[q, 1]]:
            for c in range(start[q], start[q + 1]):
                stiff[q] |= kn[c] != 0.0 or ks[c] != 0.0


@kernel(parallel=True)
def _find_stiff_shared(fixed, pairs, start, kn, ks, stiff):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(pairs))):
            last = min((part + 1) * PART, len(pairs))
            _find_stiff(part * PART, last, fixed, pairs, start, kn, ks, stiff)


@kernel()
def stiff_pairs(fixed, pairs, start, kn, ks):
    """Return whether contacts couple the blocks of each pair in K, shape (q,); fixed: never."""
    stiff = np.empty(len(pairs), np.bool_)
    if len(pairs) >= MANY:
        _find_stiff_shared(fixed, pairs, start, kn, ks, stiff)
    else:
        _find_stiff(0, len(pairs), fixed, pairs, start, kn, ks, stiff)
    return stiff


@kernel(forceinline=True)
def _stiffness_against(held, q, start, levers, kn, ks):
    """Return ``held`` = (xx, xy, yy) and what the contacts of pair q add to it, N/m."""
    xx, xy, yy = held
    for c in range(start[q], start[q + 1]):
        kxx, kxy, kyy = stiffness_of(levers, c, kn, ks)
        xx, xy, yy = xx + kxx, xy + kxy, yy + kyy
    return xx, xy, yy


@kernel()
def _left_over(i, base, own, fixed, pairs, stiff, graph, levers, kn, ks):
    """Return the translational stiffness of block i, what couplings leave of it, and its share.

    Its share is that in the weakest direction.  A translation of all blocks together moves no
    contact between two free ones: what is left is K without contacts and those with fixed blocks.
    """
    start, right, left, listed = graph
    held, coupled = (base[i, 0, 0], base[i, 0, 1], base[i, 1, 1]), False
    for q in range(right[i], right[i + 1]):
        coupled |= stiff[q]
        if fixed[pairs[q, 1]]:
            held = _stiffness_against(held, q, start, levers, kn, ks)
    for at in range(left[i], left[i + 1]):
        q = listed[at]
        coupled |= stiff[q]
        if fixed[pairs[q, 0]]:
            held = _stiffness_against(held, q, start, levers, kn, ks)
    if not coupled:
        return 0.0, 0.0, 1.0
    xx, xy, yy = held
    whole = own[i, 0, 0] + own[i, 1, 1]
    # the smaller eigenvalue of (xx, xy; xy, yy), twice
    smaller = xx + yy - np.sqrt((xx - yy) ** 2 + 4.0 * xy**2)
    return whole, xx + yy, smaller / whole if whole > 0.0 else 0.0


@kernel(forceinline=True)
def assemble_own(i, base, graph, vertex_block, levers, kn, ks, own):
    """Write K_ii with the contact springs in it into block i of ``own``."""
    start, right, left, listed = graph
    moments = zeros(), zeros(), zeros()
    for at in range(left[i], left[i + 1]):
        q = listed[at]
        moments = plus_moments(moments, levers, i, start[q], start[q + 1], vertex_block, kn, ks)
    # the pairs that begin with a block follow each other, and so do their contacts
    first, last = start[right[i]], start[right[i + 1]]
    xx, xy, yy = plus_moments(moments, levers, i, first, last, vertex_block, kn, ks)
    k0, k1, k2, k3, k4, k5 = lines(base, i)
    s0, s1, s2, s3, s4, s5 = weighted_squares(xx, xy, yy)
    k0, k1, k2 = plus(k0, s0), plus(k1, s1), plus(k2, s2)
    put_lines(own, i, k0, k1, k2, plus(k3, s3), plus(k4, s4), plus(k5, s5))


@kernel()
def _own_rows(low, high, base, fixed, pairs, stiff, graph, vertex_block, levers, kn, ks, own):
    """Assemble K_ii of blocks ``low`` to ``high`` - 1; return what ``_left_over`` sums up to."""
    whole, rest, least = 0.0, 0.0, 1.0
    for i in range(low, high):
        if fixed[i]:
            _hold(i, base, own)
            continue
        assemble_own(i, base, graph, vertex_block, levers, kn, ks, own)
        found = _left_over(i, base, own, fixed, pairs, stiff, graph, levers, kn, ks)
        whole, rest, least = whole + found[0], rest + found[1], min(least, found[2])
    return whole, rest, least


@kernel(parallel=True)
def _own_shared(base, fixed, pairs, stiff, graph, vertex_block, levers, kn, ks, own):
    found = np.empty((chunks(len(base)), 3))
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(found)):
            last = min((c + 1) * CHUNK, len(base))
            found[c, 0], found[c, 1], found[c, 2] = _own_rows(
                c * CHUNK, last, base, fixed, pairs, stiff, graph, vertex_block, levers, kn, ks, own
            )
    return found


@kernel()
def assemble(base, fixed, pairs, graph, vertex_block, levers, kn, ks, own):
    """Write K_ii with the contact springs in it into ``own`` (n, 6, 6); return what couples blocks.

    ``base`` (n, 6, 6) is K without contacts; ``graph`` the first contact of each pair and
    the pairs of each block (see block_rows.row_pointers); ``levers`` what contacts are in the
    equations (contact/jacobian.py).  Returned are the pairs that are coupled at all (q,), and which
    share of their stiffness against translation couplings leave to the blocks, to all coupled ones
    together and to the one with the least, in its weakest direction; 1 where none is coupled.
    Blocks held fixed keep a diagonal of their own size and no couplings.  Every block sums up its
    own contacts in their order: threads can share the work.
    """
    stiff = stiff_pairs(fixed, pairs, graph[0], kn, ks)
    if len(base) < SHARED:
        whole, rest, least = _own_rows(
            0, len(base), base, fixed, pairs, stiff, graph, vertex_block, levers, kn, ks, own
        )
    else:
        whole, rest, least = 0.0, 0.0, 1.0
        for part in _own_shared(
            base, fixed, pairs, stiff, graph, vertex_block, levers, kn, ks, own
        ):
            whole, rest, least = whole + part[0], rest + part[1], min(least, part[2])
    return stiff, rest / whole if whole > 0.0 else 1.0, least


@kernel()
def _couple_rows(low, high, stiff, graph, vertex_block, levers, kn, ks, upper):
    """Assemble K_ij of the pairs that begin with blocks ``low`` to ``high`` - 1."""
    start, right, _, _ = graph
    for i in range(low, high):
        for q in range(right[i], right[i + 1]):
            for a in range(6):
                put_line(upper, q, a, zeros())
            if stiff[q]:
                couple(levers, i, q, start[q], start[q + 1], vertex_block, kn, ks, upper)


@kernel(parallel=True)
def _couple_shared(stiff, graph, vertex_block, levers, kn, ks, upper):
    count = len(graph[1]) - 1
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(count)):
            last = min((c + 1) * CHUNK, count)
            _couple_rows(c * CHUNK, last, stiff, graph, vertex_block, levers, kn, ks, upper)


@kernel()
def assemble_couplings(stiff, graph, vertex_block, levers, kn, ks, upper):
    """Write K_ij of all pairs into ``upper`` (q, 6, 6), in its precision; 0 where not ``stiff``."""
    count = len(graph[1]) - 1
    if count >= SHARED:
        _couple_shared(stiff, graph, vertex_block, levers, kn, ks, upper)
    else:
        _couple_rows(0, count, stiff, graph, vertex_block, levers, kn, ks, upper)


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
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(count)):
            last = min((part + 1) * PART, count)
            _motions(
                part * PART, last, vertex_block, edge_block, levers, displacement, normal, tangent
            )


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


@kernel()
def _form_rows(first, last, blocks, d):
    s = zeros()
    for i in range(first, last):
        s = plus_product(s, times(blocks, i, d, i), row(d, i))
    return total(s)


@kernel(parallel=True)
def _form_shared(blocks, d, products):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(products)):
            products[c] = _form_rows(c * CHUNK, min((c + 1) * CHUNK, len(d)), blocks, d)


@kernel()
def form(blocks, d):
    """Return the sum of d_i.B_i d_i over symmetric blocks B (n, 6, 6)."""
    products = np.empty(chunks(len(d)))
    if len(d) >= SHARED:
        _form_shared(blocks, d, products)
    else:
        for c in range(len(products)):
            products[c] = _form_rows(c * CHUNK, min((c + 1) * CHUNK, len(d)), blocks, d)
    product = 0.0
    for part in products:
        product += part
    return product
