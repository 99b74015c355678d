"""Steps: free motion, collisions, rejection and retrying, repeatability, invariance."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from clast.contact.broad_phase import VerletList
from clast.contact.candidates import SearchDistance
from clast.contact.laws import Penalty
from clast.errors import StepOutcome, StepRejected
from clast.model.state import ContactMemory
from clast.step.convex import Convex
from clast.step.finish import reject_tunnelled
from clast.step.integration import BackwardEuler, ConstantAcceleration
from clast.step.modified import Modified, search_of_modified
from clast.step.open_close import OpenClose
from scenes.corners import memory_of
from scenes.systems import (
    GRAVITY,
    at_start,
    box,
    bricks,
    centroids,
    convex,
    march,
    method,
    momentum,
    open_ledger,
    regular,
    star,
    system,
    turned,
    voussoirs,
)

PROCESSES = {
    "modified": Modified(),
    "passes": Modified(passes=4),
    "two passes": Modified(passes=2),
    "open-close": OpenClose(),
    "convex": Convex(),
}
SCHEMES = {"constant acceleration": ConstantAcceleration(), "backward Euler": BackwardEuler()}
NOTHING = (0.0, 0.0)


def shape():
    """Return a polygon without any symmetry."""
    return star(np.random.default_rng(6), 7)


# --- free motion ---------------------------------------------------------------------------


@pytest.mark.parametrize("step", [5e-3, 0.02, 0.25])
@pytest.mark.parametrize("process", PROCESSES)
def test_projectile(process, step):
    """Constant acceleration is exact for any step; the block turns at a constant rate."""
    model = system([shape()], velocity={0: (1.0, 2.0, 0.3)})
    how = method(process=PROCESSES[process], max_displacement=10.0)
    results = march(model, how, step, 0.5)
    assert len(results) == round(0.5 / step)
    way = centroids(model, results[-1].state) - centroids(model, at_start(model))
    assert way[0] == pytest.approx([0.5, 1.0 - 0.5 * GRAVITY * 0.25], abs=1e-9)
    assert results[-1].state.velocity[0, 1] == pytest.approx(2.0 - GRAVITY * 0.5, abs=1e-9)
    assert results[-1].state.rotation[0] == pytest.approx(0.15, rel=2e-3)


@pytest.mark.parametrize("step", [5e-3, 0.02, 0.1])
def test_backward_euler_falls_too_far_by_half_a_step(step):
    model = system([shape()])
    how = method(integrator=BackwardEuler(), max_displacement=10.0)
    last = march(model, how, step, 0.5)[-1].state
    fallen = centroids(model, at_start(model))[0, 1] - centroids(model, last)[0, 1]
    error = fallen - 0.5 * GRAVITY * 0.25
    assert error == pytest.approx(0.5 * GRAVITY * 0.5 * step, rel=1e-6)


def test_spinning_block_keeps_its_rate_and_its_energy():
    model = system([shape()], velocity={0: (0.0, 0.0, 2.0)}, gravity=NOTHING)
    how = method(max_displacement=1.0)
    results = march(model, how, 5e-3, 2.0)
    energies = np.array([one.state.ledger.kinetic + one.state.ledger.elastic for one in results])
    assert np.ptp(energies) < 2e-3 * energies[0]
    rate = np.array([one.state.velocity[0, 2] for one in results])
    assert rate == pytest.approx(2.0, rel=2e-3)


# --- collisions ----------------------------------------------------------------------------


@cache
def collision(process, scheme, friction_angle, step=1e-3):
    """Return model, method and results of two blocks of different mass that meet off centre."""
    outlines = [regular(5, 0.5, 0.2), box(0.62, -0.2, 0.8, 1.0)]
    model = system(
        outlines,
        velocity={0: (1.0, 0.1, 0.5), 1: (-0.5, 0.0, 0.0)},
        gravity=NOTHING,
        friction_angle=friction_angle,
    )
    how = method(
        process=PROCESSES[process],
        integrator=SCHEMES[scheme],
        contact_law=Penalty(normal_stiffness=1e8),
    )
    return model, how, march(model, how, step, 0.12)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("process", PROCESSES)
def test_collision_keeps_the_momentum(process, scheme):
    """Action equals reaction, with friction: to round-off at every step."""
    model, how, results = collision(process, scheme, 20.0)
    before = momentum(model, how, at_start(model))
    assert results[-1].state.ledger.kinetic < 0.9 * results[0].state.ledger.kinetic
    for one in results:
        after = momentum(model, how, one.state)
        assert after[:2] == pytest.approx(before[:2], abs=1e-10 * np.abs(before).max())


@pytest.mark.parametrize("process", PROCESSES)
def test_collision_keeps_the_angular_momentum(process):
    """But for the couple of friction, which acts on vertex and foot, a gap apart, and for O(h)."""
    for friction_angle in (0.0, 20.0):
        model, how, results = collision(process, "constant acceleration", friction_angle)
        before = momentum(model, how, at_start(model))[2]
        couple = sum(
            1e-3 * np.abs(one.response.shear_force * one.contacts.gap).sum() for one in results
        )
        after = momentum(model, how, results[-1].state)[2]
        assert abs(after - before) < couple + 1e-3 * abs(before)
        assert couple < 0.02 * abs(before)


@pytest.mark.slow
@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_convex_process_stops_a_dropped_block(restitution):
    """A square dropped from 0.5 m hits stiff springs at 3 m/s; energy never grows."""
    model = system([box(-1, -1, 3.0), box(0, 0.5)], fixed=[0])
    how = method(process=Convex(restitution=restitution), contact_law=Penalty(1e10))
    results = march(model, how, 2e-3, 0.7)
    height = np.array([centroids(model, one.state)[1, 1] - 0.5 for one in results])
    energy = np.array([one.state.ledger.stored for one in results])
    weight = model.mass[1] * GRAVITY
    assert height.min() > -1e-3
    assert np.diff(energy).max() < 1e-6 * weight
    first = int(np.sqrt(2.0 * 0.5 / GRAVITY) / 2e-3) + 1
    rebound = np.sqrt(max(0.0, height[first:].max()) / 0.5)
    assert rebound == pytest.approx(restitution, abs=1e-3)
    if restitution == 0.0:
        assert results[-1].response.normal_force.sum() == pytest.approx(weight, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("scheme", SCHEMES)
def test_one_pass_bears_a_deep_drop_on_soft_springs(scheme):
    """From 1 m: 4.4 m/s, 0.15 m deep into the floor, far beyond the reach, and out again."""
    model = system([box(-1, -1, 3.0), box(0, 1.0)], fixed=[0])
    how = method(contact_law=Penalty(normal_stiffness=1e6), integrator=SCHEMES[scheme])
    results = march(model, how, 2e-3, 0.8)
    deepest = max(one.penetration for one in results)
    assert 0.1 < deepest < 0.25
    assert np.isfinite(results[-1].state.vertices).all()
    assert abs(centroids(model, results[-1].state)[1, 0] - 0.5) < 1e-6


# --- the ledger ----------------------------------------------------------------------------


def tumbling(seed=3, count=8):
    """Return polygons that fall onto a trough."""
    rng = np.random.default_rng(seed)
    trough = np.array([[-3, -1], [3, -1], [3, 2], [2, 2], [2, 0], [-2, 0], [-2, 2], [-3, 2]], float)
    balls = [
        turned(
            regular(rng.integers(3, 7), 0.35), rng.uniform(0.0, 6.0), (-1.5 + k % 4, 0.6 + k // 4)
        )
        for k in range(count)
    ]
    return system([trough, *balls], fixed=[0], friction_angle=25.0)


@cache
def tumbled(process, scheme="constant acceleration", end=0.3):
    """Return model, method and results of them; nobody writes into a state."""
    model = tumbling()
    law = Penalty(normal_stiffness=5e6)
    how = method(process=PROCESSES[process], integrator=SCHEMES[scheme], contact_law=law)
    return model, how, march(model, how, 2e-3, end)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("process", PROCESSES)
def test_ledger_explains_all_energy_at_every_step(process, scheme):
    model, how, results = tumbled(process, scheme, 0.4)
    first = open_ledger(model, how, at_start(model)).ledger
    moved = max(abs(one.state.ledger.gravity) for one in results)
    assert moved > 1e4
    for one in results:
        ledger = one.state.ledger
        lost = ledger.friction + ledger.impacts + ledger.numerical
        total = ledger.stored - ledger.loads + lost
        assert total - first.stored == pytest.approx(ledger.unaccounted, abs=1e-9 * moved)
        assert abs(ledger.unaccounted) < 1e-6 * moved
        assert ledger.friction >= 0.0


def heap(make, sides, seed):
    """Return twelve polygons above a trough, that fall on each other's corners."""
    rng = np.random.default_rng(seed)
    trough = [[-4, -1], [4, -1], [4, 6], [3, 6], [2.5, 0], [-2.5, 0], [-3, 6], [-4, 6]]
    outlines = [np.array(trough, float)]
    for k in range(12):
        outline = make(rng, rng.integers(*sides), 0.5)
        outline = turned(outline, rng.uniform(0.0, 6.0))
        x, y = -1.6 + 1.05 * (k % 4) + rng.uniform(-0.02, 0.02), 0.7 + 1.1 * (k // 4)
        outlines.append(outline + np.array([x, y]))
    return system(outlines, fixed=[0], friction_angle=30.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "sides", "seed", "end"), [(convex, (3, 8), 0, 0.36), (star, (5, 9), 2, 0.52)]
)
def test_corners_that_collide_in_a_heap_create_no_energy(make, sides, seed, end):
    """Corners that come past each other, or meet at once: no contact appears deep inside."""
    model = heap(make, sides, seed)
    how = method(process=Convex(), contact_law=Penalty(2e8))
    results = march(model, how, 1e-3, end)
    energy = np.array([one.state.ledger.stored for one in results])
    assert sum(one.response.normal_force.max(initial=0.0) > 0.0 for one in results) > 20
    assert np.diff(energy).max() < 1e-5 * np.ptp(energy)


@pytest.mark.parametrize("offset", [0.0, 2e-3, -2e-3])
def test_corners_that_meet_at_speed_stop_each_other(offset):
    """A tip flies at a corner, beyond both its edges until the step in which they would meet."""
    tip = turned(box(0.0, 0.0), 0.3)
    leading = tip[np.argmin(tip.sum(axis=1))]
    model = system(
        [box(0, 0), tip - leading + np.array([1.012 + offset, 1.012])],
        fixed=[0],
        velocity={1: (-5.0, -5.0, 0.0)},
        gravity=NOTHING,
    )
    how = method(process=Convex(), contact_law=Penalty(1e9))
    results = march(model, how, 1e-3, 0.02)
    energy = np.array([one.state.ledger.stored for one in results])
    assert results[-1].state.ledger.impacts > 0.1 * energy[0]
    # then it slides round the corner: forces act along normals of the start of each step
    assert np.diff(energy).max() < 3e-5 * energy[0]
    # pressed in by its own speed within a step or two, not found there
    found_deep = [one.contacts.gap[~one.contacts.known].min(initial=0.0) for one in results]
    assert min(found_deep) > -1e-3


# --- rejection -----------------------------------------------------------------------------


def outcome_of(model, how, step, state=None):
    state = open_ledger(model, how, state or at_start(model))
    with pytest.raises(StepRejected) as caught:
        how.process.step(model, how, state, step)
    return caught.value


@pytest.mark.parametrize("process", PROCESSES)
def test_step_is_rejected_where_a_vertex_travels_too_far(process):
    """Against a block that it might touch."""
    beside = system([box(0, 0), box(0, -1.0)], velocity={0: (2.0, 0.0, 0.0)}, gravity=(0, 0))
    how = method(process=PROCESSES[process], max_displacement=0.01)
    rejected = outcome_of(beside, how, 6e-3)
    assert rejected.outcome is StepOutcome.TRAVELLED_TOO_FAR
    assert "0.012 m" in rejected.detail
    how.process.step(beside, how, open_ledger(beside, how, at_start(beside)), 4e-3)
    apart = system([box(0, 0), box(0, -1.1)], velocity={0: (2.0, 0.0, 0.0)}, gravity=(0, 0))
    how.process.step(apart, how, open_ledger(apart, how, at_start(apart)), 6e-3)


@pytest.mark.parametrize("process", PROCESSES)
def test_step_is_rejected_where_a_block_turns_too_far(process):
    model = system([box(0, 0, 1e-2, 1e-2)], velocity={0: (0.0, 0.0, 500.0)})
    how = method(process=PROCESSES[process], max_displacement=1.0)
    assert outcome_of(model, how, 1e-3).outcome is StepOutcome.ROTATED_TOO_FAR
    # sin r0 = 2 is not a rotation at all
    assert outcome_of(model, how, 4e-3).outcome is StepOutcome.ROTATED_TOO_FAR


@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.parametrize("where", [0, 2, 4])
def test_step_is_rejected_where_something_is_not_a_number(process, where):
    model = system([box(0, 0), box(0, 1)], fixed=[0])
    how = method(process=PROCESSES[process])
    state = at_start(model)
    velocity = state.velocity.copy()
    velocity[1, where] = np.nan
    rejected = outcome_of(model, how, 1e-3, replace(state, velocity=velocity))
    assert rejected.outcome in (
        StepOutcome.NOT_FINITE,
        StepOutcome.ROTATED_TOO_FAR,
        StepOutcome.NOT_CONVERGED,
    )


def sunk(depth):
    """Return a box on a floor, and the state in which it has sunk into it."""
    model = system([box(-1, -1, 3.0), box(0, 0)], fixed=[0])
    down = np.where(model.vertex_block == 1, depth, 0.0)
    return model, at_start(model, model.vertices - np.stack([0.0 * down, down], axis=1))


def remembered(depth, vertex=4):
    return memory_of([vertex], [0], [2], [-depth], normal_force=[1.0], mode=[1])


def test_vertex_that_jumps_deeper_than_the_reach_has_tunnelled():
    reach = search_of_modified(method()).depth
    model, state = sunk(1.01 * reach)
    with pytest.raises(StepRejected) as caught:
        reject_tunnelled(
            model, model.vertices, state.vertices, ContactMemory(), reach, VerletList()
        )
    assert caught.value.outcome is StepOutcome.TUNNELLED
    assert "block '2'" in caught.value.detail
    assert "inside '1'" in caught.value.detail
    model, state = sunk(0.99 * reach)
    reject_tunnelled(model, model.vertices, state.vertices, ContactMemory(), reach, VerletList())


def test_vertex_that_was_as_deep_before_has_not_jumped():
    """To try a smaller step again and again would be of no use."""
    reach = search_of_modified(method()).depth
    model, state = sunk(3.0 * reach)
    reject_tunnelled(model, state.vertices, state.vertices, ContactMemory(), reach, VerletList())


def test_depth_that_the_contacts_of_the_pair_know_is_no_tunnelling():
    """Whichever vertex it is: deep contacts are handed from one to the other."""
    reach = search_of_modified(method()).depth
    model, state = sunk(4.0 * reach)
    for vertex in (4, 5):
        reject_tunnelled(
            model,
            model.vertices,
            state.vertices,
            remembered(3.9 * reach, vertex),
            reach,
            VerletList(),
        )
    with pytest.raises(StepRejected):
        reject_tunnelled(
            model, model.vertices, state.vertices, remembered(0.5 * reach), reach, VerletList()
        )


class Blind:
    """A corner rule that keeps nothing."""

    def choose(self, candidates):
        """Return False for all."""
        return np.zeros(len(candidates.vertex), np.bool_)


def test_step_that_ends_too_deep_is_rejected():
    """A block that enters another unseen by any contact."""
    model = system([box(-1, -1, 3.0), box(0, 0)], fixed=[0], velocity={1: (0.0, -8.0, 0.0)})
    how = method(process=PROCESSES["convex"], corner_rule=Blind(), max_displacement=0.1)
    assert outcome_of(model, how, 4e-3).outcome is StepOutcome.TUNNELLED


@pytest.mark.parametrize("process", ["modified", "passes", "convex"])
def test_rolling_on_soft_springs_is_not_taken_for_tunnelling(process):
    """A dodecagon rolls 4 cm deep in its own springs: the contact goes from vertex to vertex."""
    floor = box(-2, -1, 8.0)
    wheel = regular(12, 0.5, np.pi / 12.0) + np.array([0.0, 0.5 * np.cos(np.pi / 12.0)])
    model = system([floor, wheel], fixed=[0], velocity={1: (2.0, 0.0, -4.0)}, friction_angle=40.0)
    how = method(process=PROCESSES[process], contact_law=Penalty(normal_stiffness=3e5))
    results = march(model, how, 2e-3, 0.6)
    assert max(one.penetration for one in results) > 1.2 * search_of_modified(how).depth
    assert len({int(v) for one in results for v in one.contacts.vertex}) > 4
    # never cut but for the limit on movement, never lost
    assert min(np.diff([0.0] + [one.state.time for one in results])) > 1.9e-3
    assert centroids(model, results[-1].state)[1, 1] > 0.3


@pytest.mark.parametrize("process", PROCESSES)
def test_retried_step_is_the_smaller_step(process):
    """A rejected step leaves nothing behind: the retry is what it would have been at once."""
    model, how, results = tumbled(process)
    state = results[-1].state
    direct = how.process.step(model, how, state, 2e-3).state
    with pytest.raises(StepRejected):
        how.process.step(model, replace(how, max_displacement=1e-3), state, 2e-3)
    again = how.process.step(model, how, state, 2e-3).state
    assert same_bits(direct, again)


def same_bits(one, other):
    """Return whether two states agree in every bit, memory and ledger included."""
    if hasattr(one, "__dataclass_fields__"):
        return all(same_bits(getattr(one, k), getattr(other, k)) for k in vars(one))
    return np.array_equal(one, other)


# --- repeatability and invariance ----------------------------------------------------------


@pytest.mark.parametrize("process", PROCESSES)
def test_two_runs_agree_bit_for_bit(process):
    again = method(process=PROCESSES[process], contact_law=Penalty(5e6))
    runs = tumbled(process)[2], march(tumbling(), again, 2e-3, 0.3)
    assert len(runs[0]) == len(runs[1])
    assert all(
        same_bits(one.state, other.state) for one, other in zip(runs[0], runs[1], strict=True)
    )


@pytest.mark.parametrize("process", PROCESSES)
def test_fixed_blocks_keep_every_bit(process):
    model, _, results = tumbled(process)
    last = results[-1].state
    still = model.vertex_block == 0
    assert np.array_equal(last.vertices[still], model.vertices[still])
    assert np.array_equal(last.velocity[0], np.zeros(6))
    assert np.array_equal(last.stress[0], np.zeros(3))


@pytest.mark.parametrize("process", ["modified", "convex"])
@pytest.mark.parametrize(
    ("angle", "shift"), [(0.0, (1e6 + 0.3, -2e6)), (1.1, (0.0, 0.0)), (-2.5, (3e5, 1e5))]
)
def test_moving_and_turning_everything_changes_no_motion(process, angle, shift):
    """Gravity is turned as well.  Joints start a little open: round-off opens or closes none."""
    outlines = [one + 1e-6 * (one.mean(axis=0) - one) for one in voussoirs(5)]
    how = method(process=PROCESSES[process], contact_law=Penalty(1e8))

    def run(angle, shift):
        model = system(
            [turned(one, angle, shift) for one in outlines],
            fixed=[0, 4],
            friction_angle=40.0,
            gravity=turned(np.array([[0.0, -GRAVITY]]), angle)[0],
        )
        last = march(model, how, 1e-3, 0.05)[-1].state
        return (last.vertices - model.vertices) @ turned(np.eye(2), angle).T, last.stress

    here, stress = run(0.0, (0.0, 0.0))
    there, turned_stress = run(angle, shift)
    assert np.abs(here).max() > 1e-4
    assert there == pytest.approx(here, abs=1e-8)
    trace = stress[:, :2].sum(axis=1)
    assert turned_stress[:, :2].sum(axis=1) == pytest.approx(trace, abs=1e-3 * np.abs(trace).max())


@pytest.mark.parametrize("process", ["modified", "convex"])
def test_renumbering_blocks_changes_no_motion(process):
    outlines = [one + 1e-6 * (one.mean(axis=0) - one) for one in bricks(3, 3)]
    how = method(process=PROCESSES[process], contact_law=Penalty(1e8))
    order = np.random.default_rng(0).permutation(9)

    def run(order):
        fixed = [int(np.flatnonzero(order == k)[0]) for k in range(3)]
        model = system([outlines[k] for k in order], fixed=fixed, friction_angle=30.0)
        last = march(model, how, 1e-3, 0.05)[-1].state
        moves = last.vertices.reshape(9, 4, 2) - model.vertices.reshape(9, 4, 2)
        return moves[np.argsort(order)]

    here, there = run(np.arange(9)), run(order)
    assert np.abs(here).max() > 1e-5
    assert there == pytest.approx(here, abs=1e-9)


def test_reach_of_a_step_covers_the_motion_of_both_blocks():
    how = method(critdis=0.003, max_displacement=0.02)
    assert vars(search_of_modified(how)) == pytest.approx(
        vars(SearchDistance(front=0.003, depth=0.043, critdis=0.003))
    )
