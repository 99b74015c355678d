"""The inverse of the few equations that are left on the coarsest level.

A cycle needs it over and over: a product with the inverse has no chain of dependent numbers as the
substitutions with a factor have, and takes a fifth of the time.
"""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def invert_blocks(diagonal, pairs, upper):
    """Return the inverse (6n, 6n) of a symmetric block matrix, and whether that is definite.

    Gauss-Jordan without pivoting; the pivots of a positive definite matrix are positive.
    """
    size = 6 * len(diagonal)
    matrix = np.zeros((size, size))
    for i in range(len(diagonal)):
        for a in range(6):
            for c in range(6):
                matrix[6 * i + a, 6 * i + c] = diagonal[i, a, c]
    for q in range(len(pairs)):
        i, j = 6 * pairs[q, 0], 6 * pairs[q, 1]
        for a in range(6):
            for c in range(6):
                matrix[i + a, j + c] = matrix[j + c, i + a] = upper[q, a, c]
    for k in range(size):
        pivot = matrix[k, k]
        if not pivot > 0.0:
            return matrix, False
        matrix[k, k] = 1.0
        for c in range(size):
            matrix[k, c] /= pivot
        for a in range(size):
            factor = matrix[a, k]
            if a != k and factor != 0.0:
                matrix[a, k] = 0.0
                for c in range(size):
                    matrix[a, c] -= factor * matrix[k, c]
    for a in range(size):
        for c in range(a):
            matrix[a, c] = matrix[c, a] = 0.5 * (matrix[a, c] + matrix[c, a])
    return matrix, True


@kernel(fastmath={"contract", "reassoc"})
def multiply_dense(inverse, b, x):
    """Write the product of ``inverse`` (6n, 6n) and the numbers of b into x, rows of six or more.

    The numbers of a line are multiplied and added side by side.
    """
    size = len(inverse)
    value = np.empty(size)
    for a in range(size):
        value[a] = b[a // 6, a % 6]
    for a in range(size):
        total = 0.0
        for c in range(size):
            total += inverse[a, c] * value[c]
        x[a // 6, a % 6] = total
