"""How a run is launched, be it of a case file, of a script, or one that goes on.

Warnings known before the first step, the recorder, checkpoints and progress come together here.
A checkpoint is no part of the results: it is written every so often, at the ends of stages, and
when the run ends; where it cannot be written the run goes on, with a warning, and the checkpoint
before stays.
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
from clast.model.model import Model
from clast.results import Run, RunRecorder
from clast.results.checkpoints.checkpoint import Checkpoint, Recorded, Source
from clast.results.checkpoints.checkpoint_files import (
    check_place,
    checkpoint_path,
    write_checkpoint,
)
from clast.results.recorder import RecordMark
from clast.results.run_report import version_of
from clast.run.progress import Warner, Watch, shown
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method


@dataclass(frozen=True, kw_only=True)
class Target:
    """Where a run is recorded."""

    output: Path | None = None
    """Result file; None: frames are kept in memory."""
    recorded: Recorded | None = None
    """How far the file is recorded already; None: it is a new one."""
    recorder: RunRecorder | None = None
    """The recorder, where a script has made one."""


@dataclass(frozen=True, kw_only=True)
class Launch:
    """Everything needed to launch a run."""

    model: Model
    method: Method
    schedule: Schedule
    foreseen: Callable[[], tuple[str, ...]]
    """Returns the warnings known before the first step."""
    remarks: tuple[str, ...] = ()
    """Remarks before the warnings that do not belong to the report of the run."""
    source: Callable[[], Source]
    """Returns where the run comes from, for its checkpoints."""
    target: Callable[[Callable[[str], None]], Target]
    """Returns the file of results; remarks on it are passed on."""
    case_text: str = ""
    """Case as it is written into the result file."""
    contacts: bool = True
    """Whether frames keep contact forces."""
    checkpoint_every: float | None = None
    """Wall time between checkpoints, s; None: only when the run ends before its time."""
    begin: RunState | None = None
    """Data of the run when it was interrupted; None: it begins."""


def launch(
    what: Launch,
    progress: bool | Watch = False,
    warn: Callable[[str], None] | None = None,
) -> Run:
    """Return the run; ``progress`` and ``warn`` are those of ``Case.run``.

    Raises CaseError for an output or a place of checkpoints that cannot be written, RunStopped
    where the run cannot go on.
    """
    say = Warner(warn)

    def made() -> Run:
        with shown(progress) as watch:
            say.all_of(what.remarks)
            warnings = say.all_of(what.foreseen())
            target = what.target(say)
            recorder = target.recorder or RunRecorder(
                what.model,
                case_text=what.case_text,
                output=target.output,
                contacts=what.contacts,
                recorded=target.recorded,
            )
            keep, every = None, what.checkpoint_every
            if target.output is not None:
                path = target.output.resolve()
                if every is not None:
                    check_place(checkpoint_path(path))
                keep = Checkpointing(recorder, path, what.source, every, say)
            return simulate(
                what.model,
                what.method,
                what.schedule,
                recorder=recorder,
                watch=watch,
                keep=keep,
                begin=what.begin,
                warnings=warnings,
            )

    return say.with_report(made)


@dataclass
class Checkpointing:
    """Keeps the data of a run, as ``keep`` of ``simulate``, and writes them to checkpoints."""

    recorder: RunRecorder
    """Records the run, to a file."""
    output: Path
    """That file."""
    describe: Callable[[], Source]
    """Says where the run came from, when that is asked for."""
    every: float | None = None
    """Wall time between checkpoints, s; None: only when the run ends before its time."""
    tell: Callable[[str], None] | None = None
    """Called with every failure, as soon as it happens."""
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
