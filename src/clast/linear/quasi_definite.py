"""Block LDL^T of a matrix that is positive definite in some blocks and negative in the others.

    | K   -B^T |
    | -B   -A  |

with K and A positive definite.  Whatever the order, the pivots of K's blocks stay positive definite
and those of A's negative definite (Vanderbei 1995), so that none need be looked for: a pivot is
D_i = s_i C_i C_i^T with the sign s_i of its block, and the rest is as in linear/ldlt.py.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.compute.mat6 import entries, forward, lines, lines_times, plus_lines, put_lines
from clast.compute.vec6 import UNKNOWNS, line, plus_scaled, put_line, put_row, row, zeros
from clast.linear.block_matrix import transpose_times
from clast.linear.ldlt import _root, _take


@kernel(forceinline=True)
def _add_product(factor, blocks, f, target, t):
    """Add the product of one block, ``factor`` (6, 6), and block f to block t of ``target``."""
    other = lines(blocks, f)
    for a in range(UNKNOWNS):
        put_line(target, t, a, plus_lines(line(target, t, a), entries(factor, a), other))


@kernel()
def _pass_on(i, sign, pattern, work, turned):
    """Subtract row i from the rows after it:  K_jk -= s W_ij^T W_ik."""
    _, _, pairs, right, _, _, _ = pattern
    diagonal, upper = work
    for q in range(right[i], right[i + 1]):
        j = pairs[q, 1]
        for a in range(UNKNOWNS):
            for b in range(UNKNOWNS):
                turned[a, b] = -sign * upper[q, b, a]
        _add_product(turned, upper, q, diagonal, j)
        at = right[j]
        for following in range(q + 1, right[i + 1]):
            k = pairs[following, 1]
            while pairs[at, 1] < k:
                at += 1
            _add_product(turned, upper, following, upper, at)


@kernel()
def factor(pattern, own, given, signs):
    """Return the factor, and the first block whose pivot has not the sign of its block, or -1.

    ``pattern`` has all fill; ``own`` (n, 6, 6) are the diagonal blocks and ``given`` (q, 6, 6)
    those of the pairs, ``signs`` (n,) 1 or -1.
    """
    order, _, _, right, _, _, _ = pattern
    work = np.empty_like(own), np.empty((len(pattern[2]), UNKNOWNS, UNKNOWNS))
    _take(0, len(own), pattern, own, given, 1.0, work)
    diagonal, upper = work
    turned = np.empty((UNKNOWNS, UNKNOWNS))
    for i in range(len(own)):
        sign = signs[order[i]]
        if sign < 0.0:
            for a in range(UNKNOWNS):
                put_line(diagonal, i, a, plus_scaled(zeros(), -1.0, line(diagonal, i, a)))
        if not _root(diagonal, i):
            return (pattern, diagonal, upper, signs), order[i]
        for q in range(right[i], right[i + 1]):
            put_lines(upper, q, forward(diagonal, i, lines(upper, q)))
        _pass_on(i, sign, pattern, work, turned)
    return (pattern, diagonal, upper, signs), -1


@kernel()
def solve(factor, force):
    """Return x (n, 6) of the matrix times x = ``force`` (n, 6)."""
    (order, _, pairs, right, _, _, _), c, upper, signs = factor
    z, found = np.empty_like(force), np.empty_like(force)
    for i in range(len(order)):
        put_row(z, i, row(force, order[i]))
    for i in range(len(order)):
        for a in range(UNKNOWNS):
            for b in range(a):
                z[i, a] -= c[i, a, b] * z[i, b]
            z[i, a] *= c[i, a, a]
        sign = signs[order[i]]
        for q in range(right[i], right[i + 1]):
            j = pairs[q, 1]
            put_row(z, j, plus_scaled(row(z, j), -sign, transpose_times(upper, q, z, i)))
    for i in range(len(order) - 1, -1, -1):
        s = plus_scaled(zeros(), signs[order[i]], row(z, i))
        for q in range(right[i], right[i + 1]):
            s = plus_scaled(s, -signs[order[i]], lines_times(lines(upper, q), row(z, pairs[q, 1])))
        put_row(z, i, s)
        for a in range(UNKNOWNS - 1, -1, -1):
            for b in range(a + 1, UNKNOWNS):
                z[i, a] -= c[i, b, a] * z[i, b]
            z[i, a] *= c[i, a, a]
        put_row(found, order[i], row(z, i))
    return found
