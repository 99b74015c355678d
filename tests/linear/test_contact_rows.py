"""Rows of the contacts: gap and slip to first order in the displacements of both blocks."""

import numpy as np
import pytest

from clast.block.inertia import block_frames
from clast.block.rotation import Exact, Linear, Sine
from clast.linear.system import gap_at_end, gap_rate, graph_of, slip_in_step, with_contact_forces
from clast.step.finish import move
from scenes.systems import at_start, box, bricks, contacts_of, system, turned, voussoirs

SIZES = np.array([1.0, 1.0, 1.0, 0.3, 0.3, 0.3])


def pressed(outlines, depth=2e-4):
    """Return model and state with the blocks grown a little, so that contacts penetrate."""
    model = system(outlines)
    middle = np.array([one.mean(axis=0) for one in outlines])[model.vertex_block] - model.origin
    return model, at_start(model, model.vertices + depth * (model.vertices - middle))


SYSTEMS = {
    "wall": bricks(3, 3),
    "arch": voussoirs(7),
    "turned": [turned(one, 0.4) for one in bricks(2, 3)],
    "tip": [box(0, 0), np.array([[0.4, 1.0], [0.9, 2.1], [0.2, 1.8]])],
}


def displaced(model, state, rule, unknowns):
    """Return the vertices after the displacements of the blocks."""
    frames = block_frames(model, state)
    gradient = rule.gradient(unknowns)
    return move(state.vertices, model.vertex_block, frames.centroid, unknowns, gradient)


def measured(model, contacts, vertices):
    """Return gap and distance along the edge of each contact, from vertices alone."""
    start, point = vertices[contacts.edge], vertices[contacts.vertex]
    after = contacts.edge + 1
    ends = model.block_start[contacts.edge_block + 1]
    after = np.where(after == ends, model.block_start[contacts.edge_block], after)
    tangent = vertices[after] - start
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    offset = point - start
    return np.sum(offset * normal, axis=1), np.sum(offset * tangent, axis=1)


@pytest.mark.parametrize("rule", [Exact(), Sine(), Linear()])
@pytest.mark.parametrize("name", SYSTEMS)
def test_gap_follows_the_rows_to_first_order(name, rule):
    """Ten times smaller displacements leave a hundredth of the error."""
    model, state = pressed(SYSTEMS[name])
    contacts = contacts_of(model, state)
    gap, _ = measured(model, contacts, state.vertices)
    assert contacts.gap == pytest.approx(gap, abs=1e-14)
    for seed in range(5):
        unknowns = np.random.default_rng(seed).normal(size=(model.block_count, 6)) * SIZES
        errors = []
        for size in (1e-4, 1e-5):
            moved, _ = measured(model, contacts, displaced(model, state, rule, size * unknowns))
            errors.append(np.abs(gap_at_end(contacts, size * unknowns) - moved).max())
        assert errors[0] < 1e-6
        assert errors[1] < 0.02 * errors[0]


@pytest.mark.parametrize("name", SYSTEMS)
def test_slip_is_the_motion_along_the_edge_of_the_vertex_past_its_foot(name):
    """The edge's own stretch and, times the gap, its rotation do not belong to the slip."""
    model, state = pressed(SYSTEMS[name])
    contacts = contacts_of(model, state)
    rng = np.random.default_rng(1)
    unknowns = 1e-6 * rng.normal(size=(model.block_count, 6)) * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]
    _, before = measured(model, contacts, state.vertices)
    _, after = measured(model, contacts, displaced(model, state, Sine(), unknowns))
    turn = unknowns[contacts.edge_block, 2]
    slip = slip_in_step(contacts, unknowns)
    assert slip == pytest.approx(after - before + turn * contacts.gap, abs=1e-11)


@pytest.mark.parametrize("name", SYSTEMS)
def test_rigid_motion_of_everything_neither_closes_nor_slips(name):
    model, state = pressed(SYSTEMS[name])
    contacts = contacts_of(model, state)
    frames = block_frames(model, state)
    omega, shift = 0.3, np.array([0.2, -0.1])
    unknowns = np.zeros((model.block_count, 6))
    x, y = frames.centroid.T
    unknowns[:, :2] = shift + omega * np.stack([-y, x], axis=1)
    unknowns[:, 2] = omega
    assert gap_rate(contacts, unknowns) == pytest.approx(np.zeros(len(contacts)), abs=1e-12)
    # along the edge the foot lies a gap away from the vertex
    slip = slip_in_step(contacts, unknowns)
    assert np.abs(slip).max() <= omega * np.abs(contacts.gap).max() + 1e-12


@pytest.mark.parametrize("name", SYSTEMS)
def test_contact_forces_are_equal_and_opposite(name):
    """They change neither the momentum nor (but for the gap) the angular momentum of the system."""
    model, state = pressed(SYSTEMS[name])
    contacts = contacts_of(model, state)
    frames = block_frames(model, state)
    rng = np.random.default_rng(3)
    normal, shear = rng.uniform(0.0, 1.0, len(contacts)), rng.normal(size=len(contacts))
    count = model.block_count
    nothing, free = np.zeros((count, 6)), np.zeros(count, np.bool_)
    graph = graph_of(contacts, count)
    force = with_contact_forces(nothing, contacts, graph, free, normal, shear)
    assert force[:, :2].sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)
    x, y = frames.centroid.T
    moment = force[:, 2] + x * force[:, 1] - y * force[:, 0]
    couple = shear * contacts.gap  # friction acts on vertex and foot, which are a gap apart
    assert moment.sum() == pytest.approx(couple.sum(), abs=1e-12)
    # and the virtual work is that of N on the gap and T on the slip
    unknowns = rng.normal(size=(model.block_count, 6))
    work = normal * gap_rate(contacts, unknowns) + shear * slip_in_step(contacts, unknowns)
    assert np.sum(force * unknowns) == pytest.approx(work.sum(), rel=1e-12)
