"""Iterations of one system: without and with a coarse space, refined, from a guess, one by one."""

from dataclasses import replace

import numpy as np
import pytest

from clast.contact.contacts import ContactResponse
from clast.linear import pcg
from clast.linear.block_matrix import coupled_pairs, inertia_shares, multiply, row_pointers
from clast.linear.factor_cache import FactorOfStep
from clast.linear.pattern import Patterns
from clast.linear.solvers import (
    PCG,
    SAFE_SHIFT,
    SHIFT,
    TRIAL_ITERATIONS,
    Attempt,
    Direct,
    ExactFactor,
    IteratedMatrix,
    Iteration,
    solve,
    suffices_alone,
)
from scenes.block_matrices import PATTERNS, dense, elastic_grid, random_system, with_upper

PLAIN = Attempt(coarse=False, shift=SHIFT, iterations=400, trial=TRIAL_ITERATIONS)
COARSE = Attempt(coarse=True, shift=SHIFT, iterations=400, trial=TRIAL_ITERATIONS)
SAFE = Attempt(coarse=True, shift=SAFE_SHIFT, iterations=400, trial=40)


def by_attempts(one, *attempts, tolerance=1e-8):
    """Return a system iterated by attempts, one after the other."""
    return Iteration(tolerance, attempts).factor(one, Patterns())


def heavier(one, inertia):
    """Return a system with so much more inertia in every block."""
    return replace(one, diagonal=one.diagonal + inertia * np.eye(6))


def shares(one):
    """Return the share of inertia of all blocks, and the least of any."""
    return inertia_shares(one.diagonal, one.upper, one.rows, coupled_pairs(one.upper))


def response_of(stiffness):
    """Return an answer of a law by which systems are told apart."""
    one, nothing = np.array([stiffness]), np.zeros(1)
    return ContactResponse(
        normal_force=nothing,
        shear_force=nothing,
        normal_stiffness=one,
        shear_stiffness=nothing,
        coupling=nothing,
        mode=np.zeros(1, np.int64),
        bonded=np.zeros(1, np.bool_),
        energy=nothing,
        dissipation=nothing,
    )


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("name", PATTERNS)
def test_the_dense_solution_is_reached_as_nearly_as_asked(name, tolerance):
    """Beyond single precision by refinement."""
    count, pairs = PATTERNS[name]
    # stiffer couplings than ten times the diagonals may break the factor of a grid with fill
    one = random_system(np.random.default_rng(1), count, pairs, stiffness=10.0)
    wanted = np.linalg.solve(dense(one), one.force.ravel()).reshape(-1, 6)
    matrix = by_attempts(one, replace(PLAIN, iterations=10_000), tolerance=tolerance)
    found = matrix.solve(one.force)
    assert matrix.next_solver is None
    assert np.abs(found - wanted).max() <= 100.0 * tolerance * np.abs(wanted).max()


def test_a_factor_that_is_no_preconditioner_is_noticed():
    """Next to singular pivots: what is left by the measure of r.B r says nothing then."""
    one = elastic_grid(20, 20)
    singular = replace(COARSE, shift=-0.25)
    ready = singular.ready(one, coupled_pairs(one.upper), Patterns())
    _, iterations, size, left = pcg.solve(ready, one.force, 0.0, 1e-3, 400, 400)
    assert not left <= 1e-3 * size
    assert iterations < 400


def test_a_guess_is_improved_by_the_share_asked_for():
    one = heavier(elastic_grid(8, 8), 1e6)
    wanted = solve(Direct(), one)
    guess = wanted + 1e-3 * np.random.default_rng(2).normal(size=wanted.shape)
    for attempt in (PLAIN, COARSE):
        found = by_attempts(one, attempt).nearer(one.force, guess, 1e-4)
        assert np.abs(found - wanted).max() <= 1e-3 * np.abs(guess - wanted).max()


def test_the_product_in_double_precision_is_that_of_the_matrix():
    one = heavier(elastic_grid(9, 7), 1e7)
    x = np.random.default_rng(8).normal(size=one.force.shape)
    wanted = (dense(one) @ x.ravel()).reshape(-1, 6)
    found = multiply(one.diagonal, one.upper, one.pairs, one.rows, x)
    assert found == pytest.approx(wanted, rel=1e-12, abs=1e-12 * np.abs(wanted).max())


def test_the_share_of_inertia_is_what_a_common_translation_feels():
    """Springs between blocks add nothing to it, and all to the blocks' own stiffness."""
    sheet = elastic_grid(10, 10)
    for inertia in (1e2, 1e6, 1e8):
        one = heavier(sheet, inertia)
        two = np.eye(6)[:, :2]
        everywhere = np.tile(two, (len(one.diagonal), 1))
        felt = np.trace(everywhere.T @ dense(one) @ everywhere)
        own = sum(np.trace(block[:2, :2]) for block in one.diagonal)
        assert shares(one)[0] == pytest.approx(felt / own, rel=1e-9)


def test_blocks_that_are_coupled_to_none_do_not_count_in_the_share():
    """A large fixed base has a diagonal of its own size and no couplings."""
    one = heavier(elastic_grid(6, 6), 1e6)
    diagonal = np.concatenate([one.diagonal, [1e12 * np.eye(6)]])
    rows = row_pointers(len(diagonal), one.pairs)
    assert shares(replace(one, diagonal=diagonal, rows=rows))[0] == pytest.approx(shares(one)[0])
    assert shares(with_upper(one, np.zeros_like(one.upper))) == (1.0, 1.0)


@pytest.mark.parametrize("weight", [3e2, 3e1, 3e0])
def test_a_direction_in_single_precision_goes_where_the_solution_is(weight):
    """Down to a share of inertia of 1e-6: the error's energy is small beside the solution's."""
    one = heavier(elastic_grid(30, 30, stiffness=1e6 / 3.0), weight)
    matrix = by_attempts(one, COARSE, tolerance=1e-3)
    force = one.force + np.array([1e3, -2e3, 0.0, 0.0, 0.0, 0.0])  # all of them pushed together
    found, wanted = matrix.solve(force), Direct().factor(one, Patterns()).solve(force)
    assert matrix.next_solver is None
    error = (found - wanted).ravel()
    energy = [v @ dense(one) @ v for v in (error, wanted.ravel())]
    # 3e-4, 5e-4 and 2.4e-3 where the least share is 1.1e-4, 1.2e-5 and 1.5e-6
    assert energy[0] <= 5e-3**2 * energy[1]


def test_rounding_that_outweighs_the_inertia_of_the_blocks_is_left_to_an_exact_factor():
    """Rounded up, couplings take away more than there is, for want of any inertia to speak of."""
    one = heavier(elastic_grid(8, 8, stiffness=1e6 / 3.0), 1e-4 - 1.0)
    rounded = with_upper(one, one.upper.astype(np.float32).astype(np.float64))
    assert np.linalg.eigvalsh(dense(rounded)).min() < 0.0 < np.linalg.eigvalsh(dense(one)).min()
    wanted = solve(Direct(), one)
    found = solve(PCG(tolerance=1e-8), one)
    assert np.abs(found - wanted).max() <= 1e-6 * np.abs(wanted).max()


def test_the_preconditioner_is_as_strong_as_the_system_is_stiff():
    soft, stiff = heavier(elastic_grid(10, 10), 1e7), elastic_grid(10, 10)
    assert suffices_alone(soft, coupled_pairs(soft.upper))
    assert not suffices_alone(stiff, coupled_pairs(stiff.upper))
    for one, plain in ((soft, True), (stiff, False)):
        matrix = PCG().factor(one, Patterns())
        assert isinstance(matrix, IteratedMatrix)
        assert (len(matrix.ready[2][1]) == 1) is plain
        wanted = solve(Direct(), one)
        found = matrix.solve(one.force)
        assert matrix.next_solver is None
        assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()


def test_a_slow_iteration_is_left_early():
    one = elastic_grid(30, 30)
    matrix = by_attempts(one, replace(PLAIN, iterations=20))
    matrix.solve(one.force)
    assert matrix.iterated == TRIAL_ITERATIONS
    assert matrix.next_solver == Direct()


def test_a_coarse_space_is_added_and_then_an_exact_factor_takes_over():
    one = elastic_grid(20, 20)
    matrix = by_attempts(one, replace(PLAIN, iterations=3), COARSE)
    found = matrix.solve(one.force)
    assert matrix.next_solver == Iteration(1e-8, (COARSE,))
    assert matrix.iterated > 3
    wanted = solve(Direct(), one)
    assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()
    short = by_attempts(one, replace(PLAIN, iterations=3), replace(COARSE, iterations=2))
    assert np.array_equal(short.solve(one.force), wanted)
    assert isinstance(short.next_solver.factor(one, Patterns()), ExactFactor)


@pytest.mark.parametrize(("tolerance", "accuracy"), [(1e-8, 1e-5), (1e-3, 0.1)])
@pytest.mark.parametrize("shift", [-0.2, -0.25])
def test_pivots_next_to_singular_are_kept_away_from_it(tolerance, accuracy, shift):
    """Diagonals that are too small make such pivots; no matrix is factorised exactly.

    That takes about as long as 200 iterations with 10,000 blocks.
    """
    one = elastic_grid(20, 20)
    matrix = by_attempts(one, replace(COARSE, shift=shift), SAFE, tolerance=tolerance)
    found = matrix.solve(one.force)
    assert matrix.next_solver == Iteration(tolerance, (SAFE,))
    assert matrix.iterated < 80
    wanted = solve(Direct(), one)
    assert np.abs(found - wanted).max() <= accuracy * np.abs(wanted).max()


def test_what_is_no_number_is_no_answer():
    """A right-hand side beyond single precision: an exact factor takes over."""
    one = elastic_grid(20, 20)
    matrix = by_attempts(one, COARSE)
    force = 1e60 * one.force
    wanted = Direct().factor(one, Patterns()).solve(force)
    assert np.array_equal(matrix.solve(force), wanted)
    assert matrix.next_solver == Direct()


def test_a_step_goes_back_to_its_solver_more_and_more_rarely():
    """After a stall the other solver gets 1 matrix, then 2, then 4."""
    one = elastic_grid(10, 10)
    tried = []

    class Recorded(Iteration):
        def factor(self, system, patterns):
            tried.append(number)
            return super().factor(system, patterns)

    factor = FactorOfStep(Recorded(1e-6, (replace(PLAIN, iterations=2), COARSE)))
    for number in range(12):
        factor.nearer(one, response_of(number), np.zeros_like(one.force), 1e-6)
    assert factor.factorised == 12
    assert tried == [0, 2, 5, 10]
