"""A back-analysis: how it is made, its parameters, its runs, its result."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError, ClastError, shortened
from clast.model.distributions import Distribution, Values
from clast.model.model import Floats
from clast.study.distributions import Range
from clast.study.executors import Driver, Workers
from clast.study.fitting.observations import Observation
from clast.study.folder import DONE, StudyFolder, write_whole
from clast.study.parameters import Parameter

DIFFERENCE_STEP = 1e-3
"""Change of a parameter, as a fraction of its range, by which derivatives are taken."""
TAIL_PROBABILITY = 1e-9
"""Probability at which an unbounded distribution is taken to end."""


@dataclass(frozen=True, kw_only=True)
class Fit:
    """The result of a back-analysis; m parameters, k observations."""

    parameter: tuple[str, ...]
    value: Floats
    """Best values, shape (m,)."""
    low: Floats
    """Lower ends of their intervals, shape (m,)."""
    high: Floats
    """Upper ends, shape (m,)."""
    correlation: Floats
    """Correlations of the errors of the values, or of their logarithms, shape (m, m)."""
    observed: Floats
    """The measured values, m, shape (k,)."""
    predicted: Floats
    """The values of the case with the best parameters, m, shape (k,)."""
    runs: int
    remark: str = ""
    """The reservations; "" where there are none."""
    folder: Path | None = None
    """Where the study is kept; None: nowhere."""

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        numbers = np.stack([self.value, self.low, self.high], axis=1).tolist()
        return {
            "parameters": {
                name: dict(zip(("value", "low", "high"), row, strict=True))
                for name, row in zip(self.parameter, numbers, strict=True)
            },
            "correlation": self.correlation.tolist(),
            "observed": self.observed.tolist(),
            "predicted": self.predicted.tolist(),
            "runs": self.runs,
            "remark": self.remark,
        }


@dataclass(frozen=True, kw_only=True)
class ParameterScale:
    """How a parameter is sought: from 0 to 1 over its range, or that of its logarithm."""

    low: float
    high: float

    @classmethod
    def of(cls, one: Parameter) -> ParameterScale:
        """Return the range of a parameter; raises CaseError where it has none."""
        drawn: Distribution = one.drawn
        if not drawn.CONTINUOUS or isinstance(drawn, Values | Range):
            raise CaseError(
                f"'{shortened(one.name)}' has no range to search",
                where=f"vary {shortened(one.name)}",
                remedy="give e.g. uniform(1e8, 1e10)",
            )
        return cls(
            low=float(drawn.quantile(TAIL_PROBABILITY)),  # type: ignore[arg-type]
            high=float(drawn.quantile(1.0 - TAIL_PROBABILITY)),  # type: ignore[arg-type]
        )

    @property
    def is_logarithmic(self) -> bool:
        """Whether the logarithm is sought."""
        return self.low > 0.0 and self.high > 10.0 * self.low

    def value(self, share: float) -> float:
        """Return the value at a share of the range."""
        if self.is_logarithmic:
            return self.low * (self.high / self.low) ** share
        return self.low + share * (self.high - self.low)


Watch = Callable[[int, float], None]
"""Called with the number of runs so far and the mean error of the last ones."""


@dataclass(kw_only=True)
class Fitting:
    """A back-analysis, as far as it is."""

    scales: tuple[ParameterScale, ...]
    observations: tuple[Observation, ...]
    made: FitRuns
    watch: Watch | None = None

    @property
    def observed(self) -> Floats:
        """The measured values, m, shape (k,)."""
        return np.array([one.value for one in self.observations])

    @property
    def deviations(self) -> Floats:
        """Their standard deviations, m, shape (k,); 1 where they are not known."""
        return np.array([one.sd or 1.0 for one in self.observations])

    def computed(self, places: Sequence[Sequence[float]]) -> list[Floats | ClastError]:
        """Return the computed values (k,) with sets of parameters, or why there are none."""
        computed = self.made.computed(places)
        if self.watch is not None:
            first = next((one for one in computed if not isinstance(one, ClastError)), None)
            error = math.nan
            if first is not None:
                squares = np.square((first - self.observed) / self.deviations)
                error = float(np.sqrt(np.mean(squares)))
            self.watch(self.made.count, error)
        return computed

    def residuals(self, shares: Sequence[Floats]) -> list[Floats]:
        """Return computed less measured, over the standard deviations, at several places.

        Raises ClastError where a run cannot go on.
        """
        residuals = []
        for one in self.computed([self.values(share) for share in shares]):
            if isinstance(one, ClastError):
                raise one
            residuals.append((one - self.observed) / self.deviations)
        return residuals

    def derivative(self, share: Floats) -> Floats:
        """Return the derivatives of the residuals (k, m), by runs that are made at one time."""
        steps = np.where(share + DIFFERENCE_STEP <= 1.0, DIFFERENCE_STEP, -DIFFERENCE_STEP)
        base, *others = self.residuals([share, *(share + np.diag(steps))])
        columns = [(one - base) / step for one, step in zip(others, steps, strict=True)]
        return np.stack(columns, axis=1)

    def values(self, share: Floats) -> list[float]:
        """Return the parameters at shares of their ranges."""
        return [one.value(float(x)) for one, x in zip(self.scales, share, strict=True)]


@dataclass(kw_only=True)
class FitRuns:
    """The runs of a back-analysis in the folder of its study."""

    folder: StudyFolder
    workers: Workers
    asked: list[tuple[float, ...]]
    """Parameters of each run that has been asked for, from run 1 on, by this search or before."""
    number: dict[tuple[float, ...], int] = field(default_factory=dict)
    """Parameters -> number of the run, of this search."""

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

    def _number(self, values: tuple[float, ...]) -> int:
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
        result = self.folder.result(run)
        same = result is not None and tuple(result["parameters"].values()) == self.asked[run - 1]
        return result if same else None

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
