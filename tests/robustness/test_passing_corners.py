"""Contact memory goes along when a vertex passes from one edge to the next."""

import numpy as np
import pytest

from clast.model.model import Model
from clast.step.method import StepResult
from scenes.systems import GRAVITY, Floats, box, by_convex, march, system, turned

PLAIN = box(-2.0, -1.0, 8.0, 1.0)


def floor(bend: float) -> Floats:
    """Return a floor that falls off by an angle, degrees, from x = 2; 0: a flat corner there."""
    down = np.radians(bend)
    end = [2.0 + 4.0 * np.cos(down), -4.0 * np.sin(down)]
    return np.array([[-2.0, -1.0], [6.0, -1.0], end, [2.0, 0.0], [-2.0, 0.0]])


def table(x: float) -> Floats:
    """Return a block that stands on two tips, 1 m apart, the left one at (x, 0)."""
    return np.array(
        [[x, 0.0], [x + 0.2, 0.2], [x + 0.8, 0.2], [x + 1.0, 0.0], [x + 1.0, 0.5], [x, 0.5]]
    )


def slide(
    ground: Floats, block: Floats, stiffness: float, speed: float, end: float
) -> tuple[Model, list[StepResult]]:
    """Return a block sliding over the ground with a friction angle of 20 degrees."""
    model = system([ground, block], fixed=[0], friction_angle=20.0, velocity={1: (speed, 0, 0)})
    return model, march(model, by_convex(stiffness), 1e-3, end)


def friction(results: list[StepResult]) -> Floats:
    """Return the friction work after each step, J/m."""
    return np.array([one.state.ledger.friction for one in results])


def share_of_coulomb(model: Model, results: list[StepResult]) -> Floats:
    """Return each step's friction work over tan(phi) W times the way of the block."""
    at = np.array([one.state.vertices[-6:].mean(axis=0) for one in results])
    way = np.hypot(*np.diff(at, axis=0).T)
    force = np.tan(np.radians(20.0)) * model.mass[1] * GRAVITY
    return np.diff(friction(results)) / (force * way)


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_a_tip_does_not_feel_a_flat_corner(stiffness: float) -> None:
    """Friction work and path are those on a floor without the corner, bit for bit."""
    _, bare = slide(PLAIN, table(0.5), stiffness, 5.0, 0.2)
    model, results = slide(floor(0.0), table(0.5), stiffness, 5.0, 0.2)
    assert results[-1].state.vertices[-3, 0] > 2.1
    assert np.array_equal(friction(results), friction(bare))
    assert np.array_equal(results[-1].state.vertices[-6:], bare[-1].state.vertices[-6:])
    assert np.abs(share_of_coulomb(model, results)[60:] - 1.0).max() < 1e-7


@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_a_face_hardly_feels_a_flat_corner(stiffness: float) -> None:
    """The corner becomes a third support below the face; its load comes within few steps."""
    _, bare = slide(PLAIN, box(0.5, 0.0, 1.0, 0.5), stiffness, 5.0, 0.2)
    _, results = slide(floor(0.0), box(0.5, 0.0, 1.0, 0.5), stiffness, 5.0, 0.2)
    one_step = float(np.diff(friction(bare)).max())
    assert np.abs(friction(results) - friction(bare)).max() < one_step


@pytest.mark.parametrize("bend", [0.1, 0.5, -0.1, -0.5])
@pytest.mark.parametrize("stiffness", [5e8, 5e9, 5e10])
def test_friction_work_goes_on_round_a_slight_bend(bend: float, stiffness: float) -> None:
    """The normal force changes as the tip turns down or up; the work lost must not restart."""
    model, results = slide(floor(bend), table(0.97), stiffness, 0.5, 0.12)
    assert results[-1].state.vertices[-3, 0] > 2.0
    share = share_of_coulomb(model, results)[30:]
    assert share.min() > 1.0 - 0.7 * abs(bend) - 0.01
    assert share.max() < 1.0 + 0.4 * abs(bend) + 0.01


@pytest.mark.parametrize("before", [1e-4, 1e-6, 1e-7, 0.0])
@pytest.mark.parametrize("stiffness", [5e8, 5e10])
def test_a_held_tip_keeps_its_friction_across_a_flat_corner(
    before: float, stiffness: float
) -> None:
    """On a slope of 20 degrees it settles across the corner, and nothing gives way."""
    angle = np.radians(-20.0)

    def held(ground: Floats) -> Floats:
        blocks = [turned(ground, angle), turned(table(1.0 - before), angle)]
        model = system(blocks, fixed=[0], friction_angle=30.0)
        return march(model, by_convex(stiffness), 1e-3, 0.1)[-1].state.vertices[-6:]

    assert np.abs(held(floor(0.0)) - held(PLAIN)).max() < 1e-12
