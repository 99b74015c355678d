"""The runs of a back-analysis: each made once, and kept in a folder where one is given.

What a run gives follows from its case: it is kept under the hash of that, so that a back-analysis
which was interrupted finds the runs that it had made.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor, Executor
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np

from clast.case.case_file import Case
from clast.errors import CaseError, ClastError
from clast.model.model import Floats
from clast.study.fitting.observations import Observation
from clast.study.folder import bytes_of_files, make_folder, write_whole
from clast.study.judging.measures import RunResults

LATE = 1e-6
"""By how much a measurement may be later than the end of a run, as a share of its time."""


@dataclass(frozen=True, kw_only=True)
class FitTask:
    """A run of a back-analysis, for a worker."""

    text: str
    """The case."""
    file: str
    """Its file."""
    observations: tuple[Observation, ...]
    """The compared values."""


def predicted(task: FitTask) -> list[float] | str:
    """Return the computed values at the measurements, m, or why there are none."""
    try:
        case = Case.from_text(task.text, task.file)
        measured = RunResults(case.run(warn=lambda _text: None))
    except ClastError as error:
        return " ".join(str(error).split())
    found = []
    for one in task.observations:
        history = measured.run.history(one.point)
        way = history.displacement[:, one.part]
        end = float(history.time[-1])
        if one.time is not None and one.time > end * (1.0 + LATE):
            return f"it ends at {end:g} s, before the measurement at {one.time:g} s"
        found.append(float(way[-1] if one.time is None else np.interp(one.time, history.time, way)))
    return found


@dataclass(frozen=True, kw_only=True)
class RunStore:
    """The runs that are made, kept in a folder."""

    folder: Path | None
    """The folder; None: nowhere."""
    files: bytes
    """What the files hold that the case names."""

    @classmethod
    def opened(cls, folder: str | Path, case: Case) -> RunStore:
        """Return the store of a folder, which is made; of "" one that keeps nothing."""
        if not folder:
            return cls(folder=None, files=b"")
        make_folder(Path(folder))
        return cls(folder=Path(folder), files=bytes_of_files(case))

    def made(self, tasks: Sequence[FitTask], pool: Executor) -> list[Floats | ClastError]:
        """Return the computed values (k,) of several runs, or why there are none."""
        kept = [self._read(task) for task in tasks]
        going = [
            pool.submit(predicted, task) if known is None else None
            for task, known in zip(tasks, kept, strict=True)
        ]
        found: list[Floats | ClastError] = []
        for task, known, future in zip(tasks, kept, going, strict=True):
            if future is not None:
                try:
                    known = future.result()
                except BrokenExecutor as error:
                    raise CaseError(
                        f"a worker has ended: {error}",
                        where="workers",
                        remedy="it may have lacked memory: take fewer workers",
                    ) from None
                self._write(task, known)
            found.append(
                CaseError(known, where="vary") if isinstance(known, str) else np.array(known)
            )
        return found

    def _place(self, task: FitTask) -> Path:
        parts = [task.text, *(f"{one.point} {one.part} {one.time}" for one in task.observations)]
        hashed = sha256("\n".join(parts).encode("utf-8") + self.files).hexdigest()
        return (self.folder or Path()) / f"{hashed[:32]}.json"

    def _read(self, task: FitTask) -> list[float] | str | None:
        """Return what is kept of a run; None where there is nothing whole."""
        if self.folder is None:
            return None
        try:
            found = json.loads(self._place(task).read_bytes())
        except (OSError, ValueError):
            return None
        return found if isinstance(found, list | str) else None

    def _write(self, task: FitTask, known: list[float] | str | None) -> None:
        if self.folder is not None:
            write_whole(self._place(task), json.dumps(known).encode("utf-8"))
