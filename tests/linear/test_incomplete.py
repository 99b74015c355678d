"""Incomplete block Cholesky: exact without fill, positive definite always, in pieces if large."""

from dataclasses import replace

import numba
import numpy as np
import pytest

from clast.errors import StepOutcome, StepRejected
from clast.linear import incomplete, parts, substitution
from clast.linear import pcg as conjugate
from clast.linear.cholesky import Cholesky
from clast.linear.solvers import SHIFT, with_incomplete
from scenes.block_matrices import PATTERNS, dense, elastic_grid, grid, random_pairs, random_system


def applied(one):
    """Return the inverse of the factor as a dense matrix, and r.z of each of its columns."""
    ready = with_incomplete(one, 1)
    order, size = ready.incomplete[0], one.force.size
    columns, products = [], []
    for k in range(size):
        r = np.zeros(size)
        r[k] = 1.0
        z, turned = np.empty_like(one.force), np.empty_like(one.force)
        product = substitution.substitute(ready.incomplete, r.reshape(-1, 6)[order], z)
        turned[order] = z
        columns.append(turned.ravel())
        products.append(product)
    return np.array(columns).T, np.array(products)


def without_fill():
    """Yield systems whose factor has no fill in the order of the blocks: chain, star, trees."""
    rng = np.random.default_rng(1)
    chain = np.array([(i, i + 1) for i in range(19)])
    star = np.array([(i, 19) for i in range(19)])
    tree = np.array(sorted((i, int(rng.integers(i + 1, 20))) for i in range(19)))
    for pairs in (chain, star, tree):
        yield random_system(rng, 20, pairs, stiffness=1e2)


def test_it_is_the_inverse_where_nothing_is_left_out():
    for one in without_fill():
        inverse, _ = applied(one)
        # L is kept in single precision, 6e-8, and K's condition is 2,700 to 7,200: off by 1.5e-5
        assert inverse @ dense(one) == pytest.approx(np.eye(120), abs=5e-5)
        found, iterations, _ = with_incomplete(one, 9)(one.force, np.zeros_like(one.force), 1e-6)
        assert iterations <= 2
        wanted = np.linalg.solve(dense(one), one.force.ravel()).reshape(-1, 6)
        assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()


@pytest.mark.parametrize("name", [name for name, (count, _) in PATTERNS.items() if count <= 120])
def test_it_is_symmetric_and_positive_definite(name):
    count, pairs = PATTERNS[name]
    inverse, products = applied(
        random_system(np.random.default_rng(2), count, pairs, stiffness=1e2)
    )
    assert inverse == pytest.approx(inverse.T, rel=1e-9, abs=1e-9 * np.abs(inverse).max())
    assert np.linalg.eigvalsh(0.5 * (inverse + inverse.T)).min() > 0.0
    assert products == pytest.approx(np.diag(inverse), rel=1e-12)


def test_it_stays_positive_definite_where_a_pivot_is_not():
    """Blocks strongly coupled in rings lose their pivots without the fill."""
    rng = np.random.default_rng(3)
    lost = 0
    for _ in range(40):
        count = 12
        pairs = random_pairs(rng, count, 30)
        one = random_system(rng, count, pairs, stiffness=1e4)
        *_, inverse, _ = with_incomplete(one, 1).incomplete
        own = np.linalg.inv(one.diagonal)
        lost += sum(np.allclose(inverse[i], own[i], rtol=1e-6) for i in range(4, count))
        found, _ = applied(one)
        values = np.linalg.eigvalsh(0.5 * (found + found.T))
        assert values.min() > -1e-12 * values.max()
    assert lost > 0


def test_a_block_that_is_not_positive_definite_is_named():
    one = random_system(np.random.default_rng(4), 6, grid(2, 3))
    diagonal = one.diagonal.copy()
    diagonal[3] *= -1.0
    with pytest.raises(StepRejected, match="block 4") as caught:
        with_incomplete(replace(one, diagonal=diagonal), 10)
    assert caught.value.outcome is StepOutcome.SINGULAR


def test_strips_and_their_seam_leave_nothing_out():
    """Two chains, numbered from their free ends, meet in the seam: without fill, so exact."""
    half = parts.LEAST
    along = np.concatenate([np.arange(half), np.arange(2 * half - 1, half - 1, -1)])
    at = np.argsort(along)
    chain = np.sort(np.column_stack([at[:-1], at[1:]]), axis=1)
    chain = chain[np.lexsort(chain.T[::-1])]
    one = random_system(np.random.default_rng(5), 2 * half, chain, stiffness=1e2)
    one = replace(one, centroid=np.column_stack([along, np.zeros(2 * half)]).astype(float))
    ready = with_incomplete(one, 9)
    assert list(ready.incomplete[1]) == [0, half, 2 * half - 1, 2 * half - 1, 2 * half]
    found, iterations, _ = ready(one.force, np.zeros_like(one.force), 1e-6)
    assert iterations <= 2
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()


def eliminated(one, order):
    """Return D^-1 and L^T by place, eliminated block by block in an order, without fill."""
    place = np.argsort(order)
    own = one.diagonal[order].copy()
    upper = {}
    for (i, j), block in zip(place[one.pairs], one.upper, strict=True):
        upper[min(i, j), max(i, j)] = (block if i < j else block.T).copy()
    after = [sorted(k for i, k in upper if i == j) for j in range(len(order))]
    scaled = {}
    for i, others in enumerate(after):
        own[i] = np.linalg.inv(own[i])
        for j in others:
            scaled[i, j] = own[i] @ upper[i, j]
            own[j] -= scaled[i, j].T @ upper[i, j]
            for k in others:
                if k > j and (j, k) in upper:
                    upper[j, k] -= scaled[i, j].T @ upper[i, k]
    return own, scaled


@pytest.mark.parametrize("parted", [True, False])
def test_the_seam_is_eliminated_as_if_one_block_came_after_the_other(parted):
    """By segments, or, where blocks lie anywhere and segments are coupled, as a whole."""
    one = elastic_grid(4 * parts.LEAST // 40 + 5, 40)
    one = replace(one, diagonal=one.diagonal + 1e8 * np.eye(6))
    if not parted:
        anywhere = np.random.default_rng(6).permutation(len(one.centroid))
        one = replace(one, centroid=one.centroid[anywhere])
    coupled = one.couplings.coupled
    order, begin = parts.ordering(one.centroid, one.pairs, coupled)
    assert len(begin) // 2 > 3
    _, found, pairs, right, _, _, inverse, scaled = with_incomplete(one, 1).incomplete
    assert incomplete.is_parted(begin, pairs, right) == parted
    assert np.array_equal(found, begin) == parted
    larger = replace(one, diagonal=(1.0 + SHIFT) * one.diagonal)
    wanted, of_pairs = eliminated(larger, order)
    assert np.abs(inverse - wanted).max() <= 1e-9 * np.abs(wanted).max()
    wanted = np.array([of_pairs[tuple(pair)] for pair in pairs])
    assert np.abs(scaled - wanted).max() <= 1e-6 * np.abs(wanted).max()


def test_many_rows_are_taken_in_strips_whatever_the_threads():
    one = elastic_grid(2 * parts.LEAST // 60 + 10, 60)
    one = replace(one, diagonal=one.diagonal + 1e6 * np.eye(6))
    assert len(with_incomplete(one, 1).incomplete[1]) > 3
    answers = []
    threads = numba.get_num_threads()
    for number in (1, numba.config.NUMBA_NUM_THREADS):
        numba.set_num_threads(number)
        found, _, left = with_incomplete(one, 400)(one.force, np.zeros_like(one.force), 1e-10)
        answers.append(found)
        assert left <= 1e-10
    numba.set_num_threads(threads)
    assert np.array_equal(*answers)
    wanted = Cholesky().factor(one).solve(one.force)
    assert np.abs(found - wanted).max() <= 1e-7 * np.abs(wanted).max()


def widened(short):
    """Return short numbers (compute/vec6.py) in single precision."""
    return (short.astype(np.uint32) << 16).view(np.float32)


def test_substitutions_in_single_precision_are_those_in_double():
    """With strips and without: what a strip leaves for the seam is gathered there."""
    for lines in (5, 2 * parts.LEAST // 60 + 10):
        one = elastic_grid(lines, 60)
        one = replace(one, diagonal=one.diagonal + 1e6 * np.eye(6))
        ready = with_incomplete(one, 9, np.float32)
        r = conjugate.vector(len(one.force), ready.matrix[0])
        r[:, :6] = one.force
        found = np.full_like(r, np.nan)
        of_single = substitution.substitute(ready.incomplete, r, found)
        *rest, inverse, short = ready.incomplete
        same = (*rest, inverse.astype(float), widened(short))
        z = np.empty_like(one.force)
        product = substitution.substitute(same, one.force, z)
        assert np.abs(found[:, :6] - z).max() <= 1e-5 * np.abs(z).max()
        assert of_single == pytest.approx(product, rel=1e-5)


def test_short_numbers_are_those_of_the_factor_in_double_rounded():
    one = elastic_grid(2 * parts.LEAST // 60 + 10, 60)
    one = replace(one, diagonal=one.diagonal + 1e6 * np.eye(6))
    *_, inverse, scaled = with_incomplete(one, 9).incomplete
    *_, single, short = with_incomplete(one, 9, np.float32).incomplete
    assert np.abs(single - inverse).max() <= 1e-5 * np.abs(inverse).max()
    size = np.abs(scaled).max((1, 2), keepdims=True)
    assert (np.abs(widened(short) - scaled) <= np.abs(scaled) / 256.0 + 1e-5 * size).all()


def test_what_is_solved_in_single_precision_starts_from_a_guess_that_is_kept():
    """A guess that is right already is given back to the last digit, not rounded."""
    one = elastic_grid(5, 60)
    one = replace(one, diagonal=one.diagonal + 1e6 * np.eye(6))
    wanted = Cholesky().factor(one).solve(one.force)
    found, _, _ = with_incomplete(one, 9, np.float32)(one.force, wanted, 0.5)
    assert np.abs(found - wanted).max() <= 1e-5 * np.abs(wanted).max()
    same, _, _ = with_incomplete(one, 0, np.float32)(one.force, wanted, 0.5)
    assert np.array_equal(same, wanted)
