"""Numbers by their power of two, beside numpy's frexp."""

import numpy as np
import pytest

from clast.kernels.powers import HIGHEST, LOWEST, by_power


@pytest.mark.parametrize("seed", range(5))
def test_each_number_is_counted_with_its_power(seed):
    rng = np.random.default_rng(seed)
    numbers = np.exp2(rng.uniform(-1080.0, 1023.9, 400)) * rng.choice([0.0, 1.0], 400, p=[0.1, 0.9])
    numbers[:3] = 0.5, 1.0, 2.0
    power, together, count = by_power(numbers)
    positive = numbers > 0.0
    assert np.array_equal(power[positive], np.frexp(numbers[positive])[1])
    assert np.all(power[~positive] == LOWEST - 1)
    for k in range(HIGHEST - LOWEST + 1):
        its = numbers[power == LOWEST + k]
        assert count[k] == len(its)
        assert together[k] == pytest.approx(its.sum(), rel=1e-14)


def test_the_smallest_and_the_largest_number_have_a_place():
    ends = np.array([np.nextafter(0.0, 1.0), np.finfo(float).max])
    power, together, count = by_power(ends)
    assert list(power) == [LOWEST, HIGHEST]
    assert list(count[[0, -1]]) == [1, 1]
    assert list(together[[0, -1]]) == list(ends)
