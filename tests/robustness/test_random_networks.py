"""Rock masses drawn at random are cut, pass clast's own checks, and run (scenes/networks.py)."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.networks import STEPS, drawn
from scenes.random_systems import outcome

SEEDS = (0, 1, 3, 4, 7, 9, 12, 13, 14, 17, 18, 19)
"""Ones that are cut by all models, in sizes from 0.4 m to 900 m."""
LARGEST = 60.0
"""Blocks at most, about."""


@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_rock_mass_runs(seed):
    found = outcome(drawn(seed, LARGEST))
    run, model = found.run, found.run.model
    assert run.report.finished and run.report.steps >= STEPS
    for values in (run.state.vertices, run.state.velocity, run.state.stress, *run.energy.values()):
        assert np.isfinite(values).all()
    assert found.gain < 1e-3
    told = {frozenset(one.blocks) for one in run.report.overlaps}
    size, deepest = np.sqrt(model.area.min()), run.report.largest_penetration
    # across a corner of four, blocks overlap as far as each gives way to those beside it
    unseen = [one for one in found.unseen if one.depth > max(2.0 * deepest, 1e-3 * size)]
    assert {frozenset(one.blocks) for one in unseen} <= told
    # the settlement of one contact under the column above the largest block
    high, wide = np.ptp(model.vertices[:, 1]), np.sqrt(model.area.max())
    weight = max(rock.density for rock in model.rocks) * 9.81 * high * wide
    stiffness = found.share * model.stiffest
    assert deepest < max(10.0 * weight / stiffness, 5e-3 * size)
