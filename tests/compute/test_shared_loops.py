"""Pieces of loops that threads share: each is done once, by whoever comes first."""

import numba
import numpy as np
import pytest

from clast.compute.parallel import LINE, nothing_done, prange, threads_of, to_do


@numba.njit
def left_for(thread, progress, pieces, at_most):
    """Return what a thread does when it is asked ``at_most`` times."""
    done = np.empty(pieces, np.int64)
    number = 0
    for piece in to_do(thread, progress, pieces):
        done[number] = piece
        number += 1
        if number == at_most:
            break
    return done[:number]


@numba.njit(parallel=True)
def done_by_threads(pieces, times):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for piece in to_do(thread, progress, pieces):
            times[piece] += 1
    return progress


def test_a_thread_does_its_own_stretch_and_then_what_others_have_left():
    progress = np.zeros(3 * LINE, np.int64)
    assert list(left_for(1, progress, 12, 5)) == [4, 5, 6, 7, 8]
    assert list(left_for(0, progress, 12, 2)) == [0, 1]
    assert list(left_for(2, progress, 12, 12)) == [9, 10, 11, 2, 3]
    assert not len(left_for(0, progress, 12, 12))


@pytest.mark.parametrize("pieces", [0, 1, 2, 3, 1000, 100_001])
def test_every_piece_is_done_once(pieces):
    asked = numba.get_num_threads()
    for threads in range(1, numba.config.NUMBA_NUM_THREADS + 1):
        numba.set_num_threads(threads)
        times = np.zeros(pieces, np.int64)
        assert threads_of(done_by_threads(pieces, times)) == threads
        assert (times == 1).all()
    numba.set_num_threads(asked)
