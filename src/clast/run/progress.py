"""Progress of a run, and of the compilation for it, on the terminal.

Where there is no terminal (a pipe, a file) nothing is said of a run; of compilation, which takes
long but only once, one line when it begins and one when it is over.

Warnings of a run reach its caller, each of them once.  A script that names no function for
it gets Python's own warnings, of the category ``clast.RunWarning``.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from clast.compute.compilation import COMPILATION, working_time
from clast.errors import RunStopped, RunWarning
from clast.run.run_state import Leader

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

    from clast.results import Run
    from clast.run.schedule import Progress

Watch = Callable[["Progress"], None]
"""Called after every accepted step."""

PARTS = {
    "compute": "arithmetic of small matrices",
    "model": "geometry checks",
    "block": "block equations",
    "contact": "contact detection and friction",
    "linear": "equation solver",
    "minimise": "energy minimisation",
    "actions": "loads and supports",
    "step": "time stepping",
    "studies": "measurements",
}
"""Folder of the package -> the purpose of its kernels."""


@contextmanager
def shown(progress: bool | Watch) -> Iterator[Watch | None]:
    """Yield the function to call after every step: none, the caller's own function, or a line."""
    if isinstance(progress, Leader) and progress.wants_line:
        with _on_stderr() as watch:
            progress.line = watch
            yield progress
    elif callable(progress):
        yield progress
    elif progress:
        with _on_stderr() as watch:
            yield watch
    else:
        yield None


@contextmanager
def _on_stderr() -> Iterator[Watch | None]:
    """Show on stderr how far a run and its compilation are; on no terminal compilation alone."""
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    if not console.is_terminal:
        with compilation_told(lambda text: console.print(text, soft_wrap=True)):
            yield None
        return
    columns = (
        BarColumn(bar_width=24),
        TextColumn("{task.percentage:>3.0f}%"),
        TextColumn("{task.description}"),
    )
    with Bar(*columns, console=console, transient=True) as bar:
        line = ProgressLine(bar)
        with COMPILATION.telling(line.compiling):
            yield line


class ProgressLine:
    """Turns the progress of a run into a bar and a sentence of numbers."""

    def __init__(self, bar: Bar) -> None:
        self._bar = bar
        self._task = bar.add_task("starting", total=1.0)
        self._shown = 0.0
        self._start: tuple[float, float] | None = None

    def compiling(self, module: str | None) -> None:
        """Report compilation until a step is over."""
        if module is not None:
            self._bar.update(self._task, description=compilation_text(module))

    def __call__(self, progress: Progress) -> None:
        """Show where the run is, a few times a second."""
        if self._start is None:
            self._start = working_time(), progress.time
        if perf_counter() - self._shown < 0.1:
            return
        self._shown = perf_counter()
        wall = working_time() - self._start[0]
        speed = (progress.time - self._start[1]) / wall if wall > 0.0 else 0.0
        self._bar.update(
            self._task,
            completed=(progress.time - progress.start) / (progress.end - progress.start),
            description=status_text(progress, speed),
        )


def status_text(progress: Progress, speed: float) -> str:
    """Return where a run is: time, step, contacts, speed, time left, and balance in a stage."""
    parts = [
        *([progress.stage] if progress.stage else []),
        f"t {progress.time:.4g} of {progress.end:.4g} s",
        f"step {progress.step:.2g} s",
        f"{progress.contacts} contacts",
    ]
    if progress.force_ratio is not None and progress.speed is not None:
        parts.append(f"unbalanced {progress.force_ratio:.1e}")
        parts.append(f"fastest {progress.speed:.1e} m/s")
    if speed > 0.0:
        left = round((progress.end - progress.time) / speed)
        parts.append(f"{speed:.2g} s/s")
        parts.append(f"{left // 3600}:{left // 60 % 60:02d}:{left % 60:02d} left")
    return "  ".join(parts)


def compilation_text(module: str) -> str:
    """Return the kernels compiled with one of ``module``, and the progress."""
    folder = module.split(".")[1]
    return (
        f"compiling, once after installation: {PARTS.get(folder, folder)} "
        f"({COMPILATION.kernels} of about {COMPILATION.expected} kernels)"
    )


WAITING = (
    "compiling kernels, once after installation: a minute or so; "
    "`clast warmup` does it ahead for all cases, by all cores"
)
"""Message of a run that waits for a kernel that is not compiled yet."""


@contextmanager
def compilation_told(say: Callable[[str], None]) -> Iterator[None]:
    """Call ``say`` once when kernels are compiled, and once at the end: for pipes and files."""
    waited: list[str] = []
    kernels, seconds = COMPILATION.kernels, COMPILATION.seconds

    def tell(module: str | None) -> None:
        if module is not None and not waited:
            waited.append(module)
            say(WAITING)

    with COMPILATION.telling(tell):
        yield
    if waited:
        count, spent = COMPILATION.kernels - kernels, COMPILATION.seconds - seconds
        say(f"compiled {count} kernels in {spent:.1f} s; later runs find them on disk")


PACKAGE = str(Path(__file__).resolve().parents[1])


class Warner:
    """Says each warning once, to a function, or by ``warnings.warn`` where that is None."""

    def __init__(self, warn: Callable[[str], None] | None) -> None:
        self._warn = warn or _as_python_does
        self._said: set[str] = set()

    def __call__(self, text: str) -> None:
        """Say a warning, if it has not been said yet."""
        if text not in self._said:
            self._said.add(text)
            self._warn(text)

    def all_of(self, texts: Iterable[str]) -> tuple[str, ...]:
        """Say warnings, and return them."""
        warnings_given = tuple(texts)
        for text in warnings_given:
            self(text)
        return warnings_given

    def with_report(self, run: Callable[[], Run]) -> Run:
        """Return a run that is still to be made; pass on the warnings of its report."""
        try:
            done = run()
        except RunStopped as stopped:
            from clast.results import Run

            if isinstance(stopped.run, Run):
                self.all_of(stopped.run.report.warnings)
            raise
        self.all_of(done.report.warnings)
        return done


def _as_python_does(text: str) -> None:
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(PACKAGE):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, RunWarning, stacklevel=level)
