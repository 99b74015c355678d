"""Loops made of a body that says nothing of threads."""

import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from numba.np.ufunc import parallel as numba_threads

from clast.compute.jit import BY_THREADS
from clast.compute.parallel import Sharing, shared, summed

FEW = Sharing(part=4, many=10)


@shared(FEW)
def add(first, last, a, both, total):
    """Write a + b + c."""
    b, c = both
    for i in range(first, last):
        total[i] += a[i] + b[i] + c[i]


@summed(FEW)
def dot(first, last, a, b):
    """Return a.b."""
    found = 0.0
    for i in range(first, last):
        found += a[i] * b[i]
    return found


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 12, 41])
def test_every_piece_is_done_once(count: int):
    a, b, c = np.random.default_rng(count).random((3, count))
    total = np.zeros(count)
    add(count, a, (b, c), total)
    np.testing.assert_array_equal(total, a + b + c)
    assert dot(count, a, b) == pytest.approx(a @ b, rel=1e-14)


def test_parts_are_summed_in_their_order():
    """To the bit, by any number of threads: what is next to nothing is lost in a certain place."""
    a = np.array([1.0, *np.full(4000, 1e-16), -1.0, *np.full(4000, 1e-16)])
    total = 0.0
    for first in range(0, len(a), FEW.part):
        part = 0.0
        for value in a[first : first + FEW.part]:
            part += value
        total += part
    assert dot(len(a), a, np.ones(len(a))) == total


def test_a_loop_keeps_the_name_and_words_of_its_body():
    assert add.__doc__ == "Write a + b + c."
    assert add.py_func.__module__ == __name__


@pytest.mark.slow
def test_the_same_by_several_threads():
    """The same tests in a process that has two, where this one has one."""
    if BY_THREADS:
        pytest.skip("this process has several")
    answer = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", __file__],
        env={**os.environ, "NUMBA_NUM_THREADS": "2"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert answer.returncode == 0, answer.stdout


# --- forks ---------------------------------------------------------------------------------------


@pytest.mark.skipif(sys.platform != "linux", reason="numba has that lock where forks are usual")
def test_a_fork_that_is_killed_keeps_no_lock():
    numba_threads._launch_threads()
    lock, child = numba_threads._backend_init_process_lock, os.fork()
    if child == 0:
        numba_threads._launch_threads()
        numba_threads._backend_init_process_lock.acquire()
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    assert lock.acquire(timeout=5.0), "threads would wait for it for ever"
    lock.release()
