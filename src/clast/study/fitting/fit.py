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

import json
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy import optimize, stats

from clast.case.api import case_of
from clast.case.case_file import Case
from clast.errors import CaseError, ClastError, ResultsLost
from clast.study import trial_table
from clast.study.collapsing.collapse import Given
from clast.study.description import FIT, Description, parameters_of
from clast.study.executors import workers_of
from clast.study.fitting.ensemble import smooth
from clast.study.fitting.fitting import Fit, FitRuns, Fitting, ParameterScale, Watch
from clast.study.fitting.observations import (
    ENSEMBLE,
    PLACES_MAX,
    FitSettings,
    Observation,
    read_observations,
)
from clast.study.folder import DONE, StudyFolder, write_whole
from clast.study.parameters import ParameterPlaces, content_of
from clast.study.statistics import CONFIDENCE
from clast.study.study_api import USUAL, HowMade
from clast.study.work import check_study


def fit(
    case: Given,
    observe: Path | str | Sequence[Observation],
    vary: Mapping[str, Any],
    *,
    how: FitSettings | None = None,
    folder: str | Path | None = None,
    watch: Watch | None = None,
    **made: Any,
) -> Fit:
    """Return the parameters with which a case moves as it was measured.

    ``observe`` is a table (CSV) with the columns point, time, x, y, sd, or a list; ``vary`` has
    paths -> ranges, ``"uniform(1e8, 1e10)"``; ``how`` chooses an ensemble in place of least
    squares.  ``folder`` keeps all runs, and goes on with those that are there.  ``made`` says who
    makes them: fields of ``HowMade``, e.g. ``workers``.  Raises CaseError for invalid input, and
    where a run cannot go on.
    """
    loaded = case_of(case)
    study = described(loaded, observe, vary, how or FitSettings())
    check_study(loaded, study)
    with ExitStack() as stack:
        place = folder
        if place is None:
            place = stack.enter_context(tempfile.TemporaryDirectory(prefix="clast-fit-"))
        kept = StudyFolder.made(Path(place), loaded, study)
        result = go_on(kept, HowMade(**made), watch)
    return result if folder is not None else replace(result, folder=None)


def described(
    case: Case,
    observe: Path | str | Sequence[Observation],
    vary: Mapping[str, Any],
    how: FitSettings,
) -> Description:
    """Return the description of a back-analysis; raises CaseError for an invalid one."""
    chosen = how.checked()
    parameters = parameters_of(vary)
    if isinstance(observe, str | Path):
        observations = read_observations(Path(observe), case.model().measured_points.name)
    else:
        observations = list(observe)
    if not observations:
        raise CaseError("there is none", where="observe", remedy="give at least one observation")
    if chosen.method == ENSEMBLE and observations[0].sd is None:
        raise CaseError(
            "es-mda weights observations by their standard deviations, which are missing",
            where="observe",
            remedy="give the table a column sd, or take method least-squares",
        )
    if chosen.method != ENSEMBLE and len(observations) < len(parameters):
        raise CaseError(
            f"{len(observations)} observations do not determine {len(parameters)} parameters",
            where="observe",
            remedy="measure more, vary less, or take method es-mda, which starts from prior "
            "distributions",
        )
    for one in parameters:
        ParameterScale.of(one)
    return Description(
        kind=FIT,
        vary=parameters,
        measure={one.measure: one.measure for one in observations},
        observe=tuple(observations),
        fit=chosen,
    ).checked()


def go_on(folder: StudyFolder, made: HowMade = USUAL, watch: Watch | None = None) -> Fit:
    """Go on with the back-analysis in a folder; return its result, also written there.

    Raises CaseError where a run cannot go on.
    """
    study = folder.study
    if made.array is not None:
        raise CaseError(
            "each run of a back-analysis depends on those before, so they cannot be split into an "
            "array",
            where="--array",
            remedy="give --workers N, or --scheduler",
        )
    with (
        folder.driven(),
        workers_of(folder, made.executor, made.workers, made.scheduler) as workers,
    ):
        if made.retry:
            for one in folder.results():
                if one["status"] != DONE:
                    folder.forget(one["run"])
        fitting = Fitting(
            scales=tuple(map(ParameterScale.of, study.vary)),
            observations=study.observe,
            made=FitRuns(folder=folder, workers=workers, asked=folder.asked()),
            watch=watch,
        )
        how = study.fit or FitSettings()
        if how.method == ENSEMBLE:
            result = smooth(fitting, study.vary, how)
        else:
            result = least_squares(fitting, [one.name for one in study.vary])
        result = replace(result, folder=folder.path)
        text = json.dumps(result.as_dict(), indent=1, ensure_ascii=False)
        write_whole(folder.path / "fit.json", f"{text}\n".encode())
        trial_table.write_csv(folder, folder.path / trial_table.CSV)
        settings = ParameterPlaces.of(content_of(folder.base), study.vary)
        content = settings.case(result.value.tolist())
        write_whole(folder.path / "best.toml", folder.case_text(content, ""))
    return result


def least_squares(fitting: Fitting, names: Sequence[str]) -> Fit:
    """Return the least squares solution of parameters by name, with intervals.

    Raises CaseError where a run cannot go on.
    """
    middle = np.full(len(names), 0.5)
    try:
        solution = optimize.least_squares(
            lambda x: fitting.residuals([x])[0],
            middle,
            jac=fitting.derivative,
            bounds=(0.0, 1.0),
            x_scale=1.0,
            xtol=1e-6,
            ftol=1e-10,
            max_nfev=PLACES_MAX,
        )
    except ResultsLost:
        raise
    except ClastError as error:
        raise CaseError(
            f"a run of the back-analysis cannot continue: {' '.join(str(error).split())}",
            where="vary",
            remedy="choose ranges with which the case can be run",
        ) from None
    observed, scale = fitting.observed, fitting.deviations
    known = fitting.observations[0].sd is not None
    freedom = len(observed) - len(names)
    normal = solution.jac.T @ solution.jac
    remark = "" if solution.success else "the search ended before it had converged. "
    if np.linalg.matrix_rank(normal) < len(names):
        remark += "the observations do not tell all parameters apart. "
    variance = 1.0 if known else float(solution.fun @ solution.fun) / max(1, freedom)
    covariance = variance * np.linalg.pinv(normal)
    spread = np.sqrt(np.diag(covariance))
    chance = 0.5 + 0.5 * CONFIDENCE
    t = stats.norm.ppf(chance) if known else stats.t.ppf(chance, max(1, freedom))
    at_end = [name for name, x in zip(names, solution.x, strict=True) if not 1e-3 < x < 1.0 - 1e-3]
    if at_end:
        remark += f"{', '.join(at_end)} lies at an end of its range. "
    return Fit(
        parameter=tuple(names),
        value=np.array(fitting.values(solution.x)),
        low=np.array(fitting.values(solution.x - t * spread)),
        high=np.array(fitting.values(solution.x + t * spread)),
        correlation=covariance / np.maximum(np.outer(spread, spread), 1e-300),
        observed=observed,
        predicted=observed + solution.fun * scale,
        runs=fitting.made.count,
        remark=remark.strip(),
    )
