"""Rock masses drawn at random are cut, pass clast's own checks, and run (scenes/networks.py).

A thousand of them are run by ``python -m benchmarks.networks``.
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

from scenes.networks import MODELS, drawn, outcome, wrong

SEEDS = (0, 1, 3, 4, 7, 9, 12, 13, 14, 17, 18, 19)
"""Ones that are cut by all models, in sizes from 0.4 m to 900 m."""
LARGEST = 60.0


@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_rock_mass_runs(seed):
    found = outcome(seed, LARGEST)
    assert wrong(asdict(found)) == []
    assert found.steps >= 20


def test_they_are_as_different_as_they_are_meant_to_be():
    cases = [drawn(seed, LARGEST) for seed in range(40)]
    models = {one.model.name for case in cases for one in case.joint_set}
    assert models == set(MODELS)
    boundaries = [np.array(case.domain.boundary) for case in cases]
    sizes = [np.hypot(*np.ptp(one, axis=0)) for one in boundaries]
    assert min(sizes) < 1.0 and max(sizes) > 300.0
    assert max(np.abs(one).max() for one in boundaries) > 5e5
    for table in ("trace", "opening", "region", "block"):
        with_it = sum(bool(getattr(case, table)) for case in cases)
        assert 2 <= with_it <= 38, table
    again = drawn(7, LARGEST)
    assert again.to_toml() == cases[7].to_toml()


BAD = {
    "not cut": {"ended": "not cut", "said": "why"},
    "not finite": {"finite": False},
    "without a warning": {"unwarned": (("1", "2", 1e-3),)},
    "weight above": {"penetration": 11.0, "share": 0.1},
    "energy gained": {"gain": 0.1},
}


@pytest.mark.parametrize("what", BAD)
def test_what_is_wrong_is_said(what):
    good = {"ended": "ran", "said": "", "finite": True, "unwarned": ()}
    good |= {"penetration": 1.0, "share": 1e-3, "gain": 0.0}
    assert wrong(good) == []
    (said,) = wrong({**good, **BAD[what]})
    assert what in said
