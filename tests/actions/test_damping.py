"""Damping: exact decay, what it leaves alone, its energy, and blocks that come to rest sooner."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.scenes.systems import box, by_convex, finish, system

import clast
from clast.actions.damping import Adaptive, Kinetic, Rayleigh, Undamped
from clast.contact.laws import AugmentedLagrangian, Penalty
from clast.model.model import Model
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.convex import Convex
from clast.step.method import StepResult
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from scenes.ledgers import assert_closed
from scenes.tiers import pairwise

PROCESSES = {"modified": Modified(), "open-close": OpenClose(), "convex": Convex()}
LAWS = {"penalty": Penalty(1e8), "augmented": AugmentedLagrangian(1e8, solves=2)}
KINDS = {"rayleigh": Rayleigh(5.0, 1e-5), "adaptive": Adaptive(), "kinetic": Kinetic()}


def flying(gravity: float = 0.0) -> Model:
    """Return a block that touches nothing and turns."""
    return system([box(0, 0)], velocity={0: (3.0, 0.0, 0.5)}, gravity=(0.0, -gravity))


def stack() -> Model:
    """Return three blocks just put upon each other on a fixed one."""
    return system([box(-1, -1, 3, 1), *(box(0, k) for k in range(3))], fixed=[0], poisson=0.0)


def run_of(model: Model, step: float, end: float, **changes: object) -> Run:
    how = by_convex(1e8, **changes)
    return simulate(model, how, Schedule(step=step, end=end, every=end))


@pytest.mark.parametrize("name", PROCESSES)
def test_mass_damping_slows_a_flight_exponentially(name: str):
    run = run_of(flying(), 1e-2, 1.0, damping=Rayleigh(mass=2.0), process=PROCESSES[name])
    slower = np.exp(-2.0)
    np.testing.assert_allclose(run.final.velocity[0, [0, 2]], [3.0 * slower, 0.5 * slower], 1e-4)
    lost = run.energy["kinetic"][0] - run.energy["kinetic"][-1]
    assert run.report.ledger.damping == pytest.approx(lost, rel=1e-3)
    assert_closed(run)


@pytest.mark.slow
def test_mass_damping_limits_the_speed_of_a_fall():
    model = system([box(0, 0)])
    run = run_of(model, 1e-2, 4.0, damping=Rayleigh(mass=3.0))
    assert run.final.velocity[0, 1] == pytest.approx(-9.8 / 3.0 * (1.0 - np.exp(-12.0)), rel=1e-4)


@pytest.mark.parametrize("damping", [Rayleigh(stiffness=1e-3), Adaptive(), Kinetic()])
def test_free_flight_is_left_alone(damping: object):
    """Stiffness damps strains only, the others what slows down or meets forces that change."""
    plain = run_of(flying(9.8), 1e-2, 0.5)
    run = run_of(flying(9.8), 1e-2, 0.5, damping=damping)
    np.testing.assert_allclose(run.final.velocity[0, :3], plain.final.velocity[0, :3], rtol=1e-6)


@pytest.mark.slow
@pytest.mark.one_in(3)
def test_stiffness_damping_by_the_frequency():
    """A block that breathes with w loses exp(-s w^2 t/2) of its amplitude by the damping."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e7, poisson=0.0, density=2500.0)
    builder.block(vertices=box(0, 0), initial_stress=(1e3, 0.0, 0.0))
    model = builder.build()
    square = 12.0 * 1e7 / 2500.0  # E A/(rho A l^2/12)
    end = 20.0 * 2.0 * np.pi / np.sqrt(square)
    amount = 0.02 / np.sqrt(square)  # 1 % of critical

    def energy(damping: object) -> float:
        last = run_of(model, end / 4000.0, end, damping=damping).report.ledger
        return last.kinetic + last.elastic

    ratio = energy(Rayleigh(stiffness=amount)) / energy(Undamped())
    assert ratio == pytest.approx(np.exp(-amount * square * end), rel=0.01)


@pytest.mark.parametrize(("law", "name", "kind"), pairwise(LAWS, PROCESSES, KINDS))
def test_the_ledger_is_closed(kind: str, name: str, law: str):
    changes = {"damping": KINDS[kind], "process": PROCESSES[name], "contact_law": LAWS[law]}
    run = run_of(stack(), 5e-4, 0.05, **changes)
    assert run.report.ledger.damping > 0.0
    assert (np.diff(run.energy["damping"]) >= 0.0).all()
    assert_closed(run)


def rest(model: Model, damping: object, stiffness: float, end: float) -> tuple[float, Run]:
    """Return when the kinetic energy falls below a thousandth of its peak for good, and the run."""
    seen: list[tuple[float, float]] = []

    def watch(result: StepResult) -> None:
        seen.append((result.state.time, result.state.ledger.kinetic))

    how = by_convex(stiffness, damping=damping)
    run = finish(model, how, 2e-4, end, watch=watch).run
    time, kinetic = np.array(seen).T
    return float(time[np.flatnonzero(kinetic > 1e-3 * kinetic.max())[-1]]), run


@pytest.mark.slow
@pytest.mark.parametrize("damping", [Adaptive(), Kinetic()])
@pytest.mark.one_in(2)
def test_a_stack_comes_to_rest_sooner_and_where_it_belongs(damping: object):
    late, _ = rest(stack(), Undamped(), 1e8, 0.2)
    soon, run = rest(stack(), damping, 1e8, 0.2)
    assert soon < late / 3.0
    static = finish(stack(), by_convex(1e8, dynamic_ratio=0.0), 2e-2, 0.6).run
    sag = run.model.vertices[:, 1] - static.state.vertices[:, 1]
    off = run.state.vertices[:, 1] - static.state.vertices[:, 1]
    # 2.6e-6: contacts of static steps act on both blocks at the vertex, not a closure apart
    assert np.abs(off).max() < 4e-6 * sag.max()


def test_stages_may_change_the_damping():
    """The own states of all kinds fit each other, whichever comes first."""
    first = run_of(stack(), 5e-4, 0.01, damping=Adaptive())
    state = first.state
    for damping in (Kinetic(), Undamped(), Rayleigh(1.0), Adaptive(), Kinetic()):
        how = by_convex(1e8, damping=damping)
        state = how.process.step(first.model, how, state, 5e-4).state
    assert len(state.actions) == len(first.state.actions)


def test_doubtful_damping_is_warned_of():
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=box(0, 0))
    said = builder.case(damping={"mass": 3000.0}, step=1e-3).examine().warnings
    assert any("none exceeds 0.00327 m/s" in text for text in said)
    assert any("reverses velocities" in text for text in said)
    time = np.array([0.0, 0.1])
    record = clast.Accelerogram(time, np.array([[1.0, 0.0], [1.0, 0.0]]))
    builder.ground_motion = clast.InertialForce(record)
    said = builder.case(damping="kinetic").examine().warnings
    assert any('"kinetic" is for static stages' in text for text in said)
    assert replace(builder.case().method(), damping=Undamped()) == builder.case().method()
