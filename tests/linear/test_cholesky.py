"""Block Cholesky against a dense solve, on random patterns."""

from dataclasses import replace

import numpy as np
import pytest

from clast.errors import StepOutcome, StepRejected
from clast.linear.cholesky import Cholesky, analyse
from clast.linear.ordering import nested_dissection
from clast.linear.solvers import PCG, Automatic
from scenes.block_matrices import (
    PATTERNS,
    dense,
    grid,
    random_system,
    with_upper,
)


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
