"""The block system K d = F and its unbalanced forces, in the order of the contacts (repeatable)."""

from __future__ import annotations

import numpy as np

from clast.block.displacement import weighted_squares
from clast.compute.jit import kernel
from clast.compute.mat6 import lines, plus_each, put_lines, times
from clast.compute.parallel import BLOCKS, CONTACTS, shared, summed
from clast.compute.vec6 import (
    inner,
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
from clast.contact.jacobian import couple, force_on, plus_moments, relative_motion
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
    put_lines(own, i, plus_each(lines(base, i), weighted_squares(xx, xy, yy)))


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


@kernel(forceinline=True)
def _forces_on(i, first, last, vertex_block, arms, normal, shear):
    """Return the sum of N n + T t on block i of contacts ``first`` to ``last`` - 1."""
    s = zeros()
    for c in range(first, last):
        if normal[c] != 0.0 or shear[c] != 0.0:
            s = plus(s, force_on(arms, c, vertex_block[c] == i, normal[c], shear[c]))
    return s


@kernel(forceinline=True)
def _plus_forces(s, i, graph, vertex_block, arms, normal, shear):
    """Return s plus the sum of N n + T t on block i."""
    start, right, left, listed = graph
    for at in range(left[i], left[i + 1]):
        q = listed[at]
        s = plus(s, _forces_on(i, start[q], start[q + 1], vertex_block, arms, normal, shear))
    # the pairs that begin with a block follow each other, and so do their contacts
    first, last = start[right[i]], start[right[i + 1]]
    return plus(s, _forces_on(i, first, last, vertex_block, arms, normal, shear))


@kernel(forceinline=True)
def _balance(i, system, graph, contacts, d, normal, shear, balance):
    """Write load - B d + sum of N n + T t of block i, and its r.B^-1 r; 0 where it is fixed."""
    base, inverse, load, fixed = system
    vertex_block, arms = contacts
    residual, distance = balance
    if fixed[i]:
        put_row(residual, i, zeros())
        distance[i] = 0.0
    else:
        s = plus_scaled(row(load, i), -1.0, times(base, i, d, i))
        put_row(residual, i, _plus_forces(s, i, graph, vertex_block, arms, normal, shear))
        own = times(inverse, i, residual, i)
        distance[i] = inner(own, row(residual, i))


@shared(BLOCKS)
def balance_rows(first, last, system, graph, contacts, d, forces, balance):
    """Balance blocks."""
    normal, shear = forces
    for i in range(first, last):
        _balance(i, system, graph, contacts, d, normal, shear, balance)


@kernel()
def unbalanced(system, graph, contacts, d, normal, shear):
    """Return r = load - B d + sum of N n + T t (n, 6) and r.B^-1 r of each block (n,).

    ``system`` are B and B^-1 (n, 6, 6), the load (n, 6) and which blocks are fixed (n,), for which
    both are 0; ``graph`` says which contacts they have, ``contacts`` are the vertex_block and
    arms of those, ``d`` (n, 6) the unknowns and ``normal`` and ``shear`` (m,) N and T.
    """
    balance = np.empty_like(d), np.empty(len(d))
    balance_rows(len(d), system, graph, contacts, d, (normal, shear), balance)
    return balance


@shared(BLOCKS)
def _balance_some(first, last, blocks, system, graph, contacts, at, balance):
    """Balance some blocks."""
    d, normal, shear = at
    for k in range(first, last):
        _balance(blocks[k], system, graph, contacts, d, normal, shear, balance)


@kernel()
def balance_again(blocks, system, graph, contacts, d, normal, shear, balance):
    """Write the result of ``unbalanced`` where some ``blocks`` (k,) have changed, in place."""
    _balance_some(len(blocks), blocks, system, graph, contacts, (d, normal, shear), balance)


@shared(BLOCKS)
def _load_rows(first, last, load, fixed, graph, contacts, forces, out):
    """Write load + sum of N n + T t of blocks; 0 where fixed."""
    vertex_block, arms = contacts
    normal, shear = forces
    for i in range(first, last):
        if fixed[i]:
            put_row(out, i, zeros())
        else:
            s = _plus_forces(row(load, i), i, graph, vertex_block, arms, normal, shear)
            put_row(out, i, s)


@kernel()
def loaded(load, fixed, graph, vertex_block, arms, normal, shear):
    """Return load + sum of N n + T t (n, 6): forces with those of contacts; 0 for fixed blocks."""
    out = np.empty_like(load)
    _load_rows(len(load), load, fixed, graph, (vertex_block, arms), (normal, shear), out)
    return out
