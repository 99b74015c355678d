"""Preconditioned conjugate gradients on 6 x 6 blocks; all sums in a fixed order."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def _invert(block, inverse):
    """Invert a symmetric positive definite 6 x 6 block by Cholesky; return False if it is not."""
    lower = np.zeros((6, 6))
    for j in range(6):
        total = block[j, j]
        for k in range(j):
            total -= lower[j, k] * lower[j, k]
        if not total > 0.0:
            return False
        lower[j, j] = np.sqrt(total)
        for i in range(j + 1, 6):
            total = block[i, j]
            for k in range(j):
                total -= lower[i, k] * lower[j, k]
            lower[i, j] = total / lower[j, j]
    for column in range(6):
        forward = np.zeros(6)
        for i in range(6):
            total = 1.0 if i == column else 0.0
            for k in range(i):
                total -= lower[i, k] * forward[k]
            forward[i] = total / lower[i, i]
        for i in range(5, -1, -1):
            total = forward[i]
            for k in range(i + 1, 6):
                total -= lower[k, i] * inverse[k, column]
            inverse[i, column] = total / lower[i, i]
    return True


@kernel()
def inverse_blocks(diagonal):
    """Return the inverses (n, 6, 6) of diagonal blocks, and the first that has none or -1."""
    inverse = np.empty_like(diagonal)
    for b in range(len(diagonal)):
        if not _invert(diagonal[b], inverse[b]):
            return inverse, b
    return inverse, -1


@kernel()
def multiply(diagonal, pairs, upper, x, y):
    """Write K x into y (n, 6); K symmetric, K_ij of each pair (i < j) in ``upper``."""
    for b in range(len(diagonal)):
        for a in range(6):
            total = 0.0
            for c in range(6):
                total += diagonal[b, a, c] * x[b, c]
            y[b, a] = total
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        for a in range(6):
            total = 0.0
            factor = x[i, a]
            for c in range(6):
                total += upper[q, a, c] * x[j, c]
                y[j, c] += upper[q, a, c] * factor
            y[i, a] += total


@kernel()
def _precondition(inverse, r, z):
    """Write the block-Jacobi preconditioned residual into z and return r.z."""
    total = 0.0
    for b in range(len(r)):
        for a in range(6):
            value = 0.0
            for c in range(6):
                value += inverse[b, a, c] * r[b, c]
            z[b, a] = value
            total += value * r[b, a]
    return total


@kernel()
def solve(diagonal, inverse, pairs, upper, force, tolerance, limit):
    """Return d (n, 6) of K d = F, the iterations and the final reduction of r.M^-1 r.

    Stops where r.M^-1 r has fallen to tolerance^2 of its start, or after ``limit`` iterations.
    """
    x = np.zeros_like(force)
    r = force.copy()
    z = np.empty_like(force)
    rz = _precondition(inverse, r, z)
    start = rz
    if start == 0.0:
        return x, 0, 0.0
    p = z.copy()
    kp = np.empty_like(force)
    count = 0
    while count < limit and rz > tolerance**2 * start:
        multiply(diagonal, pairs, upper, p, kp)
        curvature = 0.0
        for b in range(len(p)):
            for a in range(6):
                curvature += p[b, a] * kp[b, a]
        if not curvature > 0.0:
            return x, count, np.inf
        alpha = rz / curvature
        for b in range(len(p)):
            for a in range(6):
                x[b, a] += alpha * p[b, a]
                r[b, a] -= alpha * kp[b, a]
        following = _precondition(inverse, r, z)
        beta = following / rz
        rz = following
        for b in range(len(p)):
            for a in range(6):
                p[b, a] = z[b, a] + beta * p[b, a]
        count += 1
    return x, count, np.sqrt(rz / start)
