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
from pathlib import Path
from typing import Any

import numpy as np
from scipy import optimize, stats

from clast.case.case_file import Case
from clast.errors import CaseError, ClastError, ResultsLost
from clast.inputs.declaring import text as case_text
from clast.study import trial_table
from clast.study.description import FIT, Description, parameters_of
from clast.study.executors import workers_of
from clast.study.fitting.ensemble import smoothed
from clast.study.fitting.fitting import Fit, FitRuns, Fitting, ParameterScale, Watch
from clast.study.fitting.observations import (
    ENSEMBLE,
    MOST_PLACES,
    FitSettings,
    Observation,
    read_observations,
)
from clast.study.folder import DONE, StudyFolder, with_files, write_whole
from clast.study.parameters import Parameter, ParameterPlaces, content_of, given_case
from clast.study.statistics import CONFIDENCE
from clast.study.study_api import USUAL, HowMade
from clast.study.work import check_study

RESULT, BEST = "fit.json", "best.toml"
"""The result of a back-analysis, and its case with the best parameters."""


def fit(
    case: Any,
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
    loaded = given_case(case)
    study = described(loaded, observe, vary, how or FitSettings())
    check_study(loaded, study)
    with ExitStack() as stack:
        place = folder
        if place is None:
            place = stack.enter_context(tempfile.TemporaryDirectory(prefix="clast-fit-"))
        kept = StudyFolder.made(Path(place), loaded, study)
        found = go_on(kept, HowMade(**made), watch)
    return found if folder is not None else found.in_folder(None)


def described(
    case: Case,
    observe: Path | str | Sequence[Observation],
    vary: Mapping[str, Any],
    how: FitSettings,
) -> Description:
    """Return the description of a back-analysis; raises CaseError for an invalid one."""
    chosen = how.checked()
    parameters = parameters_of(vary)
    if not parameters:
        raise CaseError("no parameter varies", where="vary", remedy="give at least one parameter")
    if isinstance(observe, str | Path):
        observations = read_observations(Path(observe), case.model().measured_points.name)
    else:
        observations = list(observe)
    _check_observations(observations, parameters, chosen)
    for one in parameters:
        ParameterScale.of(one)
    return Description(
        kind=FIT,
        vary=parameters,
        measure={one.measure: one.measure for one in observations},
        observe=tuple(observations),
        fit=chosen,
    ).checked()


def _check_observations(
    observations: Sequence[Observation], parameters: Sequence[Parameter], how: FitSettings
) -> None:
    """Raise CaseError where observations do not suit the method."""
    if not observations:
        raise CaseError("there is none", where="observe", remedy="give at least one observation")
    if how.method == ENSEMBLE:
        if observations[0].sd is None:
            raise CaseError(
                "es-mda weights observations by their standard deviations, which are missing",
                where="observe",
                remedy="give the table a column sd, or take method least-squares",
            )
    elif len(observations) < len(parameters):
        raise CaseError(
            f"{len(observations)} observations do not determine {len(parameters)} parameters",
            where="observe",
            remedy="measure more, vary less, or take method es-mda, which starts from prior "
            "distributions",
        )


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
            for result in folder.results():
                if result["status"] != DONE:
                    folder.forget(result["run"])
        fitting = Fitting(
            scales=tuple(map(ParameterScale.of, study.vary)),
            observations=study.observe,
            made=FitRuns.of(folder, workers),
            watch=watch,
        )
        how = study.fit or FitSettings()
        if how.method == ENSEMBLE:
            found = smoothed(fitting, study.vary, how)
        else:
            found = least_squares(fitting, [one.name for one in study.vary])
        found = found.in_folder(folder.path)
        _write(folder, found)
    return found


def _write(folder: StudyFolder, found: Fit) -> None:
    """Write the result, the table of the runs, and the case with the best parameters."""
    text = json.dumps(found.as_dict(), indent=1, ensure_ascii=False)
    write_whole(folder.path / RESULT, f"{text}\n".encode())
    trial_table.write_csv(folder, folder.path / trial_table.CSV)
    settings = ParameterPlaces.of(content_of(folder.base), folder.study.vary)
    content = settings.case(found.value.tolist())
    base = Path(folder.study.case).parent.as_posix()
    text = case_text.to_toml(with_files(content, base))
    write_whole(folder.path / BEST, text.encode("utf-8"))


def least_squares(fitting: Fitting, names: Sequence[str]) -> Fit:
    """Return the least squares solution of parameters by name, with intervals.

    Raises CaseError where a run cannot go on.
    """
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
            max_nfev=MOST_PLACES,
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
