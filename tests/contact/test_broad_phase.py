"""Broad phase: exactly the overlapping boxes, sorted, at a cost linear in their number."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from clast.contact.broad_phase import overlapping_pairs


def every_pair(box, fixed):
    """Return what overlapping_pairs must return, by looking at all pairs."""
    first, second = np.triu_indices(len(box), k=1)
    a, b = box[first], box[second]
    overlap = (a[:, :2] <= b[:, 2:]).all(axis=1) & (b[:, :2] <= a[:, 2:]).all(axis=1)
    wanted = overlap & ~(fixed[first] & fixed[second])
    return np.stack([first, second], axis=1)[wanted]


def boxes(corner, size):
    return np.ascontiguousarray(np.concatenate([corner, corner + size], axis=1))


def spread(rng, count):
    """Boxes of equal density and sizes over four decades."""
    size = 10.0 ** rng.uniform(-3.0, 1.0, (count, 1)) * rng.uniform(0.3, 1.0, (count, 2))
    return boxes(rng.uniform(-20.0, 20.0, (count, 2)), size)


def clustered(rng, count):
    """Most boxes in one small spot, some far away."""
    centre = rng.choice([0.0, 0.0, 0.0, 500.0, -3e4], count)[:, None]
    return boxes(centre + rng.normal(0.0, 0.3, (count, 2)), rng.uniform(0.01, 0.2, (count, 2)))


def identical(rng, count):
    return np.tile([[1.0, 2.0, 3.0, 5.0]], (count, 1))


def slender(rng, count):
    """Long thin boxes, lying and standing."""
    size = rng.uniform(0.01, 0.05, (count, 2))
    size[np.arange(count), rng.integers(0, 2, count)] *= 200.0
    return boxes(rng.uniform(0.0, 30.0, (count, 2)), size)


def touching(rng, count):
    """Equal boxes on a lattice, that share edges and corners exactly up to round-off."""
    width = 0.1
    row, column = np.divmod(np.arange(count), 17)
    corner = np.stack([width * column, width * row], axis=1) - 3.7
    return boxes(corner, width)


@pytest.mark.parametrize("shape", [spread, clustered, identical, slender, touching])
@pytest.mark.parametrize("count", [2, 3, 60, 400])
def test_finds_exactly_the_overlapping_pairs(shape, count):
    rng = np.random.default_rng(count)
    box = shape(rng, count)
    for share in (0.0, 0.4, 1.0):
        fixed = rng.uniform(size=count) < share
        assert np.array_equal(overlapping_pairs(box, fixed), every_pair(box, fixed))


@given(st.integers(0, 2**32 - 1), st.integers(2, 40))
def test_random_boxes(seed, count):
    rng = np.random.default_rng(seed)
    # corners on a coarse lattice: exact touching is common
    corner = rng.integers(0, 12, (count, 2)) * 0.25
    box = boxes(corner, rng.integers(1, 6, (count, 2)) * 0.25 * 2.0 ** rng.integers(-3, 3))
    fixed = rng.uniform(size=count) < 0.2
    assert np.array_equal(overlapping_pairs(box, fixed), every_pair(box, fixed))


@given(st.floats(-10.0, 10.0), st.floats(0.1, 1.0), st.integers(1, 50))
@example(3.009185525356326, 0.7169877860326253, 49)
@example(-8.81071696799323, 0.8783004658606965, 7)
def test_equal_boxes_side_by_side_on_the_grid(start, width, cells):
    """Cells and boxes of the same size: round-off must not move a neighbour out of sight."""
    left = start + cells * width
    for corner in (np.nextafter(left, -np.inf), left, np.nextafter(left, np.inf)):
        edge = np.array([start, corner, corner + width, corner + width + width])
        box = np.array([[edge[k], 0.0, edge[k + 1], 0.05] for k in (2, 1)])
        box = np.concatenate([[[start, 0.0, start + width, 0.05]], box])
        pairs = overlapping_pairs(box, np.zeros(3, np.bool_))
        assert pairs.tolist()[-1] == [1, 2]


def test_few_boxes():
    assert overlapping_pairs(np.zeros((0, 4)), np.zeros(0, np.bool_)).shape == (0, 2)
    one = np.array([[0.0, 0.0, 1.0, 1.0]])
    assert overlapping_pairs(one, np.zeros(1, np.bool_)).shape == (0, 2)


def test_more_pairs_than_room_was_made_for():
    box = identical(None, 120)
    assert len(overlapping_pairs(box, np.zeros(120, np.bool_))) == 120 * 119 // 2
