"""Which contacts close and which hold at first, against the same as conditions on arrays."""

import numpy as np
import pytest

from clast.step import impact as approach


def some(count, seed):
    """Return gaps, opening rates, slip rates and normal forces of both signs and none, (m,)."""
    rng = np.random.default_rng(seed)
    gap, opening, slip, normal = rng.normal(size=(4, count)) * rng.integers(0, 2, (4, count))
    return gap, opening, slip, np.maximum(0.0, normal)


@pytest.mark.parametrize("seed", range(5))
def test_contacts_that_close(seed):
    gap, rate, moved, _ = some(200, seed)
    found = approach.closing(gap, moved, rate, 0.1)
    assert 0 < found.sum() < 200
    assert np.array_equal(found, (rate < -0.1) & (gap + moved < 0.0))


@pytest.mark.parametrize("begins", [True, False])
def test_contacts_that_hold_at_first(begins):
    gap, opening, slip, normal = some(500, 7)
    slow, landing, step, largest = 0.5, 0.1, 0.5, 1e6
    found = approach.first_bases(normal, gap, (opening, slip), slow, landing, step, begins, largest)
    lands = (opening < -landing) & (gap + step * opening < 0.0)
    holds = (np.abs(slip) <= slow) & (lands | begins)
    assert np.array_equal(found, np.where(normal > 0.0, normal, np.where(holds, largest, 0.0)))
    assert set(found[normal == 0.0]) == {0.0, largest}
