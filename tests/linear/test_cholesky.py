"""Block Cholesky against a dense solve, on random patterns."""

from dataclasses import replace

import numpy as np
import pytest

from clast.errors import StepOutcome, StepRejected
from clast.linear.block_matrix import row_pointers
from clast.linear.cholesky import Cholesky, analyse
from clast.linear.couplings import Blocks
from clast.linear.ordering import nested_dissection
from clast.linear.solvers import PCG, Automatic
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
        couplings=Blocks(upper=upper, lower=upper.transpose(0, 2, 1)),
        symmetric=True,
        force=rng.normal(size=(count, 6)),
        centroid=rng.normal(size=(count, 2)),
    )


def with_upper(one, upper):
    """Return a symmetric system with other blocks beside the diagonal."""
    return replace(one, couplings=Blocks(upper=upper, lower=upper.transpose(0, 2, 1)))


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


@pytest.mark.parametrize("name", PATTERNS)
def test_every_block_has_its_place_in_the_order(name):
    count, pairs = PATTERNS[name]
    start, neighbour, order = nested_dissection(count, pairs, np.ones(len(pairs), np.bool_))
    assert np.array_equal(np.sort(order), np.arange(count))
    assert len(neighbour) == 2 * len(pairs) == start[-1]


@pytest.mark.parametrize("name", PATTERNS)
def test_factorisation_equals_a_dense_solve(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(2), count, pairs)
    wanted = np.linalg.solve(dense(one), one.force.ravel())
    found = Cholesky().factor(one).solve(one.force).ravel()
    assert np.abs(found - wanted).max() <= 1e-8 * np.abs(wanted).max()
    residual = dense(one) @ found - one.force.ravel()
    assert np.abs(residual).max() < 1e-7


def test_held_blocks_couple_nothing():
    one = random_system(np.random.default_rng(3), 20, grid(4, 5))
    held = 7
    diagonal, upper, force = one.diagonal.copy(), one.upper.copy(), one.force.copy()
    diagonal[held], force[held] = 5.0 * np.eye(6), 0.0
    upper[(one.pairs == held).any(axis=1)] = 0.0
    two = with_upper(replace(one, diagonal=diagonal, force=force), upper)
    found = Cholesky().factor(two).solve(two.force)
    wanted = np.linalg.solve(dense(two), force.ravel())
    assert np.abs(found.ravel() - wanted).max() < 1e-7 * np.abs(wanted).max()
    assert not found[held].any()


def test_a_grid_fills_as_little_as_dissection_promises():
    """n log n blocks: a band along the rows of 80 x 80 blocks would store twice as many."""
    count = 6400
    pairs = grid(80, 80)
    stored = analyse(count, pairs, np.ones(len(pairs), np.bool_)).stored / 36
    assert stored < 0.5 * count * 81
    assert stored < 3.0 * count * np.log2(count)


def test_an_indefinite_matrix_rejects_the_step():
    one = random_system(np.random.default_rng(4), 20, grid(4, 5))
    bad = replace(one, diagonal=one.diagonal - 1e8 * np.eye(6))
    with pytest.raises(StepRejected) as caught:
        Cholesky().factor(bad)
    assert caught.value.outcome is StepOutcome.SINGULAR


def test_an_iteration_that_stalls_is_followed_by_a_factorisation():
    one = random_system(np.random.default_rng(5), 120, grid(8, 15), stiffness=1e9)
    matrix = PCG(iterations=3).factor(one)
    assert matrix.next_solver is None
    found = matrix.solve(one.force)
    assert matrix.next_solver is not None
    assert np.array_equal(found, Cholesky().factor(one).solve(one.force))
    again = Automatic(few=1).factor(one).solve(one.force)
    assert np.abs(again - found).max() < 1e-6 * np.abs(found).max()
