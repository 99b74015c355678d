"""Time of the stages of a step, one after the other; that of compilation is not counted."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

from clast.compute.compilation import COMPILATION

Clock = Callable[[], float]
"""Returns the time since some instant, s."""


class Stages:
    """Adds up time by stage: ``stages("contacts")`` ends the stage before and begins this one.

    ``with stages("contacts"): ...`` ends it, too, after which nothing is counted until the next.
    The ``clock`` is wall time without that of compilation if none is given.
    """

    def __init__(self, clock: Clock | None = None) -> None:
        self.seconds: dict[str, float] = {}
        self._clock = clock
        self._stage = ""
        self._since = 0.0

    def __call__(self, name: str) -> Stages:
        """End the stage before, if there is one, and begin ``name``, or go on with it."""
        before, seconds = self._stage, self.seconds
        if name == before:
            return self
        clock = self._clock
        now = perf_counter() - COMPILATION.over if clock is None else clock()
        if before in seconds:
            seconds[before] += now - self._since
        elif before:
            seconds[before] = now - self._since
        self._stage, self._since = name, now
        return self

    def ended(self) -> dict[str, float]:
        """End the last stage, and return the time of each, s."""
        self("")
        return self.seconds

    def __enter__(self) -> None:
        """Go on with the stage that has just begun."""

    def __exit__(self, *fault: Any) -> None:
        """End it."""
        self("")
