"""Threads share the work of large systems and change nothing, to the last bit."""

import numba
import numpy as np
import pytest

from clast.compute import chunks as shares
from clast.linear import block_matrix as block_rows
from clast.linear import parts
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from scenes.potentials import Scheduled
from scenes.systems import at_start, by_convex, open_ledger, wall


def steps(model, method, h, count):
    """Return the states after ``count`` steps, and their contacts."""
    state = open_ledger(model, method, at_start(model))
    for _ in range(count):
        result = method.process.step(model, method, state, h)
        state = result.state
    return state, result


@pytest.mark.slow
@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one processor")
@pytest.mark.parametrize(("h", "stiffness"), [(1e-3, 1e11), (2e-2, 5e9)])
def test_same_bits_by_any_number_of_threads(h, stiffness):
    """5,051 bricks, with the interior point method (1 ms) and with levels (20 ms)."""
    model = wall(50, 100)
    method = by_convex(stiffness, process=Scheduled(changes={"patience": 10.0}))
    assert model.block_count >= max(block_rows.SHARED, 2 * parts.LEAST)
    found = []
    threads = numba.get_num_threads()
    for number in (1, 2):
        numba.set_num_threads(number)
        try:
            found.append(steps(model, method, h, 2))
        finally:
            numba.set_num_threads(threads)
    (one, of_one), (other, of_other) = found
    assert len(of_one.contacts) >= shares.MANY
    assert of_one.counts == of_other.counts
    assert of_one.counts["local"] > 0
    assert stiffness == 5e9 or of_one.counts["interior"] > 0
    for name, value in vars(one).items():
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(other, name)), name


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="one processor")
def test_few_blocks_are_left_to_one_thread():
    """Calling others for what takes microseconds would make a small run slower."""
    threads = numba.get_num_threads()
    seen = []

    def watch(_):
        seen.append(numba.get_num_threads())

    try:
        numba.set_num_threads(2)
        for model in (wall(3, 3), wall(25, 40)):
            schedule = Schedule(step=1e-3, end=1e-3, every=1e-3)
            simulate(model, by_convex(5e9), schedule, watch=watch)
            assert numba.get_num_threads() == 2
    finally:
        numba.set_num_threads(threads)
    assert seen == [1, 2]
