"""Back-analysis: the parameters with which a case moves as it was measured.

    clast study fit CASE --observe moved.csv --vary "joint.a.shear_stiffness=uniform(1e8, 1e10)"

Least squares (scipy's trust region reflective) of measured less computed values, each over its
standard deviation, within the bounds that each parameter's range gives; a parameter that varies
over more than a factor of ten is sought by its logarithm.  The derivatives are finite differences,
whose runs are made at the same time.  With J at the solution the covariance is s2 (J^T J)^-1, s2
being 1 where standard deviations were given, else the residual variance; the intervals are those of
Student's t, or of the normal distribution where standard deviations are known.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from scipy import optimize, stats

from clast import spelling
from clast.case.case_file import Case
from clast.errors import CaseError, ClastError, shortened
from clast.inputs.declaring import text as case_text
from clast.model.model import Floats
from clast.study.description import parameters_of
from clast.study.executors import start_worker
from clast.study.judging.measures import RunResults
from clast.study.probabilities import CONFIDENCE
from clast.study.trial_cases import changed, content_of, given_case
from clast.study.variables.distributions import Distribution, Range, Values
from clast.study.variables.parameters import Parameter, ParameterPlaces

STEP = 1e-3
"""Change of a parameter, as a share of its range, by which derivatives are taken."""
FAR = 1e-9
"""Probability at which an unbounded distribution is taken to end."""
DECADE = 10.0
"""Ratio of the ends of a range from which a parameter is sought by its logarithm."""
COLUMNS = ("point", "time", "x", "y", "sd")
"""Columns of a table of observations; time and sd may be missing or empty, x or y empty."""


@dataclass(frozen=True, kw_only=True)
class Observation:
    """A displacement that was measured."""

    point: str
    """Measured point."""
    part: int
    """0: x, 1: y."""
    value: float
    """Displacement, m."""
    time: float | None = None
    """When, s; None: at the end of the run."""
    sd: float | None = None
    """Standard deviation, m; None: not known."""


@dataclass(frozen=True, kw_only=True)
class Fit:
    """The result of a back-analysis; m parameters, k observations."""

    parameter: tuple[str, ...]
    """Names."""
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
    """Runs that were made."""
    remark: str = ""
    """The reservations; "" where there are none."""

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        return {
            "parameters": {
                name: {"value": value, "low": low, "high": high}
                for name, value, low, high in zip(
                    self.parameter,
                    self.value.tolist(),
                    self.low.tolist(),
                    self.high.tolist(),
                    strict=True,
                )
            },
            "correlation": self.correlation.tolist(),
            "observed": self.observed.tolist(),
            "predicted": self.predicted.tolist(),
            "runs": self.runs,
            "remark": self.remark,
        }


def read_observations(path: Path, points: Sequence[str]) -> list[Observation]:
    """Return the observations of a table (CSV); raises CaseError naming row and column."""
    text = case_text.read_text(path, "name a table with the columns point, x, y")
    reader = csv.DictReader(text.splitlines())
    heads = [head.strip() for head in reader.fieldnames or ()]
    for head in heads:
        if head not in COLUMNS:
            remedy = spelling.advice(head, COLUMNS, kind="column")
            raise CaseError(f"has a column '{shortened(head)}'", where=str(path), remedy=remedy)
    if "point" not in heads or not {"x", "y"} & set(heads):
        raise CaseError(
            "lacks the columns point and x or y", where=str(path), remedy="e.g. point,time,x,y,sd"
        )
    found = []
    for number, line in enumerate(reader, start=2):
        cells = {str(key).strip(): (value or "").strip() for key, value in line.items() if key}
        where = f"{path}, line {number}"
        if cells["point"] not in points:
            remedy = spelling.advice(cells["point"], points, kind="measured point")
            what = f"there is no measured point '{shortened(cells['point'])}'"
            raise CaseError(what, where=where, remedy=remedy)
        time, sd = (_number(cells.get(key, ""), where, key) for key in ("time", "sd"))
        if sd is not None and sd <= 0.0:
            raise CaseError("has no positive sd", where=where, remedy="leave it empty, or give one")
        for part, key in enumerate(("x", "y")):
            value = _number(cells.get(key, ""), where, key)
            if value is not None:
                one = Observation(point=cells["point"], part=part, value=value, time=time, sd=sd)
                found.append(one)
    if not found:
        raise CaseError("has no observation", where=str(path), remedy="give at least one row")
    if len({one.sd is None for one in found}) > 1:
        raise CaseError("has an sd in some rows only", where=str(path), remedy="give all, or none")
    return found


def _number(text: str, where: str, column: str) -> float | None:
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        remedy = "write a number, or leave it empty"
        raise CaseError(f"'{shortened(text)}' is no {column}", where=where, remedy=remedy)
    return value


@dataclass(frozen=True, kw_only=True)
class ParameterScale:
    """How a parameter is sought: from 0 to 1 over its range, or that of its logarithm."""

    low: float
    """Least value."""
    high: float
    """Largest value."""

    @classmethod
    def of(cls, one: Parameter) -> ParameterScale:
        """Return the range of a parameter; raises CaseError where it has none."""
        drawn: Distribution = one.drawn
        if not drawn.CONTINUOUS or isinstance(drawn, Values | Range):
            raise CaseError(
                f"'{shortened(one.name)}' has no range to be sought in",
                where=f"vary {shortened(one.name)}",
                remedy="give e.g. uniform(1e8, 1e10)",
            )
        return cls(low=float(drawn.quantile(FAR)), high=float(drawn.quantile(1.0 - FAR)))

    @property
    def is_logarithmic(self) -> bool:
        """Whether the logarithm is sought."""
        return self.low > 0.0 and self.high > DECADE * self.low

    def value(self, share: float) -> float:
        """Return the value at a share of the range."""
        if self.is_logarithmic:
            return self.low * (self.high / self.low) ** share
        return self.low + share * (self.high - self.low)


@dataclass(frozen=True, kw_only=True)
class Task:
    """A run of a back-analysis, for a worker."""

    text: str
    """The case."""
    file: str
    """Its file."""
    observations: tuple[Observation, ...]
    """The compared values."""


def predicted(task: Task) -> list[float]:
    """Return the computed values at the measurements, m; raises ClastError where there are none."""
    case = Case.from_text(task.text, task.file)
    measured = RunResults(case.run(warn=lambda _text: None))
    found = []
    for one in task.observations:
        history = measured.run.history(one.point)
        way = history.displacement[:, one.part]
        if one.time is None:
            found.append(float(way[-1]))
        else:
            found.append(float(np.interp(one.time, history.time, way)))
    return found


@dataclass(kw_only=True)
class Fitting:
    """A back-analysis on its way."""

    case: Case
    settings: ParameterPlaces
    scales: tuple[ParameterScale, ...]
    observations: tuple[Observation, ...]
    pool: Executor
    watch: Callable[[int, float], None] | None = None
    runs: int = 0

    def residuals(self, shares: Sequence[Floats]) -> list[Floats]:
        """Return computed less measured, over the standard deviations, at several places."""
        tasks = [self._task(one) for one in shares]
        self.runs += len(tasks)
        observed = np.array([one.value for one in self.observations])
        scale = np.array([one.sd or 1.0 for one in self.observations])
        found = [np.array(one) for one in self.pool.map(predicted, tasks)]
        residuals = [(one - observed) / scale for one in found]
        if self.watch is not None:
            self.watch(self.runs, float(np.sqrt(np.mean(residuals[0] ** 2))))
        return residuals

    def derivative(self, share: Floats) -> Floats:
        """Return the derivatives of the residuals (k, m), by runs that are made at one time."""
        steps = np.where(share + STEP <= 1.0, STEP, -STEP)
        places = [
            share,
            *(share + step * unit for step, unit in zip(steps, np.eye(len(share)), strict=True)),
        ]
        base, *others = self.residuals(places)
        columns = [(one - base) / step for one, step in zip(others, steps, strict=True)]
        return np.stack(columns, axis=1)

    def values(self, share: Floats) -> list[float]:
        """Return the parameters at shares of their ranges."""
        return [one.value(float(x)) for one, x in zip(self.scales, share, strict=True)]

    def _task(self, share: Floats) -> Task:
        content = self.settings.case(self.values(share))
        case = changed(self.case, content)
        return Task(text=case.to_toml(), file=case.file, observations=self.observations)


def fit(
    case: Any,
    observe: Path | str | Sequence[Observation],
    vary: Mapping[str, Any],
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    watch: Callable[[int, float], None] | None = None,
) -> Fit:
    """Return the parameters with which a case moves as it was measured.

    ``observe`` is a table (CSV) with the columns point, time, x, y, sd, or a list; ``vary`` has
    paths -> ranges, ``"uniform(1e8, 1e10)"``.  Raises CaseError for invalid input, and where a run
    cannot go on.
    """
    loaded = given_case(case)
    parameters = parameters_of(vary)
    if not parameters:
        raise CaseError("nothing varies", where="vary", remedy="give at least one parameter")
    points = loaded.model().measured_points.name
    if isinstance(observe, str | Path):
        observations = tuple(read_observations(Path(observe), points))
    else:
        observations = tuple(observe)
    if len(observations) < len(parameters):
        raise CaseError(
            f"{len(observations)} observations do not give {len(parameters)} parameters",
            where="observe",
            remedy="measure more, or vary less",
        )
    with _pool(executor, workers) as pool:
        fitting = Fitting(
            case=loaded,
            settings=ParameterPlaces.of(content_of(loaded), parameters),
            scales=tuple(map(ParameterScale.of, parameters)),
            observations=observations,
            pool=pool,
            watch=watch,
        )
        return _fitted(fitting, [one.name for one in parameters])


def _fitted(fitting: Fitting, names: list[str]) -> Fit:
    """Return the least squares solution."""
    middle = np.full(len(names), 0.5)
    try:
        found = optimize.least_squares(
            lambda x: fitting.residuals([x])[0],
            middle,
            jac=fitting.derivative,
            bounds=(0.0, 1.0),
            x_scale=1.0,
            xtol=1e-6,
            ftol=1e-10,
            max_nfev=60,
        )
    except ClastError as error:
        raise CaseError(
            f"a run of the back-analysis cannot go on: {' '.join(str(error).split())}",
            where="vary",
            remedy="choose ranges with which the case can be run",
        ) from None
    observed = np.array([one.value for one in fitting.observations])
    known = fitting.observations[0].sd is not None
    scale = np.array([one.sd or 1.0 for one in fitting.observations])
    freedom = len(observed) - len(names)
    normal = found.jac.T @ found.jac
    remark = "" if found.success else "the search ended before it had converged. "
    if np.linalg.matrix_rank(normal) < len(names):
        remark += "the observations do not tell all parameters apart. "
    variance = 1.0 if known else float(found.fun @ found.fun) / max(1, freedom)
    covariance = variance * np.linalg.pinv(normal)
    spread = np.sqrt(np.diag(covariance))
    chance = 0.5 + 0.5 * CONFIDENCE
    t = stats.norm.ppf(chance) if known else stats.t.ppf(chance, max(1, freedom))
    at_end = [name for name, x in zip(names, found.x, strict=True) if not 1e-3 < x < 1.0 - 1e-3]
    if at_end:
        remark += f"{', '.join(at_end)} lies at an end of its range. "
    return Fit(
        parameter=tuple(names),
        value=np.array(fitting.values(found.x)),
        low=np.array(fitting.values(found.x - t * spread)),
        high=np.array(fitting.values(found.x + t * spread)),
        correlation=covariance / np.maximum(np.outer(spread, spread), 1e-300),
        observed=observed,
        predicted=observed + found.fun * scale,
        runs=fitting.runs,
        remark=remark.strip(),
    )


@contextmanager
def _pool(executor: Executor | None, workers: int | None) -> Any:
    """Give who makes the runs."""
    if executor is not None:
        yield executor
        return
    context = get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context, initializer=start_worker) as pool:
        yield pool
