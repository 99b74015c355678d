"""Checkpoints of a run while it goes: every so often, at the ends of stages, and when it ends.

A checkpoint is no part of the results: where it cannot be written the run goes on, with a warning,
and the checkpoint before stays.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from clast.compute.compilation import working_time
from clast.errors import CaseError
from clast.results import RunRecorder
from clast.results.checkpoints.checkpoint import Checkpoint, Source
from clast.results.checkpoints.files import checkpoint_path, write_checkpoint
from clast.results.recorder import Mark

if TYPE_CHECKING:
    from clast.run.simulate import RunState


@dataclass
class Checkpointing:
    """Keeps what a run carries, as ``keep`` of ``simulate``, and writes it to checkpoints."""

    recorder: RunRecorder
    """Records the run, to a file."""
    output: Path
    """That file."""
    describe: Callable[[], Source]
    """Says where the run came from, when that is asked for."""
    every: float | None = None
    """Wall time between checkpoints, s; None: only when the run ends before its time."""
    tell: Callable[[str], None] | None = None
    """Called with what goes wrong, as soon as it does."""
    _now: tuple[RunState, Mark] | None = None
    _written: float = field(default_factory=monotonic)
    _started: float = field(default_factory=working_time)
    _time: float | None = None
    _trouble: str = ""
    _stages: int = 0

    def __call__(self, now: RunState) -> None:
        """Keep what the run carries after a step; write it if it is time to."""
        self._now = now, self.recorder.mark()
        if self.every is not None and monotonic() - self._written >= self.every:
            self._write(checkpoint_path(self.output))
            self._written = monotonic()

    def stage_ended(self, stage: str, now: RunState) -> None:
        """Write a checkpoint of its own for the end of a stage."""
        self._now = now, self.recorder.mark()
        self._stages += 1
        self._write(checkpoint_path(self.output, stage), stage=stage)

    def over(self, outcome: str, *, finished: bool) -> tuple[str, ...]:
        """Write the last checkpoint, where one is wanted; return what went wrong with them."""
        wanted = not finished or self.every is not None or self._stages > 0
        if wanted:
            self._write(checkpoint_path(self.output), outcome=outcome, finished=finished)
        return (self._trouble,) if self._trouble else ()

    @cached_property
    def _source(self) -> Source:
        return self.describe()

    def _write(
        self, path: Path, *, stage: str = "", outcome: str = "", finished: bool = False
    ) -> None:
        """Write a checkpoint of the last step; what goes wrong becomes a warning."""
        if self._now is None:
            return
        run, mark = self._now
        try:
            checkpoint = Checkpoint(
                version=own_version(),
                time=run.state.time,
                outcome=outcome,
                finished=finished,
                stage=stage,
                source=self._source,
                recorded=self.recorder.recorded(mark, working_time() - self._started),
                run=run,
            )
            write_checkpoint(path, checkpoint)
        except (CaseError, OSError) as error:
            self._warn(path, error)
            return
        self._trouble, self._time = "", run.state.time
        self.recorder.checkpoint = path

    def _warn(self, path: Path, error: Exception) -> None:
        """Say why there is no checkpoint, and which there is: once, until one is written again."""
        number = getattr(error, "errno", None)
        why = os.strerror(number) if number else " ".join(str(error).split())
        kept = "" if self._time is None else f"; that of t = {self._time:.6g} s stays"
        first = not self._trouble
        self._trouble = f"no checkpoint could be written to {path}: {why}{kept}"
        if first and self.tell:
            self.tell(self._trouble)


def last_checkpoint(keep: object, outcome: str, *, finished: bool) -> tuple[str, ...]:
    """Have the last checkpoint of a run written; return what went wrong with its checkpoints."""
    if not isinstance(keep, Checkpointing):
        return ()
    return keep.over(outcome, finished=finished)


def stage_checkpoint(keep: object, stage: str, now: RunState) -> None:
    """Have a checkpoint written of the end of a stage."""
    if isinstance(keep, Checkpointing):
        keep.stage_ended(stage, now)


def own_version() -> str:
    """Return the version of clast."""
    try:
        return version("clast")
    except PackageNotFoundError:
        return "unknown"
