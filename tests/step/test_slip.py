"""Slip of contacts: how far the two sides of a joint have moved along each other."""

from dataclasses import replace

import numpy as np
import pytest

from clast.contact.contacts import OPEN
from clast.step.convex import Convex
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from scenes import systems

PROCESSES = {"convex": Convex(), "modified": Modified(), "open-close": OpenClose()}


def pushed(angle, process, steps=12, step=2e-3, **changes):
    """Return model and states of a brick that is shot along a plane that rises by ``angle``."""
    ground, brick = systems.box(-4.0, -1.0, 9.0, 1.0), systems.box(0.0, 0.0, 1.0, 0.5)
    gravity = tuple(systems.turned(np.array([[0.0, -9.8]]), angle)[0])
    outlines = [systems.turned(one, angle) for one in (ground, brick)]
    model = systems.system(outlines, fixed=[0], friction_angle=20.0, gravity=gravity)
    how = systems.method(process=process, max_displacement=0.1, **changes)
    state = systems.at_start(model)
    velocity = np.zeros((2, 6))
    velocity[1, :2] = systems.turned(np.array([[3.0, 0.0]]), angle)[0]
    state = replace(state, velocity=velocity)
    states = [state]
    for _ in range(steps):
        states.append(how.process.step(model, how, states[-1], step).state)
    return model, states


@pytest.mark.parametrize("process", PROCESSES.values(), ids=PROCESSES)
@pytest.mark.parametrize("angle", [0.0, 0.7, np.pi, 4.0])
def test_slip_is_the_way_along_the_plane(angle, process):
    _, states = pushed(angle, process)
    along = systems.turned(np.array([[1.0, 0.0]]), angle)[0]
    moved = (states[-1].vertices - states[0].vertices) @ along
    memory = states[-1].memory
    assert len(memory) >= 2
    # to the right as seen from the ground, whose edge has it on its left: against t
    assert memory.slip == pytest.approx(-moved[memory.vertex], abs=1e-9)
    assert moved[memory.vertex].min() > 0.03


def test_slip_does_not_depend_on_the_steps():
    _, coarse = pushed(0.3, Convex(), steps=8, step=4e-3)
    _, fine = pushed(0.3, Convex(), steps=32, step=1e-3)
    assert coarse[-1].memory.slip == pytest.approx(fine[-1].memory.slip, rel=2e-3)


def test_both_sides_of_a_joint_have_the_same_slip():
    """A vertex of the ground under the brick's edge slips as the brick's own vertices do."""
    ground = np.array([(-4.0, -1.0), (0.4, -1.0), (0.4, 0.0), (-4.0, 0.0)])
    brick = systems.box(-0.6, 0.0, 2.0, 0.2)
    model = systems.system([ground, brick], fixed=[0], gravity=(-3.0, -9.8))
    how = systems.method(process=Convex(), max_displacement=0.1)
    state = systems.at_start(model)
    for _ in range(10):
        state = how.process.step(model, how, state, 2e-3).state
    memory = state.memory
    assert set(model.vertex_block[memory.vertex]) == {0, 1}
    # to the left as seen from the ground is to the left as seen from the brick
    assert (memory.slip > 1e-5).all()
    assert memory.slip == pytest.approx(memory.slip[0], rel=1e-3)


def test_slip_goes_round_a_corner():
    """A tip passes a bend of the ground: it has another edge then, and its slip goes on."""
    fall = 3.0 * np.tan(np.radians(4.0))
    ground = np.array([(-3.0, -2.0), (3.0, -2.0), (3.0, -fall), (0.0, 0.0), (-3.0, 0.0)])
    tip = np.array([(-0.01, 0.0), (0.14, 0.3), (-0.16, 0.3)])
    model = systems.system([ground, tip], fixed=[0])
    how = systems.method(process=Convex(), max_displacement=0.05)
    velocity = np.zeros((2, 6))
    velocity[1, 0] = 0.3
    state = replace(systems.at_start(model), velocity=velocity)
    front = int(model.block_start[1])
    edges, slips, ways = [], [], []
    for _ in range(40):
        before = state.vertices
        state = how.process.step(model, how, state, 2e-3).state
        ways.append(np.hypot(*(state.vertices - before)[front]))
        row = np.flatnonzero(state.memory.vertex == front)
        if len(row):
            edges.append(int(state.memory.edge[row[0]]))
            slips.append(float(state.memory.slip[row[0]]))
    assert len(set(edges)) == 2, "the vertex has passed to the next edge"
    assert len(slips) == 40
    assert np.diff(np.abs(slips)).min() > 0.0
    assert abs(slips[-1]) == pytest.approx(sum(ways), rel=1e-3)


def test_slip_begins_with_the_step_that_makes_the_contact():
    """A brick in flight lands: what it has flown before is not slip."""
    ground, brick = systems.box(-4.0, -1.0, 9.0, 1.0), systems.box(0.0, 0.01, 1.0, 0.5)
    model = systems.system([ground, brick], fixed=[0], gravity=(0.0, 0.0))
    velocity = np.zeros((2, 6))
    velocity[1, :2] = 1.0, -1.0
    state = replace(systems.at_start(model), velocity=velocity)
    how = systems.method(process=Convex(), max_displacement=0.1)
    ways, landed = [], None
    for number in range(20):
        before = state.vertices
        state = how.process.step(model, how, state, 1e-3).state
        ways.append((state.vertices - before)[model.block_start[1], 0])
        bears = len(state.memory) and (state.memory.mode != OPEN).any()
        landed = number if bears and landed is None else landed
        if not bears and landed is None:
            assert (state.memory.slip == 0.0).all()
    assert landed is not None and landed > 5
    assert state.memory.slip.min() == pytest.approx(-sum(ways[landed:]), rel=0.1)
