"""Python's own housekeeping during a run."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

MANY = 100_000
"""New objects after which Python looks for cycles among them during a run."""


@contextmanager
def left_alone() -> Iterator[None]:
    """Keep Python from looking for cycles among old objects, and often, as long as this lasts.

    A step makes thousands of objects and no cycles, and kernels that are loaded make many more.
    """
    frozen_by_others = gc.get_freeze_count() > 0
    usual = gc.get_threshold()
    gc.freeze()
    if usual[0] > 0:
        gc.set_threshold(max(usual[0], MANY), *usual[1:])
    try:
        yield
    finally:
        gc.set_threshold(*usual)
        if not frozen_by_others:
            gc.unfreeze()
