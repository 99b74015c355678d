"""Compilation while a program runs, a clock that stands still meanwhile, and times of stages.

numba announces every function that it compiles, and none that it finds on disk.  A kernel is
compiled within the compilation of the kernel that calls it: the time of the outermost counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter, process_time
from typing import Any

from numba.core import event

Tell = Callable[[str | None], None]
"""Called with the module of a kernel before it is compiled, with None when work goes on."""
USED = 0.65
"""Compilations in a run by a process, as a share of the kernels in the files that it loads."""


class Compilation(event.Listener):
    """Counts the kernels that this process compiles, and the time that takes."""

    def __init__(self) -> None:
        self.known = 0
        """Kernels in the files that have been loaded."""
        self.kernels = 0
        """Kernels compiled, or being compiled."""
        self.over = 0.0
        """Wall time of the compilations that are over, s."""
        self.over_by_processor = 0.0
        """Time that the processor took for them, s."""
        self.compiles = 0
        """Functions that are being compiled, one for another."""
        self._begun = 0.0
        self._begun_by_processor = 0.0
        self._reported = 0.0
        self._told: tuple[Tell, ...] = ()

    @property
    def expected(self) -> int:
        """About how many kernels are compiled where none are found on disk."""
        return max(self.kernels, round(USED * self.known))

    @property
    def seconds(self) -> float:
        """Wall time of compilation so far, s."""
        return self.over + (perf_counter() - self._begun if self.compiles else 0.0)

    def unreported(self) -> float:
        """Return the wall time of compilation, s, that no call before has returned."""
        before, self._reported = self._reported, self.seconds
        return self._reported - before

    @contextmanager
    def telling(self, tell: Tell) -> Iterator[None]:
        """Call ``tell`` with the module of every kernel that is compiled meanwhile."""
        before = self._told
        self._told = (*before, tell)
        try:
            yield
        finally:
            self._told = before

    def on_start(self, event: Any) -> None:
        """Count a function that is going to be compiled."""
        if self.compiles == 0:
            self._begun = perf_counter()
            self._begun_by_processor = process_time()
        self.compiles += 1
        module = str(event.data["dispatcher"].py_func.__module__)
        if module.startswith("clast."):
            self.kernels += 1
            self._tell(module)

    def on_end(self, event: Any) -> None:
        """Add its time, if it was not compiled for another one."""
        self.compiles -= 1
        if self.compiles == 0:
            self.over += perf_counter() - self._begun
            self.over_by_processor += process_time() - self._begun_by_processor
            self._tell(None)

    def _tell(self, module: str | None) -> None:
        for tell in self._told:
            tell(module)


COMPILATION = Compilation()
"""The compilation of this process; it belongs to the process as its kernels do."""
event.register("numba:compile", COMPILATION)


def working_time() -> float:
    """Return the wall time since some instant, s, without the time of compilation."""
    return perf_counter() - (COMPILATION.seconds if COMPILATION.compiles else COMPILATION.over)


def processor_time() -> float:
    """Return the time of the processor, s, without that of the compilations that are over."""
    return process_time() - COMPILATION.over_by_processor


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
