"""Cholesky factorisation of the few equations that are left on the coarsest level."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def factor_blocks(diagonal, pairs, upper):
    """Return U (6n, 6n) of K = U^T U for a symmetric block matrix, and whether it is definite."""
    size = 6 * len(diagonal)
    matrix = np.zeros((size, size))
    for i in range(len(diagonal)):
        for a in range(6):
            for c in range(6):
                matrix[6 * i + a, 6 * i + c] = diagonal[i, a, c]
    for q in range(len(pairs)):
        for a in range(6):
            for c in range(6):
                matrix[6 * pairs[q, 0] + a, 6 * pairs[q, 1] + c] = upper[q, a, c]
    for k in range(size):
        if not matrix[k, k] > 0.0:
            return matrix, False
        root = np.sqrt(matrix[k, k])
        for c in range(k, size):
            matrix[k, c] /= root
        for a in range(k + 1, size):
            factor = matrix[k, a]
            if factor != 0.0:
                for c in range(a, size):
                    matrix[a, c] -= factor * matrix[k, c]
    return matrix, True


@kernel(fastmath={"contract", "reassoc"})
def solve_factored(factor, b, x):
    """Write the solution of U^T U x = b into x, both (n, 6).

    Along the lines of U both ways: sums of products run side by side.
    """
    size = len(factor)
    value = np.empty(size)
    for a in range(size):
        value[a] = b[a // 6, a % 6]
    for k in range(size):
        known = value[k] / factor[k, k]
        value[k] = known
        for a in range(k + 1, size):
            value[a] -= factor[k, a] * known
    for k in range(size - 1, -1, -1):
        total = 0.0
        for a in range(k + 1, size):
            total += factor[k, a] * value[a]
        value[k] = (value[k] - total) / factor[k, k]
    for a in range(size):
        x[a // 6, a % 6] = value[a]
