"""Gathers the results of a run, step by step, and writes them to the result file frame by frame."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError, ResultsLost, RunStopped
from clast.model.model import Floats, Model
from clast.model.state import ReferenceState, State
from clast.results.checkpoints.checkpoint import Recorded
from clast.results.checkpoints.reopen import rows_after
from clast.results.frames import FrameStore
from clast.results.recording import Run, parts_of
from clast.results.result_tables import GrowingTable, no_contacts
from clast.results.run_report import Report
from clast.results.schema import FRAME_ROW, OVER_TIME
from clast.step.method import StepResult

if TYPE_CHECKING:
    from clast.contact.contacts import ContactResponse, Contacts

MEMORY_LIMIT = 2e9
"""Memory for the frames of a run that writes no file, bytes, unless another is given."""


@dataclass(frozen=True, kw_only=True)
class RecordMark:
    """How far a run was recorded after one of its steps."""

    frames: int = 0
    frame: tuple[float, int, int, int] = (0.0, 0, 0, 0)
    """Row of the last of them: time, s, and how many steps, instants and contacts there were."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Rows of each table after it."""
    now: Mapping[str, int] = field(default_factory=dict)
    """Rows of each table after the step."""
    result: StepResult | None = None


class RunRecorder:
    """Records one run: every step in memory, frames in the file ``output`` or in memory as well.

    The output is looked at when the recorder is made, so that a bad path is known before the
    first step, and written from ``start`` on; a good result of an earlier run under the same name
    is kept until then.  ``contacts=False`` leaves contact forces out of the frames.  Without an
    output, frames beyond ``memory_limit`` bytes are not kept, but for the last.  With ``recorded``
    the output goes on from there, as if the run had never ended.  Raises CaseError for an output
    that cannot be written.
    """

    def __init__(
        self,
        model: Model,
        case_text: str = "",
        output: Path | str | None = None,
        contacts: bool = True,
        memory_limit: float = MEMORY_LIMIT,
        recorded: Recorded | None = None,
    ) -> None:
        # Compiled kernels are slow to import; who only reads results does not need them.
        from clast.results.frame_samples import FrameFields, FramesInMemory

        self._model = model
        self._case_text = case_text
        self._with_contacts = contacts
        self._fields = FrameFields(model)
        self._kinds = [one for one in OVER_TIME if one.is_kept(model)]
        self._tables = {one.name: GrowingTable(one.rows(one.count(model))) for one in OVER_TIME}
        self._follow()
        self._state: State | None = None
        self._result: StepResult | None = None
        self._frame_times: list[float] = []
        self._framed = RecordMark()
        self._recorded = recorded
        self.checkpoint: Path | None = None
        self._about: Mapping[str, Any] = {}
        self._stages: list[str] = []
        self._begins: dict[str, str] = {}
        self._stage = 0
        self._kept = FramesInMemory(model, memory_limit) if output is None else None
        self._file = None
        if output is not None:
            from clast.results.result_writer import ResultFile, reopened

            path = Path(output)
            storage = None if recorded is None else reopened(path, model, recorded)
            self._file = ResultFile(path, model, case_text, storage)

    def _follow(self, reference: ReferenceState | None = None) -> None:
        from clast.results.frame_samples import ROWS, STEP_ROWS

        names = [one.name for one in self._kinds]
        self._instant_rows = {
            name: rows(self._model, reference) for name, rows in ROWS.items() if name in names
        }
        self._step_rows = {
            name: rows(self._model) for name, rows in STEP_ROWS.items() if name in names
        }

    @property
    def state(self) -> State:
        """The last state recorded."""
        if self._state is None:
            raise RuntimeError("nothing has been recorded yet: call start first")
        return self._state

    def start(self, state: State, about: Mapping[str, Any] | None = None) -> None:
        """Record the state at the start of the run and begin the file with it.

        ``about`` says how the run is simulated (``clast.results.run_report``).
        """
        self._about = about = about or {}
        recorded = self._recorded
        self._stages = list(about.get("stages", ()))
        self._begins = dict(about.get("begins", {}))
        if self._file is not None:
            self._file.about = about
        if self._file is None or recorded is None:
            self.instant(state)
            self.frame(state)
            return
        self._state = state
        times, before = self._file.go_on(recorded)
        self._frame_times = times.tolist()
        for name, table in self._tables.items():
            table.extend(before[name])
            table.extend(recorded.since[name])
        self._framed = RecordMark(
            frames=recorded.frames,
            frame=recorded.frame[0].item(),
            counts=rows_after(recorded.frame, self._model),
        )

    def enter(self, stage: int, reference: ReferenceState | None) -> None:
        """Record later frames as of a stage, by its number among those of ``about``.

        Displacements count from ``reference`` on, if there is one.
        """
        from clast.results.frame_samples import FrameFields

        self._stage = stage
        if reference is not None:
            self._follow(reference)
            self._fields = FrameFields(self._model, reference)
            if self._kept is not None:
                self._kept.count_from(self._fields)

    def step(self, result: StepResult, step: float, unbalanced: float = math.nan) -> None:
        """Record an accepted step of length ``step``, s.

        ``unbalanced`` is the largest unbalanced force of a block, as a share of all forces on it.
        """
        state = result.state
        self.instant(state)
        self._result = result
        for name, row in self._step_rows.items():
            self._tables[name].append(row(result, step, unbalanced))

    def frame(
        self,
        state: State,
        contacts: Contacts | None = None,
        response: ContactResponse | None = None,
    ) -> None:
        """Keep a frame; a file gets all rows since the last one, too."""
        rows = no_contacts()
        if self._with_contacts and contacts is not None and response is not None:
            rows = self._fields.contacts(state, contacts, response)
        self._keep(state, rows)

    def keep_last(self) -> None:
        """Keep a frame of the last state, if it is in none yet."""
        last, before = self._result, self._recorded
        if self.state.time in self._frame_times[-1:]:
            return
        if last is not None:
            self.frame(last.state, last.contacts, last.response)
        elif before is not None:
            self._keep(self.state, before.contacts)

    def _keep(self, state: State, rows: NDArray[Any]) -> None:
        if self._kept is not None:
            from clast.results.frame_samples import PlaceOfFrame

            name = self._stages[self._stage] if self._stages else ""
            place = PlaceOfFrame(name=name, stage=self._stage, counts=self._counts())
            self._kept.add(state, rows, place)
        if self._file is not None:
            from clast.results.frame_samples import beside_of

            beside = beside_of(self._model, state)
            self._file.stage = self._stage
            self._file.frame(state.time, self._fields.of(state), rows, self._tables, beside)
        self._frame_times.append(state.time)
        self._framed = RecordMark(
            frames=len(self._frame_times),
            frame=(
                state.time,
                len(self._tables["steps"]),
                len(self._tables["energy"]),
                self._framed.frame[3] + len(rows),
            ),
            counts=self._counts(),
        )

    def mark(self) -> RecordMark:
        """Return how far the run is recorded, at the cost of a few numbers."""
        return replace(self._framed, now=self._counts(), result=self._result)

    def recorded(self, mark: RecordMark, wall: float) -> Recorded:
        """Return the records until a mark, for a checkpoint.

        ``wall`` is the time that the run has taken, s.  The frames until then are on the disk.
        """
        file = self._file
        if file is None:
            raise RuntimeError("a run in memory has no checkpoints")
        file.sync()
        contacts = no_contacts() if self._recorded is None else self._recorded.contacts
        if mark.result is not None and self._with_contacts:
            last = mark.result
            contacts = self._fields.contacts(last.state, last.contacts, last.response)
        at = mark.counts["energy"]
        return Recorded(
            file=file.path.name,
            lineage=file.lineage,
            frames=mark.frames,
            frame=np.array([mark.frame], FRAME_ROW),
            energy=self._tables["energy"].since(at - 1)[:1].copy(),
            since={
                name: table.since(mark.counts[name])[: mark.now[name] - mark.counts[name]].copy()
                for name, table in self._tables.items()
            },
            contacts=contacts,
            wall=wall + (0.0 if self._recorded is None else self._recorded.wall),
        )

    def finish(self, report: Report) -> Run:
        """Close the file with the last state and the report; return the recording.

        Raises RunStopped, with the recording in its ``run``, where they cannot be written.
        """
        report = replace(report, notes=(*report.notes, *self._bolt_notes(), *self._flow_notes()))
        if self._recorded is not None:
            report = replace(report, wall_seconds=report.wall_seconds + self._recorded.wall)
        try:
            self.keep_last()
            if self._file is not None:
                self._file.finish(report, self._tables)
        except ResultsLost as lost:
            if report.finished:
                outcome = f"stopped at t = {self.state.time:.6g} s: {lost}"
                report = replace(report, finished=False, outcome=outcome)
            raise RunStopped(f"the run {report.outcome}", self._run(report)) from lost
        if self._kept is not None and (since := self._kept.left_out_from) is not None:
            note = f"frames from t = {since:.4g} s on were dropped: memory limit reached"
            report = replace(report, notes=(*report.notes, f"{note}: name an output file"))
        return self._run(report)

    def _run(self, report: Report) -> Run:
        path = self._file.path if self._file else None
        times = np.array(self._frame_times) if self._kept is None else self._kept.times
        return Run(
            model=self._model,
            state=self.state,
            output=path,
            checkpoint=self.checkpoint,
            report=report,
            times=times,
            tables={name: table.rows for name, table in self._tables.items()},
            open_frames=partial(_opened, self._kept, path, self._model.title, times),
            begins=self._begins,
            case_text=self._case_text,
            about=self._about,
            **parts_of(self._model),
        )

    def instant(self, state: State) -> None:
        """Record the rows of a state in tables that have one for each instant."""
        self._state = state
        for name, row in self._instant_rows.items():
            self._tables[name].append(row(state))

    def _bolt_notes(self) -> tuple[str, ...]:
        if not len(self._model.bolts) or self._state is None:
            return ()
        from clast.actions.bolts import story_of
        from clast.results.frame_samples import bolt_states

        return story_of(bolt_states(self._model, self._state), self._model)

    def _flow_notes(self) -> tuple[str, ...]:
        if self._model.flow is None or self._state is None:
            return ()
        from clast.results.frame_samples import flow_notes

        return flow_notes(self._model, self._state)

    def _counts(self) -> dict[str, int]:
        return {name: len(table) for name, table in self._tables.items()}


def _opened(frames: FrameStore | None, path: Path | None, title: str, times: Floats) -> FrameStore:
    """Return the frames of a run, in memory or else in its file; raises CaseError."""
    from clast.results.result_reader import read_results

    if frames is not None:
        return frames
    results = read_results(path or Path())
    if results.title != title or not np.array_equal(results.times, times):
        raise CaseError(
            "now holds another run", where=str(path), remedy="keep the results of each run"
        )
    return results
