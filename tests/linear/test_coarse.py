"""The coarse system of aggregates: which there are, what is solved, what it gives the iteration."""

from dataclasses import replace

import numpy as np
import pytest

from clast.errors import StepOutcome, StepRejected
from clast.linear import coarse_space, pcg
from clast.linear.block_matrix import coupled_pairs
from clast.linear.coarse_space import number_of_aggregates
from clast.linear.pattern import Patterns
from clast.linear.pcg import substitute
from clast.linear.solvers import PCG, SHIFT, Attempt
from scenes.block_matrices import PATTERNS, dense, elastic_grid, grid, random_system


def ready(one, coarse=True):
    """Return what linear/pcg.py iterates with."""
    attempt = Attempt(coarse=coarse, shift=SHIFT, iterations=1, trial=1)
    return attempt.ready(one, coupled_pairs(one.upper), Patterns())


def iterations(one, coarse):
    """Return how many are needed for the accuracy of single precision."""
    _, needed, size, left = pcg.solve(ready(one, coarse), one.force, 0.0, 1e-5, 2000, 2000)
    assert left <= 1e-5 * size
    return needed


def prolongation(parent, offset, count):
    """Return P (6n, 6N): every block follows its aggregate as a material point of it does."""
    matrix = np.zeros((len(parent), 6, count, 6))
    for i, (k, (x, y)) in enumerate(zip(parent, offset, strict=True)):
        if k >= 0:
            matrix[i, :, k] = np.eye(6)
            matrix[i, 0, k] = [1.0, 0.0, -y, x, 0.0, 0.5 * y]
            matrix[i, 1, k] = [0.0, 1.0, x, 0.0, y, 0.5 * x]
    return matrix.reshape(6 * len(parent), 6 * count)


@pytest.mark.parametrize(
    ("blocks", "number"), [(1, 1), (3, 1), (100, 16), (1000, 64), (10**4, 256), (10**6, 8192)]
)
def test_ten_times_as_many_blocks_have_five_times_as_many_aggregates(blocks, number):
    assert number_of_aggregates(blocks) == number


@pytest.mark.parametrize(("count", "number"), [(1, 1), (8, 8), (37, 4), (1000, 64)])
def test_blocks_are_halved_again_and_again(count, number):
    rng = np.random.default_rng(1)
    scattered = np.stack([4.0 * rng.random(count), rng.random(count)], axis=1)
    for place in (scattered, np.zeros((count, 2)), np.round(scattered)):
        of_blocks = coarse_space.bisected(place, number)
        sizes = np.bincount(of_blocks, minlength=number)
        assert len(sizes) == number
        assert sizes.max() - sizes.min() <= 1
    halves = coarse_space.bisected(scattered, number) >= number // 2
    if number > 1:
        assert scattered[~halves, 0].max() <= scattered[halves, 0].min()


def test_aggregates_of_a_row_follow_each_other():
    row = np.stack([np.arange(64.0), np.zeros(64)], axis=1)
    shuffled = np.random.default_rng(2).permutation(64)
    of_blocks = coarse_space.bisected(row[shuffled], 16)
    assert np.array_equal(of_blocks, shuffled // 4)


@pytest.mark.parametrize("name", PATTERNS)
def test_the_coarse_system_is_the_projection_and_is_solved_exactly(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(2), count, pairs, stiffness=1e3)
    ((order, *_), *_), _, coarse = ready(one)
    aggregate, start, members, offset, factor = coarse
    number = len(start) - 1
    alone = ~np.isin(order, np.asarray(pairs))
    assert np.array_equal(aggregate < 0, alone)
    assert np.array_equal(np.sort(members), np.flatnonzero(~alone))
    blocks = np.arange(6 * count).reshape(count, 6)[order].ravel()
    projection = prolongation(aggregate, offset, number)
    wanted = projection.T @ dense(one)[np.ix_(blocks, blocks)] @ projection
    empty = np.repeat(np.diff(start) == 0, 6)
    wanted[empty, empty] = 1.0
    r, z = pcg.vector(number), pcg.vector(number)
    r[:, :6] = np.random.default_rng(3).normal(size=(number, 6))
    product = substitute(factor, r, z)
    exact = np.linalg.solve(wanted, r[:, :6].astype(float).ravel())
    # all is in single precision, and springs are 1e3 times as stiff as blocks are heavy
    assert np.abs(z[:, :6].ravel() - exact).max() <= 1e-3 * np.abs(exact).max()
    assert product == pytest.approx(np.sum(r.astype(float) * z), rel=1e-12)


@pytest.mark.parametrize("name", PATTERNS)
def test_iteration_equals_a_dense_solve(name):
    count, pairs = PATTERNS[name]
    # stiffer couplings than ten times the diagonals may break the factor of a grid with fill
    one = random_system(np.random.default_rng(2), count, pairs, stiffness=10.0)
    wanted = np.linalg.solve(dense(one), one.force.ravel())
    matrix = PCG(tolerance=1e-10, plain=0).factor(one, Patterns())
    found = matrix.solve(one.force)
    assert matrix.next_solver is None
    assert np.abs(found.ravel() - wanted).max() <= 1e-7 * np.abs(wanted).max()


def test_what_is_preconditioned_with_is_symmetric_and_positive():
    count = 36
    one = random_system(np.random.default_rng(5), count, grid(6, 6), stiffness=1e4)
    factor, _, coarse = ready(one)
    number = len(coarse[1]) - 1
    assert number > 1
    r, z = pcg.vector(count), pcg.vector(count)
    p, of_coarse = pcg.vector(count), (pcg.vector(number), pcg.vector(number))
    columns = []
    for k in range(6 * count):
        r[:, :6] = np.eye(6 * count)[k].reshape(count, 6)
        product = pcg._precondition(factor, coarse, r, z, of_coarse)
        pcg._turn_to(coarse, z, of_coarse, 0.0, p)
        assert product == pytest.approx(p[k // 6, k % 6], rel=1e-5)
        columns.append(p[:, :6].astype(float).ravel())
    matrix = np.array(columns)
    assert np.abs(matrix - matrix.T).max() <= 1e-5 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0.0


def test_iterations_grow_far_less_than_the_width_of_a_sheet():
    """With the factor without fill alone they are in proportion to it."""
    sheets = [elastic_grid(n, n) for n in (10, 40)]
    few, many = (iterations(one, True) for one in sheets)
    assert many <= 2.0 * few
    some, more = (iterations(one, False) for one in sheets)
    assert more >= 2.5 * some
    assert many < 0.25 * more


def test_a_block_without_stiffness_is_named():
    one = random_system(np.random.default_rng(7), 30, grid(5, 6))
    diagonal = one.diagonal.copy()
    diagonal[4] = 0.0
    with pytest.raises(StepRejected, match="block 5") as caught:
        PCG().factor(replace(one, diagonal=diagonal), Patterns())
    assert caught.value.outcome is StepOutcome.SINGULAR
