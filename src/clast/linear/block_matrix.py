"""Products with a symmetric matrix of 6 x 6 blocks, row by row.

Only K_ij with i < j is kept.  Row i takes its blocks right of the diagonal as they stand (pairs
sorted by row: they follow each other in memory) and those left of it as transposes.  No row writes
to another one, so that rows can be worked on at the same time, and every sum has a fixed order:
answers do not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import entries, invert, lines, lines_times, plus_lines, times
from clast.compute.parallel import BLOCKS, CONTACTS, shared, summed
from clast.compute.vec6 import (
    line,
    plus,
    plus_product,
    put_line,
    put_row,
    row,
    total,
    zeros,
)


@kernel()
def row_pointers(count, pairs):
    """Return where each row finds its pairs (q, 2), which are sorted.

    ``right`` (n + 1,): the pairs (i, .) of row i are right[i] to right[i + 1] - 1.  ``left``
    (n + 1,) and ``listed`` (q,): the pairs (., i), listed by their other block.  All are integers
    of the kind that ``pairs`` has.
    """
    right = np.zeros(count + 1, pairs.dtype)
    left = np.zeros(count + 1, pairs.dtype)
    for q in range(len(pairs)):
        right[pairs[q, 0] + 1] += 1
        left[pairs[q, 1] + 1] += 1
    for i in range(count):
        right[i + 1] += right[i]
        left[i + 1] += left[i]
    at = left[:-1].copy()
    listed = np.empty(len(pairs), pairs.dtype)
    for q in range(len(pairs)):
        listed[at[pairs[q, 1]]] = q
        at[pairs[q, 1]] += 1
    return right, left, listed


@kernel(forceinline=True)
def transpose_times(blocks, q, x, j):
    """Return the transpose of block q times row j of x (n, 6)."""
    return plus_lines(zeros(), entries(x, j), lines(blocks, q))


@shared(BLOCKS)
def _multiply(first, last, matrix, pairs, rows, x, y):
    """Write rows of K x into y."""
    diagonal, upper = matrix
    right, left, listed = rows
    for i in range(first, last):
        s = times(diagonal, i, x, i)
        for at in range(left[i], left[i + 1]):
            s = plus(s, transpose_times(upper, listed[at], x, pairs[listed[at], 0]))
        for q in range(right[i], right[i + 1]):
            s = plus(s, lines_times(lines(upper, q), row(x, pairs[q, 1])))
        put_row(y, i, s)


@kernel()
def multiply(diagonal, upper, pairs, rows, x):
    """Return K x (n, 6) of a symmetric matrix, in double precision."""
    y = np.empty_like(x)
    _multiply(len(x), (diagonal, upper), pairs, rows, x, y)
    return y


@shared(BLOCKS)
def _products(first, last, blocks, x, y):
    """Write B_i x_i into y_i."""
    for i in range(first, last):
        put_row(y, i, times(blocks, i, x, i))


@kernel()
def products(blocks, x):
    """Return B_i x_i (n, 6) of symmetric blocks B (n, 6, 6)."""
    y = np.empty_like(x)
    _products(len(x), blocks, x, y)
    return y


@shared(BLOCKS)
def _take(first, last, blocks, which, chosen):
    """Write the blocks ``which``."""
    for k in range(first, last):
        for a in range(6):
            put_line(chosen, k, a, line(blocks, which[k], a))


@kernel()
def taken(blocks, which):
    """Return the blocks ``which`` (k,) of blocks (n, 6, 6)."""
    chosen = np.empty((len(which), 6, 6))
    _take(len(which), blocks, which, chosen)
    return chosen


@summed(BLOCKS)
def _dot(first, last, a, b):
    """Return the part of a.b that rows ``first`` to ``last`` - 1 have."""
    s = zeros()
    for i in range(first, last):
        s = plus_product(s, row(a, i), row(b, i))
    return total(s)


@kernel()
def dot(a, b):
    """Return a.b of two vectors (n, 6)."""
    return _dot(len(a), a, b)


@shared(BLOCKS)
def _invert(first, last, diagonal, inverse, definite):
    """Write the inverses of blocks, and which of them are positive definite."""
    for b in range(first, last):
        definite[b] = invert(diagonal[b], inverse[b])


@kernel()
def inverse_blocks(diagonal):
    """Return the inverses (n, 6, 6) of symmetric blocks, and the first not definite or -1."""
    inverse, definite = np.empty_like(diagonal), np.empty(len(diagonal), np.bool_)
    _invert(len(diagonal), diagonal, inverse, definite)
    for b in range(len(definite)):
        if not definite[b]:
            return inverse, b
    return inverse, -1


@shared(CONTACTS)
def _find_coupled(first, last, upper, coupled):
    """Write which blocks have any number that is not zero."""
    for q in range(first, last):
        coupled[q] = False
        for a in range(6):
            for c in range(6):
                if upper[q, a, c] != 0.0:
                    coupled[q] = True
                    break
            if coupled[q]:
                break


@kernel()
def coupled_pairs(upper):
    """Return whether the blocks of each pair are coupled at all, shape (q,)."""
    coupled = np.empty(len(upper), np.bool_)
    _find_coupled(len(upper), upper, coupled)
    return coupled


@shared(BLOCKS)
def _left_over(first, last, diagonal, upper, rows, coupled, sums):
    """Write the translational stiffness of blocks, its remainder, and its share (n, 3).

    The remainder is K_ii + sum of K_ij, its translations alone; its share is that in the weakest
    direction.  Blocks that are coupled to none have 0, 0 and 1.
    """
    right, left, listed = rows
    for i in range(first, last):
        xx, xy, yy = diagonal[i, 0, 0], diagonal[i, 0, 1], diagonal[i, 1, 1]
        whole, alone = xx + yy, True
        for q in range(right[i], right[i + 1]):
            if coupled[q]:
                xx, xy, yy = xx + upper[q, 0, 0], xy + upper[q, 0, 1], yy + upper[q, 1, 1]
                alone = False
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            if coupled[q]:
                xx, xy, yy = xx + upper[q, 0, 0], xy + upper[q, 1, 0], yy + upper[q, 1, 1]
                alone = False
        # the smaller eigenvalue of (xx, xy; xy, yy), twice
        smaller = xx + yy - np.sqrt((xx - yy) ** 2 + 4.0 * xy**2)
        sums[i, 0] = 0.0 if alone else whole
        sums[i, 1] = 0.0 if alone else xx + yy
        sums[i, 2] = 1.0 if alone else smaller / whole if whole > 0.0 else 0.0


@kernel()
def inertia_shares(diagonal, upper, rows, coupled):
    """Return which share of their stiffness against translation couplings leave to the blocks.

    Of all coupled blocks together and the least of any, in its weakest direction; 1 where none is
    coupled.  ``rows`` are right, left and listed of the pairs (``row_pointers``), ``coupled``
    (q,) says which are coupled at all.
    """
    sums = np.empty((len(diagonal), 3))
    _left_over(len(diagonal), diagonal, upper, rows, coupled, sums)
    whole, rest = sums[:, 0].sum(), sums[:, 1].sum()
    return (rest / whole if whole > 0.0 else 1.0), sums[:, 2].min()
