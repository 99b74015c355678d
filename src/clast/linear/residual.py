"""The unbalanced forces on the blocks, with those of contacts, block by block."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import BLOCKS, shared
from clast.compute.vec6 import plus, plus_product, plus_scaled, put_row, row, total, zeros
from clast.contact.jacobian import force_on


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
def _balance(i, system, graph, contacts, d, normal, shear, found):
    """Write load - B d + sum of N n + T t of block i, and its r.B^-1 r; 0 where it is fixed."""
    base, inverse, load, fixed = system
    vertex_block, arms = contacts
    residual, distance = found
    if fixed[i]:
        put_row(residual, i, zeros())
        distance[i] = 0.0
    else:
        s = plus_scaled(row(load, i), -1.0, times(base, i, d, i))
        put_row(residual, i, _plus_forces(s, i, graph, vertex_block, arms, normal, shear))
        own = times(inverse, i, residual, i)
        distance[i] = total(plus_product(zeros(), own, row(residual, i)))


@shared(BLOCKS)
def _balance_rows(first, last, system, graph, contacts, d, forces, found):
    """Balance blocks."""
    normal, shear = forces
    for i in range(first, last):
        _balance(i, system, graph, contacts, d, normal, shear, found)


@kernel()
def unbalanced(system, graph, contacts, d, normal, shear):
    """Return r = load - B d + sum of N n + T t (n, 6) and r.B^-1 r of each block (n,).

    ``system`` are B and B^-1 (n, 6, 6), the load (n, 6) and which blocks are fixed (n,), for which
    both are 0; ``graph`` says which contacts they have, ``contacts`` are the vertex_block and
    arms of those, ``d`` (n, 6) the unknowns and ``normal`` and ``shear`` (m,) N and T.
    """
    found = np.empty_like(d), np.empty(len(d))
    _balance_rows(len(d), system, graph, contacts, d, (normal, shear), found)
    return found


@shared(BLOCKS)
def _balance_some(first, last, blocks, system, graph, contacts, at, found):
    """Balance some blocks."""
    d, normal, shear = at
    for k in range(first, last):
        _balance(blocks[k], system, graph, contacts, d, normal, shear, found)


@kernel()
def balance_again(blocks, system, graph, contacts, d, normal, shear, found):
    """Write the result of ``unbalanced`` where some ``blocks`` (k,) have changed, in place."""
    _balance_some(len(blocks), blocks, system, graph, contacts, (d, normal, shear), found)


@shared(BLOCKS)
def _left_rows(first, last, system, graph, contacts, starts, forces, left):
    """Write r.B^-1 r of blocks at each start: B is read once for all."""
    normal, shear = forces
    base, inverse, load, fixed = system
    vertex_block, arms = contacts
    residual = np.empty((1, 6))
    for i in range(first, last):
        for k in range(len(starts)):
            if fixed[i]:
                left[k, i] = 0.0
                continue
            s = plus_scaled(row(load, i), -1.0, times(base, i, starts[k], i))
            s = _plus_forces(s, i, graph, vertex_block, arms, normal[k], shear[k])
            put_row(residual, 0, s)
            own = times(inverse, i, residual, 0)
            left[k, i] = total(plus_product(zeros(), own, row(residual, 0)))


@kernel()
def left_at(system, graph, contacts, starts, normal, shear):
    """Return r.B^-1 r of each block (k, n), as ``unbalanced`` does, at k starts at once.

    ``starts`` (k, n, 6) are the unknowns, ``normal`` and ``shear`` (k, m) N and T there.
    """
    left = np.empty(starts.shape[:2])
    _left_rows(left.shape[1], system, graph, contacts, starts, (normal, shear), left)
    return left


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
