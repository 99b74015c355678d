"""Impacts of the convex process: by rigid bodies, at the moment at which a contact closes."""

from dataclasses import replace

import numpy as np
import pytest

from clast.contact.laws import AugmentedLagrangian, Penalty
from clast.inputs.builder import InputBuilder
from clast.step.convex import Convex
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from scenes.systems import (
    GRAVITY,
    at_start,
    box,
    by_convex,
    centroids,
    march,
    method,
    regular,
    system,
)

FLOOR = box(-4.0, -1.0, 12.0, 1.0)


def scene(blocks, velocity=(), *, gravity=GRAVITY, loads=(), joints=(), pins=()):
    """Return a model of a fixed floor and blocks of 1 m2 and 2500 kg, with their velocities."""
    builder = InputBuilder(gravity=(0.0, -gravity))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    for joint in joints or ({"friction_angle": 0.0},):
        builder.add_joint(**joint)
    builder.block(name="0", vertices=FLOOR, fixed=True)
    speeds = dict(velocity)
    for k, outline in enumerate(blocks, start=1):
        builder.block(name=str(k), vertices=outline, velocity=speeds.get(k, (0.0, 0.0, 0.0)))
    for at, force, block in loads:
        builder.point_load(at, force, block=block)
    for at, block in pins:
        builder.fixed_point(at, block=block)
    return builder.build()


def how(restitution=0.0, stiffness=5e9, **changes):
    """Return the method with a restitution."""
    law = Penalty(normal_stiffness=stiffness)
    made = method(process=Convex(restitution=restitution), contact_law=law, max_displacement=0.2)
    return replace(made, **changes)


@pytest.mark.parametrize("stiffness", [5e7, 5e9, 5e10])
@pytest.mark.parametrize("step", [1e-3, 5e-3])
def test_a_pushed_block_with_weight_keeps_its_parabola(step, stiffness):
    """It swings on its contacts while it slides: the way along them is that of a free block."""
    model = scene([box(0.0, 0.0)], loads=[((0.5, 0.5), (1e4, 0.0), "1")])
    last = march(model, how(stiffness=stiffness), step, 0.2)[-1].state
    assert centroids(model, last)[1, 0] - 0.5 == pytest.approx(4.0 * 0.2**2 / 2.0, rel=1e-12)
    assert last.velocity[1, 0] == pytest.approx(4.0 * 0.2, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_block_that_bounces_keeps_its_way_along_the_floor(restitution):
    model = scene([box(0.0, 0.3)], {1: (1.0, 0.0, 0.0)}.items())
    last = march(model, how(restitution), 2e-3, 0.4)[-1].state
    assert centroids(model, last)[1, 0] - 0.5 == pytest.approx(0.4, rel=1e-12)
    assert abs(last.rotation[1]) < 1e-9


def test_friction_takes_its_share_of_an_impact():
    """A plate that falls flat at 2 m/s with e = 1/2 and slides: mu (1 + e) 2 m/s less."""
    plate = box(0.0, 1e-3, 4.0, 0.05)
    friction = {"friction_angle": np.degrees(np.arctan(0.2))}
    model = scene([plate], {1: (3.0, -2.0, 0.0)}.items(), gravity=0.0, joints=[friction])
    last = march(model, how(0.5), 1e-3, 5e-3)[-1].state.velocity[1]
    # friction below its centroid turns it, which moves impulses forward but leaves their sum
    assert 3.0 - last[0] == pytest.approx(0.2 * (last[1] + 2.0), rel=1e-6)
    assert last[1] == pytest.approx(1.0, abs=0.05)


def test_each_joint_has_its_own_restitution():
    joints = [
        {"name": "default", "friction_angle": 0.0},
        {"name": "hard", "restitution": 0.9, "between": [("0", "2")]},
    ]
    boxes = [box(0.0, 1e-3), box(2.0, 1e-3)]
    fall = {1: (0.0, -1.0, 0.0), 2: (0.0, -1.0, 0.0)}.items()
    model = scene(boxes, fall, gravity=0.0, joints=joints)
    last = march(model, how(0.4), 1e-3, 0.01)[-1].state.velocity
    assert last[1:, 1] == pytest.approx([0.4, 0.9], abs=1e-9)


@pytest.mark.parametrize("stiffness", [5e8, 5e10])
@pytest.mark.parametrize("step", [2e-4, 1e-3])
def test_a_stack_that_is_hit_does_not_rebound(step, stiffness):
    """Its contacts bear already: they pass the impulse on to the floor."""
    stack = [box(0.0, 1.0 * k) for k in range(4)]
    joints = [{"friction_angle": 30.0}]
    time = 0.04
    ram = box(0.0, 4.0 + 3.0 * time + 0.5 * GRAVITY * time**2)
    model = scene([*stack, ram], {5: (0.0, -3.0, 0.0)}.items(), joints=joints)
    results = march(model, how(stiffness=stiffness), step, 0.07)
    after = [one.state for one in results if one.state.time > time + 2.0 * step]
    assert max(one.velocity[:, 1].max() for one in after) < 0.03 * 3.4
    assert np.abs(after[-1].rotation).max() < 1e-3
    ledger = after[-1].ledger
    assert ledger.impacts == pytest.approx(0.5 * 2500.0 * (3.0 + GRAVITY * time) ** 2, rel=0.05)
    assert abs(ledger.numerical) < 0.01 * ledger.impacts


def test_symmetric_drops_stay_symmetric():
    """A beam on two blocks, and a wedge on its tip, that fall at 3 m/s."""
    beam = [box(0.0, 0.0), box(3.0, 0.0), box(0.0, 1.002, 4.0, 0.4)]
    tip = [np.array([[0.0, 2e-3], [0.5, 1.0], [-0.5, 1.0]])]
    for blocks, falling in ((beam, 3), (tip, 1)):
        velocity = {falling: (0.0, -3.0, 0.0)}.items()
        model = scene(blocks, velocity, joints=[{"friction_angle": 30.0}])
        for restitution in (0.0, 0.6):
            last = march(model, how(restitution), 1e-3, 0.02)[-1].state
            assert abs(last.velocity[falling, [0, 2]]).max() < 1e-6
            assert abs(last.rotation[falling]) < 1e-8


@pytest.mark.parametrize("slenderness", [0.15, 0.3])
def test_a_rocking_block_keeps_what_housner_says(slenderness):
    """1 - 3/2 sin^2 of the slenderness of its rate, where it strikes with its other corner."""
    width, height = 2.0 * np.sin(slenderness), 2.0 * np.cos(slenderness)
    tilt, rate = 5e-4, 0.5
    turn = np.array([[np.cos(tilt), np.sin(tilt)], [-np.sin(tilt), np.cos(tilt)]])
    outline = np.array([[-width, 0.0], [0.0, 0.0], [0.0, height], [-width, height]]) @ turn.T
    centre = outline.mean(axis=0)
    velocity = {1: (-rate * centre[1], rate * centre[0], rate)}.items()
    model = scene([outline], velocity, joints=[{"friction_angle": 60.0}])
    results = march(model, how(), 1e-4, 2e-3)
    rates = np.array([one.state.velocity[1, 2] for one in results])
    struck = int(np.argmin(np.diff(rates)))
    exact = 1.0 - 1.5 * np.sin(slenderness) ** 2
    assert rates[struck + 1] / rates[struck] == pytest.approx(exact, abs=0.01)


def test_a_block_turns_about_its_fixed_point():
    """A small square hits the lower edge of one that hangs on a point, flat and without rebound."""
    hanging, flying = box(0.0, 1.0), box(-0.101, 1.0, 0.1, 0.1)
    velocity = {2: (1.0, 0.0, 0.0)}.items()
    model = scene([hanging, flying], velocity, gravity=0.0, pins=[((0.5, 2.0), "1")])
    pinned = how(fixed_point_stiffness=1e13)
    one = march(model, pinned, 1e-3, 2e-3)[-1].state
    # moment of momentum about the point: the small one turns with it as far as its corners touch
    place = centroids(model, one) - [0.5, 2.0]
    mass, speed = model.mass, one.velocity
    inertia = mass / 6.0 * np.array([1.0, 1.0, 0.01])
    turning = inertia * speed[:, 2] + mass * (place[:, 0] * speed[:, 1] - place[:, 1] * speed[:, 0])
    before = mass[2] * 1.0 * (2.0 - 1.05)
    assert turning[1:].sum() == pytest.approx(before, rel=2e-3)
    assert speed[1, 2] > 0.0


class Plain:
    """The penalty law as a script would write it: nothing but its answers."""

    def __init__(self, law):
        self.law, self.normal_stiffness = law, law.normal_stiffness

    def respond(self, contacts, gap, slip):
        return self.law.respond(contacts, gap, slip)


@pytest.mark.parametrize("law", [Plain(Penalty(5e7)), AugmentedLagrangian(5e7, solves=3)])
def test_any_law_has_impacts(law):
    model = scene([box(0.0, 1e-3)], {1: (0.0, -1.0, 0.0)}.items(), gravity=0.0)
    for restitution in (0.0, 0.7):
        results = march(model, how(restitution, contact_law=law), 1e-4, 5e-3)
        assert results[-1].state.velocity[1, 1] == pytest.approx(restitution, abs=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_impacts_give_back_no_more_than_there_was(seed):
    """Blocks that spin and rub each other, with e = 1: the ledger's entry never falls."""
    rng = np.random.default_rng(seed)
    blocks = [box(1.2 * (k % 3), 0.1 + 1.2 * (k // 3)) for k in range(6)]
    velocity = [(k, tuple(rng.uniform(-3.0, 3.0, 3))) for k in range(1, 7)]
    model = scene(blocks, velocity, joints=[{"friction_angle": 35.0}])
    results = march(model, how(1.0, stiffness=5e8), 2e-3, 0.3)
    lost = np.array([one.state.ledger.impacts for one in results])
    scale = lost[-1]
    assert scale > 0.0
    assert np.diff(lost).min() > -1e-9 * scale
    assert abs(results[-1].state.ledger.unaccounted) < 1e-9 * scale


@pytest.mark.parametrize("process", [Modified(), OpenClose()])
def test_processes_without_restitution_say_so(process):
    joints = [{"friction_angle": 30.0, "restitution": 0.5}]
    model, made = scene([box(0.0, 0.0)], joints=joints), how()
    said = process.advice(model, made, at_start(model), 1e-4)
    assert any("restitution of joint 'default'" in one for one in said)
    plain = scene([box(0.0, 0.0)])
    said = process.advice(plain, made, at_start(plain), 1e-4)
    assert not any("restitution" in one for one in said)


@pytest.mark.slow
@pytest.mark.parametrize("corners", [4, 6, 8])
@pytest.mark.parametrize(("stiffness", "within"), [(5e7, 1e-2), (5e9, 2e-3)])
@pytest.mark.one_in(3)
def test_a_polygon_that_rolls_loses_what_plastic_impacts_take(corners, stiffness, within):
    """From corner to corner: w+/w = (i + R^2 cos(2 pi/n))/(i + R^2), i = I/m of the polygon.

    On soft springs it swings on the corner that it turns about.
    """
    outline = regular(corners, 0.5, -0.5 * np.pi)
    outline -= outline[0]
    arm = outline.mean(axis=0)
    spin = -1.5
    velocity = {1: (-spin * arm[1], spin * arm[0], spin)}
    floor = box(-3.0, -1.0, 9.0, 1.0)
    model = system([floor, outline], fixed=[0], friction_angle=60.0, velocity=velocity)
    results = march(model, by_convex(stiffness, max_displacement=0.05), 5e-4, 0.6)
    spins = np.array([one.state.velocity[1, 2] for one in results])
    lost = np.array([one.state.ledger.impacts for one in results])
    lands = int(np.argmax(np.diff(lost) > 0.2 * lost[-1]))
    turn = np.cos(2.0 * np.pi / corners)
    inertia = 0.25 * (2.0 + turn) / 6.0
    exact = (inertia + 0.25 * turn) / (inertia + 0.25)
    assert spins[lands + 1] / spins[lands] == pytest.approx(exact, abs=within)
