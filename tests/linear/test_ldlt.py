"""Block LDL^T against a dense solve, on random patterns, with fill and without."""

from dataclasses import replace

import numpy as np
import pytest

from clast.errors import StepOutcome, StepRejected
from clast.linear import ldlt, ordering
from clast.linear.block_matrix import coupled_pairs, row_pointers
from clast.linear.pattern import (
    FILL,
    exact_pattern,
    strips_of,
    with_fill,
    without_fill,
)
from clast.linear.solvers import SHIFT, Direct, solve
from scenes.block_matrices import (
    PATTERNS,
    dense,
    elastic_grid,
    grid,
    random_pairs,
    random_system,
    with_upper,
)


def tree(rng, count):
    """Return the pairs of a random tree of blocks with random numbers."""
    number = rng.permutation(count)
    parents = np.array([rng.integers(0, k) for k in range(1, count)])
    pairs = np.sort(np.stack([number[parents], number[1:]], axis=1), axis=1)
    return np.ascontiguousarray(pairs[np.lexsort(pairs.T[::-1])])


@pytest.mark.parametrize("name", PATTERNS)
def test_every_block_has_its_place_in_the_order(name):
    count, pairs = PATTERNS[name]
    start, neighbour, order = ordering.nested_dissection(count, pairs, np.ones(len(pairs), bool))
    assert np.array_equal(np.sort(order), np.arange(count))
    assert len(neighbour) == 2 * len(pairs) == start[-1]


@pytest.mark.parametrize("name", PATTERNS)
def test_the_pattern_has_all_fill_and_nothing_else(name):
    count, pairs = PATTERNS[name]
    order, _, found, *rows, source = with_fill(count, pairs, np.ones(len(pairs), bool))
    place = np.argsort(order)
    full = np.zeros((count, count), bool)
    full[place[pairs[:, 0]], place[pairs[:, 1]]] = True
    full |= full.T
    known = np.triu(full, 1)
    for column in range(count):
        below = np.flatnonzero(full[column])
        below = below[below > column]
        full[np.ix_(below, below)] = True
    assert np.array_equal(found, np.argwhere(np.triu(full, 1)))
    assert np.array_equal(source != FILL, known[tuple(found.T)])
    for mine, wanted in zip(rows, row_pointers(count, found), strict=True):
        assert np.array_equal(mine, wanted)


def test_trees_have_no_fill_however_they_are_numbered():
    rng = np.random.default_rng(1)
    for pairs in (tree(rng, 300), PATTERNS["star"][1], PATTERNS["chain"][1]):
        count = int(pairs.max()) + 1
        _, _, found, *_ = with_fill(count, pairs, np.ones(len(pairs), bool))
        assert len(found) == len(pairs)


def test_a_grid_fills_as_little_as_dissection_promises():
    """n log n blocks: a band along the rows of 80 x 80 blocks would store twice as many."""
    count, pairs = 6400, grid(80, 80)
    _, _, found, *_ = with_fill(count, pairs, np.ones(len(pairs), bool))
    assert len(found) < 0.5 * count * 81
    assert len(found) < 3.0 * count * np.log2(count)


@pytest.mark.parametrize("name", PATTERNS)
def test_the_exact_factor_equals_a_dense_solve(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(2), count, pairs)
    wanted = np.linalg.solve(dense(one), one.force.ravel())
    found = solve(Direct(), one).ravel()
    assert np.abs(found - wanted).max() <= 1e-8 * np.abs(wanted).max()
    residual = dense(one) @ found - one.force.ravel()
    assert np.abs(residual).max() < 1e-7


@pytest.mark.parametrize("seed", range(10))
def test_couplings_between_any_blocks_are_solved_exactly(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 22))
    one = random_system(rng, count, random_pairs(rng, count, int(rng.integers(0, 80))), 1e3)
    wanted = np.linalg.solve(dense(one), one.force.ravel()).reshape(-1, 6)
    assert solve(Direct(), one) == pytest.approx(wanted, rel=1e-9, abs=1e-10)


def test_springs_a_thousand_times_as_stiff_as_the_rock_leave_a_small_residual():
    """p = 1,000 E in steps of 1 ms: the condition of K is 1e10 and more."""
    one = elastic_grid(20, 20, stiffness=1e13)
    diagonal = one.diagonal.copy()
    diagonal[:, [0, 1, 2], [0, 1, 2]] += 1e3
    one = replace(one, diagonal=diagonal)
    found = solve(Direct(), one)
    residual = dense(one) @ found.ravel() - one.force.ravel()
    scale = np.abs(dense(one)).max() * np.abs(found).max()
    assert np.abs(residual).max() <= 1e-14 * scale


def test_held_blocks_couple_nothing():
    one = random_system(np.random.default_rng(3), 20, grid(4, 5))
    held = 7
    diagonal, upper, force = one.diagonal.copy(), one.upper.copy(), one.force.copy()
    diagonal[held], force[held] = 5.0 * np.eye(6), 0.0
    upper[(one.pairs == held).any(axis=1)] = 0.0
    fixed = np.arange(20) == held
    two = with_upper(replace(one, diagonal=diagonal, force=force, fixed=fixed), upper)
    pattern = exact_pattern(two)
    place = np.flatnonzero(pattern[0] == held)
    assert not np.isin(pattern[2], place).any()
    found = solve(Direct(), two)
    wanted = np.linalg.solve(dense(two), force.ravel())
    assert np.abs(found.ravel() - wanted).max() < 1e-7 * np.abs(wanted).max()
    assert not found[held].any()


@pytest.mark.parametrize("change", [-1e8, np.nan])
def test_a_matrix_that_is_not_positive_definite_rejects_the_step(change):
    one = random_system(np.random.default_rng(4), 20, grid(4, 5))
    bad = replace(one, diagonal=one.diagonal + change * np.eye(6))
    with pytest.raises(StepRejected) as caught:
        solve(Direct(), bad)
    assert caught.value.outcome is StepOutcome.SINGULAR


# --- without fill ----------------------------------------------------------------------------


def incomplete(one, shift=0.0):
    """Return the factor without fill, K in its order and the first block without a pivot."""
    order, begin = strips_of(one)
    pattern = without_fill(order, begin, one.pairs, one.rows, coupled_pairs(one.upper))
    return ldlt.incomplete(pattern, one.diagonal, one.upper, shift)


def product_of(factor):
    """Return L D L^T as a dense matrix in the order of the blocks."""
    (order, _, pairs, *_), inverse, scaled = factor
    count = len(order)
    lower = np.zeros((count, 6, count, 6))
    middle = np.zeros_like(lower)
    for k in range(count):
        lower[k, :, k] = np.eye(6)
        middle[k, :, k] = np.linalg.inv(inverse[k].astype(float))
    for (i, j), block in zip(pairs, scaled, strict=True):
        lower[j, :, i] = block.T
    lower, middle = lower.reshape(6 * count, -1), middle.reshape(6 * count, -1)
    blocks = np.argsort((6 * np.asarray(order)[:, None] + np.arange(6)).ravel())
    return (lower @ middle @ lower.T)[np.ix_(blocks, blocks)]


def test_nothing_is_left_out_where_there_is_no_fill():
    """Chains in the order of their blocks, and the star whose middle comes last."""
    rng = np.random.default_rng(1)
    along = np.stack([np.arange(20.0), np.zeros(20)], axis=1)
    for pairs in (grid(1, 20), np.array([(i, 19) for i in range(19)])):
        one = replace(random_system(rng, 20, pairs, stiffness=1e2), centroid=along)
        factor, _, bad = incomplete(one)
        assert bad == -1
        # in single precision, 6e-8, with pivots of a condition of some 1,000
        assert np.abs(product_of(factor) - dense(one)).max() <= 1e-4 * np.abs(dense(one)).max()


@pytest.mark.parametrize("name", [name for name, (count, _) in PATTERNS.items() if count <= 120])
def test_it_is_k_where_k_has_blocks_and_positive_definite(name):
    count, pairs = PATTERNS[name]
    one = random_system(np.random.default_rng(2), count, pairs, stiffness=1.0)
    factor, (own, upper), bad = incomplete(one)
    assert bad == -1
    found = product_of(factor).reshape(count, 6, count, 6)
    assert np.linalg.eigvalsh(found.reshape(6 * count, -1)).min() > 0.0
    scale = np.abs(one.diagonal).max()
    for i in range(count):
        assert found[i, :, i] == pytest.approx(one.diagonal[i], abs=1e-5 * scale)
    for (i, j), block in zip(one.pairs, one.upper, strict=True):
        assert found[i, :, j] == pytest.approx(block, abs=1e-5 * scale)
    order, _, new, *_ = factor[0]
    assert np.array_equal(own, one.diagonal[order].astype(np.float32))
    known = dense(one).reshape(count, 6, count, 6)
    for (i, j), block in zip(new, upper, strict=True):
        assert np.array_equal(block, known[order[i], :, order[j]].astype(np.float32))


def test_it_stays_positive_definite_where_a_pivot_is_not():
    """Blocks strongly coupled in rings lose their pivots without the fill."""
    rng, lost = np.random.default_rng(3), 0
    for _ in range(40):
        one = random_system(rng, 12, random_pairs(rng, 12, 30), stiffness=1e4)
        factor, _, bad = incomplete(one)
        assert bad == -1
        (order, *_), inverse, _ = factor
        own = np.linalg.inv(one.diagonal)[order]
        lost += sum(np.allclose(inverse[k], own[k], rtol=1e-3) for k in range(4, 12))
        for block in inverse.astype(float):
            assert np.linalg.eigvalsh(0.5 * (block + block.T)).min() > 0.0
    assert lost > 0


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


@pytest.mark.slow  # no fewer blocks have four strips
@pytest.mark.parametrize("parted", [True, False])
@pytest.mark.one_in(2)
def test_the_seam_is_eliminated_as_if_one_block_came_after_the_other(parted):
    """By segments, or, where segments are coupled, as a whole."""
    one = elastic_grid(4 * ordering.LEAST // 40 + 5, 40)
    one = replace(one, diagonal=one.diagonal + 1e8 * np.eye(6))
    if not parted:  # neighbours lie anywhere
        anywhere = np.random.default_rng(6).permutation(len(one.centroid))
        one = replace(one, centroid=one.centroid[anywhere])
    factor, _, bad = incomplete(one, SHIFT)
    (order, begin, pairs, *_), inverse, scaled = factor
    assert bad == -1
    assert len(begin) // 2 > 3
    assert ldlt.is_parted(factor[0]) and (np.diff(begin)[-1] > 0) == parted
    larger = replace(one, diagonal=(1.0 + SHIFT) * one.diagonal)
    wanted, of_pairs = eliminated(larger, order)
    assert np.abs(inverse - wanted).max() <= 1e-5 * np.abs(wanted).max()
    wanted = np.array([of_pairs[tuple(pair)] for pair in pairs])
    assert np.abs(scaled - wanted).max() <= 1e-5 * np.abs(wanted).max()


# --- strips ----------------------------------------------------------------------------------


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize("size", [(30, 40), (100, 100), (40, 250), (300, 100)])
def test_strips_are_not_coupled(size, shuffled):
    columns, lines = size
    number = np.arange(columns * lines).reshape(lines, columns)
    x, y = np.meshgrid(np.arange(columns), np.arange(lines))
    pairs = np.concatenate(
        [
            np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()]),
            np.column_stack([number[:-1].ravel(), number[1:].ravel()]),
        ]
    )
    centroid, count = np.column_stack([x.ravel(), y.ravel()]).astype(float), columns * lines
    if shuffled:
        place = np.random.default_rng(1).permutation(count)
        centroid, pairs = centroid[np.argsort(place)], np.sort(place[pairs], axis=1)
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    order, begin = ordering.strips(centroid, pairs, np.ones(len(pairs), bool))
    strips = len(begin) // 2
    assert strips == ordering.number_of_strips(count)
    assert np.array_equal(np.sort(order), np.arange(count))
    part = np.empty(count, int)
    part[order] = np.searchsorted(begin[: strips + 1], np.arange(count), side="right") - 1
    one, other = part[pairs].T
    assert ((one == other) | (one == strips) | (other == strips)).all()
    assert begin[-1] == count
    if strips > 1:
        assert np.diff(begin)[:strips].min() > 0.6 * count / strips
        assert count - begin[strips] <= (strips - 1) * (min(size) + 2)


def test_pairs_are_renumbered():
    rng = np.random.default_rng(2)
    pairs = np.array(sorted({tuple(sorted(rng.choice(20, 2, replace=False))) for _ in range(60)}))
    coupled = rng.random(len(pairs)) < 0.7
    order = rng.permutation(20)
    begin = np.array([0, 20, 20])
    *_, new, right, left, listed, source = without_fill(
        order, begin, pairs, row_pointers(20, pairs), coupled
    )
    for found, wanted in zip((right, left, listed), row_pointers(20, new), strict=True):
        assert np.array_equal(found, wanted)
    assert len(new) == coupled.sum()
    assert np.array_equal(new, new[np.lexsort(new.T[::-1])])
    for (i, j), q in zip(new, source, strict=True):
        assert i < j
        old = pairs[q] if q >= 0 else pairs[-1 - q][::-1]
        assert coupled[q if q >= 0 else -1 - q]
        assert tuple(order[[i, j]]) == tuple(old)


def test_blocks_in_one_line_are_ordered_along_it():
    line = np.stack([np.zeros(50), np.random.default_rng(1).permutation(50)], axis=1)
    assert np.array_equal(line[ordering.by_rows(line), 1], np.arange(50))
