"""The ensemble smoother against the posterior distribution of a linear case, which is known."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from clast.errors import CaseError
from clast.model.model import Floats
from clast.study.description import parameters_of
from clast.study.fitting.ensemble import smooth
from clast.study.fitting.observations import ENSEMBLE, FitSettings

SLOPES = np.array([[1.0, 0.5], [0.0, 2.0], [1.0, -1.0]])
MEANS, SDS = np.array([3.0, -1.0]), np.array([2.0, 0.5])
VARY = {"a": "normal(3, 2)", "b": "normal(-1, 0.5)"}


@dataclass
class Linear:
    """A case that moves in proportion to its parameters."""

    observed: Floats
    deviations: Floats = field(default_factory=lambda: np.array([0.5, 0.8, 1.0]))
    count: int = 0
    failing: float = np.inf

    @property
    def made(self) -> Linear:
        return self

    def computed(self, places):  # type: ignore[no-untyped-def]
        self.count += len(places)
        return [
            CaseError("stops") if one[0] > self.failing else SLOPES @ np.array(one)
            for one in places
        ]


def exact(case: Linear) -> tuple[Floats, Floats]:
    """Return mean and standard deviations of the posterior distribution."""
    scaled = SLOPES / case.deviations[:, None]
    covariance = np.linalg.inv(np.diag(SDS**-2) + scaled.T @ scaled)
    mean = covariance @ (MEANS / SDS**2 + scaled.T @ (case.observed / case.deviations))
    return mean, np.sqrt(np.diag(covariance))


@pytest.mark.parametrize("rounds", [1, 4])
def test_a_linear_case_has_its_posterior_distribution(rounds: int) -> None:
    case = Linear(np.array([2.0, -3.0, 5.0]))
    how = FitSettings(method=ENSEMBLE, members=4000, rounds=rounds, seed=2).checked()
    found = smooth(case, parameters_of(VARY), how)  # type: ignore[arg-type]
    mean, sd = exact(case)
    assert found.value == pytest.approx(mean, abs=0.08 * sd.min())
    assert (found.high - found.low) / (2 * 1.96) == pytest.approx(sd, rel=0.05)
    assert found.runs == 4000 * (rounds + 1)


def test_members_that_fail_are_left_out_and_half_of_them_are_too_many() -> None:
    how = FitSettings(method=ENSEMBLE, members=200).checked()
    few = smooth(Linear(np.array([1.0, -3.0, 2.0]), failing=6.0), parameters_of(VARY), how)  # type: ignore[arg-type]
    assert "of 200 members" in few.remark and np.isfinite(few.value).all()
    with pytest.raises(CaseError, match="members cannot be completed"):
        smooth(Linear(np.array([1.0, -3.0, 2.0]), failing=0.0), parameters_of(VARY), how)  # type: ignore[arg-type]
