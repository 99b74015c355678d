"""The line on the terminal that says how far a run is; silent where there is no terminal."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

    from clast.run.schedule import Progress

Watch = Callable[["Progress"], None]
"""Called after every accepted step."""

REFRESH = 0.1
"""Time between updates of the line, s of wall time."""
SHARE_OF_TIME = "{task.percentage:>3.0f}%"


@contextmanager
def shown(progress: bool | Watch) -> Iterator[Watch | None]:
    """Give what to call after every step: nothing, the caller's own function, or a line."""
    if callable(progress):
        yield progress
    elif progress:
        with _line() as line:
            yield line
    else:
        yield None


@contextmanager
def _line() -> Iterator[Watch | None]:
    """Show a line on stderr while the run goes, where stderr is a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (BarColumn(bar_width=24), TextColumn(SHARE_OF_TIME), TextColumn("{task.description}"))
    with Bar(*columns, console=console, transient=True) as bar:
        yield _Line(bar)


class _Line:
    """Turns the progress of a run into a bar and a sentence of numbers."""

    def __init__(self, bar: Bar) -> None:
        self._bar = bar
        self._task = bar.add_task(_first_words(), total=1.0)
        self._shown = 0.0
        self._start: tuple[float, float] | None = None

    def __call__(self, progress: Progress) -> None:
        now = perf_counter()
        if self._start is None:
            self._start = now, progress.time
        if now - self._shown < REFRESH:
            return
        self._shown = now
        self._bar.update(
            self._task,
            completed=progress.time / progress.end,
            description=status_text(progress, self._speed(now, progress.time)),
        )

    def _speed(self, now: float, time: float) -> float:
        """Return the simulated time per wall time since the first step, 0 at first."""
        start_wall, start_time = self._start or (now, time)
        return (time - start_time) / (now - start_wall) if now > start_wall else 0.0


def status_text(progress: Progress, speed: float) -> str:
    """Return where a run is: simulated time, step size, contacts, speed, time left."""
    parts = [
        f"t {progress.time:.4g} of {progress.end:.4g} s",
        f"step {progress.step:.2g} s",
        f"{progress.contacts} contacts",
    ]
    if speed > 0.0:
        left = round((progress.end - progress.time) / speed)
        parts.append(f"{speed:.2g} s/s")
        parts.append(f"{left // 3600}:{left // 60 % 60:02d}:{left % 60:02d} left")
    return "  ".join(parts)


def _first_words() -> str:
    if kernels_are_compiled():
        return "starting"
    return "compiling the kernels: once after installation, clast warmup does it ahead"


def kernels_are_compiled() -> bool:
    """Return whether compiled kernels of an earlier run are found."""
    spec = find_spec("clast")
    folders = [Path(place) for place in (spec.submodule_search_locations or ())] if spec else []
    if "NUMBA_CACHE_DIR" in os.environ:
        folders.append(Path(os.environ["NUMBA_CACHE_DIR"]))
    return any(next(folder.rglob("*.nbi"), None) is not None for folder in folders)
