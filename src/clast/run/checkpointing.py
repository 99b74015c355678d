"""Checkpoints while a run goes: every so often, at the ends of stages, and when it ends.

A checkpoint is no part of the results: where it cannot be written the run goes on, with a warning,
and the checkpoint before stays.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from time import monotonic

from clast.compute.compilation import working_time
from clast.errors import CaseError
from clast.results import RunRecorder
from clast.results.checkpoints.checkpoint import Checkpoint, Source
from clast.results.checkpoints.checkpoint_files import checkpoint_path, write_checkpoint
from clast.results.recorder import RecordMark
from clast.results.run_report import version_of
from clast.run.run_state import RunState


@dataclass
class Checkpointing:
    """Keeps the data of a run, as ``keep`` of ``simulate``, and writes them to checkpoints."""

    recorder: RunRecorder
    output: Path
    """File that the run is recorded to."""
    describe: Callable[[], Source]
    """Returns where the run came from."""
    every: float | None = None
    """Wall time between checkpoints, s; None: only when the run ends before its time."""
    tell: Callable[[str], None] | None = None
    """Receives every failure, as soon as it happens."""
    _now: tuple[RunState, RecordMark] | None = None
    _written: float = field(default_factory=monotonic)
    _started: float = field(default_factory=working_time)
    _time: float | None = None
    _trouble: str = ""
    _stages: int = 0

    def __call__(self, now: RunState) -> None:
        """Keep the data of the run after a step; write them if it is time to."""
        self._now = now, self.recorder.mark()
        if self.every is not None and monotonic() - self._written >= self.every:
            self._write(checkpoint_path(self.output))
            self._written = monotonic()

    def stage_ended(self, stage: str, now: RunState) -> None:
        """Write a checkpoint of its own for the end of a stage."""
        self._now = now, self.recorder.mark()
        self._stages += 1
        self._write(checkpoint_path(self.output, stage), stage=stage)

    def at_once(self) -> str:
        """Write a checkpoint of the last step; return where it is, or the failure."""
        if self._now is None:
            return "no checkpoint: no step has been made yet"
        path, time = checkpoint_path(self.output), self._now[0].state.time
        self._write(path)
        return self._trouble or f"checkpoint of t = {time:.6g} s in {path.name}"

    def over(self, outcome: str, *, finished: bool) -> tuple[str, ...]:
        """Write the last checkpoint, where one is wanted; return the failures of checkpoints."""
        if not finished or self.every is not None or self._stages > 0:
            self._write(checkpoint_path(self.output), outcome=outcome, finished=finished)
        return (self._trouble,) if self._trouble else ()

    @cached_property
    def _source(self) -> Source:
        return self.describe()

    def _write(
        self, path: Path, *, stage: str = "", outcome: str = "", finished: bool = False
    ) -> None:
        """Write a checkpoint of the last step; a failure becomes a warning."""
        if self._now is None:
            return
        run, mark = self._now
        try:
            checkpoint = Checkpoint(
                version=version_of("clast"),
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
