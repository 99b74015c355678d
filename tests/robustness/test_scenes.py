"""Tall, wedged, thin and unequal blocks."""

import numpy as np
import pytest

from scenes.systems import GRAVITY, Finished, at_start, box, by_convex, centroids, finish, system

GROUND = box(-20.0, -1.0, 40.0, 1.0)


def settled(done: Finished, drift: float) -> None:
    """Assert that no step failed, nothing moved away and the ledger closes."""
    assert done.failed_steps == 0
    assert done.drift < drift
    assert done.created <= 1e-9 * done.turnover
    assert abs(done.run.report.ledger.unaccounted) < 1e-6 * done.turnover


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_fifty_storeys_stand(stiffness: float) -> None:
    """The load passes 50 joints within a step, and no storey leaves its place."""
    model = system([GROUND, *[box(0.0, k) for k in range(50)]], fixed=[0], friction_angle=30.0)
    settled(finish(model, by_convex(stiffness), 1e-3, 0.2), 1e-4)


def wedged(friction_angle: float, half_angle: float = 20.0) -> list[np.ndarray]:
    """Return ground, two blocks and a wedge between their inclined faces."""
    slope = np.tan(np.radians(half_angle))
    right = np.array([[0.2, 0.0], [4.0, 0.0], [4.0, 2.0], [0.2 + 2.0 * slope, 2.0]])
    left = right[::-1] * [-1.0, 1.0]
    low, high = 0.2 + 0.4 * slope, 0.2 + 2.0 * slope
    wedge = np.array([[-low, 0.4], [low, 0.4], [high, 2.0], [-high, 2.0]])
    return [GROUND, left, right, wedge]


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_a_smooth_wedge_drives_two_blocks_apart(stiffness: float) -> None:
    """Without friction the wedge falls with m g/(m + 2 M tan2 a), the blocks give way evenly."""
    model = system(wedged(0.0), fixed=[0], poisson=0.0)
    done = finish(model, by_convex(stiffness), 1e-3, 0.3)
    moved = centroids(model, done.run.state) - centroids(model, at_start(model))
    slope = np.tan(np.radians(20.0))
    fall = GRAVITY * model.mass[3] / (model.mass[3] + 2.0 * model.mass[1] * slope**2)
    assert done.failed_steps == 0
    assert moved[3, 1] == pytest.approx(-0.5 * fall * 0.3**2, rel=5e-3)
    assert moved[2, 0] == pytest.approx(0.5 * fall * slope * 0.3**2, rel=5e-3)
    assert moved[1, 0] == pytest.approx(-moved[2, 0], rel=1e-9)


def test_a_rough_wedge_sticks() -> None:
    model = system(wedged(30.0), fixed=[0], friction_angle=30.0)
    done = finish(model, by_convex(5e9), 1e-3, 0.3)
    settled(done, 2e-5)
    assert np.abs(done.run.state.velocity[:, :2]).max() < 1e-8


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_a_pile_of_slabs_lies_still(stiffness: float) -> None:
    """Slabs of 5 m x 0.1 m, each a little beside the one below; critdis is 1/20 of their height."""
    shift = [0.4 * (k % 2) + 0.1 * (k % 3) for k in range(20)]
    slabs = [box(-2.5 + shift[k], 0.1 * k, 5.0, 0.1) for k in range(20)]
    model = system([GROUND, *slabs], fixed=[0], friction_angle=30.0)
    settled(finish(model, by_convex(stiffness), 1e-3, 0.2), 2e-4)


def test_slabs_on_two_legs_lie_still() -> None:
    legs = [box(-2.5, 0.0, 0.5, 0.5), box(2.0, 0.0, 0.5, 0.5)]
    slabs = [box(-2.5 + 0.3 * (k % 2), 0.5 + 0.1 * k, 5.0, 0.1) for k in range(10)]
    model = system([GROUND, *legs, *slabs], fixed=[0], friction_angle=30.0)
    settled(finish(model, by_convex(5e9), 1e-3, 0.2), 1e-5)


@pytest.mark.parametrize("stiffness", [5e9, 5e10, 5e11])
def test_blocks_of_very_different_size(stiffness: float) -> None:
    """A block of 8 m x 10 m rests on cubes of 1 cm and bears others; 800,000 times their weight.

    critdis is 1/20 and max_displacement 1/10 of the smallest size.
    """
    under = [box(x, 0.0, 0.01, 0.01) for x in (1.0, 5.0, 8.99)]
    upon = [box(2.0 + 0.02 * k, 10.01, 0.01, 0.01) for k in range(5)]
    blocks = [GROUND, *under, box(1.0, 0.01, 8.0, 10.0), *upon]
    model = system(blocks, fixed=[0], friction_angle=30.0, young=50e9)
    how = by_convex(stiffness, critdis=5e-4, max_displacement=1e-3)
    settled(finish(model, how, 1e-3, 0.3), 1e-5)
