"""Walls without damping stand still, whatever the stiffness and the step."""

import numpy as np
import pytest

from scenes.systems import GRAVITY, Finished, by_convex, finish, wall

YOUNG = 5e9
MUCH = 5e-5
"""Horizontal drift, m, that counts as movement."""


def base_penetration(done: Finished) -> np.ndarray:
    """Return the penetrations of the contacts with the base, m."""
    memory = done.run.state.memory
    return -memory.gap[(memory.block == 0) & (memory.gap < 0.0)]


@pytest.mark.parametrize("stiffness", [1e9, 1e10, 1e11])
def test_a_brick_wall_stands_in_few_iterations(stiffness: float) -> None:
    done = finish(wall(10, 10), by_convex(stiffness), 1e-3, 0.3)
    assert done.run.report.cut_steps == 0
    assert done.iterations <= 4.0
    assert done.drift < MUCH
    assert abs(done.run.report.ledger.unaccounted) < 1e-6 * done.turnover


@pytest.mark.parametrize("bonded", [True, False], ids=["running bond", "aligned columns"])
@pytest.mark.parametrize("share", [0.1, 1.0, 50.0])
def test_the_base_carries_the_weight(bonded: bool, share: float) -> None:
    """The mean penetration is W/(n_c p), where every corner meets a corner too."""
    model = wall(6, 6, bonded=bonded, friction_angle=26.57)
    done = finish(model, by_convex(share * YOUNG), 5e-3, 0.5)
    weight = float(model.mass[~model.fixed].sum()) * GRAVITY
    depth = base_penetration(done)
    assert done.failed_steps == 0
    assert len(depth) == 12
    assert depth.mean() == pytest.approx(weight / (12 * share * YOUNG), rel=1e-3)
    assert depth.max() <= 1.2 * depth.mean()
    assert done.drift < MUCH


def test_a_soft_wall_bounces_about_its_rest() -> None:
    """Far below E an undamped wall oscillates, but neither falls nor gains energy."""
    done = finish(wall(6, 6, friction_angle=26.57), by_convex(0.01 * YOUNG), 1e-3, 0.5)
    assert done.failed_steps == 0
    assert done.created <= 1e-9 * done.turnover
    assert done.drift < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("step", [2e-4, 1e-3, 5e-3])
@pytest.mark.parametrize("share", [0.01, 0.1, 1.0, 10.0, 50.0])
def test_105_bricks_stand_for_any_stiffness_and_step(share: float, step: float) -> None:
    done = finish(wall(10, 10, friction_angle=26.57), by_convex(share * YOUNG), step, 200 * step)
    assert done.failed_steps == 0
    assert done.drift < (MUCH if share >= 1.0 else 2e-3)
    assert done.created <= 1e-9 * done.turnover
