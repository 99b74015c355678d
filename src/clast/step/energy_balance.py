"""The energy ledger: the work of each kind of force in a step, measured term by term.

For unknowns d, every force of the step's equations does the work F.d at its end-of-step value, or
at that of its middle where the scheme has forces taken there.  Where that differs from the change
of the energy that the force stores, the difference is the energy that the time integration removed.
Kinetic energy is compared with the inertia terms of the scheme, so ``unaccounted`` is the residual
of the solved equations: it is measured, not made to vanish.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.actions.action import NOTHING, Solution
from clast.actions.active import result_of
from clast.block.inertia import block_frames
from clast.compute.jit import kernel
from clast.compute.mat6 import times
from clast.compute.parallel import Sharing, shared
from clast.compute.reductions import CHUNK, PART, largest_size
from clast.compute.vec6 import inner, row
from clast.contact.contacts import Contacts
from clast.contact.joints.along_joint import range_of_springs
from clast.model.model import Floats, Model
from clast.model.state import Ledger, State
from clast.read_only import changed
from clast.step.method import Method, StepSolution
from clast.step.prescribed import DrivenBlocks
from clast.step.start import StepContext

FINEST = 4.0 * float(np.finfo(float).eps)
"""Rounding of coordinates, as a share of the largest."""


def opening(model: Model, state: State) -> Ledger:
    """Return the ledger of a state at the start of a run: its stored energy."""
    frames = block_frames(model, state)
    energies = energies_of_blocks(  # those of a step in which nothing moves
        (np.zeros_like(state.velocity), state.velocity, state.velocity),
        (frames.mass_matrix, 1.0),
        (state.stress, state.stress, state.stress),
        (model.area, model.compliance),
    )
    contact = state.ledger.contact
    return Ledger(kinetic=float(energies[0]), elastic=float(energies[3]), contact=contact)


def created(ledger: Ledger, first: Ledger) -> float:
    """Return the energy, J/m, held beyond that of the start and the loads (negative: lost)."""
    held = ledger.stored + ledger.removed + ledger.boundary
    return held - ledger.brought - first.stored


def round_off(model: Model, method: Method, state: State, contacts: int) -> float:
    """Return the energy, J/m, of so many contacts that penetrate by the rounding of coordinates.

    Where nothing acts at all there is no other energy to compare with.
    """
    stiffest = range_of_springs(model, method.contact_law.normal_stiffness)[1]
    return contacts * stiffest * _finest(state) ** 2


def noise_of(model: Model, method: Method, state: State) -> float:
    """Return the force of the stiffest spring by the rounding of coordinates, N/m."""
    return _finest(state) * range_of_springs(model, method.contact_law.normal_stiffness)[1]


def _finest(state: State) -> float:
    """Return the rounding of coordinates, m."""
    return FINEST * float(largest_size(state.vertices.ravel()))


def with_overlap(ledger: Ledger, method: Method, contacts: Contacts) -> Ledger:
    """Return the ledger at the start of a run with the energy of contacts there, J/m.

    ``contacts`` are those of the first step; coordinates are rounded, blocks may be wedged in,
    bonds reach over gaps, and there may be forces of in-situ stress.
    """
    at_start = method.contact_law.respond(contacts, contacts.gap, np.zeros(len(contacts)))
    held = float(at_start.energy.sum())
    return replace(ledger, contact=held)


def tolerated(model: Model, ledger: Ledger, first: Ledger) -> float:
    """Return the created energy, J/m, above which a run is called unstable.

    Impacts of the constant acceleration scheme return a little too much energy now and then, so
    this is a wide bound: the energy that lifts every block by a twentieth of its size, or doubles
    the first one.
    """
    size = np.sqrt(model.area[~model.fixed])
    weight = model.mass[~model.fixed] * np.hypot(*model.gravity)
    return 0.05 * float(np.sum(weight * size)) + first.stored + abs(ledger.brought)


@dataclass(frozen=True, kw_only=True)
class StepEnd:
    """The end of a step, in directions of its start."""

    velocity: Floats
    """Velocity, shape (n, 6)."""
    stress: Floats
    """Stress, Pa, shape (n, 3)."""
    forces_at: float = 1.0
    """Where in the step the stress acted, 1 at its end."""
    gap: Floats
    """Gap of each contact, m, shape (m,)."""
    slip: Floats
    """Slip of each contact in the step, m, shape (m,)."""

    def acted_from(self, before: Floats) -> Floats:
        """Return the stress (n, 3) of the equations, Pa; ``before`` (n, 3) is that of the start."""
        if self.forces_at == 1.0:
            return self.stress
        return before + self.forces_at * (self.stress - before)


def balance(
    context: StepContext,
    solution: StepSolution,
    end: StepEnd,
    points: Floats,
    holding: Floats,
) -> tuple[Ledger, tuple[Any, ...]]:
    """Return the ledger at the end of a step, and the own state of each action.

    ``points`` (np, 2), m, are the material points there; ``holding`` (n, 3) is the force of
    prescribed motions (``Solution``).
    """
    ledger = _with_blocks_and_contacts(context, solution, end)
    of_actions = Solution(
        displacement=solution.unknowns,
        points=points,
        linearised_at=solution.linearised_at,
        velocity=solution.velocity,
        gained=end.velocity - solution.velocity,
        holding=holding,
    )
    numerical, unaccounted = ledger.numerical, ledger.unaccounted
    results = [
        result_of(action, context.at, mine, share, of_actions)
        for action, mine, share in zip(
            context.actions, context.action_states, context.contributions, strict=True
        )
    ]
    with_work = [done for done in results if done is not NOTHING]
    changes = [done.ledger for done in with_work]
    for done, change in zip(with_work, changes, strict=True):
        removed = change.brought - done.work - change.stored - change.lost
        numerical = numerical + change.numerical + removed
        unaccounted = unaccounted + change.unaccounted - done.work
    if context.held is not None:
        carried = math.prod([one.carried for one in context.contributions])
        energy, shock = _of_driven(context, end, context.held)
        undamped = (1.0 - carried**2) * energy
        changes.append(Ledger(damping=-undamped, motions=-shock))
        numerical += undamped - shock
    ledger = ledger.plus(*changes)
    states = tuple([one.state for one in results])
    return changed(ledger, numerical=numerical, unaccounted=unaccounted), states


def _of_driven(context: StepContext, end: StepEnd, held: DrivenBlocks) -> tuple[float, float]:
    """Return the kinetic energy of prescribed motions, J/m, and the work of steps beyond it.

    No damping takes that energy.  A jump of the velocity is the impulse M (v+ - v), done at the
    mean of both: (v + v+)/2 in place of the velocity D/h of the step.
    """
    mass, nothing = context.frames.mass_matrix, np.zeros_like(context.velocity)
    moving = np.where(held.components, context.state.velocity, 0.0)
    energy = 0.5 * float(np.sum(moving * np.einsum("nij,nj->ni", mass, moving)))
    before, after = (held.put(nothing, v) for v in (context.velocity, end.velocity))
    impulse = np.einsum("nij,nj->ni", mass, after - before)
    ahead = held.displacement - 0.5 * context.step * (before + after)
    return energy, float(np.sum(impulse * ahead)) / context.step


def _with_blocks_and_contacts(context: StepContext, solution: StepSolution, end: StepEnd) -> Ledger:
    """Return the ledger with the work of inertia, elasticity, impacts and contacts."""
    before, model = context.state.ledger, context.model
    of_blocks = energies_of_blocks(
        (solution.unknowns, solution.velocity, end.velocity),
        (context.frames.mass_matrix, context.step),
        (context.state.stress, end.acted_from(context.state.stress), end.stress),
        (model.area, model.compliance),
    )
    entering, kinetic, inertia_work = map(float, of_blocks[:3])
    elastic_before, elastic, elastic_work = map(float, of_blocks[3:])
    removed = inertia_work - (kinetic - entering) - elastic_work - (elastic - elastic_before)
    of_contacts = energies_of_contacts(
        solution.applied,
        (solution.contacts.gap, end.gap),
        end.slip,
        (solution.response.energy, solution.response.dissipation),
    )
    contact_work, contact, friction = map(float, of_contacts)
    removed += -contact_work - (contact - before.contact) - friction
    driven = 0.0
    if solution.driven is not None and context.held is not None:
        # what bodies that are driven have brought into impacts
        driven = float(np.sum(solution.driven * context.held.displacement)) / context.step
    return changed(
        before,
        kinetic=kinetic,
        elastic=elastic,
        contact=contact,
        friction=before.friction + friction,
        impacts=before.impacts + solution.lost,
        motions=before.motions + driven,
        numerical=before.numerical + removed + (before.kinetic - entering) - solution.lost + driven,
        unaccounted=before.unaccounted + inertia_work - elastic_work - contact_work,
    )


@kernel()
def _kinetic(b, mass_matrix, v):
    """Return 1/2 v.M v of block b, J/m."""
    return 0.5 * inner(times(mass_matrix, b, v, b), row(v, b))


@kernel()
def _strain_energy(b, area, compliance, stress):
    """Return 1/2 A sigma.E'^-1 sigma of block b, J/m."""
    energy = 0.0
    for i in range(3):
        for j in range(3):
            energy += stress[b, i] * compliance[b, i, j] * stress[b, j]
    return 0.5 * area[b] * energy


@shared(Sharing(part=CHUNK, many=1))
def _of_chunks(first, last, motion, inertia, stresses, elastic, sums):
    """Add up the energies and works of the chunk of blocks ``first`` to ``last`` - 1 in its sums.

    A chunk without blocks has none.
    """
    if last <= first:
        return
    s = sums[first // CHUNK]
    d, entering, leaving = motion
    mass_matrix, step = inertia
    before, acting, after = stresses
    area, compliance = elastic
    force = np.empty((1, 6))
    for b in range(first, last):
        s[0] += _kinetic(b, mass_matrix, entering)
        s[1] += _kinetic(b, mass_matrix, leaving)
        for k in range(6):
            force[0, k] = (leaving[b, k] - entering[b, k]) / step
        s[2] += inner(times(mass_matrix, b, force, 0), row(d, b))
        s[3] += _strain_energy(b, area, compliance, before)
        s[4] += _strain_energy(b, area, compliance, after)
        for k in range(3):
            s[5] -= area[b] * acting[b, k] * d[b, 3 + k]


@kernel()
def energies_of_blocks(motion, inertia, stresses, elastic):
    """Return energies and works of the blocks in a step, J/m, shape (6,).

    Kinetic energy that entered and that left, work on inertia; elastic energy before and after,
    work on the elastic terms.  Sums of many numbers keep their digits where parts of them are
    summed up first.

    ``motion``: d and the velocities that entered and left, (n, 6) each.  ``inertia``: mass matrix
    (n, 6, 6) and h.  ``stresses``: before the step, in its equations and after it, unturned, Pa,
    (n, 3) each.
    ``elastic``: area (n,) and compliance (n, 3, 3).
    """
    area = elastic[0]
    sums = np.zeros(((len(area) + CHUNK - 1) // CHUNK, 6))
    _of_chunks(len(area), motion, inertia, stresses, elastic, sums)
    result = np.zeros(6)
    for part in sums:
        result += part
    return result


@kernel()
def energies_of_contacts(forces, gaps, slip, stored):
    """Return the work of contact forces, J/m, and the sums of ``stored`` energy, shape (3,).

    ``forces``: normal and shear, N/m; ``gaps``: at the start and the end, m; ``slip``, m;
    ``stored``: energy and dissipation, J/m; (m,) each.
    """
    normal, shear = forces
    start, end = gaps
    energy, dissipation = stored
    sums = np.zeros(((len(slip) + PART - 1) // PART, 3))
    for c in range(len(slip)):
        s = sums[c // PART]
        s[0] += normal[c] * (end[c] - start[c]) + shear[c] * slip[c]
        s[1] += energy[c]
        s[2] += dissipation[c]
    result = np.zeros(3)
    for part in sums:
        result += part
    return result
