"""Broad phase: exactly the overlapping boxes, sorted, at a cost linear in their number."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from clast.block import polygon
from clast.compute.parallel import CONTACTS
from clast.contact.broad_phase import (
    SPARE_WIDENINGS,
    VerletList,
    all_within,
    overlapping_pairs,
)
from scenes.systems import box as square


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


@pytest.mark.parametrize("shape", [spread, clustered, slender, touching])
@pytest.mark.parametrize("count", [2, 3, 60, 400])
def test_finds_exactly_the_overlapping_pairs(shape, count):
    rng = np.random.default_rng(count)
    box = shape(rng, count)
    for share in (0.0, 0.4, 1.0):
        fixed = rng.uniform(size=count) < share
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
    box = np.tile([[1.0, 2.0, 3.0, 5.0]], (120, 1))
    assert len(overlapping_pairs(box, np.zeros(120, np.bool_))) == 120 * 119 // 2


# --- pairs that are kept from step to step


def squares(rng, count):
    """Return ``count`` unit squares about a lattice, some of them much larger, (4 count, 2)."""
    side = int(np.ceil(np.sqrt(count)))
    number = np.arange(count)
    corner = 1.1 * np.stack([number % side, number // side], axis=1)
    size = np.where(rng.random(count) < 0.02, 3.0, 1.0)
    return (corner[:, None] + square(0.0, 0.0) * size[:, None, None]).reshape(-1, 2)


def searched(vertices, start, half, fixed):
    """Return the near pairs as a new search finds them."""
    wide = polygon.boxes(vertices, start) + half[:, None] * np.array([-1.0, -1.0, 1.0, 1.0])
    return overlapping_pairs(wide, fixed)


@pytest.mark.parametrize("count", [1, 2, 60, CONTACTS.many + 100])
@pytest.mark.parametrize("speed", [0.0, 0.01, 0.5])
def test_the_same_as_a_new_search(count, speed):
    rng = np.random.default_rng(count)
    vertices, start = squares(rng, count), np.arange(0, 4 * count + 1, 4)
    fixed = rng.random(count) < 0.1
    velocity = np.repeat(rng.normal(size=(count, 2)) * speed, 4, axis=0)
    kept = VerletList()
    for step in range(12):
        half = 0.01 + rng.random(count) * 0.02 * (1 + step % 3)
        found = kept.near_pairs(vertices, start, half, fixed)
        assert np.array_equal(found, searched(vertices, start, half, fixed))
        none = np.zeros(count)
        found = kept.near_pairs(vertices, start, none, fixed)
        assert np.array_equal(found, searched(vertices, start, none, fixed))
        vertices = vertices + velocity
    if count > 2:
        assert (kept.searches == 1) if speed == 0.0 else (kept.searches > 1)


def test_a_slow_block_is_looked_for_once_in_several_steps():
    vertices, start = squares(np.random.default_rng(1), 50), np.arange(0, 201, 4)
    half, fixed, kept = np.full(50, 0.01), np.zeros(50, bool), VerletList()
    steps = int(3 * SPARE_WIDENINGS)
    for _ in range(steps):
        kept.near_pairs(vertices, start, half, fixed)
        vertices = vertices + 0.01 * np.array([0.6, 0.8])
    assert 1 < kept.searches <= steps / SPARE_WIDENINGS + 1


def test_other_blocks_are_looked_for_anew():
    rng = np.random.default_rng(2)
    start, half = np.arange(0, 201, 4), np.full(50, 0.01)
    vertices = squares(rng, 50)
    kept = VerletList()
    for number in range(3):
        fixed = np.arange(50) % 3 == number  # another array, other pairs that do not count
        found = kept.near_pairs(vertices, start, half, fixed)
        assert np.array_equal(found, searched(vertices, start, half, fixed))
    assert kept.searches == 3


def test_what_is_no_number_lies_within_nothing():
    wide = np.array([[0.0, 0.0, 1.0, 1.0]] * 3)
    assert all_within(wide, wide)
    for side in range(4):
        for odd in (np.nan, 2.0 if side > 1 else -1.0):
            outside = wide.copy()
            outside[1, side] = odd
            assert not all_within(outside, wide)
