"""Joints that open as they slide, slide with kinetic friction, or are rough."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from clast.contact.joints.barton_bandis import rough_contacts
from clast.contact.laws import Penalty
from clast.inputs.builder import InputBuilder
from clast.model.joints import BartonBandis
from clast.step.convex import Convex
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from scenes import systems

PROCESSES = {"convex": Convex(), "modified": Modified(), "open-close": OpenClose()}
ROUGH = {
    "law": "barton-bandis",
    "jrc": 10.0,
    "jcs": 100e6,
    "residual_friction_angle": 28.0,
    "sample_length": 1.0,
}
STRESS = 1e5
DENSITY = 1e6
"""Heavy enough for friction to slow the block by 1 mm/s a step only."""
PSI = np.tan(np.radians(10.0))


def pressed(*, cuts=(), turn=0.0, scale=1.0, mirrored=False, weight=0.0, **joint):
    """Return a flat block under pressure on a floor, which may be cut, turned, scaled, mirrored."""
    cosine, sine = np.cos(turn), np.sin(turn)
    side = -1.0 if mirrored else 1.0

    def placed(points):
        points = scale * np.asarray(points, float) * [side, 1.0]
        points = points[::-1] if mirrored else points
        return points @ np.array([[cosine, sine], [-sine, cosine]])

    gravity = weight * np.array([sine, -cosine])
    builder = InputBuilder(gravity=tuple(gravity))
    builder.add_rock("rock", young=5e13, poisson=0.0, density=DENSITY)
    builder.add_joint(**joint)
    for left, right in pairwise([-1.0, *cuts, 3.0]):
        builder.block(vertices=placed(systems.box(left, -1.0, right - left, 1.0)), fixed=True)
    builder.block(name="block", vertices=placed(systems.box(0.0, 0.0, 1.0, 0.1)))
    top = placed([(0.0, 0.1), (1.0, 0.1)])
    force = STRESS * scale * np.array([sine, -cosine])
    if weight == 0.0:
        builder.line_load(tuple(top[0]), tuple(top[1]), tuple(force / scale), block="block")
    return builder.build(), side * np.array([cosine, sine]), np.array([-sine, cosine])


def moved(scene, process, speeds, step=1e-3):
    """Return states after steps in which a block goes along at given speeds, m/s."""
    model, along, up = scene
    how = systems.method(
        process=process, max_displacement=0.1, contact_law=Penalty(normal_stiffness=5e10)
    )
    state, states = systems.at_start(model), []
    for speed in speeds:
        velocity = state.velocity.copy()
        velocity[-1, :3] = *(speed * along + (velocity[-1, :2] @ up) * up), 0.0
        state = how.process.step(model, how, replace(state, velocity=velocity), step).state
        states.append(state)
    return states


def lift(scene, states):
    """Return how far the block is from the floor in each state, m."""
    model, _, up = scene
    first = model.block_start[-2]
    start = model.vertices[first:].mean(axis=0)
    return np.array([(one.vertices[first:].mean(axis=0) - start) @ up for one in states])


@pytest.mark.parametrize("process", PROCESSES.values(), ids=PROCESSES)
@pytest.mark.parametrize("turn", [0.0, 2.0])
def test_a_joint_opens_by_its_angle_and_closes_on_the_way_back(process, turn):
    scene = pressed(turn=turn, friction_angle=35.0, dilation_angle=10.0, dilation_until=3e-3)
    states = moved(scene, process, [0.1] * 50 + [-0.1] * 60)
    opened = [one.memory.dilation.max() for one in states]
    slid = abs(states[24].memory.slide).max()
    assert opened[24] == pytest.approx(slid * PSI, rel=1e-6)
    assert slid == pytest.approx(2.5e-3, rel=0.1)
    assert opened[49] == pytest.approx(3e-3 * PSI, rel=1e-6)
    assert opened[-1] < 0.7 * opened[49]
    height = lift(scene, states) - lift(scene, states[:1])
    assert height[49] > 0.95 * 3e-3 * PSI


def test_dilation_works_against_the_normal_force_at_the_cost_of_friction():
    """Friction has lost what shearing has put in, less what has lifted the block."""
    scene = pressed(friction_angle=35.0, dilation_angle=10.0)
    states = moved(scene, Convex(), [0.1] * 50)
    expected = 0.0
    for before, after in pairwise(states):
        old, new = before.memory, after.memory
        slid, opened = new.slide_length - old.slide_length, new.dilation - old.dilation
        expected += float(abs(new.shear_force) @ slid - new.normal_force @ opened)
    lost = states[-1].ledger.friction - states[0].ledger.friction
    # as it lands it opens by all of its slip, and T is bounded by an N of the solution before
    assert lost == pytest.approx(expected, rel=1e-4)
    assert abs(states[-1].ledger.unaccounted) < 1e-9 * lost


FLOOR = {"plane": {"friction_angle": 35.0, "dilation_angle": 10.0}, "rough": ROUGH}


@pytest.mark.parametrize("cuts", [[0.4], [0.5, 1.01], [0.1 * k for k in range(1, 14)]])
@pytest.mark.parametrize("joint", FLOOR.values(), ids=FLOOR)
def test_the_floor_may_be_cut(cuts, joint):
    """Faces take slides and openings along on to the next piece of the floor.

    At 0.5 mm a step the block hops over its asperities, and lands on other points of a cut face.
    """
    speeds = [0.5 * min(1.0, k / 60) for k in range(120)]
    found = []
    for floor in (cuts, []):
        scene = pressed(cuts=floor, **joint)
        states = moved(scene, Convex(), speeds)
        found.append((lift(scene, states)[-1], states[-1].ledger.friction))
    assert found[0][0] == pytest.approx(found[1][0], rel=3e-3)
    assert found[0][1] == pytest.approx(found[1][1], rel=0.01)


@pytest.mark.parametrize("other", [{"turn": 1.1}, {"mirrored": True}, {"turn": 4.0}])
def test_a_rough_joint_may_be_turned_and_mirrored(other):
    found = []
    for how in (other, {}):
        scene = pressed(**how, **ROUGH)
        states = moved(scene, Convex(), [0.1] * 60)
        memory = states[-1].memory
        ratio = abs(memory.shear_force.sum()) / memory.normal_force.sum()
        found.append((lift(scene, states)[-1], ratio, states[-1].ledger.friction))
    assert found[0] == pytest.approx(found[1], rel=1e-4)


def test_a_rough_joint_has_the_peak_strength_of_its_formula():
    """The others bound friction by the force of the solve before: see clast verify rough-joint."""
    scene = pressed(**ROUGH)
    states = moved(scene, Convex(), [0.1] * 70)
    ratio = [abs(one.memory.shear_force.sum() / one.memory.normal_force.sum()) for one in states]
    # it closes in the first step, under whatever friction; later the stress is uneven by some per
    # cent, for the block hops, and strength is not proportional to stress
    assert max(ratio[5:]) == pytest.approx(np.tan(np.radians(28.0 + 30.0)), rel=0.03)


def test_strength_depends_on_scale_as_bandis_says():
    small = BartonBandis(jrc=10.0, jcs=100e6, sample_length=0.1)
    large = replace(small, field_length=1.0)
    assert large.scaled_jrc == pytest.approx(10.0 * 10.0**-0.2)
    assert large.scaled_jcs == pytest.approx(100e6 * 10.0**-0.3)
    assert large.peak_slip == pytest.approx((1.0 / 500.0) * (10.0**0.8 / 1.0) ** 0.33)
    assert small.peak_slip == pytest.approx((0.1 / 500.0) * (10.0 / 0.1) ** 0.33)


def test_closure_is_the_hyperbola_and_its_energy_the_work_of_closing():
    scene = pressed(**ROUGH)
    rough = rough_contacts(scene[0].joint_table, np.zeros(1, np.int64))
    stress = np.array([3e6])
    closures = np.linspace(0.0, float(rough.closed_by(stress)[0]), 20_001)
    share = 1.0 - closures / rough.closure
    assert rough.stiffness * closures[-1] / share[-1] == pytest.approx(stress)
    work = np.trapezoid(rough.stiffness * closures / share, closures)
    assert rough.energy(stress)[0] == pytest.approx(work, rel=1e-6)
    tangent = rough.tangent(stress)[0]
    assert tangent == pytest.approx(float(rough.stiffness[0] / share[-1] ** 2))


@pytest.mark.parametrize("process", PROCESSES.values(), ids=PROCESSES)
def test_friction_is_kinetic_while_a_block_slides_and_static_when_it_stands(process):
    scene = pressed(friction_angle=35.0, kinetic_friction_angle=20.0, weight=9.8)
    states = moved(scene, process, [0.2] * 20 + [0.0] * 60)
    ratio = [abs(one.memory.shear_force.sum() / one.memory.normal_force.sum()) for one in states]
    assert np.median(ratio[5:20]) == pytest.approx(np.tan(np.radians(20.0)), rel=0.01)
    assert states[-1].memory.slide_speed.max() == 0.0


def test_friction_falls_with_speed_up_to_the_critical_one():
    scene = pressed(friction_angle=35.0, kinetic_friction_angle=20.0, critical_speed=0.4)
    states = moved(scene, Convex(), [0.1] * 20)
    ratio = [abs(one.memory.shear_force.sum() / one.memory.normal_force.sum()) for one in states]
    static, kinetic = np.tan(np.radians([35.0, 20.0]))
    speed = states[-2].memory.slide_speed.mean()
    assert ratio[-1] == pytest.approx(static + speed / 0.4 * (kinetic - static), rel=0.01)


def test_statics_knows_no_kinetic_friction():
    model, along, _ = pressed(friction_angle=35.0, kinetic_friction_angle=20.0)
    how = systems.method(process=Convex(), max_displacement=0.1)
    how = replace(how, dynamic_ratio=0.0)
    state = systems.at_start(model)
    for _ in range(5):
        velocity = state.velocity.copy()
        velocity[-1, :2] = 0.2 * along
        state = how.process.step(model, how, replace(state, velocity=velocity), 1e-3).state
    assert state.memory.slide_speed.max() == 0.0
