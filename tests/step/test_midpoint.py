"""Forces half way through the step: energy, order, ledger, resting and falling blocks, actions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clast
from clast import Stage
from clast.actions.damping import Adaptive, Kinetic, Rayleigh, Undamped
from clast.contact.laws import AugmentedLagrangian, Penalty
from clast.model.ground_motion import highest_frequency
from clast.model.model import Model
from clast.run.method_warnings import method_warnings
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.convex import Convex
from clast.step.integration import BackwardEuler, ConstantAcceleration, Midpoint
from clast.step.method import Method
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from clast.verification.problems.blocks import floating
from clast.verification.problems.method import resumed_run
from clast.verification.problems.waves import layer
from clast.verification.variants import MIDPOINT

PROCESSES = {
    "convex": Convex(),
    "modified": Modified(passes=4),
    "open-close": OpenClose(),
}
YOUNG = 2e9
MIDWAY, SPRINGS = Midpoint(), Penalty(YOUNG)


def builder(gravity: float = 0.0, **joint: float) -> clast.ModelBuilder:
    found = clast.ModelBuilder(title="Midpoint", gravity=(0.0, -gravity))
    found.add_rock("rock", young=YOUNG, poisson=0.2, density=2000.0)
    found.add_joint("default", friction_angle=30.0, **joint)
    return found


def bar(turn: float = 0.0) -> Model:
    """Return three bonded blocks on a fixed one, the last with a velocity, in any direction."""
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-along[1], along[0]])
    found = builder(cohesion=1e9, tensile_strength=1e9)
    for k in range(4):
        corners = [(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)]
        found.block(
            name=f"b{k}",
            vertices=[tuple(x * along + y * across) for x, y in corners],
            fixed=k == 0,
            velocity=(0.0, 0.0, 0.0) if k < 3 else (*(1e-3 * along), 0.0),
        )
    return found.build()


def method(model: Model, process=PROCESSES["convex"], scheme=MIDWAY, law=SPRINGS) -> Method:
    found = MIDPOINT.method(model, p=YOUNG, max_displacement=0.05)
    return replace(found, process=process, integrator=scheme, contact_law=law)


def ran(model: Model, how: Method, step: float, end: float):
    return simulate(model, how, Schedule(step=step, end=end, every=end))


def held(energy) -> np.ndarray:
    names = ("kinetic", "elastic", "contact", "gravity", "fixed_points", "bolts")
    return sum(np.asarray(energy[name]) for name in names)


@pytest.mark.slow
@pytest.mark.parametrize("name", PROCESSES)
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_bonded_bar_keeps_its_energy(name, turn):
    model = bar(turn)
    run = ran(model, method(model, PROCESSES[name]), 5e-4, 0.1)
    whole = held(run.energy)
    # gaps are measured anew in every step: second order in strains of 1e-6
    assert np.abs(whole / whole[0] - 1.0).max() < 1e-6
    assert abs(run.energy["unaccounted"][-1]) < 1e-9 * whole[0]


@pytest.mark.slow
def test_the_default_damps_it():
    model = bar()
    run = ran(model, method(model, scheme=ConstantAcceleration()), 5e-4, 0.1)
    assert held(run.energy)[-1] < 0.5 * held(run.energy)[0]


@pytest.mark.slow
def test_a_dry_joint_that_is_pressed_keeps_the_energy_of_waves():
    found = builder()
    for k in range(3):
        found.block(name=f"b{k}", vertices=[(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)], fixed=k == 0)
    found.point_load((3.0, 0.5), force=(-1e5, 0.0), block="b2")
    model = found.build()
    settled = ran(model, replace(method(model), dynamic_ratio=0.0), 2e-3, 0.4)
    velocity = np.zeros_like(model.velocity)
    velocity[2, 0] = 1e-3
    moving = replace(settled.final, velocity=velocity)
    assert moving.memory.normal_force.min() > 0.0
    now = moving
    how, energies = method(model), []
    for _ in range(200):
        result = how.process.step(model, how, now, 4e-4, None)
        now = result.state
        ledger = now.ledger
        energies.append(ledger.kinetic + ledger.elastic + ledger.contact - ledger.loads)
    kinetic = 0.5 * model.mass[2] * 1e-6
    assert np.ptp(energies) < 1e-5 * kinetic


@pytest.mark.slow
@pytest.mark.parametrize("law", [Penalty(YOUNG), AugmentedLagrangian(YOUNG)])
def test_a_pile_stays_at_rest(law):
    found = builder(9.8)
    found.block(name="floor", vertices=[(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
    for k in range(4):
        shift = 0.25 * (k % 2)
        corners = [(shift, k), (shift + 1, k), (shift + 1, k + 1), (shift, k + 1)]
        found.block(name=f"b{k}", vertices=corners)
    model = found.build()
    run = ran(model, method(model, law=law), 1e-3, 0.2)
    assert np.abs(run.final.vertices - model.vertices).max() < 5e-4
    energy = run.energy
    assert held(energy)[-1] <= held(energy)[0] + 1e-9
    assert abs(energy["unaccounted"][-1]) < 1e-6


def test_free_flight_is_exact():
    found = builder(9.8)
    found.block(name="b", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], velocity=(1.0, 2.0, 0.0))
    model = found.build()
    run = ran(model, method(model), 1e-2, 0.2)
    moved = (run.final.vertices - model.vertices).mean(axis=0)
    assert moved == pytest.approx([0.2, 2.0 * 0.2 - 4.9 * 0.04], abs=1e-12)


@pytest.mark.parametrize("damping", [Rayleigh(1.0, 1e-5), Adaptive(), Kinetic()])
def test_the_ledger_closes_with_bolts_supports_loads_and_damping(damping):
    found = builder(9.8, normal_stiffness=1e8, shear_stiffness=1e8)
    found.block(name="base", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    found.block(name="top", vertices=[(0, 1), (2, 1), (2, 2), (0, 2)])
    for x in (0.0, 2.0):
        found.fixed_point((x, 0.0))
    found.add_bolt_kind("rod", stiffness=1e8, pretension=1e4, yield_force=2e4)
    found.bolt((1.0, 0.5), (1.0, 1.5), kind="rod")
    found.add_amplitude("push", [0.0, 0.02, 0.04], [0.0, 1.0, 0.0])
    found.point_load((0.0, 2.0), force=(5e4, 0.0), block="top", amplitude="push")
    model = found.build()
    run = ran(model, replace(method(model), damping=damping), 1e-3, 0.1)
    whole = np.ptp(held(run.energy)) + np.abs(run.energy["gravity"]).max()
    assert abs(run.energy["unaccounted"][-1]) < 1e-8 * whole
    assert run.energy["numerical"].min() > -1e-6 * whole


@pytest.mark.parametrize(
    ("time", "value", "frequency"),
    [
        ([0.0, 0.2], [0.0, 1.0], 0.0),
        ([0.0, 0.002], [0.0, 1.0], 0.0),
        ([0.0, 0.2, 0.4, 1.0], [0.0, 0.25, 0.42, 1.0], 0.0),
        (np.linspace(0.0, 1.0, 201), np.sin(40.0 * np.pi * np.linspace(0.0, 1.0, 201)), 20.0),
    ],
    ids=["ramp", "quick ramp", "ramp in parts", "vibration"],
)
def test_a_ramp_has_no_frequency(time, value, frequency):
    """Repeated for ever it would be the tooth of a saw; it is not."""
    values = np.array(value)[:, None]
    assert highest_frequency(np.array(time), values) == pytest.approx(frequency)
    # none of them has more to tell on top of a ramp that is 20 times as high
    ramp = 20.0 * np.array(time)[:, None] / time[-1]
    assert highest_frequency(np.array(time), values + ramp) == 0.0


def test_steps_damp_nothing_that_is_brought_to_rest_anyway():
    """Warned of is a load that swings where the blocks may swing."""
    found, time = builder(), np.linspace(0.0, 1.0, 401)
    found.block(name="base", vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    found.add_amplitude("push", time, np.sin(40.0 * np.pi * time))
    found.point_load((0.0, 1.0), force=(5e4, 0.0), block="base", amplitude="push")
    model, schedule = found.build(), Schedule(step=2e-3, end=1.0, every=1.0)
    for damping, told in ((Undamped(), True), (Rayleigh(mass=1.0), True), (Adaptive(), False)):
        how = replace(method(model, scheme=ConstantAcceleration()), damping=damping)
        found = method_warnings(model, how, schedule)
        assert any("amplitude 'push' has frequencies" in text for text in found) is told


def test_check_warns_where_steps_damp_a_record():
    model = layer.pile(layer.swelling())
    schedule = Schedule(step=2e-3, end=5.0, every=5.0)
    texts = {
        scheme: [
            text
            for text in method_warnings(model, method(model, scheme=scheme()), schedule)
            if "ground motion has frequencies" in text
        ]
        for scheme in (ConstantAcceleration, BackwardEuler, Midpoint)
    }
    # 1.2 Hz: 1 - exp(-w2 h t/4) = 13 %, and twice the rate by backward Euler
    assert "by 13 %" in texts[ConstantAcceleration][0]
    assert "by 25 %" in texts[BackwardEuler][0]
    assert texts[Midpoint] == []
    quick = replace(schedule, step=5e-5)
    assert not [
        text
        for text in method_warnings(model, method(model, scheme=ConstantAcceleration()), quick)
        if "ground motion has frequencies" in text
    ]
    long = replace(schedule, step=0.1)
    found = method_warnings(model, method(model), long)
    assert [text for text in found if "a period: lower time.step" in text]


def test_a_static_stage_is_as_without_it_and_a_dynamic_one_after_it_stays_at_rest():
    found = builder(9.8, cohesion=1e9, tensile_strength=1e9)
    found.block(name="floor", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    for k in range(3):
        found.block(name=f"b{k}", vertices=[(0, k), (1, k), (1, k + 1), (0, k + 1)])
    found.measured_point("top", (0.5, 3.0), block="b2")
    model = found.build()
    stages = (
        Stage(name="weight", dynamic_ratio=0.0),
        Stage(name="rest", until="time", time=0.1, dynamic_ratio=1.0),
    )
    ends = []
    for scheme in (MIDWAY, ConstantAcceleration()):
        schedule = Schedule(step=1e-3, end=1.0, every=1.0, stages=stages)
        run = simulate(model, method(model, scheme=scheme), schedule)
        assert run.stages[0].outcome == "equilibrium"
        down = run.history("top").displacement[:, 1]
        settled = run.stages[0].steps
        # dynamic steps take up the couples of shear forces and gaps (decision 193)
        assert np.abs(down[settled:] - down[settled]).max() < 3e-9
        ends.append(down[settled])
    assert ends[0] == ends[1]


@pytest.mark.parametrize("kept", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_impacts_keep_their_restitution(kept, step):
    found = builder(9.8)
    found.block(name="floor", vertices=[(-1, -1), (2, -1), (2, 0), (-1, 0)], fixed=True)
    found.block(name="b", vertices=[(0, 0.2), (1, 0.2), (1, 1.2), (0, 1.2)])
    found.measured_point("b", (0.5, 0.7), block="b")
    model = found.build()
    how = method(model, process=Convex(restitution=kept))
    fall = np.sqrt(2.0 * 0.2 / 9.8)
    run = ran(model, how, step, fall * (1.0 + 1.5 * max(kept, 0.5)))
    height = 0.2 + run.history("b").displacement[:, 1]
    after = height[run.history("b").time > fall + 2.0 * step]
    # the corners of a block that strains give by its weight
    assert after.max() == pytest.approx(0.2 * kept**2, abs=2e-3)


def test_a_raft_swings_on_water():
    """Pressures that follow are those half way, by either rule."""
    period, left = floating.swings(*_heave(MIDPOINT))
    assert period == pytest.approx(floating.HEAVE, rel=1e-3)
    assert left == pytest.approx(1.0, abs=2e-3)


def _heave(variant):
    history = floating.moved(floating.DOWN, 0.0, 3.4 * floating.HEAVE, variant)
    return history.time, floating.DOWN - history.displacement[:, 1]


@pytest.mark.parametrize("ratio", [1.0, 0.0])
def test_it_is_resumed_to_the_same_bits(ratio):
    assert set(resumed_run.apart(*resumed_run.both(ratio, MIDPOINT)).values()) == {0.0}
