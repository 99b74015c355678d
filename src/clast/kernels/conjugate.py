"""Conjugate gradients preconditioned by the diagonal blocks alone.

Each iteration costs a product and a few vectors, a fifth of one with levels
(kernels/multilevel.py), and where inertia holds its own against the contacts, p h2/m of a few
units, ten of them are enough.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from clast.kernels.block_rows import CHUNK, FMA, SHARED, chunks, line, multiply
from clast.kernels.compiled import kernel

TRIED = 8
"""Iterations after which the rate of convergence is judged."""
HOPE = 1.5
"""Iterations, as a share of the limit, that may seem needed then: the rate improves."""


@kernel(fastmath=FMA)
def _advance_rows(first, last, alpha, p, kp, inverse, x, r, z):
    """Go alpha along p in rows ``first`` to ``last`` - 1 and return their part of r.z.

    x += alpha p, r -= alpha K p, z = D^-1 r.
    """
    total = 0.0
    for i in range(first, last):
        for a in range(6):
            x[i, a] += alpha * p[i, a]
            r[i, a] -= alpha * kp[i, a]
        r0, r1, r2, r3, r4, r5 = r[i, 0], r[i, 1], r[i, 2], r[i, 3], r[i, 4], r[i, 5]
        for a in range(6):
            z[i, a] = line(inverse, i, a, r0, r1, r2, r3, r4, r5)
            total += r[i, a] * z[i, a]
    return total


@kernel(parallel=True)
def _advance_shared(alpha, p, kp, inverse, x, r, z, parts):
    for c in prange(len(parts)):
        last = min((c + 1) * CHUNK, len(p))
        parts[c] = _advance_rows(c * CHUNK, last, alpha, p, kp, inverse, x, r, z)


@kernel()
def advance(alpha, p, kp, inverse, x, r, z):
    """Go alpha along p: x += alpha p, r -= alpha K p, z = D^-1 r, in place; return r.z."""
    parts = np.empty(chunks(len(p)))
    if len(p) >= SHARED:
        _advance_shared(alpha, p, kp, inverse, x, r, z, parts)
    else:
        for c in range(len(parts)):
            last = min((c + 1) * CHUNK, len(p))
            parts[c] = _advance_rows(c * CHUNK, last, alpha, p, kp, inverse, x, r, z)
    total = 0.0
    for part in parts:
        total += part
    return total


@kernel()
def solve(diagonal, inverse, upper, pairs, right, left, listed, force, guess, tolerance, limit):
    """Return d (n, 6) of K d = F, the iterations and the reduction of r.D^-1 r reached.

    Starts from ``guess`` (n, 6) and stops where r.D^-1 r has fallen to tolerance^2 of its start,
    after ``limit`` iterations, or as soon as far more than that seem needed; D are the diagonal
    blocks and ``inverse`` (n, 6, 6) theirs.  Rows are those of kernels/block_rows.py.
    """
    x = guess.copy()
    r, z, kp = force.copy(), np.empty_like(force), np.zeros_like(force)
    if x.any():
        multiply(diagonal, upper, pairs, right, left, listed, x, kp)
        r -= kp
    rz = advance(0.0, r, kp, inverse, x, r, z)
    start = rz
    if start == 0.0:
        return x, 0, 0.0
    p = z.copy()
    count = 0
    while count < limit and rz > tolerance**2 * start:
        curvature = multiply(diagonal, upper, pairs, right, left, listed, p, kp)
        if not curvature > 0.0:
            return x, count, np.inf
        following = advance(rz / curvature, p, kp, inverse, x, r, z)
        count += 1
        beta = following / rz
        rz = following
        if count == TRIED and rz > tolerance**2 * start:
            # needed / count = log(tolerance^2) / log(rz / start), for what is gained so far
            gained = np.log(start / rz)
            if -2.0 * np.log(tolerance) * count > HOPE * limit * gained:
                break
        for i in range(len(p)):
            for a in range(6):
                p[i, a] = z[i, a] + beta * p[i, a]
    return x, count, np.sqrt(rz / start)
