"""The path to a flow leads there from anywhere."""

from __future__ import annotations

import numpy as np
import pytest

from clast.model.flow.path import followed
from clast.model.flow.pieces import Problem, error_of, piece_at, water_at
from clast.model.flow.solving import advanced, steady
from scenes.channels import drawn

SEEDS = (0, 2, 5, 8)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_path_leads_to_the_flow(seed: int) -> None:
    balance = drawn(seed).balance
    before = steady(balance)
    lowered = drawn(seed).lowered
    solved = advanced(lowered, before, 100.0)
    problem = Problem(
        balance=lowered, pressure=before.pressure, saturation=before.saturation, rate=0.01
    )
    random = np.random.default_rng(seed)
    x = problem.scale * random.uniform(-1.0, 1.0, len(balance.kind))
    reached, pieces = followed(problem, x, 1.0, 10_000)
    piece = piece_at(problem, reached)
    water = water_at(problem, piece, reached)
    assert 1 < pieces < 10_000
    assert error_of(problem, water) < 1e-9
    assert water.pressure == pytest.approx(solved.pressure, abs=1e-8 * problem.scale)


def test_every_component_falls_alike_along_the_path() -> None:
    balance = drawn(5).balance
    nothing = np.zeros(len(balance.kind))
    problem = Problem(balance=balance, pressure=nothing, saturation=nothing, rate=1e-3)
    x = np.full(len(nothing), -0.5 * problem.scale)
    lefts = []
    for pieces in (0, 8, 40):
        at, _ = followed(problem, x, 1.0, pieces)
        lefts.append(water_at(problem, piece_at(problem, at), at).left[problem.free])
    for left in lefts[1:]:
        share = (left @ lefts[0]) / (lefts[0] @ lefts[0])
        assert 0.0 < share < 1.0
        assert left == pytest.approx(share * lefts[0], abs=1e-9 * np.abs(lefts[0]).max())
