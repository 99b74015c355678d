"""The energy ledger: what each kind of force did in a step, measured term by term.

For unknowns d, every force of the step's equations does the work F.d at its end-of-step value.
Where that differs from the change of the energy that the force stores, the difference is what the
time integration removed.  Kinetic energy is compared with the inertia terms of the scheme, so
``unaccounted`` is what the solved equations leave open: it is measured, not made to vanish.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.block.inertia import BlockFrames, block_frames
from clast.contact.contacts import ContactResponse, Contacts
from clast.model.model import Floats, Model
from clast.model.state import Ledger, State
from clast.step import energies as works
from clast.step.method import Method
from clast.step.start import fixed_point_rows, load_rows


def fixed_point_energy(model: Model, stiffness: float, drift: Floats) -> float:
    """Return the energy of the fixed points' springs, J/m; ``drift`` (k, 2) in m."""
    return 0.5 * stiffness * float(np.sum(drift**2))


def opening(model: Model, method: Method, state: State) -> Ledger:
    """Return the ledger of a state at the start of a run: what it holds already."""
    frames = block_frames(model, method.displacement, state)
    velocity, stress = state.velocity, state.stress
    energies = works.of_blocks(  # those of a step in which nothing moves
        (np.zeros_like(velocity), velocity, velocity),
        (frames.mass_matrix, 1.0),
        (stress, stress),
        (model.area, model.compliance),
        (model.mass, model.gravity, model.gravity),
    )
    return Ledger(kinetic=float(energies[0]), elastic=float(energies[3]))


def created(ledger: Ledger, first: Ledger) -> float:
    """Return the energy, J/m, held beyond what the start and the loads gave (negative: lost)."""
    return ledger.stored - ledger.loads - first.stored


def round_off(method: Method, state: State, contacts: int) -> float:
    """Return the energy, J/m, of so many contacts that penetrate by the rounding of coordinates.

    Where nothing acts at all there is no other energy to compare with.
    """
    finest = 4.0 * float(np.finfo(float).eps) * float(np.abs(state.vertices).max())
    return contacts * method.contact_law.normal_stiffness * finest**2


def with_overlap(ledger: Ledger, method: Method, contacts: Contacts) -> Ledger:
    """Return the ledger at the start of a run with what contacts hold there already, J/m.

    ``contacts`` are those of the first step; coordinates are rounded, blocks may be wedged in, and
    bonds reach over gaps.
    """
    stretched = contacts.bonded & (contacts.tensile_strength > 0.0)
    held_by = np.where(stretched, contacts.gap, np.minimum(contacts.gap, 0.0))
    held = 0.5 * method.contact_law.normal_stiffness * float(held_by @ held_by)
    return replace(ledger, contact=ledger.contact + held)


def tolerated(model: Model, ledger: Ledger, first: Ledger) -> float:
    """Return the created energy, J/m, above which a run is called unstable.

    Impacts of the constant acceleration scheme give back a little too much now and then, so this
    is a wide bound: what lifts every block by a twentieth of its size, or doubles what there was.
    """
    size = np.sqrt(model.area[~model.fixed])
    weight = model.mass[~model.fixed] * np.hypot(*model.gravity)
    return 0.05 * float(np.sum(weight * size)) + first.stored + abs(ledger.loads)


def fixed_point_works(
    model: Model, method: Method, frames: BlockFrames, state: State, unknowns: Floats, end: float
) -> tuple[float, float, float, float]:
    """Return the work on blocks, the ground's work, and the energy held before and after, J/m.

    The anchors move until ``end``, s, under the force that stretches their springs then.
    """
    held_by = model.fixed_points.block
    if not len(held_by):
        return 0.0, 0.0, 0.0, 0.0
    basis, drift = fixed_point_rows(model, frames, method.displacement, state, end)
    held = drift + np.einsum("kxi,ki->kx", basis, unknowns[held_by])
    stiffness, ground = method.fixed_point_stiffness, model.ground_motion
    moved = ground.anchor_displacement(end) - ground.anchor_displacement(state.time)
    return (
        -stiffness * float(np.sum(held * (held - drift))),
        -stiffness * float(np.sum(held * moved)),
        fixed_point_energy(model, stiffness, drift + moved),
        fixed_point_energy(model, stiffness, held),
    )


def balance(
    model: Model,
    method: Method,
    state: State,
    frames: BlockFrames,
    velocity: Floats,
    lost: float,
    unknowns: Floats,
    end_velocity: Floats,
    end_stress: Floats,
    step: float,
    contacts: Contacts,
    applied: tuple[Floats, Floats],
    response: ContactResponse,
    gap: Floats,
    slip: Floats,
) -> Ledger:
    """Return the ledger at the end of a step.

    ``velocity`` (n, 6) is the velocity that entered the equations, ``lost`` what impacts took
    before, J/m, ``end_velocity`` the velocity and ``end_stress`` (n, 3) the stress, Pa, that came
    out, in directions of the start, ``applied`` the normal and shear forces (m,) that the equations
    held at the end of the step, ``response`` the forces of the law.
    """
    before, end = state.ledger, state.time + step
    inertial = model.ground_motion.body_acceleration(state.time, end)
    of_blocks = works.of_blocks(
        (unknowns, velocity, end_velocity),
        (frames.mass_matrix, step),
        (state.stress, end_stress),
        (model.area, model.compliance),
        (model.mass, model.gravity, inertial),
    )
    entering, kinetic, inertia_work = map(float, of_blocks[:3])
    elastic_before, elastic, elastic_work = map(float, of_blocks[3:6])
    gravity_work, load_work = map(float, of_blocks[6:])
    removed = inertia_work - (kinetic - entering) - elastic_work - (elastic - elastic_before)
    block, load = load_rows(model, frames, method.displacement, state)
    load_work += float(np.sum(load * unknowns[block]))

    fixed_work, base_work, fixed_before, fixed = fixed_point_works(
        model, method, frames, state, unknowns, end
    )
    removed += base_work - fixed_work - (fixed - fixed_before)
    stored = response.energy, response.dissipation
    of_contacts = works.of_contacts(applied, (contacts.gap, gap), slip, stored)
    contact_work, contact, friction = map(float, of_contacts)
    removed += -contact_work - (contact - before.contact) - friction

    done = elastic_work + gravity_work + load_work + fixed_work + contact_work
    return Ledger(
        kinetic=kinetic,
        elastic=elastic,
        gravity=before.gravity - gravity_work,
        contact=contact,
        fixed_points=fixed,
        loads=before.loads + load_work + base_work,
        friction=before.friction + friction,
        impacts=before.impacts + lost,
        numerical=before.numerical + removed + (before.kinetic - entering) - lost,
        unaccounted=before.unaccounted + inertia_work - done,
    )
