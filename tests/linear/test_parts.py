"""Strips of blocks that do not touch each other, and the seam between them."""

import numpy as np
import pytest

from clast.linear import parts
from clast.linear.block_matrix import row_pointers


def lattice(columns, rows):
    """Return the centroids of blocks in columns and rows, and the pairs of neighbours."""
    number = np.arange(columns * rows).reshape(rows, columns)
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    pairs = np.concatenate(
        [
            np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()]),
            np.column_stack([number[:-1].ravel(), number[1:].ravel()]),
        ]
    )
    return np.column_stack([x.ravel(), y.ravel()]).astype(float), pairs[np.lexsort(pairs.T[::-1])]


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize("size", [(30, 40), (100, 100), (40, 250), (300, 100)])
def test_strips_are_not_coupled(size, shuffled):
    centroid, pairs = lattice(*size)
    count = len(centroid)
    if shuffled:
        place = np.random.default_rng(1).permutation(count)
        centroid = centroid[np.argsort(place)]
        pairs = np.sort(place[pairs], axis=1)
        pairs = pairs[np.lexsort(pairs.T[::-1])]
    order, begin = parts.ordering(centroid, pairs, np.ones(len(pairs), np.bool_))
    strips = len(begin) // 2
    assert strips == parts.number_of_strips(count)
    assert np.array_equal(np.sort(order), np.arange(count))
    part = np.empty(count, int)
    part[order] = np.searchsorted(begin[: strips + 1], np.arange(count), side="right") - 1
    one, other = part[pairs].T
    assert ((one == other) | (one == strips) | (other == strips)).all()
    assert begin[-1] == count
    if strips > 1:
        assert np.diff(begin)[:strips].min() > 0.6 * count / strips
        assert count - begin[strips] <= (strips - 1) * min(size)


def test_pairs_are_renumbered():
    rng = np.random.default_rng(2)
    pairs = np.array(sorted({tuple(sorted(rng.choice(20, 2, replace=False))) for _ in range(60)}))
    coupled = rng.random(len(pairs)) < 0.7
    order = rng.permutation(20)
    new, source, rows = parts.renumbered(order, pairs, row_pointers(20, pairs), coupled)
    for found, wanted in zip(rows, row_pointers(20, new), strict=True):
        assert np.array_equal(found, wanted)
    assert len(new) == coupled.sum()
    assert np.array_equal(new, new[np.lexsort(new.T[::-1])])
    for (i, j), q in zip(new, source, strict=True):
        assert i < j
        old = pairs[q] if q >= 0 else pairs[-1 - q][::-1]
        assert coupled[q if q >= 0 else -1 - q]
        assert tuple(order[[i, j]]) == tuple(old)


def test_blocks_in_one_place_are_one_strip():
    _, count = parts.strips(np.zeros((3 * parts.LEAST, 2)))
    assert count == 1


def test_four_times_as_many_blocks_have_twice_as_many_strips():
    """Whatever the threads: the sums depend on it."""
    found = {count: parts.number_of_strips(count) for count in (100, 799, 800, 3199, 3200, 12800)}
    assert found == {100: 1, 799: 1, 800: 2, 3199: 2, 3200: 4, 12800: 8}
    assert parts.number_of_strips(10_000_000) == parts.MOST
