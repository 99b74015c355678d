"""Rock masses drawn at random are cut, pass clast's own checks, and run (scenes/networks.py).

A thousand of them are run by ``python -m benchmarks.networks``.
"""

from __future__ import annotations

from dataclasses import asdict

import pytest

from scenes.networks import outcome, wrong

SEEDS = (0, 1, 3, 4, 7, 9, 12, 13, 14, 17, 18, 19)
"""Ones that are cut by all models, in sizes from 0.4 m to 900 m."""
LARGEST = 60.0


@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_rock_mass_runs(seed):
    found = outcome(seed, LARGEST)
    assert wrong(asdict(found)) == []
    assert found.steps >= 20
