"""Random polygons, convex and not, fall into a trough and settle."""

import pytest

from scenes.systems import Finished, by_convex, finish, heap, overlaps

YOUNG = 5e9
LONGEST = 1.1
"""Largest size of a block, m."""


def check(done: Finished) -> None:
    """Assert that nothing failed, nothing passed through and no energy came from nowhere."""
    assert done.failed_steps == 0
    deepest = done.run.report.largest_penetration
    through = [
        (i, j, area)
        for i, j, area in overlaps(done.run.model, done.run.state.vertices)
        if area > deepest * LONGEST
    ]
    assert not through
    assert abs(done.run.report.ledger.unaccounted) < 1e-6 * done.turnover
    assert done.created <= 1e-9 * done.turnover


@pytest.mark.parametrize("share", [0.01, 1.0, 10.0])
@pytest.mark.one_in(3)
def test_a_heap_settles_with_large_steps(share: float) -> None:
    # a block may lean for long before it topples: one did from 2.0 to 2.9 s
    done = finish(heap(30, 6), by_convex(share * YOUNG, max_displacement=0.05), 5e-3, 3.5)
    check(done)
    assert done.run.report.ledger.kinetic < 1e-3 * done.turnover


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.01, 0.1, 1.0, 10.0])
def test_a_heap_settles_with_small_steps(share: float) -> None:
    check(finish(heap(30, 6), by_convex(share * YOUNG, max_displacement=0.05), 1e-3, 1.5))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 3, 4])
def test_other_heaps_settle_as_well(seed: int) -> None:
    how = by_convex(YOUNG, max_displacement=0.05)
    check(finish(heap(30, 6, seed=seed), how, 5e-3, 1.5))
