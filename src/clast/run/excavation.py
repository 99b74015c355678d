"""Blocks that are excavated: they leave the equations, and their support forces are taken away.

Their energy goes to the ledger's ``removed``: kinetic and strain energy, the energy that their
weight has gained or lost since the start, and that of their contacts and supports.  The forces that
they exerted on their neighbours are released at once or little by little, or held for a later
stage (actions/relaxation.py).
Welds along an opening end with it.
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np

from clast.actions.active import actions_of, states_of
from clast.actions.in_situ import LoadedEnds
from clast.actions.relaxation import Relaxation, SupportForces, absent_in, no_forces, released
from clast.block import polygon
from clast.block.inertia import block_frames
from clast.contact import laws as multipliers
from clast.contact.contacts import Contacts
from clast.contact.detection import remembered
from clast.errors import ModelError, shortened
from clast.model.drainage import drained
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import Ledger, State
from clast.step.method import Method


def excavated(
    model: Model,
    method: Method,
    state: State,
    blocks: Ints,
    relax: float = 1.0,
    relax_time: float = 0.0,
    release: Floats | float = 1.0,
) -> tuple[Model, State]:
    """Return model and state without ``blocks`` (k,), which keep their places in all arrays.

    The forces that they exert on their neighbours are released by the share ``release``, one number
    or one for each of ``blocks``: ``relax`` (0 to 1) of it ends at once, the rest falls to nothing
    within ``relax_time``, s; the part that is not released is held.  Blocks already excavated do
    not count.  Raises ModelError for shares and times out of range, for values that are not block
    numbers, and where no block would be left.
    """
    if not 0.0 <= relax <= 1.0:
        raise ModelError(
            f"{relax:g} is not a valid share",
            where="relax",
            remedy="give the share of the forces released at once, 0 to 1",
        )
    if not 0.0 <= relax_time < np.inf:
        raise ModelError(
            f"{relax_time:g} s is not a valid duration",
            where="relax_time",
            remedy="give the time over which the rest is released, s, or 0",
        )
    blocks = _numbers(blocks, model.block_count)
    leaving = np.zeros(model.block_count, np.bool_)
    leaving[blocks] = True
    leaving &= ~model.absent
    if not leaving.any():
        return model, state
    absent = model.absent | leaving
    if absent.all():
        raise ModelError(
            "no block would be left", where="excavate", remedy="excavate some of the blocks"
        )
    centroid = polygon.moments(state.vertices, model.block_start)[1]
    contacts = remembered(model, state, centroid, method.critdis)
    left = without(model, absent)
    fraction = np.zeros(model.block_count)
    fraction[blocks] = release
    forces = _on_neighbours(model, state, contacts, leaving)
    forces = released(forces, fraction, relax, relax_time, state.time)
    states = _states_after(model, left, method, state, forces)
    velocity, stress = state.velocity.copy(), state.stress.copy()
    velocity[leaving], stress[leaving] = 0.0, 0.0
    taken = _energy(model, method, state, contacts, leaving)
    given = Ledger(**{one.name: -getattr(taken, one.name) for one in fields(taken)})
    ledger = state.ledger.plus(given, Ledger(removed=taken.stored))
    memory = state.memory
    stays = ~(leaving[memory.block] | leaving[model.vertex_block[memory.vertex]])
    memory = replace(
        memory, **{one.name: getattr(memory, one.name)[stays] for one in fields(memory)}
    )
    return left, replace(
        state, velocity=velocity, stress=stress, memory=memory, ledger=ledger, actions=states
    )


def without(model: Model, absent: Bools) -> Model:
    """Return the model without blocks that are ``absent`` (n,), and without welds along them.

    A weld ends where its opening is excavated, and where the blocks that it held are.
    """
    edge_joint = model.edge_joint.copy()
    for one in model.openings:
        # Which edges (k,) lay on an edge of a block that is ``absent`` at the start, (k,).
        onwards, here = model.vertex_after, model.vertices + 0.0  # so that there is one zero only
        # segments that wait have never been rock
        out = np.flatnonzero((absent & ~model.lined)[model.vertex_block])
        opposite = np.concatenate([here[onwards[out]], here[out]], axis=1)
        known = {ends.tobytes() for ends in opposite}
        own = np.concatenate([here[one.welded], here[onwards[one.welded]]], axis=1)
        ends = absent[one.block].all() | np.array(
            [ends.tobytes() in known for ends in own], np.bool_
        )
        edge_joint[one.welded[ends]] = -1
    # segments of linings may come back
    fixed = np.where(model.absent & ~absent, False, model.fixed)
    return with_drains(replace(model, absent=absent, fixed=fixed | absent, edge_joint=edge_joint))


def with_drains(model: Model) -> Model:
    """Return the model with water that excavated openings drain."""
    if not any((one.joints.drain >= 0).any() for one in model.water):
        return model
    water = tuple(drained(one, model.absent) for one in model.water)
    return replace(model, water=water)


def as_in(model: Model, state: State) -> Model:
    """Return the model without the excavated blocks in a state of its run."""
    absent = absent_in(state)
    return (
        model if absent is None or np.array_equal(absent, model.absent) else without(model, absent)
    )


def _numbers(blocks: Any, count: int) -> Ints:
    """Return numbers of blocks, of which there are ``count``, (k,)."""
    numbers = np.asarray(blocks)
    if numbers.ndim != 1 or (numbers.dtype.kind not in "iu" and numbers.size):
        raise ModelError(
            f"{shortened(repr(blocks))} are not block numbers",
            where="blocks",
            remedy='give their numbers from 0; for names use model.blocks_called(["name"])',
        )
    for number in numbers[(numbers < 0) | (numbers >= count)][:1]:
        raise ModelError(
            f"there is no block {number}",
            where="blocks",
            remedy=f"give numbers from 0 to {count - 1}",
        )
    return numbers.astype(np.int64)


def release(
    model: Model, method: Method, state: State, fraction: Floats, relax: float, relax_time: float
) -> State:
    """Return the state after excavated blocks have released a ``fraction`` (n,) of those held.

    The share ``relax`` of it ends at once, the rest within ``relax_time``, s.
    """
    actions = actions_of(model, method.fixed_point_stiffness, method.damping)
    states = [
        released(own, fraction, relax, relax_time, state.time)
        if isinstance(own, SupportForces)
        else own
        for own in states_of(actions, model, state)
    ]
    return replace(state, actions=tuple(states))


def _on_neighbours(model: Model, state: State, contacts: Contacts, leaving: Bools) -> SupportForces:
    """Return the forces of blocks that are ``leaving`` (n,) on others, where they touch.

    N n + T t acts on the block of the vertex, the opposite of it on that of the edge.
    """
    normal = contacts.normal
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    force = contacts.normal_force[:, None] * normal + contacts.shear_force[:, None] * along
    carries = (contacts.normal_force != 0.0) | (contacts.shear_force != 0.0)
    moves = ~(leaving | model.fixed)
    of_vertex = carries & leaving[contacts.edge_block] & moves[contacts.vertex_block]
    of_edge = carries & leaving[contacts.vertex_block] & moves[contacts.edge_block]
    own, edge = contacts.vertex[of_vertex], contacts.edge[of_edge]
    owner = contacts.edge_block[of_edge]
    own_end, end = model.vertex_after[own], model.vertex_after[edge]
    side = state.vertices[end] - state.vertices[edge]
    foot = contacts.foot[of_edge] - state.vertices[edge]
    place = np.einsum("kx,kx->k", foot, side) / np.einsum("kx,kx->k", side, side)
    count = len(own) + len(edge)
    return SupportForces(
        absent=model.absent | leaving,
        of=np.concatenate([contacts.edge_block[of_vertex], contacts.vertex_block[of_edge]]),
        block=np.concatenate([contacts.vertex_block[of_vertex], owner]),
        vertex=np.concatenate([np.stack([own, own_end], axis=1), np.stack([edge, end], axis=1)]),
        share=np.concatenate([contacts.along[of_vertex], place]),
        force=np.concatenate([force[of_vertex], -force[of_edge]]),
        since=np.full(count, state.time),
        duration=np.full(count, np.inf),
    )


def _states_after(
    model: Model, left: Model, method: Method, state: State, forces: SupportForces
) -> tuple[Any, ...]:
    """Return the states of all actions of the model that is ``left``, with new ``forces``."""
    before = actions_of(model, method.fixed_point_stiffness, method.damping)
    after = actions_of(left, method.fixed_point_stiffness, method.damping)
    states = list(states_of(before, model, state))
    at = next(k for k, action in enumerate(after) if isinstance(action, Relaxation))
    if len(before) < len(after):
        states.insert(at, no_forces(model.absent))
    known = states[at]
    states[at] = forces.plus(known.rows(~forces.absent[known.block]))
    return tuple(states)


def _energy(
    model: Model, method: Method, state: State, contacts: Contacts, leaving: Bools
) -> Ledger:
    """Return the energy of blocks that are ``leaving`` (n,), by the entries of the ledger, J/m."""
    frames = block_frames(model, state)
    velocity, stress = state.velocity[leaving], state.stress[leaving]
    strain = np.einsum("nab,nb->na", model.compliance[leaving], stress)
    fallen = frames.centroid - polygon.moments(model.vertices, model.block_start)[1]
    law, none = method.contact_law, np.zeros(len(contacts))
    touching = leaving[contacts.vertex_block] | leaving[contacts.edge_block]
    springs = law.respond(multipliers.begin(law, contacts), contacts.gap, none).energy
    # The energy in springs that hold blocks that are ``leaving`` (n,), J/m.
    points = model.fixed_points
    anchors = points.at + model.ground_motion.anchor_displacement(state.time)
    drift = (state.points[model.point_slices.fixed] - anchors)[leaving[points.block]]
    held = 0.5 * method.fixed_point_stiffness * float(np.sum(drift**2))
    for own in state.actions:
        if isinstance(own, LoadedEnds):
            some = leaving[own.block]
            moved = (state.vertices - model.vertices)[own.vertex[some]]
            held += 0.5 * float(np.einsum("kx,kxy,ky", moved, own.hold[some], moved))
    return Ledger(
        kinetic=0.5
        * float(np.einsum("ni,nij,nj", velocity, frames.mass_matrix[leaving], velocity)),
        elastic=0.5 * float(model.area[leaving] @ np.einsum("na,na->n", stress, strain)),
        gravity=-float((model.mass[leaving] @ fallen[leaving]) @ model.gravity),
        contact=float(springs[touching].sum()),
        fixed_points=held,
    )
