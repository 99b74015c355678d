"""The runs of a back-analysis, in the order in which its search asks for them.

The search is the same whenever it is made again, so that one which was interrupted asks for the
runs that it had made, and finds them.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from clast.errors import CaseError, ClastError
from clast.model.model import Floats
from clast.study.executors import Driver, Workers
from clast.study.folder import DONE, StudyFolder, write_whole

Asked = tuple[float, ...]
"""Parameters of a run, in their order."""


@dataclass(kw_only=True)
class FitRuns:
    """The runs of a back-analysis in the folder of its study."""

    folder: StudyFolder
    """The folder."""
    workers: Workers
    """Who makes them."""
    asked: list[Asked] = field(default_factory=list)
    """Parameters of each run that has been asked for, from run 1 on, by this search or before."""
    number: dict[Asked, int] = field(default_factory=dict)
    """Parameters -> number of the run, of this search."""

    @classmethod
    def of(cls, folder: StudyFolder, workers: Workers) -> FitRuns:
        """Return the runs in a folder."""
        return cls(folder=folder, workers=workers, asked=folder.asked())

    @property
    def count(self) -> int:
        """How many runs this search has asked for."""
        return len(self.number)

    def computed(self, places: Sequence[Sequence[float]]) -> list[Floats | ClastError]:
        """Return the computed values (k,) with sets of parameters, or why there are none."""
        numbers = [self._number(tuple(map(float, values))) for values in places]
        missing = [run for run in dict.fromkeys(numbers) if self._result(run) is None]
        if missing:
            lines = [json.dumps(values) + "\n" for values in self.asked]
            write_whole(self.folder.asked_file, "".join(lines).encode("ascii"))
            for run in missing:
                self.folder.forget(run)
            Driver(self.folder, self.workers).make(iter(missing), len(missing), len(missing))
        return [self._values(run) for run in numbers]

    def _number(self, values: Asked) -> int:
        """Return the number of the run with these parameters, a new one where there is none."""
        if values not in self.number:
            run = self.count + 1
            if self.asked[run - 1 : run] != [values]:
                # it is another search from here on: another machine may round otherwise
                self.asked[run - 1 :] = [values]
            self.number[values] = run
        return self.number[values]

    def _result(self, run: int) -> dict[str, object] | None:
        """Return the result of a run; None where it is not there, or has other parameters."""
        found = self.folder.result(run)
        same = found is not None and tuple(found["parameters"].values()) == self.asked[run - 1]
        return found if same else None

    def _values(self, run: int) -> Floats | ClastError:
        """Return the computed values of a run that was made, m, shape (k,)."""
        result = self.folder.result(run)
        if result is None:
            raise CaseError(
                f"run {run} was removed while it was needed",
                where=str(self.folder.path),
                remedy="use the folder for one study only; clast study resume makes it again",
            )
        if result["status"] != DONE:
            return CaseError(result["reason"], where="vary")
        study = self.folder.study
        values = np.array([result["measures"][one.measure] for one in study.observe])
        if not np.isfinite(values).all():
            return CaseError(f"run {run} has a measured point without a position", where="observe")
        return values
