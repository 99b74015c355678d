"""Back-analysis: the parameters with which a case moves as it was measured.

    clast study fit CASE --observe moved.csv --vary "joint.a.shear_stiffness=uniform(1e8, 1e10)"

Least squares (scipy's trust region reflective) of measured less computed values, each over its
standard deviation, within the bounds that each parameter's range gives; a parameter that varies
over more than a factor of ten is sought by its logarithm.  The derivatives are finite differences,
whose runs are made at the same time.  With J at the solution the covariance is s2 (J^T J)^-1, s2
being 1 where standard deviations were given, else the residual variance; the intervals are those of
Student's t, or of the normal distribution where standard deviations are known.  For many parameters
there is an ensemble (``fitting/ensemble.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from scipy import optimize, stats

from clast.errors import CaseError, ClastError
from clast.study.description import parameters_of
from clast.study.executors import start_worker
from clast.study.fitting.back_analysis import (
    ENSEMBLE,
    Fit,
    FitSettings,
    Fitting,
    ParameterScale,
)
from clast.study.fitting.ensemble import smoothed
from clast.study.fitting.fit_runs import RunStore
from clast.study.fitting.observations import Observation, read_observations
from clast.study.probabilities import CONFIDENCE
from clast.study.trial_cases import content_of, given_case
from clast.study.variables.parameters import ParameterPlaces


def fit(
    case: Any,
    observe: Path | str | Sequence[Observation],
    vary: Mapping[str, Any],
    *,
    how: FitSettings | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    watch: Callable[[int, float], None] | None = None,
) -> Fit:
    """Return the parameters with which a case moves as it was measured.

    ``observe`` is a table (CSV) with the columns point, time, x, y, sd, or a list; ``vary`` has
    paths -> ranges, ``"uniform(1e8, 1e10)"``; ``how`` chooses an ensemble in place of least
    squares, and a folder that keeps the runs.  Raises CaseError for invalid input, and where a run
    cannot go on.
    """
    loaded = given_case(case)
    chosen = (how or FitSettings()).checked()
    parameters = parameters_of(vary)
    if not parameters:
        raise CaseError("nothing varies", where="vary", remedy="give at least one parameter")
    points = loaded.model().measured_points.name
    if isinstance(observe, str | Path):
        observations = tuple(read_observations(Path(observe), points))
    else:
        observations = tuple(observe)
    is_ensemble = chosen.method == ENSEMBLE
    if len(observations) < len(parameters) and not is_ensemble:
        raise CaseError(
            f"{len(observations)} observations do not give {len(parameters)} parameters",
            where="observe",
            remedy="measure more, vary less, or take method es-mda, which begins with what is "
            "known before",
        )
    if is_ensemble and observations[0].sd is None:
        raise CaseError(
            "es-mda weighs observations by their standard deviations, which are not given",
            where="observe",
            remedy="give the table a column sd, or take method least-squares",
        )
    scales = tuple(map(ParameterScale.of, parameters))
    keep = RunStore.opened(chosen.folder, loaded)
    with _pool(executor, workers) as pool:
        fitting = Fitting(
            case=loaded,
            settings=ParameterPlaces.of(content_of(loaded), parameters),
            scales=scales,
            observations=observations,
            pool=pool,
            keep=keep,
            watch=watch,
        )
        if is_ensemble:
            return smoothed(fitting, parameters, chosen)
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
    observed, scale = fitting.observed, fitting.deviations
    known = fitting.observations[0].sd is not None
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
