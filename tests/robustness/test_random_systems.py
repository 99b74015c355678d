"""Random systems: none overlaps silently, none stops, none gains energy."""

import pytest

from clast.errors import CaseError
from scenes.random_systems import drawn, outcome

SEEDS = (25, 33, 35, 80, 103, 158, 178)
"""Gained energy, stopped, or overlapped without a contact before crossing edges were looked for."""
MORE = range(1000, 1060)


def check(seed):
    """Check one system."""
    found = outcome(drawn(seed))
    report = found.run.report
    assert report.finished or found.share < 0.01
    assert found.gain < 1e-3
    told = {frozenset(one.blocks) for one in report.overlaps}
    assert {frozenset(one.blocks) for one in found.unseen} <= told


def overlap_at_start(seed):
    """Return whether the blocks were drawn in each other."""
    try:
        return len(drawn(seed).model().overlaps.depth) > 0
    except CaseError:
        return True


@pytest.mark.parametrize("seed", SEEDS)
def test_systems_that_failed(seed):
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", MORE)
def test_more_systems(seed):
    if overlap_at_start(seed):
        pytest.skip("the blocks drawn overlap")
    check(seed)
