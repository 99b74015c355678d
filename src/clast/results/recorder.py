"""Gathers what a run computes, step by step, and writes it to the result file frame by frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.errors import ResultsLost, RunStopped
from clast.model.model import Model
from clast.model.stages.reference import Reference
from clast.model.state import LEDGER_ENTRIES, State
from clast.results.layout import ENERGY_ROW, STEP_ROW
from clast.results.run import Report, Run
from clast.results.tables import Table, no_contacts, points_row
from clast.step.method import StepResult

if TYPE_CHECKING:
    from clast.contact.contacts import ContactResponse, Contacts

MEMORY_LIMIT = 2e9
"""Memory for the frames of a run that writes no file, bytes, unless another is given."""

_ledger_entries = attrgetter(*LEDGER_ENTRIES)


class RunRecorder:
    """Records one run: every step in memory, frames in the file ``output`` or in memory as well.

    The output is looked at when the recorder is made, so that a bad path is known before the
    first step, and written from ``start`` on; a good result of an earlier run under the same name
    is kept until then.  ``contacts=False`` leaves contact forces out of the frames.  Without an
    output, frames beyond ``memory_limit`` bytes are not kept, but for the last.  Raises CaseError
    for an output that cannot be written.
    """

    def __init__(
        self,
        model: Model,
        case_text: str = "",
        output: Path | str | None = None,
        contacts: bool = True,
        memory_limit: float = MEMORY_LIMIT,
    ) -> None:
        # Compiled kernels are slow to import; who only reads results does not need them.
        from clast.results.frames_in_memory import FramesInMemory
        from clast.results.sampling import FrameFields, PointTracker

        self._model = model
        self._case_text = case_text
        self._with_contacts = contacts
        self._tracker = PointTracker(model)
        self._fields = FrameFields(model)
        self._points = Table(points_row(len(model.measured_points.name)))
        self._energy = Table(ENERGY_ROW)
        self._steps = Table(STEP_ROW)
        self._state: State | None = None
        self._result: StepResult | None = None
        self._frame_times: list[float] = []
        self._stages: list[str] = []
        self._stage = 0
        self._kept = FramesInMemory(model, memory_limit) if output is None else None
        self._file = None
        if output is not None:
            from clast.results.writing import ResultFile

            self._file = ResultFile(Path(output), model, case_text)

    @property
    def state(self) -> State:
        """The last state recorded."""
        if self._state is None:
            raise RuntimeError("nothing is recorded yet: call start first")
        return self._state

    def start(self, state: State, about: Mapping[str, Any] | None = None) -> None:
        """Record the state at the start of the run and begin the file with it.

        ``about`` says how the run is simulated (``clast.results.provenance``).
        """
        about = about or {}
        self._stages = list(about.get("stages", ()))
        if self._file is not None:
            self._file.about = about
        self._record(state)
        self.frame(state)

    def enter(self, stage: int, reference: Reference | None) -> None:
        """Record what follows as of a stage, by its number among those of ``about``.

        Displacements count from ``reference`` on, if there is one.
        """
        from clast.results.sampling import FrameFields, PointTracker

        self._stage = stage
        if reference is not None:
            self._tracker = PointTracker(self._model, reference)
            self._fields = FrameFields(self._model, reference)
            if self._kept is not None:
                self._kept.count_from(self._fields)

    def step(self, result: StepResult, step: float) -> None:
        """Record an accepted step of length ``step``, s."""
        state = result.state
        self._record(state)
        self._result = result
        self._steps.append(
            (
                state.time,
                step,
                result.passes,
                len(result.contacts),
                result.penetration,
                result.travel,
            )
        )

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
        if self._kept is not None:
            self._kept.add(state, rows, self._stages[self._stage] if self._stages else "")
        if self._file is not None:
            self._file.stage = self._stage
            self._file.frame(state.time, self._fields.of(state), rows, self._tables())
        self._frame_times.append(state.time)

    def finish(self, report: Report) -> Run:
        """Close the file with the last state and the report; return what was recorded.

        Raises RunStopped, with what was recorded in its ``run``, where they cannot be written.
        """
        last = self._result
        try:
            if last is not None and last.state.time not in self._frame_times[-1:]:
                self.frame(last.state, last.contacts, last.response)
            if self._file is not None:
                self._file.finish(report, self._tables())
        except ResultsLost as lost:
            if report.finished:
                outcome = f"stopped at t = {self.state.time:.6g} s: {lost}"
                report = replace(report, finished=False, outcome=outcome)
            raise RunStopped(f"the run {report.outcome}", self._run(report)) from lost
        if self._kept is not None and self._kept.left_out_from is not None:
            note = f"frames from t = {self._kept.left_out_from:.4g} s on found no room in memory"
            report = replace(report, notes=(*report.notes, f"{note}: name an output file"))
        return self._run(report)

    def _run(self, report: Report) -> Run:
        return Run(
            model=self._model,
            state=self.state,
            report=report,
            output=self._file.path if self._file else None,
            point_rows=self._points.rows,
            energy_rows=self._energy.rows,
            step_rows=self._steps.rows,
            times=np.array(self._frame_times) if self._kept is None else self._kept.times,
            kept=self._kept,
        )

    def _record(self, state: State) -> None:
        self._state = state
        self._energy.append((state.time, *_ledger_entries(state.ledger)))
        self._points.append(self._tracker.row(state))

    def _tables(self) -> dict[str, Table]:
        return {"energy": self._energy, "steps": self._steps, "history": self._points}
