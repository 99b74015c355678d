"""Symmetric matrices of 6 x 6 blocks."""

from dataclasses import replace

import numpy as np

from clast.linear.block_matrix import row_pointers
from clast.linear.system import BlockSystem


def random_pairs(rng, count, most):
    """Return distinct sorted pairs of blocks."""
    pairs = np.sort(rng.integers(0, count, (most, 2)), axis=1)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    return np.unique(pairs, axis=0).astype(np.int64).reshape(-1, 2)


def grid(rows, columns):
    """Return the pairs of neighbours of a grid, with one diagonal."""
    number = np.arange(rows * columns).reshape(rows, columns)
    parts = [
        np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1),
        np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1),
        np.stack([number[:-1, :-1].ravel(), number[1:, 1:].ravel()], axis=1),
    ]
    pairs = np.concatenate(parts)
    return np.ascontiguousarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])


def random_system(rng, count, pairs, stiffness=1e6):
    """Return a symmetric positive definite system of stiff couplings on soft diagonals."""
    diagonal = np.broadcast_to(np.eye(6), (count, 6, 6)).copy()
    upper = np.zeros((len(pairs), 6, 6))
    for q, (i, j) in enumerate(pairs):
        left, right = rng.normal(size=(2, 6, 2))
        diagonal[i] += stiffness * left @ left.T
        diagonal[j] += stiffness * right @ right.T
        upper[q] += stiffness * left @ right.T
    return BlockSystem(
        diagonal=diagonal,
        pairs=pairs,
        rows=row_pointers(count, pairs),
        upper=upper,
        fixed=np.zeros(count, np.bool_),
        force=rng.normal(size=(count, 6)),
        centroid=rng.normal(size=(count, 2)),
    )


def with_upper(one, upper):
    """Return a symmetric system with other blocks beside the diagonal."""
    return replace(one, upper=upper)


def dense(one):
    """Return the matrix in full."""
    count = len(one.diagonal)
    matrix = np.zeros((count, 6, count, 6))
    for b in range(count):
        matrix[b, :, b] = one.diagonal[b]
    for (i, j), block in zip(one.pairs, one.upper, strict=True):
        matrix[i, :, j] = block
        matrix[j, :, i] = block.T
    return matrix.reshape(6 * count, 6 * count)


def patterns():
    """Yield names, block counts and pairs: grids, random graphs, stars, pieces, nothing."""
    rng = np.random.default_rng(1)
    yield "grid", 120, grid(8, 15)
    yield "chain", 60, grid(1, 60)
    yield "star", 80, np.array([[0, other] for other in range(1, 80)])
    yield "one block", 1, np.zeros((0, 2), np.int64)
    yield "nothing coupled", 30, np.zeros((0, 2), np.int64)
    yield "all coupled", 14, random_pairs(rng, 14, 2000)
    for most in (10, 40, 90, 200):
        yield f"random, {most}", 60, random_pairs(rng, 60, most)


PATTERNS = {name: (count, pairs) for name, count, pairs in patterns()}


def elastic_grid(rows, columns, stiffness=1e6):
    """Return a sheet of elastic unit squares with springs at the ends of common edges."""
    pairs = grid(rows, columns)
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    centroid = np.stack([x.ravel(), y.ravel()], axis=1).astype(float)
    apart = np.abs(centroid[pairs[:, 0]] - centroid[pairs[:, 1]]).sum(axis=1)
    pairs = np.ascontiguousarray(pairs[apart == 1.0])
    one = random_system(np.random.default_rng(0), len(centroid), pairs, stiffness=0.0)
    diagonal, upper = one.diagonal.copy(), one.upper.copy()
    diagonal[:, [3, 4, 5], [3, 4, 5]] += stiffness
    for q, (i, j) in enumerate(pairs):
        middle = 0.5 * (centroid[i] + centroid[j])
        across = np.array([-(centroid[j] - centroid[i])[1], (centroid[j] - centroid[i])[0]])
        for end in (-0.5, 0.5):
            at = middle + end * across
            rows_of = []
            for b, sign in ((i, 1.0), (j, -1.0)):
                dx, dy = at - centroid[b]
                basis = [[1, 0, -dy, dx, 0, 0.5 * dy], [0, 1, dx, 0, dy, 0.5 * dx]]
                rows_of.append(sign * np.array(basis).T)
            diagonal[i] += stiffness * rows_of[0] @ rows_of[0].T
            diagonal[j] += stiffness * rows_of[1] @ rows_of[1].T
            upper[q] += stiffness * rows_of[0] @ rows_of[1].T
    return with_upper(replace(one, diagonal=diagonal, centroid=centroid), upper)
