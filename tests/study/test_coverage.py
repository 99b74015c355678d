"""How often intervals of back-analyses hold the truth, of cases that are formulas.

The pushed block is that of docs/how-to/back-analysis.md; tests/system/study/test_fit.py shows that
clast moves it as the formula does.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest

from clast.study.description import parameters_of
from clast.study.fitting.ensemble import smooth
from clast.study.fitting.fit import least_squares
from clast.study.fitting.fitting import Fit, Fitting, ParameterScale
from clast.study.fitting.observations import ENSEMBLE, FitSettings, Observation

WEIGHT, BAR, PUSH, NOISE = 2600.0 * 9.81, 1e7, 4e4, 2e-5
TIMES = np.linspace(0.1, 1.0, 10)
TRUTH = np.array([1e8, 30.0])
RANGES = {"stiffness": "uniform(1e7, 1e9)", "friction": "uniform(15, 45)"}
PRIOR = {"stiffness": "lognormal(2e8, 1.5e8)", "friction": "normal(28, 5, low=10, high=50)"}


def pushed(values: Sequence[float]) -> np.ndarray:
    """Return the displacements of a block that is pushed against a bar, m."""
    stiffness, friction = values
    sliding = (PUSH * TIMES - WEIGHT * math.tan(math.radians(friction))) / BAR
    return np.maximum(PUSH * TIMES / (stiffness + BAR), sliding)


@dataclass
class Formula:
    """Runs whose results are those of a formula."""

    of: object
    count: int = 0

    def computed(self, places):  # type: ignore[no-untyped-def]
        self.count += len(places)
        return [self.of(one) for one in places]  # type: ignore[operator]


def fitting(of: object, vary: dict[str, str], observed: np.ndarray, sd: float | None) -> Fitting:
    return Fitting(
        scales=tuple(map(ParameterScale.of, parameters_of(vary))),
        observations=tuple(Observation(point="A", part=0, value=x, sd=sd) for x in observed),
        made=Formula(of),  # type: ignore[arg-type]
    )


def holds(found: Fit, truth: np.ndarray) -> np.ndarray:
    return (found.low < truth) & (truth < found.high)


@pytest.mark.parametrize("sd", [None, NOISE], ids=["noise unknown", "noise known"])
def test_intervals_of_least_squares_hold_the_truth_as_often_as_they_say(sd) -> None:
    """Of 40 intervals of 95 %, 35 or more hold the truth with a probability of 98.6 %."""
    inside = np.zeros(2, int)
    for seed in range(40):
        noise = np.random.default_rng(seed).normal(0.0, NOISE, len(TIMES))
        one = fitting(pushed, RANGES, pushed(TRUTH) + noise, sd)
        inside += holds(least_squares(one, list(RANGES)), TRUTH)
    assert (inside >= 35).all()


def test_intervals_of_an_ensemble_hold_the_truth_as_often_as_they_say() -> None:
    """Of 20 intervals of 95 %, 17 or more hold the truth with a probability of 98.4 %."""
    inside = np.zeros(2, int)
    for seed in range(20):
        noise = np.random.default_rng(seed).normal(0.0, NOISE, len(TIMES))
        how = FitSettings(method=ENSEMBLE, members=24, rounds=3, seed=seed)
        one = fitting(pushed, PRIOR, pushed(TRUTH) + noise, NOISE)
        inside += holds(smooth(one, parameters_of(PRIOR), how), TRUTH)
    assert (inside >= 17).all()


@dataclass(frozen=True)
class Linear:
    """k observations of m parameters, each normal(0, 1), with noise."""

    m: int
    k: int
    sd: float
    slopes: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        slopes = np.random.default_rng(3).standard_normal((self.k, self.m))
        object.__setattr__(self, "slopes", slopes)

    @property
    def spread(self) -> np.ndarray:
        """Standard deviations of the posterior distribution, shape (m,)."""
        precision = np.eye(self.m) + self.slopes.T @ self.slopes / self.sd**2
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(precision))))


@pytest.mark.parametrize(
    ("case", "members"),
    [(Linear(10, 30, 0.3), 100), (Linear(40, 20, 0.5), 100), (Linear(5, 20, 0.5), 30)],
    ids=["10 parameters", "40 parameters", "few members"],
)
def test_ensembles_of_many_parameters_are_not_too_sure(case: Linear, members: int) -> None:
    """Moved by their own covariances 0.91, 0.83 and 0.85 of the intervals hold the truth."""
    vary = {f"x{k}": "normal(0, 1)" for k in range(case.m)}
    inside, width, seeds = 0.0, 0.0, 5
    for seed in range(seeds):
        draw = np.random.default_rng([9, seed])
        truth = draw.standard_normal(case.m)
        noise = case.sd * draw.standard_normal(case.k)
        how = FitSettings(method=ENSEMBLE, members=members, rounds=4, seed=seed)
        one = fitting(lambda x: case.slopes @ x, vary, case.slopes @ truth + noise, case.sd)
        found = smooth(one, parameters_of(vary), how)
        inside += float(holds(found, truth).mean()) / seeds
        width += float(np.mean((found.high - found.low) / (2 * 1.96 * case.spread))) / seeds
    assert inside > 0.93
    assert 0.95 < width < 1.5
