"""Python's own housekeeping during a run."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def left_alone() -> Iterator[Callable[[], None]]:
    """Keep Python from looking through old objects for cycles, as long as this lasts.

    A step makes thousands of objects that need no such search, and each full one goes through all
    of numba's: a twentieth of the time of a run of 10,000 blocks.  Given is what leaves alone also
    those that have come since, such as kernels that a run has just begun to use.
    """
    frozen_by_others = gc.get_freeze_count() > 0
    gc.freeze()
    try:
        yield gc.freeze
    finally:
        if not frozen_by_others:
            gc.unfreeze()
