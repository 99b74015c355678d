"""The exact solution of a small system, block after block.

The block with the fewest neighbours is eliminated next (minimum degree; Tinney and Walker 1967):
chains and trees, which most small systems are, then have no fill.  Where a block comes to have more
than MOST neighbours, or there is too much fill, nothing is solved.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import invert, lines, times
from clast.compute.vec6 import (
    line,
    plus_product,
    plus_scaled,
    put_line,
    put_row,
    row,
    totals,
    zeros,
)
from clast.linear.block_products import multiply_into, subtract_product

MOST = 40
"""Neighbours of a block at most."""
ROOM = 10
"""Blocks above the diagonal for which there is room, for each one on it."""


@kernel()
def room_for(count):
    """Return room for the links of ``count`` blocks: how many each has, to whom, and by what."""
    degree = np.empty(count, np.int64)
    other, which = np.empty((count, MOST), np.int32), np.empty((count, MOST), np.int32)
    return degree, other, which, np.empty((ROOM * count, 6, 6)), np.zeros(1, np.int64)


@kernel()
def joined(i, j, links):
    """Return the number of the block that couples i and j, zero where it is new; -1: no room."""
    degree, other, which, blocks, used = links
    for k in range(degree[i]):
        if other[i, k] == j:
            return np.int64(which[i, k])
    at = used[0]
    if degree[i] == MOST or degree[j] == MOST or at == len(blocks):
        return -1
    used[0] += 1
    for a in range(6):
        put_line(blocks, at, a, zeros())
    other[i, degree[i]], which[i, degree[i]] = j, at
    other[j, degree[j]], which[j, degree[j]] = i, at
    degree[i] += 1
    degree[j] += 1
    return at


@kernel()
def _part(i, j, links):
    """Take j from the neighbours of i."""
    degree, other, which, _, _ = links
    last = degree[i] - 1
    for k in range(last):
        if other[i, k] == j:
            other[i, k], which[i, k] = other[i, last], which[i, last]
    degree[i] = last


@kernel()
def _take_row(i, links, of_row):
    """Write the blocks K_ij of block i as they stand in row i."""
    degree, other, which, blocks, _ = links
    for k in range(degree[i]):
        at = which[i, k]
        if i < other[i, k]:
            for a in range(6):
                put_line(of_row, k, a, line(blocks, at, a))
        else:
            for a in range(6):
                for b in range(6):
                    of_row[k, a, b] = blocks[at, b, a]


@kernel()
def _pass_on(i, links, of_row, own, force):
    """Take row i out of the rows of its neighbours; return False where there is no room."""
    degree, other, which, blocks, _ = links
    for k in range(degree[i]):
        j, at = other[i, k], which[i, k]
        subtract_product(blocks, at, of_row, k, own, j)
        s = row(force, j)
        for a in range(6):
            s = plus_scaled(s, -force[i, a], line(blocks, at, a))
        put_row(force, j, s)
        for later in range(k + 1, degree[i]):
            other_one = other[i, later]
            target = joined(j, other_one, links)
            if target < 0:
                return False
            if j < other_one:
                subtract_product(blocks, at, of_row, later, blocks, target)
            else:
                subtract_product(blocks, which[i, later], of_row, k, blocks, target)
    return True


@kernel(forceinline=True)
def _product(blocks, at, x):
    """Return block ``at``, which is not symmetric, times six numbers x."""
    k0, k1, k2, k3, k4, k5 = lines(blocks, at)
    return totals(
        plus_product(zeros(), k0, x),
        plus_product(zeros(), k1, x),
        plus_product(zeros(), k2, x),
        plus_product(zeros(), k3, x),
        plus_product(zeros(), k4, x),
        plus_product(zeros(), k5, x),
    )


@kernel()
def _put_back(order, links, own, force):
    """Write the unknowns in place of ``force``, from the last block eliminated to the first."""
    degree, other, which, blocks, _ = links
    for at in range(len(order) - 1, -1, -1):
        i = order[at]
        s = times(own, i, force, i)
        for k in range(degree[i]):
            s = plus_scaled(s, -1.0, _product(blocks, which[i, k], row(force, other[i, k])))
        put_row(force, i, s)


@kernel()
def _next(degree, left, place):
    """Return the place among the blocks left, ``place`` on, of the one with fewest neighbours."""
    best = place
    for at in range(place, len(left)):
        if degree[left[at]] < degree[left[best]]:
            best = at
            if degree[left[best]] <= 1:
                break
    return best


@kernel()
def solve(own, links, force):
    """Write the solution of K d = F in place of F (n, 6); return False where there is none.

    ``own`` (n, 6, 6) are the diagonal blocks, ``links`` the others, K_ij with i < j
    (:func:`room_for`); both are worked on in place.
    """
    degree, other, which, blocks, _ = links
    count = len(degree)
    order = np.arange(count)
    of_row, pivot = np.empty((MOST, 6, 6)), np.empty((1, 6, 6))
    for place in range(count):
        at = _next(degree, order, place)
        i = order[at]
        order[at], order[place] = order[place], i
        if not invert(own[i], pivot[0]):
            return False
        for a in range(6):
            put_line(own, i, a, line(pivot, 0, a))
        if degree[i] == 0:
            continue
        _take_row(i, links, of_row)
        for k in range(degree[i]):
            _part(other[i, k], i, links)
            multiply_into(pivot, 0, of_row, k, blocks, which[i, k])
        if not _pass_on(i, links, of_row, own, force):
            return False
    _put_back(order, links, own, force)
    return True
