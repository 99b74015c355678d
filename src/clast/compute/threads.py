"""How many threads may take part in a run, and their fate in a process that is forked.

GNU's OpenMP would wait for ever in a forked process for its threads, which did not come along, and
numba ends a process that calls it there.  By one thread it is sound: it has nobody to wait for.  So
a forked process works by one thread, whatever its parent did; the results are the same.
"""

from __future__ import annotations

import ctypes
import importlib
import os
from collections.abc import Iterator
from contextlib import contextmanager

import numba
from numba.np.ufunc.parallel import threading_layer

from clast.compute.parallel import BLOCKS


@contextmanager
def threads_worth(blocks: int) -> Iterator[None]:
    """Let one thread work alone, as long as this lasts, where there are too few ``blocks``.

    Nothing that takes long is shared then, but calling the others for the rest costs time.
    """
    asked = numba.get_num_threads()
    if blocks < BLOCKS.many:
        numba.set_num_threads(1)
    try:
        yield
    finally:
        numba.set_num_threads(asked)


def work_alone() -> None:
    """Let one thread do all the work of this process, which was forked from one with more."""
    numba.set_num_threads(1)
    if threading_layer() != "omp":
        return
    # numba refuses OpenMP to any other process than the one that last asked for its threads.  It
    # does not start them a second time.
    address = getattr(importlib.import_module("numba.np.ufunc.omppool"), "launch_threads", None)
    if address is not None:
        ctypes.CFUNCTYPE(None, ctypes.c_int)(address)(1)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=work_alone)
