"""Indices of sensitivity: which parameter a measure depends on, alone and with others.

Computed by SALib (extra ``salib``) of runs that were drawn for it: Sobol' indices of ``saltelli``,
elementary effects of ``morris``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.model.model import Floats
from clast.study.probabilities import CONFIDENCE, StudyResults
from clast.study.variables.designs import Morris

RESAMPLES = 200
"""Bootstrap samples of an interval."""
MEANING = {
    "saltelli": "First: share of the variance that the parameter causes alone; total: with all of "
    "its interactions. Plus or minus: 95 %, by bootstrap.",
    "morris": "mu: mean change of the measure where the parameter goes from end to end of its "
    "range (probability 0.01 to 0.99); mu*: mean of its size; sigma: standard deviation, large "
    "where it interacts or is not linear. Plus or minus: 95 %, by bootstrap.",
}
"""Sampling -> meaning of its indices."""


@dataclass(frozen=True, kw_only=True)
class SensitivityIndex:
    """The indices of one parameter."""

    parameter: str
    """The parameter."""
    index: dict[str, float]
    """Name of an index -> value: first, total; or mu, mu*, sigma; and "plus or minus ..."."""


def sensitivities(columns: StudyResults, values: Floats) -> list[SensitivityIndex]:
    """Return the indices of a measure (k,), the strongest parameter first.

    There are none for other samplings, and where the measure does not change.  Groups of runs of
    which one has no result are left out.  Raises CaseError where SALib is not installed, or where
    no two groups are left.
    """
    study = columns.study
    if not study.sampling.INDICES or study.kind != "montecarlo":
        return []
    names = [one.name for one in study.vary]
    is_morris = isinstance(study.sampling, Morris)
    size = len(names) + (1 if is_morris else 2)
    rows, output = _whole_groups(columns, values, size)
    if len(output) < 2 * size:
        raise CaseError(
            "too few groups of runs have results",
            where="sampling",
            remedy="continue the study, or look at the reasons it gives",
        )
    if np.ptp(output) == 0.0:
        return []
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    found = _of_morris(study, problem, rows, output) if is_morris else _of_sobol(problem, output)
    strength = "mu*" if is_morris else "total"
    listed = [
        SensitivityIndex(
            parameter=name, index={key: float(column[k]) for key, column in found.items()}
        )
        for k, name in enumerate(names)
    ]
    return sorted(listed, key=lambda one: -one.index[strength])


def _whole_groups(columns: StudyResults, values: Floats, size: int) -> tuple[list[int], Floats]:
    """Return the runs of whole groups, from 0, and their values."""
    sound = {
        int(run) - 1: float(value)
        for run, value in zip(columns.run, values, strict=True)
        if np.isfinite(value)
    }
    rows = [
        row
        for group in range(columns.study.n // size)
        for row in range(group * size, (group + 1) * size)
        if all(one in sound for one in range(group * size, (group + 1) * size))
    ]
    return rows, np.array([sound[row] for row in rows])


def _of_sobol(problem: dict[str, Any], output: Floats) -> dict[str, Sequence[float]]:
    """Return first and total indices with their intervals."""
    try:
        from SALib.analyze import sobol
    except ImportError:
        raise _missing() from None
    # Saltelli's estimators lose digits where the mean is large against the spread
    found = sobol.analyze(
        problem,
        (output - output.mean()) / output.std(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=1,
    )
    return {
        "first": found["S1"],
        "plus or minus": found["S1_conf"],
        "total": found["ST"],
        "plus or minus of total": found["ST_conf"],
    }


def _of_morris(
    study: Any, problem: dict[str, Any], rows: list[int], output: Floats
) -> dict[str, Sequence[float]]:
    """Return elementary effects with their interval."""
    try:
        from SALib.analyze import morris
    except ImportError:
        raise _missing() from None
    places = np.array([study.sampling.shares(row, len(study.vary)) for row in rows])
    found = morris.analyze(
        problem,
        places,
        output,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        num_levels=Morris.LEVELS,
        seed=1,
    )
    return {
        "mu": found["mu"],
        "mu*": found["mu_star"],
        "plus or minus": found["mu_star_conf"],
        "sigma": found["sigma"],
    }


def _missing() -> CaseError:
    return CaseError(
        "indices of sensitivity need SALib, which is not installed",
        where="sampling",
        remedy="install it: pip install 'clast[salib]', then clast study collect",
    )
