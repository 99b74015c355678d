"""Near pairs that are kept from step to step are those of a new search."""

import numpy as np
import pytest

from clast.block import polygon
from clast.compute.parallel import CONTACTS
from clast.contact.broad_phase import SPARE, VerletList, all_within, overlapping_pairs
from scenes.systems import box


def squares(rng, count):
    """Return ``count`` unit squares about a lattice, some of them much larger, (4 count, 2)."""
    side = int(np.ceil(np.sqrt(count)))
    number = np.arange(count)
    corner = 1.1 * np.stack([number % side, number // side], axis=1)
    size = np.where(rng.random(count) < 0.02, 3.0, 1.0)
    return (corner[:, None] + box(0.0, 0.0) * size[:, None, None]).reshape(-1, 2)


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
    steps = int(3 * SPARE)
    for _ in range(steps):
        kept.near_pairs(vertices, start, half, fixed)
        vertices = vertices + 0.01 * np.array([0.6, 0.8])
    assert 1 < kept.searches <= steps / SPARE + 1


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
