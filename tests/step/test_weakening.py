"""Peak and residual strength of joints: laws by hand, and planes on which blocks weaken."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from clast.inputs.builder import InputBuilder
from clast.step.convex import Convex
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from scenes import systems

PROCESSES = {"convex": Convex(), "modified": Modified(), "open-close": OpenClose()}
PEAK, RESIDUAL = np.tan(np.radians(38.0)), np.tan(np.radians(24.0))


def shear_box(**joint):
    """Return a brick on a base, 1 m wide, and how it is simulated."""
    builder = InputBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(**joint)
    builder.block(vertices=systems.box(-3.0, -1.0, 6.0, 1.0), fixed=True)
    builder.block(vertices=systems.box(0.0, 0.0, 1.0, 0.5))
    return builder.build()


def dragged(model, process, speed=0.2, step=1e-3, steps=60, turn=None):
    """Return how far a brick drawn at one speed has slid, m, and T/N, after each step."""
    how = systems.method(process=process, max_displacement=0.1)
    state, found = systems.at_start(model), []
    for number in range(steps):
        way = -speed if turn is not None and number >= turn else speed
        velocity = state.velocity.copy()
        velocity[1, :3] = way, velocity[1, 1], 0.0
        state = how.process.step(model, how, replace(state, velocity=velocity), step).state
        memory = state.memory
        # at the second corner: the brick that is drawn by its velocity rocks on its first
        pressed = int(np.argmax(memory.normal_force))
        ratio = abs(memory.shear_force[pressed]) / memory.normal_force[pressed]
        found.append((memory.slide_length[pressed], ratio))
    return state, np.array(found)


@pytest.mark.parametrize("process", PROCESSES.values(), ids=PROCESSES)
def test_friction_falls_linearly_with_the_way_of_sliding(process):
    model = shear_box(friction_angle=38.0, residual_friction_angle=24.0, slip_weakening=5e-3)
    _, found = dragged(model, process)
    slid, ratio = found[:-1, 0], found[1:, 1]
    expected = PEAK + np.minimum(1.0, slid / 5e-3) * (RESIDUAL - PEAK)
    sliding = (slid > 0.0) & (np.diff(found[:, 0]) > 1e-4)
    assert sliding.sum() > 30
    # friction is bounded by the force of the last evaluation, and corners change places
    assert np.median(np.abs(ratio / expected - 1.0)[sliding]) < 0.02
    assert slid[-1] > 8e-3


def test_sliding_to_and_fro_wears_the_joint_and_slip_goes_back():
    model = shear_box(friction_angle=38.0, residual_friction_angle=24.0, slip_weakening=1.0)
    state, found = dragged(model, Convex(), steps=80, turn=40)
    assert found[-1, 0] > 1.8 * found[39, 0]
    assert abs(state.memory.slip).max() < 0.2 * found[-1, 0]


def test_strength_at_once_is_gone_after_the_first_slide():
    model = shear_box(friction_angle=38.0, residual_friction_angle=24.0)
    _, found = dragged(model, Convex(), steps=20)
    assert np.median(found[10:, 1]) == pytest.approx(RESIDUAL, rel=0.01)


def test_cohesion_and_tension_go_with_the_way_of_sliding():
    strong = {"friction_angle": 30.0, "cohesion": 2e5, "tensile_strength": 1e5}
    model = shear_box(**strong, residual_cohesion=5e4, slip_weakening=4e-3)
    how = systems.method(process=Convex(), max_displacement=0.1)
    state, steps = systems.at_start(model), []
    for _ in range(60):
        velocity = state.velocity.copy()
        velocity[1, :3] = 0.2, velocity[1, 1], 0.0
        result = how.process.step(model, how, replace(state, velocity=velocity), 1e-3)
        steps.append(result.contacts)
        state = result.state
    for contacts in steps:
        share = np.minimum(1.0, contacts.slide_length / 4e-3)
        bonded = contacts.bonded
        assert contacts.cohesion[bonded] == pytest.approx((2e5 - share * 1.5e5)[bonded])
        assert contacts.tensile_strength[bonded] == pytest.approx((1e5 * (1.0 - share))[bonded])
        assert contacts.cohesion[~bonded & contacts.cohesive] == pytest.approx(5e4)
    assert steps[0].bonded.all()
    assert not steps[-1].bonded[steps[-1].known].any()


def on_plane(angle, push, process, steps, step):
    """Return how far a block on a plane has come, and its speed, after a push of its velocity."""
    builder = InputBuilder(
        gravity=(9.8 * np.sin(np.radians(angle)), -9.8 * np.cos(np.radians(angle)))
    )
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=35.0, residual_friction_angle=20.0, slip_weakening=2e-3)
    builder.block(vertices=systems.box(-1.0, -1.0, 40.0, 1.0), fixed=True)
    builder.block(vertices=systems.box(0.0, 0.0, 1.0, 0.5), velocity=(push, 0.0, 0.0))
    model = builder.build()
    how = systems.method(process=process, max_displacement=0.1)
    state = systems.at_start(model)
    for _ in range(steps):
        state = how.process.step(model, how, state, step).state
    moved = state.vertices[model.block_start[1]] - model.vertices[model.block_start[1]]
    return float(moved[0]), float(state.velocity[1, 0])


@pytest.mark.parametrize("process", PROCESSES.values(), ids=PROCESSES)
def test_a_block_between_peak_and_residual_stands_until_it_is_pushed(process):
    """Between both angles it stands; pushed over the weakening it slides for good."""
    way, speed = on_plane(28.0, 0.0, process, 100, 2e-3)
    assert way < 1e-4
    assert abs(speed) < 1e-3
    _, speed = on_plane(28.0, 0.3, process, 100, 2e-3)
    later = on_plane(28.0, 0.3, process, 200, 2e-3)[1]
    acceleration = (later - speed) / 0.2
    exact = 9.8 * (np.sin(np.radians(28.0)) - np.cos(np.radians(28.0)) * np.tan(np.radians(20.0)))
    assert acceleration == pytest.approx(exact, rel=5e-3)


def test_a_small_push_does_not_weaken_it_enough():
    """The work of the push is used up within the weakening: by hand 0.06 m/s come to rest."""
    way, speed = on_plane(28.0, 0.03, Convex(), 200, 1e-3)
    assert abs(speed) < 1e-3
    assert way < 2e-3


def test_blocks_that_meet_anew_have_residual_strength():
    builder = InputBuilder(gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=35.0, residual_friction_angle=20.0, slip_weakening=1e-2)
    builder.block(vertices=systems.box(-3.0, -1.0, 6.0, 1.0), fixed=True)
    builder.block(vertices=systems.box(0.0, 0.05, 1.0, 0.5))
    model = builder.build()
    how = systems.method(process=Convex(), max_displacement=0.1)
    state = systems.at_start(model)
    for _ in range(80):
        result = how.process.step(model, how, state, 2e-3)
        state = result.state
    assert len(result.contacts)
    assert result.contacts.friction == pytest.approx(np.tan(np.radians(20.0)))


@pytest.mark.parametrize("cuts", [[1.1], [0.5, 1.02, 1.2], [0.3, 1.3]])
@pytest.mark.parametrize(("fixed", "within"), [(True, 1e-9), (False, 6e-3)])
def test_it_does_not_matter_how_the_floor_is_cut(cuts, fixed, within):
    """A brick slides on, half worn, onto other slabs; those that are free settle by themselves."""

    def speed(cuts):
        builder = InputBuilder(gravity=(0.0, -9.8))
        builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
        builder.add_joint(friction_angle=35.0, residual_friction_angle=20.0, slip_weakening=0.5)
        builder.block(vertices=systems.box(-4.0, -3.0, 8.0, 2.0), fixed=True)
        for left, right in pairwise([-3.0, *cuts, 3.0]):
            builder.block(vertices=systems.box(left, -1.0, right - left, 1.0), fixed=fixed)
        builder.block(vertices=systems.box(0.0, 0.0, 1.0, 0.5), velocity=(2.0, 0.0, 0.0))
        model = builder.build()
        how = systems.method(process=Convex(), max_displacement=0.1)
        state = systems.at_start(model)
        for _ in range(100):
            state = how.process.step(model, how, state, 2e-3).state
        return float(state.velocity[-1, 0])

    assert speed(cuts) == pytest.approx(speed([]), rel=within)
