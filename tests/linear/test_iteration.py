"""Iterations of one system: without and with a coarse system, from a guess, one by one."""

from dataclasses import replace

import numpy as np
import pytest

from clast.contact.contacts import ContactResponse
from clast.linear.block_matrix import multiply, row_pointers
from clast.linear.cholesky import Cholesky, CholeskyFactor
from clast.linear.reuse import FactorOfStep
from clast.linear.solvers import (
    DIRECTION,
    LIGHT,
    PCG,
    ROUGH,
    TRIED,
    IteratedMatrix,
    Shifted,
    inertia_shares,
    precision_for,
    suffices_alone,
    with_aggregates,
    with_incomplete,
)
from scenes.block_matrices import PATTERNS, dense, elastic_grid, grid, random_system, with_upper


def by_incomplete(one, guess, tolerance, limit):
    """Return d, iterations and reduction by the incomplete factor alone."""
    return with_incomplete(one, limit)(one.force, guess, tolerance)


def heavier(one, inertia):
    """Return a system with so much more inertia in every block."""
    return replace(one, diagonal=one.diagonal + inertia * np.eye(6))


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


@pytest.mark.parametrize("name", PATTERNS)
def test_the_incomplete_factor_reaches_the_dense_solution(name):
    count, pairs = PATTERNS[name]
    # stiffer couplings than ten times the diagonals may break the factor of a grid with fill
    one = random_system(np.random.default_rng(1), count, pairs, stiffness=10.0)
    wanted = np.linalg.solve(dense(one), one.force.ravel()).reshape(-1, 6)
    found, _, left = by_incomplete(one, np.zeros_like(one.force), 1e-12, 100_000)
    assert left <= 1e-12
    assert np.abs(found - wanted).max() <= 1e-8 * np.abs(wanted).max()


def test_a_factor_that_is_no_preconditioner_is_noticed():
    """Next to singular pivots: r.B r falls by 1e-6 in a few iterations that have solved nothing."""
    one = random_system(np.random.default_rng(1), *PATTERNS["grid"], stiffness=1e6)
    for precision in (np.float64, np.float32):
        _, iterations, left = with_incomplete(one, 1000, precision)(one.force, None, 1e-3)
        assert iterations < 10
        assert left == np.inf
    matrix = dense(one)
    wanted = np.linalg.solve(matrix, one.force.ravel())
    error = PCG(tolerance=1e-3).factor(one).solve(one.force).ravel() - wanted
    # 1e-3 in the norm of a B that is so far from K^-1 is 0.05 in that of K
    assert error @ matrix @ error <= 0.1**2 * (wanted @ matrix @ wanted)


def test_a_guess_is_improved_by_the_share_asked_for():
    one = heavier(elastic_grid(8, 8), 1e6)
    wanted = Cholesky().factor(one).solve(one.force)
    guess = wanted + 1e-3 * np.random.default_rng(2).normal(size=wanted.shape)
    for iteration in (PCG(plain=100), PCG(plain=0)):
        found = iteration.factor(one).nearer(one.force, guess, 1e-4)
        assert np.abs(found - wanted).max() <= 1e-3 * np.abs(guess - wanted).max()
    assert np.array_equal(by_incomplete(one, wanted, 1e300, 10)[0], wanted)


def test_the_share_of_inertia_is_what_a_common_translation_feels():
    """Springs between blocks add nothing to it, and all to the blocks' own stiffness."""
    sheet = elastic_grid(10, 10)
    for inertia in (1e2, 1e6, 1e8):
        one = heavier(sheet, inertia)
        two = np.eye(6)[:, :2]
        everywhere = np.tile(two, (len(one.diagonal), 1))
        felt = np.trace(everywhere.T @ dense(one) @ everywhere)
        own = sum(np.trace(block[:2, :2]) for block in one.diagonal)
        assert inertia_shares(one)[0] == pytest.approx(felt / own, rel=1e-9)


def test_blocks_that_are_coupled_to_none_do_not_count_in_the_share():
    """A large fixed base has a diagonal of its own size and no couplings."""
    one = heavier(elastic_grid(6, 6), 1e6)
    diagonal = np.concatenate([one.diagonal, [1e12 * np.eye(6)]])
    rows = row_pointers(len(diagonal), one.pairs)
    wider = replace(one, diagonal=diagonal, rows=rows)
    assert inertia_shares(wider)[0] == pytest.approx(inertia_shares(one)[0])
    assert inertia_shares(with_upper(one, np.zeros_like(one.upper))) == (1.0, 1.0)


def test_the_least_share_of_inertia_is_that_of_the_weakest_block_in_its_weakest_direction():
    sheet = heavier(elastic_grid(5, 5), 1e5)
    light = sheet.diagonal.copy()
    light[12, :2, :2] += 0.99e5 * np.array([[-0.5, 0.5], [0.5, -0.5]])
    one = replace(sheet, diagonal=light)
    rest = dense(one).reshape(25, 6, 25, 6).sum(axis=2)[:, :2, :2]
    own = np.trace(light[:, :2, :2], axis1=1, axis2=2)
    shares = 2.0 * np.linalg.eigvalsh(rest)[:, 0] / own
    assert shares.argmin() == 12
    assert inertia_shares(one)[1] == pytest.approx(shares[12], rel=1e-9)
    assert shares[12] < 0.1 * np.delete(shares, 12).min()


def test_couplings_are_read_in_single_precision_where_that_is_enough():
    heavy = heavier(elastic_grid(10, 10, stiffness=1e6 / 3.0), 1e7)
    wanted = Cholesky().factor(heavy).solve(heavy.force)
    size, kinds = 2.0 * np.abs(wanted).max(), {}
    for tolerance in (1e-3, 1e-8):
        matrix = PCG(tolerance=tolerance).factor(heavy)
        kinds[tolerance] = matrix._iteration.matrix[1].dtype
        assert np.abs(matrix.solve(heavy.force) - wanted).max() <= size * tolerance
        assert matrix.next_solver is None
    assert kinds == {1e-3: np.float32, 1e-8: np.float64}
    for tolerance in (1e-3, 1e-8):
        matrix = PCG(plain=0, tolerance=tolerance).factor(heavy)
        assert matrix._iteration.matrix[1].dtype == kinds[tolerance]
        assert np.abs(matrix.solve(heavy.force) - wanted).max() <= size * tolerance
    assert precision_for(heavy, DIRECTION, LIGHT) is np.float32
    assert precision_for(heavy, DIRECTION, 0.9 * LIGHT) is np.float64
    assert precision_for(heavy, 0.1 * DIRECTION, 9.0 * LIGHT) is np.float64
    assert precision_for(heavy, ROUGH, 1.0) is np.float32
    assert precision_for(heavy, 0.9 * ROUGH, 1.0) is np.float64
    chain = heavier(elastic_grid(1, 10), 1e7)
    assert precision_for(chain, ROUGH, 1.0) is np.float64


@pytest.mark.parametrize("weight", [3e2, 3e1, 3e0])
def test_what_is_solved_in_single_precision_goes_where_the_solution_is(weight):
    """Down to a share of inertia of LIGHT: the error's energy is small beside the solution's."""
    one = heavier(elastic_grid(30, 30, stiffness=1e6 / 3.0), weight)
    _, least = inertia_shares(one)
    assert precision_for(one, DIRECTION, least) is np.float32
    matrix = PCG(tolerance=DIRECTION).factor(one)
    force = one.force + np.array([1e3, -2e3, 0.0, 0.0, 0.0, 0.0])  # all of them pushed together
    found, wanted = matrix.solve(force), Cholesky().factor(one).solve(force)
    assert matrix.by_rows[1].dtype == np.float32
    assert matrix.next_solver is None
    error = (found - wanted).ravel()
    energy = [v @ dense(one) @ v for v in (error, wanted.ravel())]
    # 3e-4, 5e-4 and 2.4e-3 where the least share is 1.1e-4, 1.2e-5 and 1.5e-6
    assert energy[0] <= 5e-3**2 * energy[1]


def test_what_is_multiplied_with_is_the_matrix():
    one = heavier(elastic_grid(9, 7), 1e7)
    x, y = np.random.default_rng(8).normal(size=one.force.shape), np.empty_like(one.force)
    wanted = (dense(one) @ x.ravel()).reshape(-1, 6)
    for plain in (0, 100):
        matrix = PCG(plain=plain).factor(one)
        order = matrix._iteration.incomplete[0]
        energy = multiply(*matrix.by_rows, x[order], y)
        assert y == pytest.approx(wanted[order], rel=1e-12, abs=1e-9 * np.abs(wanted).max())
        assert energy == pytest.approx(np.sum(x * wanted), rel=1e-12)


def test_rounding_that_would_outweigh_the_inertia_of_the_blocks_is_not_done():
    """Rounded up, couplings take away more than there is, for want of any inertia to speak of."""
    one = heavier(elastic_grid(8, 8, stiffness=1e6 / 3.0), 1e-4 - 1.0)
    rounded = with_upper(one, one.upper.astype(np.float32).astype(np.float64))
    assert np.linalg.eigvalsh(dense(rounded)).min() < 0.0 < np.linalg.eigvalsh(dense(one)).min()
    matrix = PCG(tolerance=1e-3).factor(one)
    assert matrix._iteration.matrix[1].dtype == np.float64
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(matrix.solve(one.force) - wanted).max() <= 1e-2 * np.abs(wanted).max()


def test_single_precision_takes_as_many_iterations():
    one = heavier(elastic_grid(30, 30, stiffness=1e6 / 3.0), 1e3)
    needed = []
    for precision in (np.float32, np.float64):
        found, iterations, left = with_aggregates(one, 400, precision)(one.force, None, 1e-5)
        residual = dense(one) @ found.ravel() - one.force.ravel()
        assert np.abs(residual).max() <= 1e-2 * np.abs(one.force).max()
        assert left <= 1e-5
        needed.append(iterations)
    assert abs(needed[0] - needed[1]) <= 2


def test_the_preconditioner_is_as_strong_as_the_system_is_stiff():
    soft, stiff = heavier(elastic_grid(10, 10), 1e7), elastic_grid(10, 10)
    assert suffices_alone(soft, *inertia_shares(soft))
    assert not suffices_alone(stiff, *inertia_shares(stiff))
    for one, plain in ((soft, True), (stiff, False)):
        matrix = PCG().factor(one)
        assert isinstance(matrix, IteratedMatrix)
        assert (len(matrix._iteration.coarse[1]) == 1) is plain
        wanted = Cholesky().factor(one).solve(one.force)
        found = matrix.solve(one.force)
        assert matrix.next_solver is None
        assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()


def test_a_slow_iteration_is_left_early():
    one = elastic_grid(30, 30)
    _, iterations, left = by_incomplete(one, np.zeros_like(one.force), 1e-8, 20)
    assert iterations == TRIED
    assert left > 1e-8


def test_a_coarse_system_is_added_and_then_a_factorisation_takes_over(monkeypatch):
    monkeypatch.setattr("clast.linear.solvers.HEAVY", 0.0)
    one = elastic_grid(20, 20)
    matrix = PCG(tolerance=1e-8, plain=3).factor(one)
    found = matrix.solve(one.force)
    assert matrix.next_solver == PCG(tolerance=1e-8, plain=0)
    assert matrix.iterated > 3
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()
    short = PCG(tolerance=1e-8, plain=3, iterations=2).factor(one)
    assert np.array_equal(short.solve(one.force), wanted)
    assert isinstance(short.next_solver.factor(one), CholeskyFactor)


@pytest.mark.parametrize(("tolerance", "accuracy"), [(1e-8, 1e-5), (1e-3, 0.1)])
@pytest.mark.parametrize("shift", [-0.2, -0.25])
def test_pivots_next_to_singular_are_kept_away_from_it(monkeypatch, tolerance, accuracy, shift):
    """Diagonals that are too small make such pivots; in either precision no matrix is factorised.

    That takes about as long as 500 iterations with 10,000 blocks.
    """
    monkeypatch.setattr("clast.linear.solvers.SHIFT", shift)
    one = elastic_grid(20, 20)
    precision = precision_for(one, tolerance, inertia_shares(one)[1])
    _, _, left = with_aggregates(one, 400, precision, shift)(one.force, None, tolerance)
    assert not left <= 1.0
    matrix = PCG(tolerance=tolerance, plain=0).factor(one)
    found = matrix.solve(one.force)
    assert matrix.next_solver == Shifted(tolerance, 400)
    assert matrix.iterated < 60
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(found - wanted).max() <= accuracy * np.abs(wanted).max()


def test_what_is_no_number_is_no_answer():
    """A factor that has overflown: what comes next takes over."""
    one = elastic_grid(20, 20)
    ready = with_aggregates(one, 400)
    *others, inverse, scaled = ready.incomplete
    bad = replace(ready, incomplete=(*others, np.full_like(inverse, np.inf), scaled))
    matrix = IteratedMatrix(one, bad, Shifted(1e-8, 400), 1e-8)
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(matrix.solve(one.force) - wanted).max() <= 1e-5 * np.abs(wanted).max()
    assert matrix.next_solver == Shifted(1e-8, 400)


def test_a_step_goes_back_to_its_solver_more_and_more_rarely(monkeypatch):
    """After a stall the other solver gets 1 matrix, then 2, then 4."""
    monkeypatch.setattr("clast.linear.solvers.HEAVY", 0.0)
    one = elastic_grid(10, 10)
    tried = []

    class Recorded(PCG):
        def factor(self, system):
            if self.plain > 0:
                tried.append(number)
            return super().factor(system)

    factor = FactorOfStep(Recorded(tolerance=1e-6, plain=2))
    for number in range(12):
        factor.nearer(one, response_of(number), np.zeros_like(one.force), 1e-6)
    assert factor.factorised == 12
    assert tried == [0, 2, 5, 10]


def test_one_system_is_made_ready_once():
    one = random_system(np.random.default_rng(3), 60, grid(6, 10))
    factor = FactorOfStep(PCG())
    for _ in range(3):
        factor.solve(one, response_of(1.0))
    assert (factor.factorised, factor.solved) == (1, 3)
    factor.solve(one, response_of(2.0))
    assert (factor.factorised, factor.solved) == (2, 4)
