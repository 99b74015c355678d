"""Products with a symmetric matrix of 6 x 6 blocks, in single precision.

As linear/block_matrix.py has them, but each block is read once: row i takes K_ij x_j from it and
hands K_ij^T x_i on to row j.  It may do so within its stretch of rows; where j lies in a later one,
row j reads the block again, and no stretch writes to another one.  In single precision there are
registers enough for both products, and rounding is that of a K which is rounded anyway.
"""

from __future__ import annotations

import numpy as np

from clast.compute import vec6 as six
from clast.compute import vec6_single as single
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do

STRETCHES, SHORTEST = 8, 256
"""Stretches of rows that threads share, and rows of one at least."""
AHEAD = 24
"""Blocks that are asked for before they are needed: memory is read page by page otherwise."""


@kernel()
def stretch(count):
    """Return the rows of a stretch of ``count``: they depend on nothing else.

    Their number is a power of two, for as many threads to have as much to do.
    """
    number = 1
    while number < STRETCHES and count >= 2 * number * SHORTEST:
        number *= 2
    return (count + number - 1) // number


@kernel(forceinline=True)
def times(blocks, i, x):
    """Return symmetric block i of (n, 6, 6) times six numbers."""
    k0, k1, k2, k3, k4, k5 = single.lines(blocks, i)
    x0, x1, x2, x3, x4, x5 = single.spread(x)
    s0 = single.plus_product(single.zeros(), x0, k0)
    s1 = single.plus_product(single.zeros(), x1, k1)
    s0 = single.plus_product(s0, x2, k2)
    s1 = single.plus_product(s1, x3, k3)
    s0 = single.plus_product(s0, x4, k4)
    s1 = single.plus_product(s1, x5, k5)
    return single.plus(s0, s1)


@kernel(forceinline=True)
def right_of(low, high, upper, pairs, x):
    """Return the sum of K_ij x_j over the pairs ``low`` to ``high`` - 1, those of a row i.

    Rows are taken from the last to the first.
    """
    t0, t1, t2 = single.zeros(), single.zeros(), single.zeros()
    t3, t4, t5 = single.zeros(), single.zeros(), single.zeros()
    for q in range(low, high):
        single.fetch(upper, q, -AHEAD)
        other = single.row(x, pairs[q, 1])
        k0, k1, k2, k3, k4, k5 = single.lines(upper, q)
        t0 = single.plus_product(t0, k0, other)
        t1 = single.plus_product(t1, k1, other)
        t2 = single.plus_product(t2, k2, other)
        t3 = single.plus_product(t3, k3, other)
        t4 = single.plus_product(t4, k4, other)
        t5 = single.plus_product(t5, k5, other)
    return single.totals(t0, t1, t2, t3, t4, t5)


@kernel(forceinline=True)
def left_of(low, high, before, listed, upper, pairs, x):
    """Return the sum of K_ji^T x_j over the pairs listed ``low`` to ``high`` - 1 of a row i.

    Of those before pair ``before`` alone; they are listed in ascending order.
    """
    s0, s1 = single.zeros(), single.zeros()
    for at in range(low, high):
        q = listed[at]
        if q >= before:
            break
        k0, k1, k2, k3, k4, k5 = single.lines(upper, q)
        x0, x1, x2, x3, x4, x5 = single.spread(single.row(x, pairs[q, 0]))
        s0 = single.plus_product(s0, x0, k0)
        s1 = single.plus_product(s1, x1, k1)
        s0 = single.plus_product(s0, x2, k2)
        s1 = single.plus_product(s1, x3, k3)
        s0 = single.plus_product(s0, x4, k4)
        s1 = single.plus_product(s1, x5, k5)
    return single.plus(s0, s1)


@kernel(forceinline=True)
def both_sides(low, high, end, x_i, upper, pairs, x, y):
    """Return the sum of K_ij x_j over the pairs ``low`` to ``high`` - 1; add K_ij^T x_i to y_j.

    To rows j < end alone.
    """
    t0, t1, t2 = single.zeros(), single.zeros(), single.zeros()
    t3, t4, t5 = single.zeros(), single.zeros(), single.zeros()
    x0, x1, x2, x3, x4, x5 = single.spread(x_i)
    for q in range(low, high):
        j = pairs[q, 1]
        single.fetch(upper, q, AHEAD)
        other = single.row(x, j)
        k0, k1, k2, k3, k4, k5 = single.lines(upper, q)
        t0 = single.plus_product(t0, k0, other)
        t1 = single.plus_product(t1, k1, other)
        t2 = single.plus_product(t2, k2, other)
        t3 = single.plus_product(t3, k3, other)
        t4 = single.plus_product(t4, k4, other)
        t5 = single.plus_product(t5, k5, other)
        if j < end:
            s0 = single.plus_product(single.row(y, j), x0, k0)
            s1 = single.plus_product(single.zeros(), x1, k1)
            s0 = single.plus_product(s0, x2, k2)
            s1 = single.plus_product(s1, x3, k3)
            s0 = single.plus_product(s0, x4, k4)
            s1 = single.plus_product(s1, x5, k5)
            single.put_row(y, j, single.plus(s0, s1))
    return single.totals(t0, t1, t2, t3, t4, t5)


@kernel()
def _begin_stretch(first, last, upper, pairs, right, left, listed, x, y):
    """Write into rows ``first`` to ``last`` - 1 of y what they have of the pairs of earlier rows.

    By itself, for in one loop with the rest registers would not suffice.
    """
    before = right[first]
    for i in range(first, last):
        if left[i] < left[i + 1] and listed[left[i]] < before:
            known = left_of(left[i], left[i + 1], before, listed, upper, pairs, x)
            single.put_row(y, i, known)
        else:
            single.put_row(y, i, single.zeros())


@kernel()
def _multiply_stretch(first, last, diagonal, upper, pairs, right, left, listed, x, y):
    """Write rows ``first`` to ``last`` - 1 of K x into y and return their part of x.K x."""
    _begin_stretch(first, last, upper, pairs, right, left, listed, x, y)
    product = six.zeros()
    for i in range(first, last):
        own = single.row(x, i)
        begun = single.plus(single.row(y, i), times(diagonal, i, own))
        found = both_sides(right[i], right[i + 1], last, own, upper, pairs, x, y)
        y_i = single.plus(begun, found)
        single.put_row(y, i, y_i)
        product = six.plus_product(product, single.double(own), single.double(y_i))
    return six.total(product)


@kernel(parallel=True)
def _multiply_shared(parts, diagonal, upper, pairs, right, left, listed, x, y):
    length = stretch(len(x))
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, len(parts)):
            last = min((c + 1) * length, len(x))
            parts[c] = _multiply_stretch(
                c * length, last, diagonal, upper, pairs, right, left, listed, x, y
            )


@kernel()
def multiply(shared, diagonal, upper, pairs, right, left, listed, x, y):
    """Write K x (n, 8) into y and return x.K x; threads share it where there are rows enough."""
    length = stretch(len(x))
    parts = np.empty((len(x) + length - 1) // length)
    if len(x) >= shared:
        _multiply_shared(parts, diagonal, upper, pairs, right, left, listed, x, y)
    else:
        for c in range(len(parts)):
            last = min((c + 1) * length, len(x))
            parts[c] = _multiply_stretch(
                c * length, last, diagonal, upper, pairs, right, left, listed, x, y
            )
    product = 0.0
    for part in parts:
        product += part
    return product
