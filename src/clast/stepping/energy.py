"""The energy ledger: what each kind of force did in a step, measured term by term.

For unknowns d, every force of the step's equations does the work F.d at its end-of-step value.
Where that differs from the change of the energy that the force stores, the difference is what the
time integration removed.  Kinetic energy is compared with the inertia terms of the scheme, so
``unaccounted`` is what the solved equations leave open: it is measured, not made to vanish.
"""

from __future__ import annotations

import numpy as np

from clast.contact.arrays import ContactResponse, Contacts
from clast.equations.frames import BlockFrames, block_frames
from clast.equations.terms import fixed_point_rows, inertial_force, load_rows
from clast.interfaces import Method
from clast.kernels import assembly, block_rows
from clast.model import Floats, Model
from clast.state import Ledger, State


def kinetic_energy(frames: BlockFrames, velocity: Floats) -> float:
    """Return 1/2 v.M v, J/m."""
    return 0.5 * float(assembly.form(frames.mass_matrix, velocity))


def elastic_energy(model: Model, stress: Floats) -> float:
    """Return the strain energy 1/2 A sigma.E'^-1 sigma of the blocks, J/m."""
    strain = np.einsum("nij,nj->ni", model.compliance, stress)
    return 0.5 * float(np.sum(model.area[:, None] * stress * strain))


def fixed_point_energy(model: Model, stiffness: float, drift: Floats) -> float:
    """Return the energy of the fixed points' springs, J/m; ``drift`` (k, 2) in m."""
    return 0.5 * stiffness * float(np.sum(drift**2))


def opening(model: Model, method: Method, state: State) -> Ledger:
    """Return the ledger of a state at the start of a run: what it holds already."""
    frames = block_frames(model, method.displacement, state)
    return Ledger(
        kinetic=kinetic_energy(frames, state.velocity), elastic=elastic_energy(model, state.stress)
    )


def created(ledger: Ledger, first: Ledger) -> float:
    """Return the energy, J/m, held beyond what the start and the loads gave (negative: lost)."""
    return ledger.stored - ledger.loads - first.stored


def tolerated(model: Model, ledger: Ledger, first: Ledger) -> float:
    """Return the created energy, J/m, above which a run is called unstable.

    Impacts of the constant acceleration scheme give back a little too much now and then, so this
    is a wide bound: what lifts every block by a twentieth of its size, or doubles what there was.
    """
    size = np.sqrt(model.area[~model.fixed])
    weight = model.mass[~model.fixed] * np.hypot(*model.gravity)
    return 0.05 * float(np.sum(weight * size)) + first.stored + abs(ledger.loads)


def balance(
    model: Model,
    method: Method,
    state: State,
    frames: BlockFrames,
    velocity: Floats,
    theta: Floats,
    unknowns: Floats,
    end_velocity: Floats,
    step: float,
    contacts: Contacts,
    applied: tuple[Floats, Floats],
    response: ContactResponse,
    gap: Floats,
    slip: Floats,
) -> Ledger:
    """Return the ledger at the end of a step.

    ``velocity`` (n, 6) is the velocity that entered the equations, ``theta`` (n,) the scheme's
    weight by block, ``end_velocity`` the velocity that came out, ``applied`` the normal and shear
    forces (m,) that the equations held at the end of the step, ``response`` the forces of the law.
    """
    before = state.ledger
    kinetic = kinetic_energy(frames, end_velocity)
    inertia = (unknowns / step - velocity) / (theta[:, None] * step)
    forces = block_rows.products(frames.mass_matrix, inertia)
    inertia_work = float(block_rows.dot(unknowns, forces))
    entering = kinetic_energy(frames, velocity)
    removed = inertia_work - (kinetic - entering)

    end_stress = state.stress + np.einsum("nij,nj->ni", model.elasticity, unknowns[:, 3:])
    elastic_work = -float(np.sum(model.area[:, None] * end_stress * unknowns[:, 3:]))
    elastic_before = elastic_energy(model, state.stress)
    elastic = elastic_energy(model, end_stress)
    removed += -elastic_work - (elastic - elastic_before)

    gravity_work = float(np.sum(model.mass[:, None] * model.gravity * unknowns[:, :2]))
    block, load = load_rows(model, frames, method.displacement, state)
    load_work = float(np.sum(load * unknowns[block]))
    load_work += float(np.sum(inertial_force(model, state, step) * unknowns))

    # the anchors move by ``moved`` under the force that stretches their springs at the end
    end = state.time + step
    basis, drift = fixed_point_rows(model, frames, method.displacement, state, end)
    held = np.einsum("kxi,ki->kx", basis, unknowns[model.fixed_points.block])
    stiffness = method.fixed_point_stiffness
    ground = model.ground_motion
    moved = ground.anchor_displacement(end) - ground.anchor_displacement(state.time)
    fixed_work = -stiffness * float(np.sum((drift + held) * held))
    base_work = -stiffness * float(np.sum((drift + held) * moved))
    fixed = fixed_point_energy(model, stiffness, drift + held)
    fixed_before = fixed_point_energy(model, stiffness, drift + moved)
    removed += base_work - fixed_work - (fixed - fixed_before)

    contact_work = float(np.sum(applied[0] * (gap - contacts.gap) + applied[1] * slip))
    contact, friction = float(np.sum(response.energy)), float(np.sum(response.dissipation))
    removed += -contact_work - (contact - before.contact) - friction

    works = elastic_work + gravity_work + load_work + fixed_work + contact_work
    return Ledger(
        kinetic=kinetic,
        elastic=elastic,
        gravity=before.gravity - gravity_work,
        contact=contact,
        fixed_points=fixed,
        loads=before.loads + load_work + base_work,
        friction=before.friction + friction,
        numerical=before.numerical + removed + (before.kinetic - entering),
        unaccounted=before.unaccounted + inertia_work - works,
    )
