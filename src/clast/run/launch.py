"""How a run is launched, be it of a case file, of a script, or one that goes on.

Warnings known before the first step, the recorder, checkpoints and progress come together here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from clast.model.model import Model
from clast.results import Run, RunRecorder
from clast.results.checkpoints.checkpoint import Recorded, Source
from clast.results.checkpoints.checkpoint_files import check_place, checkpoint_path
from clast.run.checkpointing import Checkpointing
from clast.run.progress import Warner, Watch, shown
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method


@dataclass(frozen=True, kw_only=True)
class Target:
    """Where a run is recorded: in ``output``, or in memory; by ``recorder``, or by a new one."""

    output: Path | None = None
    recorded: Recorded | None = None
    """How far the file is recorded already; None: it is a new one."""
    recorder: RunRecorder | None = None


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
    what: Launch, progress: bool | Watch = False, warn: Callable[[str], None] | None = None
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
