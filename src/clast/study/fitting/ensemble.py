"""An ensemble smoother that takes in observations several times (ES-MDA; Emerick, Reynolds 2013).

Members are drawn from the distributions of the parameters.  In each of N_a rounds every member is
run, and moved by

    z += C_zd (C_dd + N_a I)^-1 (sqrt(N_a) e - r),

z being the normal scores of its parameters, r its computed less the measured values over their
standard deviations, e noise of variance 1, C the covariances in the ensemble.  For a linear case
the members end as draws from the posterior distribution.  It needs no derivatives: its runs are as
many for one parameter as for fifty.

Covariances of some tens of members have errors, and members that are moved by covariances of their
own lie too close together afterwards.  So they are divided into groups, each of which is moved by
the covariances of the others (Houtekamer, Mitchell 1998): the errors then make the spread larger,
as they should.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy import special, stats

from clast.errors import CaseError, ClastError
from clast.model.model import Floats
from clast.study.fitting.fitting import Fit, Fitting
from clast.study.fitting.observations import FitSettings
from clast.study.parameters import Parameter
from clast.study.statistics import CONFIDENCE

GROUPS = 5
"""Groups of members, each of which is moved by the covariances of the others."""


def smooth(fitting: Fitting, parameters: Sequence[Parameter], how: FitSettings) -> Fit:
    """Return means and intervals of an ensemble that has taken in the observations.

    Both are those of the normal scores; the interval is that of one more draw, by Student's t of
    the members.  Members whose run cannot go on are left out.  Raises CaseError where less than
    half are left.
    """
    draw = np.random.default_rng(how.seed)
    scores = draw.standard_normal((how.members, len(parameters)))
    for _ in range(how.rounds):
        scores, computed = _sound(fitting, parameters, scores, how)
        residuals = (computed - fitting.observed) / fitting.deviations
        noise = math.sqrt(how.rounds) * draw.standard_normal(residuals.shape)
        scores = update(scores, residuals, noise, float(how.rounds))
    scores, computed = _sound(fitting, parameters, scores, how)
    count, mean = len(scores), scores.mean(axis=0)
    half = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, count - 1) * scores.std(axis=0, ddof=1)
    half *= math.sqrt(1.0 + 1.0 / count)
    low, middle, high = (
        np.array(values_of(parameters, one)) for one in (mean - half, mean, mean + half)
    )
    lost = how.members - len(scores)
    return Fit(
        parameter=tuple(one.name for one in parameters),
        value=middle,
        low=low,
        high=high,
        correlation=np.atleast_2d(np.corrcoef(scores.T)),
        observed=fitting.observed,
        predicted=computed.mean(axis=0),
        runs=fitting.made.count,
        remark=f"{lost} of {how.members} members could not be run to their end." if lost else "",
    )


def update(scores: Floats, residuals: Floats, noise: Floats, inflation: float) -> Floats:
    """Return the scores (n, m) of members that have taken in residuals (n, k) with noise (n, k)."""
    group = np.arange(len(scores)) % GROUPS
    moved = scores.copy()
    for chosen in (group == one for one in range(GROUPS)):
        others = gain(scores[~chosen], residuals[~chosen], inflation)
        moved[chosen] += (noise[chosen] - residuals[chosen]) @ others.T
    return moved


def gain(scores: Floats, residuals: Floats, inflation: float) -> Floats:
    """Return C_zd (C_dd + inflation I)^-1, (m, k), of scores (n, m) and residuals (n, k)."""
    z, d = scores - scores.mean(axis=0), residuals - residuals.mean(axis=0)
    count = len(z) - 1
    covariance = d.T @ d / count + inflation * np.eye(d.shape[1])
    return np.asarray(np.linalg.solve(covariance, d.T @ z / count).T)


def values_of(parameters: Sequence[Parameter], scores: Floats) -> list[float]:
    """Return the parameters at normal scores (m,)."""
    chances = np.clip(special.ndtr(scores), 1e-12, 1.0 - 1e-12)
    return [
        float(one.drawn.quantile(chance))  # type: ignore[arg-type]
        for one, chance in zip(parameters, chances.tolist(), strict=True)
    ]


def _sound(
    fitting: Fitting, parameters: Sequence[Parameter], scores: Floats, how: FitSettings
) -> tuple[Floats, Floats]:
    """Return the scores (n, m) of members that can be run, and their computed values (n, k)."""
    computed = fitting.computed([values_of(parameters, one) for one in scores])
    kept = [not isinstance(one, ClastError) for one in computed]
    if sum(kept) < 0.5 * how.members:
        reason = next(str(one) for one in computed if isinstance(one, ClastError))
        raise CaseError(
            f"{len(kept) - sum(kept)} of {len(kept)} members cannot be completed: {reason}",
            where="vary",
            remedy="choose ranges with which the case can be run",
        )
    return scores[kept], np.array([one for one in computed if not isinstance(one, ClastError)])
