"""The coarse system of aggregates: which there are, what is solved, what it gives the iteration."""

from dataclasses import replace

import numba
import numpy as np
import pytest

from clast.errors import StepOutcome, StepRejected
from clast.linear import aggregates, substitution
from clast.linear import block_matrix as block_rows
from clast.linear import coarse_kernels as coarse
from clast.linear import pcg as conjugate
from clast.linear.cholesky import Cholesky
from clast.linear.coarse_space import LAST, aggregates_of, number_of_aggregates
from clast.linear.solvers import PCG, with_aggregates, with_incomplete
from scenes.block_matrices import PATTERNS, dense, elastic_grid, grid, random_system


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
    return with_aggregates(one, limit)(one.force, None, tolerance)


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
        of_blocks = aggregates.bisected(place, number)
        sizes = np.bincount(of_blocks, minlength=number)
        assert len(sizes) == number
        assert sizes.max() - sizes.min() <= 1
    halves = aggregates.bisected(scattered, number) >= number // 2
    if number > 1:
        assert scattered[~halves, 0].max() <= scattered[halves, 0].min()


def test_aggregates_of_a_row_follow_each_other():
    row = np.stack([np.arange(64.0), np.zeros(64)], axis=1)
    shuffled = np.random.default_rng(2).permutation(64)
    of_blocks = aggregates.bisected(row[shuffled], 16)
    assert np.array_equal(of_blocks, shuffled // 4)


@pytest.mark.parametrize("name", PATTERNS)
def test_elimination_fills_the_pattern_and_nothing_else(name):
    count, pairs = PATTERNS[name]
    order, found = coarse.filled(count, pairs)
    place = np.empty(count, np.int64)
    place[order] = np.arange(count)
    full = np.zeros((count, count), bool)
    full[place[pairs[:, 0]], place[pairs[:, 1]]] = True
    full |= full.T
    for column in range(count):
        below = np.flatnonzero(full[column])
        below = below[below > column]
        full[np.ix_(below, below)] = True
    assert np.array_equal(found, np.argwhere(np.triu(full, 1)))


@pytest.mark.parametrize("name", PATTERNS)
def test_the_coarse_system_is_the_projection_and_is_solved_exactly(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(2), count, pairs, stiffness=1e3)
    ready = with_aggregates(one, 100)
    order = ready.incomplete[0]
    aggregate, start, members, offset, factor = ready.coarse
    number = len(start) - 1
    alone = ~np.isin(order, np.asarray(pairs))
    assert np.array_equal(aggregate < 0, alone)
    assert np.array_equal(np.sort(members), np.flatnonzero(~alone))
    blocks = np.arange(6 * count).reshape(count, 6)[order].ravel()
    projection = prolongation(aggregate, offset, number)
    wanted = projection.T @ dense(one)[np.ix_(blocks, blocks)] @ projection
    empty = np.repeat(np.diff(start) == 0, 6)
    wanted[empty, empty] = 1.0
    r = np.random.default_rng(3).normal(size=(number, 6))
    z = np.empty_like(r)
    product = substitution.substitute(factor, r, z)
    exact = np.linalg.solve(wanted, r.ravel())
    # L is kept in single precision, and springs are 1e3 times as stiff as blocks are heavy
    assert np.abs(z.ravel() - exact).max() <= 1e-4 * np.abs(exact).max()
    assert product == pytest.approx(np.sum(r * z), rel=1e-12)


@pytest.mark.parametrize("name", PATTERNS)
def test_iteration_equals_a_dense_solve(name):
    count, pairs = PATTERNS[name]
    # stiffer couplings than ten times the diagonals may break the factor of a grid with fill
    one = random_system(np.random.default_rng(2), count, pairs, stiffness=10.0)
    wanted = np.linalg.solve(dense(one), one.force.ravel())
    found, _, reduction = solved(one, limit=2000)
    assert reduction <= 1e-10
    assert np.abs(found.ravel() - wanted).max() <= 1e-7 * np.abs(wanted).max()


@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_what_is_preconditioned_with_is_symmetric_and_positive(precision):
    count = 36
    one = random_system(np.random.default_rng(5), count, grid(6, 6), stiffness=1e4)
    ready = with_aggregates(one, 100, precision)
    number = len(ready.coarse[1]) - 1
    assert number > 1
    r = conjugate.vector(count, ready.matrix[0])
    z, p, of_coarse = np.empty_like(r), r.copy(), tuple(conjugate.vector(number, r) for _ in "12")
    columns = []
    for k in range(6 * count):
        r[:, :6] = np.eye(6 * count)[k].reshape(count, 6)
        product = conjugate._precondition(ready.incomplete, ready.coarse, r, z, of_coarse)
        conjugate._turn_to(ready.coarse, z, of_coarse, 0.0, p)
        assert product == pytest.approx(p[k // 6, k % 6], rel=1e-5)
        columns.append(p[:, :6].astype(float).ravel())
    matrix = np.array(columns)
    near = {np.float64: 1e-10, np.float32: 1e-5}[precision]
    assert np.abs(matrix - matrix.T).max() <= near * np.abs(matrix).max()
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() > 0.0


def test_iterations_grow_far_less_than_the_width_of_a_sheet():
    """With the incomplete factor alone they are in proportion to it."""
    needed = {}
    for way in (with_incomplete, with_aggregates):
        sheets = [elastic_grid(n, n) for n in (10, 40)]
        needed[way] = [way(one, 1000)(one.force, None, 1e-8)[1] for one in sheets]
    few, many = needed[with_aggregates]
    assert many <= 2.0 * few  # 19 and 32
    few, more = needed[with_incomplete]
    assert more >= 3.0 * few  # 83 and 315
    assert many < 0.2 * more


def test_aggregates_are_found_once_for_all_systems_of_a_step():
    one = elastic_grid(10, 10)
    first = LAST.of(one)
    assert LAST.of(replace(one, diagonal=2.0 * one.diagonal)) is first
    moved = replace(one, centroid=one.centroid + 1.0)
    assert LAST.of(moved) is not first
    assert np.allclose(LAST.of(moved).offset, aggregates_of(one).offset)
    fewer = replace(one, pairs=one.pairs[:-1])
    assert len(LAST.of(fewer).pairs) <= len(first.pairs)
    assert LAST.of(fewer) is not first


@pytest.mark.parametrize("precision", [np.float64, np.float32])
def test_answers_do_not_depend_on_the_number_of_threads(precision):
    one = elastic_grid(60, 60)
    one = replace(one, diagonal=one.diagonal + 1e3 * np.eye(6))
    assert len(one.diagonal) >= block_rows.SHARED
    threads = numba.get_num_threads()
    try:
        answers = []
        for number in (1, numba.config.NUMBA_NUM_THREADS):
            numba.set_num_threads(number)
            answers.append(with_aggregates(one, 500, precision)(one.force, None, 1e-5)[0])
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
