"""Incomplete block Cholesky without fill, K ~ L D L^T, as a preconditioner.

Rows are eliminated in their order; what would fall on a pair of blocks that share no contact is
left out (Meijerink and van der Vorst 1977).  Where a pivot is not positive definite any more the
diagonal block itself takes its place, so that the product is positive definite in any case.

Many rows are taken in pieces of a fixed number, and couplings between pieces are left out too:
pieces can be worked on at the same time, and answers do not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.block_rows import FMA, SHARED, invert, line
from clast.kernels.compiled import kernel

PIECE = 16384
"""Rows of a piece; with 2,048 a heap of 10,000 squares needs three times the iterations."""


@kernel()
def pieces(count):
    """Return the number of pieces of rows."""
    return (count + PIECE - 1) // PIECE


@kernel(fastmath=FMA)
def _subtract_product(left, right, block):
    """Subtract left x right from a block, in place."""
    for a in range(6):
        l0, l1, l2 = left[a, 0], left[a, 1], left[a, 2]
        l3, l4, l5 = left[a, 3], left[a, 4], left[a, 5]
        for b in range(6):
            block[a, b] -= (
                l0 * right[0, b]
                + l1 * right[1, b]
                + l2 * right[2, b]
                + l3 * right[3, b]
                + l4 * right[4, b]
                + l5 * right[5, b]
            )


@kernel(fastmath=FMA)
def _transposed_product(left, right, product):
    """Write left^T x right into a block."""
    for a in range(6):
        for b in range(6):
            total = 0.0
            for c in range(6):
                total += left[c, a] * right[c, b]
            product[a, b] = total


@kernel()
def _eliminate(low, high, own, diagonal, upper, pairs, right, inverse):
    """Eliminate rows ``low`` to ``high`` - 1; return the first whose own block is bad, or -1.

    ``diagonal`` and ``upper`` are worked on in place, ``own`` are the diagonal blocks as they were.
    """
    share = np.empty((6, 6))
    for i in range(low, high):
        if not invert(diagonal[i], inverse[i]) and not invert(own[i], inverse[i]):
            return i
        for q in range(right[i], right[i + 1]):
            j = pairs[q, 1]
            if j >= high:
                break
            _transposed_product(upper[q], inverse[i], share)
            _subtract_product(share, upper[q], diagonal[j])
            at = right[j]
            for following in range(q + 1, right[i + 1]):
                k = pairs[following, 1]
                while at < right[j + 1] and pairs[at, 1] < k:
                    at += 1
                if at < right[j + 1] and pairs[at, 1] == k:
                    _subtract_product(share, upper[following], upper[at])
    return -1


@kernel(parallel=True)
def _eliminate_shared(own, diagonal, upper, pairs, right, inverse, bad):
    for c in prange(len(bad)):
        high = min((c + 1) * PIECE, len(own))
        bad[c] = _eliminate(c * PIECE, high, own, diagonal, upper, pairs, right, inverse)


@kernel()
def factor(own, couplings, pairs, right):
    """Return D^-1 (n, 6, 6), D L^T above the diagonal (q, 6, 6), and the first bad row or -1.

    ``own`` (n, 6, 6) and ``couplings`` (q, 6, 6) are the blocks of K, ``pairs`` and ``right`` its
    rows (kernels/block_rows.py).  A row is bad whose own block is not positive definite.
    """
    diagonal, upper, inverse = own.copy(), couplings.copy(), np.empty_like(own)
    bad = np.full(pieces(len(own)), -1)
    if len(own) >= SHARED:
        _eliminate_shared(own, diagonal, upper, pairs, right, inverse, bad)
    else:
        for c in range(len(bad)):
            high = min((c + 1) * PIECE, len(own))
            bad[c] = _eliminate(c * PIECE, high, own, diagonal, upper, pairs, right, inverse)
    for first in bad:
        if first >= 0:
            return inverse, upper, first
    return inverse, upper, -1


@kernel(fastmath=FMA)
def _substitute(low, high, inverse, upper, pairs, right, left, listed, r, z):
    """Write (L D L^T)^-1 r into rows ``low`` to ``high`` - 1 of z; return their part of r.z."""
    for i in range(low, high):
        y0, y1, y2, y3, y4, y5 = r[i, 0], r[i, 1], r[i, 2], r[i, 3], r[i, 4], r[i, 5]
        for at in range(left[i], left[i + 1]):
            q = listed[at]
            k = pairs[q, 0]
            if k < low:
                continue
            for a in range(6):
                x = z[k, a]
                y0 -= upper[q, a, 0] * x
                y1 -= upper[q, a, 1] * x
                y2 -= upper[q, a, 2] * x
                y3 -= upper[q, a, 3] * x
                y4 -= upper[q, a, 4] * x
                y5 -= upper[q, a, 5] * x
        for a in range(6):
            z[i, a] = line(inverse, i, a, y0, y1, y2, y3, y4, y5)
    total = 0.0
    for i in range(high - 1, low - 1, -1):
        y0 = y1 = y2 = y3 = y4 = y5 = 0.0
        for q in range(right[i], right[i + 1]):
            j = pairs[q, 1]
            if j >= high:
                break
            x0, x1, x2, x3, x4, x5 = z[j, 0], z[j, 1], z[j, 2], z[j, 3], z[j, 4], z[j, 5]
            y0 += line(upper, q, 0, x0, x1, x2, x3, x4, x5)
            y1 += line(upper, q, 1, x0, x1, x2, x3, x4, x5)
            y2 += line(upper, q, 2, x0, x1, x2, x3, x4, x5)
            y3 += line(upper, q, 3, x0, x1, x2, x3, x4, x5)
            y4 += line(upper, q, 4, x0, x1, x2, x3, x4, x5)
            y5 += line(upper, q, 5, x0, x1, x2, x3, x4, x5)
        for a in range(6):
            z[i, a] -= line(inverse, i, a, y0, y1, y2, y3, y4, y5)
            total += r[i, a] * z[i, a]
    return total


@kernel(parallel=True)
def _substitute_shared(inverse, upper, pairs, right, left, listed, r, z, parts):
    for c in prange(len(parts)):
        high = min((c + 1) * PIECE, len(r))
        parts[c] = _substitute(c * PIECE, high, inverse, upper, pairs, right, left, listed, r, z)


@kernel()
def substitute(inverse, upper, pairs, right, left, listed, r, z):
    """Write (L D L^T)^-1 r (n, 6) into z and return r.z."""
    parts = np.empty(pieces(len(r)))
    if len(r) >= SHARED:
        _substitute_shared(inverse, upper, pairs, right, left, listed, r, z, parts)
    else:
        for c in range(len(parts)):
            high = min((c + 1) * PIECE, len(r))
            parts[c] = _substitute(
                c * PIECE, high, inverse, upper, pairs, right, left, listed, r, z
            )
    total = 0.0
    for part in parts:
        total += part
    return total
