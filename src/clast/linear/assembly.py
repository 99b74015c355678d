"""Contact springs in the block system K d = F, in the order of the contacts (repeatable)."""

from __future__ import annotations

import numpy as np

from clast.block.displacement import weighted_squares
from clast.compute.jit import kernel
from clast.compute.mat6 import lines, put_lines, times
from clast.compute.parallel import BLOCKS, CONTACTS, shared, summed
from clast.compute.vec6 import plus, plus_product, put_line, row, total, with_number, zeros
from clast.contact.jacobian import couple, plus_moments, relative_motion
from clast.linear.block_matrix import row_pointers


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


@shared(CONTACTS)
def _find_stiff(first, last, fixed, pairs, start, kn, ks, stiff):
    """Write whether each pair has a contact with any stiffness."""
    for q in range(first, last):
        stiff[q] = False
        if not fixed[pairs[q, 0]] and not fixed[pairs[q, 1]]:
            for c in range(start[q], start[q + 1]):
                stiff[q] |= kn[c] != 0.0 or ks[c] != 0.0


@kernel()
def stiff_pairs(fixed, pairs, start, kn, ks):
    """Return whether contacts couple the blocks of each pair in K, shape (q,); fixed: never."""
    stiff = np.empty(len(pairs), np.bool_)
    _find_stiff(len(pairs), fixed, pairs, start, kn, ks, stiff)
    return stiff


@kernel(forceinline=True)
def assemble_own(i, base, graph, springs, own):
    """Write K_ii with the contact springs in it into block i of ``own``.

    ``springs`` are the contacts' vertex_block, arms, and stiffnesses against opening and slip.
    """
    start, right, left, listed = graph
    vertex_block, arms, kn, ks = springs
    moments = zeros(), zeros(), zeros()
    for at in range(left[i], left[i + 1]):
        q = listed[at]
        moments = plus_moments(moments, arms, i, start[q], start[q + 1], vertex_block, kn, ks)
    # the pairs that begin with a block follow each other, and so do their contacts
    first, last = start[right[i]], start[right[i + 1]]
    xx, xy, yy = plus_moments(moments, arms, i, first, last, vertex_block, kn, ks)
    k0, k1, k2, k3, k4, k5 = lines(base, i)
    s0, s1, s2, s3, s4, s5 = weighted_squares(xx, xy, yy)
    k0, k1, k2 = plus(k0, s0), plus(k1, s1), plus(k2, s2)
    put_lines(own, i, k0, k1, k2, plus(k3, s3), plus(k4, s4), plus(k5, s5))


@kernel(forceinline=True)
def assemble_coupling(i, q, start, springs, upper):
    """Write K_ij of pair q, which begins with block i, from its contact springs."""
    vertex_block, arms, kn, ks = springs
    for a in range(6):
        put_line(upper, q, a, zeros())
    couple(arms, i, q, start[q], start[q + 1], vertex_block, kn, ks, upper)


@kernel()
def _hold(i, base, own):
    """Write the equations d = 0 of a fixed block, of its own size (or 1), into block i."""
    scale = 0.0
    for a in range(6):
        scale = max(scale, base[i, a, a])
    for a in range(6):
        put_line(own, i, a, with_number(zeros(), a, scale if scale > 0.0 else 1.0))


@shared(BLOCKS)
def _assemble_rows(first, last, blocks, graph, springs, stiff, own, upper):
    """Write K_ii of each block and K_ij of the pairs that begin with it."""
    base, fixed = blocks
    start, right, _, _ = graph
    for i in range(first, last):
        if fixed[i]:
            _hold(i, base, own)
        else:
            assemble_own(i, base, graph, springs, own)
        for q in range(right[i], right[i + 1]):
            if stiff[q]:
                assemble_coupling(i, q, start, springs, upper)
            else:
                for a in range(6):
                    put_line(upper, q, a, zeros())


@kernel()
def assemble(base, fixed, pairs, graph, springs):
    """Return K_ii (n, 6, 6) and K_ij (q, 6, 6) with the contact springs in them.

    ``base`` (n, 6, 6) is K without contacts; ``graph`` the first contact of each pair and the rows
    of the pairs.  ``springs`` are the contacts' vertex_block, arms (contact/jacobian.py), and
    stiffnesses against opening and slip.  Blocks held fixed keep a diagonal of their own size and
    no couplings.  Every block sums up its own contacts in their order: threads share the work.
    """
    own, upper = np.empty_like(base), np.empty((len(pairs), 6, 6))
    stiff = stiff_pairs(fixed, pairs, graph[0], springs[2], springs[3])
    _assemble_rows(len(base), (base, fixed), graph, springs, stiff, own, upper)
    return own, upper


@shared(CONTACTS)
def _motions(first, last, ends, arms, displacement, normal, tangent):
    """Write n.d and t.d of each contact."""
    vertex_block, edge_block = ends
    for c in range(first, last):
        normal[c], tangent[c] = relative_motion(
            arms, c, displacement, vertex_block[c], edge_block[c]
        )


@kernel()
def contact_motions(vertex_block, edge_block, arms, displacement):
    """Return n.d and t.d of every contact: how far it opens and slips by d (n, 6), m, (m,) each."""
    count = len(vertex_block)
    normal, tangent = np.empty(count), np.empty(count)
    _motions(count, (vertex_block, edge_block), arms, displacement, normal, tangent)
    return normal, tangent


@summed(BLOCKS)
def _form(first, last, blocks, d):
    """Return the part of the sum of d_i.B_i d_i that rows ``first`` to ``last`` - 1 have."""
    s = zeros()
    for i in range(first, last):
        s = plus_product(s, times(blocks, i, d, i), row(d, i))
    return total(s)


@kernel()
def form(blocks, d):
    """Return the sum of d_i.B_i d_i over symmetric blocks B (n, 6, 6)."""
    return _form(len(d), blocks, d)
