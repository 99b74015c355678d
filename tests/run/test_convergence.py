"""How much movement of a static run is still to come, seen from its last steps."""

import numpy as np
import pytest

from clast.run.stages.convergence import COMING_MIN, STEPS_AHEAD_MAX, Convergence

SIZE, PUSHED = np.ones(2), np.ones(2, np.bool_)
SETTLED, SWAY = (
    np.array([[0.0, -5e-3, 0.0], [0.0, -9e-3, 0.0]]),
    np.array([[1e-4, 0, 0], [3e-4, 0, 0]]),
)


def followed(ratio: float, steps: int, step: float = 1.0) -> Convergence:
    """Return a settlement with a sway, and the sways after it, each ``ratio`` times the last."""
    now = Convergence().restarted(SETTLED + SWAY, step)
    for k in range(1, steps + 1):
        now = now.followed(SWAY * ratio**k, step, SIZE, PUSHED)
    return now


@pytest.mark.parametrize("ratio", [0.5, 0.9, 0.95])
def test_the_rest_is_that_of_a_geometric_series(ratio: float):
    now = followed(ratio, 3)
    exact = 3e-4 * ratio**4 / (1.0 - ratio)
    assert now.coming == pytest.approx(exact, rel=1e-3)
    assert now.series(np.inf) == pytest.approx(1.0 / (1.0 - ratio), rel=1e-3)
    # the way that it may cover is that of the step before, times q
    assert now.series(3e-4 * ratio**4 * 1.7) == pytest.approx(1.7, rel=1e-3)


def test_nothing_is_to_come_where_it_is_little_of_the_way():
    steps = int(np.ceil(np.log(COMING_MIN) / np.log(0.9)))
    assert followed(0.9, steps - 3).coming > 0.0
    assert followed(0.9, steps + 1).coming == 0.0


@pytest.mark.parametrize("ratio", [1.0, 1.02, 1.5])
def test_what_does_not_become_less_has_no_end(ratio: float):
    now = followed(ratio, 3)
    assert np.isinf(now.coming)
    assert now.series(np.inf) == pytest.approx(sum(ratio**k for k in range(STEPS_AHEAD_MAX)))


def test_blocks_that_tremble_have_come_to_rest():
    now = followed(0.9, 2)
    aside = now.followed(SWAY[:, [1, 0, 2]], 1.0, SIZE, PUSHED)
    back = now.followed(-SWAY, 1.0, SIZE, PUSHED)
    assert (aside.coming, back.coming) == (0.0, 0.0)
    assert aside.series(np.inf) == back.series(np.inf) == 1.0


def test_forces_that_are_none_move_nothing():
    now = Convergence().restarted(SWAY, 1.0)
    assert now.followed(SWAY, 1.0, SIZE, ~PUSHED).coming == 0.0
    assert np.isinf(now.followed(SWAY, 1.0, SIZE, PUSHED).coming)


def test_a_step_held_back_by_its_mass_says_how_far_longer_ones_would_go():
    now = Convergence().restarted(SWAY, 10.0)
    short = now.followed(SWAY * 1e-3, 1.0, SIZE, PUSHED)
    assert short.coming == pytest.approx(3e-7 * (100.0 / (1.0 - 0.1) - 1.0))


def test_after_a_step_that_went_ahead_its_ratio_holds_until_two_are_seen():
    now = followed(0.9, 3).gone_ahead(10.0 * SWAY, 1.0)
    assert now.coming > 0.0 and now.series(np.inf) == 1.0
    for k, ratio in enumerate((0.9, 0.9, 0.1)):
        now = now.followed(SWAY * 0.1**k, 1.0, SIZE, PUSHED)
        left = ratio / (1.0 - ratio) * 3e-4 * 0.1**k
        covered = np.sum(now.total * SWAY) / np.sum(SWAY**2) * 3e-4
        assert now.coming == pytest.approx(left if left > COMING_MIN * covered else 0.0, rel=1e-2)
