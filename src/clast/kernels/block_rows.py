"""Products with a symmetric matrix of 6 x 6 blocks, row by row.

Only K_ij with i < j is kept.  Row i takes its blocks right of the diagonal as they stand (pairs
sorted by row: they follow each other in memory) and those left of it as transposes.  No row writes
to another one, so that rows can be worked on at the same time, and every sum has a fixed order:
answers do not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.compiled import kernel, start_threads

start_threads()

FMA = {"contract"}
"""a b + c may be one operation; the order of sums stays."""
CHUNK = 256
"""Rows that a thread takes at a time, and that are summed up by themselves."""
SHARED = 1500
"""Rows from which threads share the work; below, starting them costs more than they give."""


@kernel()
def row_pointers(count, pairs):
    """Return where each row finds its pairs (q, 2), which are sorted.

    ``right`` (n + 1,): the pairs (i, .) of row i are right[i] to right[i + 1] - 1.  ``left``
    (n + 1,) and ``listed`` (q,): the pairs (., i), listed by their other block.
    """
    right = np.zeros(count + 1, np.int64)
    left = np.zeros(count + 1, np.int64)
    for q in range(len(pairs)):
        right[pairs[q, 0] + 1] += 1
        left[pairs[q, 1] + 1] += 1
    for i in range(count):
        right[i + 1] += right[i]
        left[i + 1] += left[i]
    at = left[:-1].copy()
    listed = np.empty(len(pairs), np.int64)
    for q in range(len(pairs)):
        listed[at[pairs[q, 1]]] = q
        at[pairs[q, 1]] += 1
    return right, left, listed


@kernel()
def chunks(count):
    """Return the number of chunks of rows."""
    return (count + CHUNK - 1) // CHUNK


@kernel(fastmath=FMA)
def line(blocks, i, a, x0, x1, x2, x3, x4, x5):
    """Return line a of block i times six numbers."""
    return (
        blocks[i, a, 0] * x0
        + blocks[i, a, 1] * x1
        + blocks[i, a, 2] * x2
        + blocks[i, a, 3] * x3
        + blocks[i, a, 4] * x4
        + blocks[i, a, 5] * x5
    )


@kernel(fastmath=FMA)
def _multiply_rows(first, last, diagonal, upper, pairs, right, left, listed, x, y):
    """Write rows ``first`` to ``last`` - 1 of K x into y and return their part of x.K x."""
    total = 0.0
    for i in range(first, last):
        y0 = y1 = y2 = y3 = y4 = y5 = 0.0
        for a in range(6):
            xa = x[i, a]
            y0 += diagonal[i, a, 0] * xa
            y1 += diagonal[i, a, 1] * xa
            y2 += diagonal[i, a, 2] * xa
            y3 += diagonal[i, a, 3] * xa
            y4 += diagonal[i, a, 4] * xa
            y5 += diagonal[i, a, 5] * xa
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            j = pairs[q, 0]
            for a in range(6):
                xa = x[j, a]
                y0 += upper[q, a, 0] * xa
                y1 += upper[q, a, 1] * xa
                y2 += upper[q, a, 2] * xa
                y3 += upper[q, a, 3] * xa
                y4 += upper[q, a, 4] * xa
                y5 += upper[q, a, 5] * xa
        for q in range(right[i], right[i + 1]):
            j = pairs[q, 1]
            x0, x1, x2, x3, x4, x5 = x[j, 0], x[j, 1], x[j, 2], x[j, 3], x[j, 4], x[j, 5]
            y0 += line(upper, q, 0, x0, x1, x2, x3, x4, x5)
            y1 += line(upper, q, 1, x0, x1, x2, x3, x4, x5)
            y2 += line(upper, q, 2, x0, x1, x2, x3, x4, x5)
            y3 += line(upper, q, 3, x0, x1, x2, x3, x4, x5)
            y4 += line(upper, q, 4, x0, x1, x2, x3, x4, x5)
            y5 += line(upper, q, 5, x0, x1, x2, x3, x4, x5)
        y[i, 0], y[i, 1], y[i, 2], y[i, 3], y[i, 4], y[i, 5] = y0, y1, y2, y3, y4, y5
        total += x[i, 0] * y0 + x[i, 1] * y1 + x[i, 2] * y2
        total += x[i, 3] * y3 + x[i, 4] * y4 + x[i, 5] * y5
    return total


@kernel(parallel=True)
def _multiply_shared(diagonal, upper, pairs, right, left, listed, x, y):
    parts = np.empty(chunks(len(x)))
    for c in prange(len(parts)):
        last = min((c + 1) * CHUNK, len(x))
        parts[c] = _multiply_rows(
            c * CHUNK, last, diagonal, upper, pairs, right, left, listed, x, y
        )
    return parts


@kernel()
def multiply(diagonal, upper, pairs, right, left, listed, x, y):
    """Write K x (n, 6) into y and return x.K x."""
    if len(x) >= SHARED:
        parts = _multiply_shared(diagonal, upper, pairs, right, left, listed, x, y)
    else:
        parts = np.empty(chunks(len(x)))
        for c in range(len(parts)):
            last = min((c + 1) * CHUNK, len(x))
            parts[c] = _multiply_rows(
                c * CHUNK, last, diagonal, upper, pairs, right, left, listed, x, y
            )
    total = 0.0
    for part in parts:
        total += part
    return total


@kernel(fastmath=FMA)
def _relax_rows(first, last, damping, inverse, b, kx, x):
    """Add damping x inverse_i (b_i - kx_i) to x_i, in place, for rows ``first`` to ``last`` - 1."""
    for i in range(first, last):
        r0, r1, r2 = b[i, 0] - kx[i, 0], b[i, 1] - kx[i, 1], b[i, 2] - kx[i, 2]
        r3, r4, r5 = b[i, 3] - kx[i, 3], b[i, 4] - kx[i, 4], b[i, 5] - kx[i, 5]
        for a in range(6):
            x[i, a] += damping * line(inverse, i, a, r0, r1, r2, r3, r4, r5)


@kernel(parallel=True)
def _relax_shared(damping, inverse, b, kx, x):
    for c in prange(chunks(len(x))):
        _relax_rows(c * CHUNK, min((c + 1) * CHUNK, len(x)), damping, inverse, b, kx, x)


@kernel()
def relax(damping, inverse, b, kx, x):
    """Add damping D^-1 (b - K x) to x (n, 6), in place, kx being K x."""
    if len(x) >= SHARED:
        _relax_shared(damping, inverse, b, kx, x)
    else:
        _relax_rows(0, len(x), damping, inverse, b, kx, x)


@kernel(fastmath=FMA)
def dot(a, b):
    """Return a.b of two vectors (n, 6), chunk by chunk."""
    total = 0.0
    for c in range(chunks(len(a))):
        part = 0.0
        for i in range(c * CHUNK, min((c + 1) * CHUNK, len(a))):
            for k in range(6):
                part += a[i, k] * b[i, k]
        total += part
    return total


@kernel()
def invert(block, inverse):
    """Write the inverse of a symmetric block and return True, or False where it is not definite.

    Gauss-Jordan without pivoting; the pivots of a positive definite block are positive.
    """
    inverse[:] = block
    for k in range(6):
        pivot = inverse[k, k]
        if not pivot > 0.0:
            return False
        inverse[k, k] = 1.0
        for c in range(6):
            inverse[k, c] /= pivot
        for a in range(6):
            if a != k:
                factor = inverse[a, k]
                inverse[a, k] = 0.0
                for c in range(6):
                    inverse[a, c] -= factor * inverse[k, c]
    return True


@kernel()
def inverse_blocks(diagonal):
    """Return the inverses (n, 6, 6) of symmetric blocks, and the first not definite or -1."""
    inverse = np.empty_like(diagonal)
    for b in range(len(diagonal)):
        if not invert(diagonal[b], inverse[b]):
            return inverse, b
    return inverse, -1
