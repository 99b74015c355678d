"""Products with a symmetric matrix of 6 x 6 blocks, row by row.

Only K_ij with i < j is kept.  Row i takes its blocks right of the diagonal as they stand (pairs
sorted by row: they follow each other in memory) and those left of it as transposes.  No row writes
to another one, so that rows can be worked on at the same time, and every sum has a fixed order:
answers do not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import CHUNK, SHARED, chunks
from clast.compute.jit import kernel, overload, types
from clast.compute.mat6 import invert, times
from clast.compute.parallel import nothing_done, prange, threads_of, to_do
from clast.compute.vec6 import (
    line,
    plus,
    plus_product,
    plus_scaled,
    put_line,
    put_row,
    row,
    total,
    totals,
    zeros,
)
from clast.linear import single_rows


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
def right_of(low, high, upper, pairs, x):
    """Return the sum of K_ij x_j over the pairs ``low`` to ``high`` - 1, those of a row i."""
    t0, t1, t2, t3, t4, t5 = zeros(), zeros(), zeros(), zeros(), zeros(), zeros()
    for q in range(low, high):
        other = row(x, pairs[q, 1])
        t0 = plus_product(t0, line(upper, q, 0), other)
        t1 = plus_product(t1, line(upper, q, 1), other)
        t2 = plus_product(t2, line(upper, q, 2), other)
        t3 = plus_product(t3, line(upper, q, 3), other)
        t4 = plus_product(t4, line(upper, q, 4), other)
        t5 = plus_product(t5, line(upper, q, 5), other)
    return totals(t0, t1, t2, t3, t4, t5)


@kernel(forceinline=True)
def left_of(low, high, listed, upper, pairs, x):
    """Return the sum of K_ji^T x_j over the pairs listed ``low`` to ``high`` - 1 of a row i.

    Three sums side by side: one addition need not wait for the one before.
    """
    s0, s1, s2 = zeros(), zeros(), zeros()
    for at in range(low, high):
        q = listed[at]
        j = pairs[q, 0]
        s0 = plus_scaled(s0, x[j, 0], line(upper, q, 0))
        s1 = plus_scaled(s1, x[j, 1], line(upper, q, 1))
        s2 = plus_scaled(s2, x[j, 2], line(upper, q, 2))
        s0 = plus_scaled(s0, x[j, 3], line(upper, q, 3))
        s1 = plus_scaled(s1, x[j, 4], line(upper, q, 4))
        s2 = plus_scaled(s2, x[j, 5], line(upper, q, 5))
    return plus(plus(s0, s1), s2)


@kernel()
def _multiply_rows(first, last, diagonal, upper, pairs, right, left, listed, x, y):
    """Write rows ``first`` to ``last`` - 1 of K x into y and return their part of x.K x."""
    product = 0.0
    for i in range(first, last):
        own = row(x, i)
        y_i = plus(times(diagonal, i, x, i), left_of(left[i], left[i + 1], listed, upper, pairs, x))
        y_i = plus(y_i, right_of(right[i], right[i + 1], upper, pairs, x))
        put_row(y, i, y_i)
        product += total(plus_product(zeros(), own, y_i))
    return product


@kernel(parallel=True)
def _multiply_shared(diagonal, upper, pairs, right, left, listed, x, y):
    parts = np.empty(chunks(len(x)))
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(parts)):
            last = min((c + 1) * CHUNK, len(x))
            parts[c] = _multiply_rows(
                c * CHUNK, last, diagonal, upper, pairs, right, left, listed, x, y
            )
    return parts


@kernel()
def _multiply_double(diagonal, upper, pairs, right, left, listed, x, y):
    if len(x) >= SHARED:
        parts = _multiply_shared(diagonal, upper, pairs, right, left, listed, x, y)
    else:
        parts = np.empty(chunks(len(x)))
        for c in range(len(parts)):
            last = min((c + 1) * CHUNK, len(x))
            parts[c] = _multiply_rows(
                c * CHUNK, last, diagonal, upper, pairs, right, left, listed, x, y
            )
    product = 0.0
    for part in parts:
        product += part
    return product


def _multiply(diagonal, upper, pairs, right, left, listed, x, y):
    """Stand for the product in the precision of x."""


@overload(_multiply)
def _multiply_of(diagonal, upper, pairs, right, left, listed, x, y):
    def in_single(diagonal, upper, pairs, right, left, listed, x, y):
        return single_rows.multiply(SHARED, diagonal, upper, pairs, right, left, listed, x, y)

    def in_double(diagonal, upper, pairs, right, left, listed, x, y):
        return _multiply_double(diagonal, upper, pairs, right, left, listed, x, y)

    return in_single if x.dtype == types.float32 else in_double


@kernel()
def multiply(diagonal, upper, pairs, right, left, listed, x, y):
    """Write K x into y and return x.K x.

    x and y are (n, 6) in double precision, or (n, 8) in single (compute/vec6_single.py); K
    then is in single precision as well.
    """
    return _multiply(diagonal, upper, pairs, right, left, listed, x, y)


@kernel()
def _products(first, last, blocks, x, y):
    """Write B_i x_i into y_i for rows ``first`` to ``last`` - 1."""
    for i in range(first, last):
        put_row(y, i, times(blocks, i, x, i))


@kernel(parallel=True)
def _products_shared(blocks, x, y):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(x))):
            _products(c * CHUNK, min((c + 1) * CHUNK, len(x)), blocks, x, y)


@kernel()
def products(blocks, x):
    """Return B_i x_i (n, 6) of symmetric blocks B (n, 6, 6)."""
    y = np.empty_like(x)
    if len(x) >= SHARED:
        _products_shared(blocks, x, y)
    else:
        _products(0, len(x), blocks, x, y)
    return y


@kernel()
def _take(first, last, blocks, which, found):
    for k in range(first, last):
        for a in range(6):
            put_line(found, k, a, line(blocks, which[k], a))


@kernel(parallel=True)
def _take_shared(blocks, which, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(which))):
            _take(c * CHUNK, min((c + 1) * CHUNK, len(which)), blocks, which, found)


@kernel()
def taken(blocks, which):
    """Return the blocks ``which`` (k,) of blocks (n, 6, 6)."""
    found = np.empty((len(which), 6, 6))
    if len(which) >= SHARED:
        _take_shared(blocks, which, found)
    else:
        _take(0, len(which), blocks, which, found)
    return found


@kernel()
def _dot_rows(first, last, a, b):
    """Return the part of a.b of rows ``first`` to ``last`` - 1."""
    s = zeros()
    for i in range(first, last):
        s = plus_product(s, row(a, i), row(b, i))
    return total(s)


@kernel(parallel=True)
def _dot_shared(a, b):
    parts = np.empty(chunks(len(a)))
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(parts)):
            parts[c] = _dot_rows(c * CHUNK, min((c + 1) * CHUNK, len(a)), a, b)
    return parts


@kernel()
def dot(a, b):
    """Return a.b of two vectors (n, 6), chunk by chunk."""
    product = 0.0
    if len(a) >= SHARED:
        for part in _dot_shared(a, b):
            product += part
        return product
    for c in range(chunks(len(a))):
        product += _dot_rows(c * CHUNK, min((c + 1) * CHUNK, len(a)), a, b)
    return product


@kernel()
def _invert_rows(first, last, diagonal, inverse):
    """Invert blocks ``first`` to ``last`` - 1; return the first that is not definite, or -1."""
    for b in range(first, last):
        if not invert(diagonal[b], inverse[b]):
            return b
    return -1


@kernel(parallel=True)
def _invert_shared(diagonal, inverse, bad):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(bad)):
            last = min((c + 1) * CHUNK, len(diagonal))
            bad[c] = _invert_rows(c * CHUNK, last, diagonal, inverse)


@kernel()
def inverse_blocks(diagonal):
    """Return the inverses (n, 6, 6) of symmetric blocks, and the first not definite or -1."""
    inverse = np.empty_like(diagonal)
    if len(diagonal) < SHARED:
        return inverse, _invert_rows(0, len(diagonal), diagonal, inverse)
    bad = np.empty(chunks(len(diagonal)), np.int64)
    _invert_shared(diagonal, inverse, bad)
    for b in bad:
        if b >= 0:
            return inverse, b
    return inverse, -1


@kernel()
def _left_over(first, last, diagonal, upper, right, left, listed):
    """Return the translational stiffness of coupled rows, what is left of it, and the least share.

    Of rows ``first`` to ``last`` - 1.  What is left is K_ii + sum of K_ij, its translations alone.
    """
    own, rest, least = 0.0, 0.0, 1.0
    for i in range(first, last):
        xx, xy, yy = 0.0, 0.0, 0.0
        coupled = False
        for q in range(right[i], right[i + 1]):
            xx, xy, yy = xx + upper[q, 0, 0], xy + upper[q, 0, 1], yy + upper[q, 1, 1]
            coupled |= upper[q, 0, 0] != 0.0 or upper[q, 0, 1] != 0.0 or upper[q, 1, 1] != 0.0
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            xx, xy, yy = xx + upper[q, 0, 0], xy + upper[q, 1, 0], yy + upper[q, 1, 1]
            coupled |= upper[q, 0, 0] != 0.0 or upper[q, 1, 0] != 0.0 or upper[q, 1, 1] != 0.0
        if not coupled:
            continue
        stiffness = diagonal[i, 0, 0] + diagonal[i, 1, 1]
        xx, xy, yy = xx + diagonal[i, 0, 0], xy + diagonal[i, 0, 1], yy + diagonal[i, 1, 1]
        own += stiffness
        rest += xx + yy
        # the smaller eigenvalue of (xx, xy; xy, yy), twice
        smaller = xx + yy - np.sqrt((xx - yy) ** 2 + 4.0 * xy**2)
        least = min(least, smaller / stiffness if stiffness > 0.0 else 0.0)
    return own, rest, least


@kernel(parallel=True)
def _left_over_shared(diagonal, upper, right, left, listed):
    found = np.empty((chunks(len(diagonal)), 3))
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(found)):
            last = min((c + 1) * CHUNK, len(diagonal))
            found[c, 0], found[c, 1], found[c, 2] = _left_over(
                c * CHUNK, last, diagonal, upper, right, left, listed
            )
    return found


@kernel()
def inertia_shares(diagonal, upper, rows):
    """Return which share of their stiffness against translation couplings leave to the blocks.

    Of all coupled blocks together and the least of any, in its weakest direction; 1 where none is
    coupled.  ``rows`` are right, left and listed of the pairs (:func:`row_pointers`).
    """
    right, left, listed = rows
    if len(diagonal) < SHARED:
        own, rest, least = _left_over(0, len(diagonal), diagonal, upper, right, left, listed)
    else:
        own, rest, least = 0.0, 0.0, 1.0
        for part in _left_over_shared(diagonal, upper, right, left, listed):
            own, rest, least = own + part[0], rest + part[1], min(least, part[2])
    return (rest / own if own > 0.0 else 1.0), least
