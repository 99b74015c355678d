"""Conjugate gradients preconditioned by the diagonal blocks alone.

Each iteration costs a product and a few vectors, a fifth of one with levels
(kernels/multilevel.py), and where inertia holds its own against the contacts, p h2/m of a few
units, ten of them are enough.
"""

from __future__ import annotations

import numpy as np

from clast.kernels.block_rows import FMA, dot, multiply, relax
from clast.kernels.compiled import kernel

TRIED = 8
"""Iterations after which the rate of convergence is judged."""
HOPE = 1.5
"""Iterations, as a share of the limit, that may seem needed then: the rate improves."""


@kernel(fastmath=FMA)
def advance(alpha, p, kp, x, r):
    """Go alpha along p: x += alpha p, r -= alpha K p."""
    for i in range(len(p)):
        for a in range(6):
            x[i, a] += alpha * p[i, a]
            r[i, a] -= alpha * kp[i, a]


@kernel()
def solve(diagonal, inverse, upper, pairs, right, left, listed, force, guess, tolerance, limit):
    """Return d (n, 6) of K d = F, the iterations and the reduction of r.D^-1 r reached.

    Starts from ``guess`` (n, 6) and stops where r.D^-1 r has fallen to tolerance^2 of its start,
    after ``limit`` iterations, or as soon as far more than that seem needed; D are the diagonal
    blocks and ``inverse`` (n, 6, 6) theirs.  Rows are those of kernels/block_rows.py.
    """
    x = guess.copy()
    kp = np.empty_like(force)
    multiply(diagonal, upper, pairs, right, left, listed, x, kp)
    r = force - kp
    z = np.zeros_like(force)
    nothing = np.zeros_like(force)
    relax(1.0, inverse, r, nothing, z)
    start = rz = dot(r, z)
    if start == 0.0:
        return x, 0, 0.0
    p = z.copy()
    count = 0
    while count < limit and rz > tolerance**2 * start:
        curvature = multiply(diagonal, upper, pairs, right, left, listed, p, kp)
        if not curvature > 0.0:
            return x, count, np.inf
        advance(rz / curvature, p, kp, x, r)
        count += 1
        z[:] = 0.0
        relax(1.0, inverse, r, nothing, z)
        following = dot(r, z)
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
