"""Levels of larger blocks: the coarse systems, the cycle, the iteration."""

from dataclasses import replace

import numba
import numpy as np
import pytest
from test_cholesky import PATTERNS, dense, grid, random_system, with_upper

from clast.equations.cholesky import Cholesky
from clast.equations.multilevel import COARSEST, levels_of
from clast.equations.solvers import PCG
from clast.errors import StepOutcome, StepRejected
from clast.kernels import block_rows, multilevel


def level(levels, k):
    """Return diagonal, inverse, upper, pairs, rows, aggregates ... of a level."""
    return [column[k] for column in levels.levels]


def full(diagonal, pairs, upper):
    """Return a block matrix in full."""
    count = len(diagonal)
    matrix = np.zeros((count, 6, count, 6))
    for b in range(count):
        matrix[b, :, b] = diagonal[b]
    for (i, j), block in zip(pairs, upper, strict=True):
        matrix[i, :, j] = block
        matrix[j, :, i] = block.T
    return matrix.reshape(6 * count, 6 * count)


def prolongation(parent, offset, count):
    """Return P (6n, 6N): every block follows its aggregate as a material point of it does."""
    matrix = np.zeros((len(parent), 6, count, 6))
    for i, (k, (x, y)) in enumerate(zip(parent, offset, strict=True)):
        if k >= 0:
            matrix[i, :, k] = np.eye(6)
            matrix[i, 0, k] = [1.0, 0.0, -y, x, 0.0, 0.5 * y]
            matrix[i, 1, k] = [0.0, 1.0, x, 0.0, y, 0.5 * x]
    return matrix.reshape(6 * len(parent), 6 * count)


def solved(one, tolerance=1e-10, limit=500):
    """Return d, iterations and reduction."""
    found = levels_of(one)
    return multilevel.solve(
        found.matrix,
        found.levels,
        found.last,
        found.inverse,
        found.work,
        one.force,
        np.zeros_like(one.force),
        tolerance,
        limit,
    )


@pytest.mark.parametrize("name", PATTERNS)
def test_every_level_is_the_projection_of_the_one_before(name):
    count, pairs = PATTERNS[name]
    found = levels_of(random_system(np.random.default_rng(2), count, pairs))
    for k in range(found.last):
        diagonal, _, upper, of_pairs, *_, parent, start, members, offset = level(found, k)
        next_diagonal, _, next_upper, next_pairs, *_ = level(found, k + 1)
        projection = prolongation(parent, offset, len(start) - 1)
        wanted = projection.T @ full(diagonal, of_pairs, upper) @ projection
        assert np.abs(full(next_diagonal, next_pairs, next_upper) - wanted).max() <= 1e-12 * (
            np.abs(wanted).max()
        )
        assert np.array_equal(np.sort(members), np.flatnonzero(parent >= 0))
        assert len(next_diagonal) < len(diagonal)


@pytest.mark.parametrize("name", PATTERNS)
def test_product_equals_the_dense_one(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(3), count, pairs)
    diagonal, _, upper, of_pairs, right, left, listed, *_ = level(levels_of(one), 0)
    x = np.random.default_rng(4).normal(size=(count, 6))
    y = np.empty_like(x)
    energy = block_rows.multiply(diagonal, upper, of_pairs, right, left, listed, x, y)
    wanted = dense(one) @ x.ravel()
    assert np.abs(y.ravel() - wanted).max() <= 1e-12 * np.abs(wanted).max()
    assert energy == pytest.approx(x.ravel() @ wanted, rel=1e-12)


@pytest.mark.parametrize("name", PATTERNS)
def test_iteration_equals_a_dense_solve(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(2), count, pairs, stiffness=1e3)
    wanted = np.linalg.solve(dense(one), one.force.ravel())
    found, iterations, reduction = solved(one, limit=2000)
    assert reduction <= 1e-10
    assert np.abs(found.ravel() - wanted).max() <= 1e-7 * np.abs(wanted).max()
    if count <= COARSEST or not len(pairs):
        assert iterations <= 2


def test_the_cycle_is_symmetric_and_positive():
    """With two levels it is linear, so that B can be written down column by column."""
    count = 36
    one = random_system(np.random.default_rng(5), count, grid(6, 6), stiffness=1e4)
    found = levels_of(one)
    assert found.last == 1
    columns = []
    for k in range(6 * count):
        found.work[0][0][:] = np.eye(6 * count)[k].reshape(count, 6)
        multilevel._cycle(found.last, found.levels, found.inverse, found.work)
        columns.append(found.work[1][0].ravel().copy())
    matrix = np.array(columns)
    assert np.abs(matrix - matrix.T).max() <= 1e-10 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0.0


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


def test_iterations_hardly_grow_with_the_number_of_blocks():
    """Block-Jacobi needs iterations in proportion to the width of the sheet."""
    few, many = (solved(elastic_grid(n, n), tolerance=1e-8)[1] for n in (10, 40))
    assert many <= 1.5 * few
    assert many < 80


def test_answers_do_not_depend_on_the_number_of_threads():
    one = elastic_grid(60, 60)
    assert len(one.diagonal) >= block_rows.SHARED
    threads = numba.get_num_threads()
    try:
        answers = []
        for number in (1, numba.config.NUMBA_NUM_THREADS):
            numba.set_num_threads(number)
            answers.append(solved(one, tolerance=1e-6)[0])
    finally:
        numba.set_num_threads(threads)
    assert np.array_equal(*answers)
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(answers[0] - wanted).max() < 1e-3 * np.abs(wanted).max()


def test_a_block_without_stiffness_is_named():
    one = random_system(np.random.default_rng(7), 30, grid(5, 6))
    diagonal = one.diagonal.copy()
    diagonal[4] = 0.0
    with pytest.raises(StepRejected, match="block 5") as caught:
        PCG().factor(type(one)(**{**vars(one), "diagonal": diagonal}))
    assert caught.value.outcome is StepOutcome.SINGULAR
