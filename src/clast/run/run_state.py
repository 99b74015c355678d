"""The data of a run from one step to the next, and the interface of those who lead it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from clast.model.stage_records import Event
from clast.model.state import Ledger, State
from clast.run.run_checks import Watched
from clast.run.schedule import Progress
from clast.run.stages.stage_position import Position
from clast.run.stages.static_path import OnPath
from clast.step.method import StepResult


@dataclass(frozen=True, kw_only=True)
class Tally:
    """Counts of a run so far."""

    steps: int = 0
    """Accepted steps."""
    passes: int = 0
    """Assemblies and solves."""
    cut_steps: int = 0
    """Steps that were rejected and tried again with a shorter one."""
    contacts: int = 0
    """Largest number of contacts in a step."""
    penetration: float = 0.0
    """Largest penetration, m."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall time of each stage of the steps, s."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """The counts of the process."""

    def with_step(self, result: StepResult, cuts: int = 0) -> Tally:
        """Return the counts with those of an accepted step, and of the ``cuts`` before it."""
        seconds, counts = dict(self.seconds), dict(self.counts)
        for name, spent in result.seconds.items():
            seconds[name] = seconds.get(name, 0.0) + spent
        for name, count in result.counts.items():
            counts[name] = counts.get(name, 0) + count
        return Tally(
            steps=self.steps + 1,
            passes=self.passes + result.passes,
            cut_steps=self.cut_steps + cuts,
            contacts=max(self.contacts, len(result.contacts)),
            penetration=max(self.penetration, result.penetration),
            seconds=seconds,
            counts=counts,
        )


@dataclass(frozen=True, kw_only=True)
class RunState:
    """All that a run carries from one step to the next."""

    state: State
    """The blocks, their contacts and the energy ledger."""
    step: float
    """Length that the next step is tried with, s."""
    taken: float = 0.0
    """Length of the last step, s."""
    frame: int = 1
    """Number of the next frame; that at the start has the number 0."""
    first: Ledger
    """The ledger at the start, with the energy that contacts held there already."""
    tally: Tally = field(default_factory=Tally)
    """Counts so far."""
    seen: Watched
    """Measurements for warnings."""
    notes: tuple[str, ...] = ()
    """Notes on the start of the run."""
    events: tuple[Event, ...] = ()
    """Events so far."""
    position: Position | None = None
    """Where it is among its stages; None: it has none."""
    path: OnPath | None = None
    """Where it is on its path of equilibria; None: it is dynamic."""


@dataclass(frozen=True, kw_only=True)
class Halt:
    """The control of a run between two of its steps."""

    let_go: Callable[[], None]
    """Raises KeyboardInterrupt if the key was pressed; to be called while the run waits."""
    keep_frame: Callable[[], None]
    """Keeps a frame of the last step, if it is in none yet."""
    checkpoint: Callable[[], str]
    """Writes a checkpoint of the last step and says where, or why not."""
    where: Callable[[], Progress]
    """Returns where the run is: a run that goes on has time and steps before its first step."""


@runtime_checkable
class Leader(Protocol):
    """Follows a run as its ``watch``, and may hold it up between steps."""

    wants_line: bool
    """Whether the terminal is to show a line beside it."""
    line: Callable[[Progress], None] | None
    """That line, to be told of the progress; set when the run begins."""

    def __call__(self, progress: Progress) -> None:
        """Take note of where the run is after a step."""

    def lead(self, halt: Halt) -> None:
        """Wait, keep a frame, write a checkpoint, or raise KeyboardInterrupt, before a step."""
