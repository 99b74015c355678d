"""The start of a run under in-situ stress: contacts bear what belongs to the stress of blocks.

A contact begins with the traction of the mean stress of its two blocks on the length of joint that
it stands for, as its rest force N_0 and as its shear force; no block has to sink or slip first.
For uniform stress that is in balance to the last bit, however the rock is cut.  With weight and a
gradient blocks of constant stress are not: a static solution, in which nothing is moved, then takes
what is left into the forces and stresses.  Its contacts are as stiff as the rock, whatever those of
the run are: what it is after are forces.  Water and the pretension of bolts that are there from the
start count among what acts: contacts then bear the effective stress, and what bolts press on them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.actions.acting import actions_of, own_states
from clast.actions.damping import Undamped
from clast.actions.in_situ import Outline, tractions
from clast.actions.viscous_edges import ViscousBoundary
from clast.block import elasticity, polygon
from clast.block.displacement import basis
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.coulomb import largest_forces
from clast.contact.laws import Penalty, has_limits
from clast.contact.memory import renew
from clast.errors import ModelError
from clast.linear.solvers import solve
from clast.linear.system import (
    BlockSystem,
    DiagonalTerms,
    assemble,
    contact_motions,
    graph_of,
    with_contact_forces,
)
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.step.integration import Scheme
from clast.step.method import Method
from clast.step.start import Begun, begin, diagonal_terms
from clast.step.travel import search_within_step, travel_expected

SOLUTIONS = 30
"""Static solutions at most: contacts that slip or open shift their load to others."""
BALANCED = 1e-12
"""Force on a block, in units of the largest contact force, that is none."""
LOOKS = 5
"""Looks for contacts at most."""
RESTING = 1e-9
"""Inertia in the static solutions, in units of the stiffness of contacts: nothing floats away."""
FAR = 1e-2
"""Displacement, as a share of the smallest block's size, beyond which nothing is in balance."""


@dataclass(frozen=True, kw_only=True)
class Balance:
    """Forces and stresses on the way to equilibrium; nothing has moved."""

    state: State
    """Blocks with their stress, and the own states of actions with what supports bear."""
    contacts: Contacts
    """Contacts, with N as their normal force and T as their shear force."""
    capped: int = 0
    """Contacts whose shear force was beyond their strength at first."""


def in_equilibrium(
    model: Model, method: Method, state: State, step: float
) -> tuple[State, tuple[str, ...]]:
    """Return the state with the forces of in-situ stress in its contacts, and what is to be said.

    ``step`` is the length of the run's first step, s.  Raises ModelError where stress, weight and
    supports are not in balance.
    """
    stress = model.in_situ
    if stress is None or stress.in_contacts == 0.0:
        return state, ()
    if not has_limits(method.contact_law):
        raise ModelError(
            f"the contact law {type(method.contact_law).__name__} knows of no forces at the start",
            where="in_situ",
            remedy='use the law "penalty" or "augmented-lagrangian", or contacts = "none"',
        )
    model = _held_fast(model)
    actions = actions_of(model, method.fixed_point_stiffness, method.damping)
    state = replace(state, actions=own_states(actions, model, state))
    balance = _at_first(model, method, state, stress.in_contacts, step)
    left: list[float] = []
    while True:
        system = _equations(model, method, balance, step)
        left.append(float(np.hypot(*system.force[~model.fixed, :2].T).max(initial=0.0)))
        enough = BALANCED * float(balance.contacts.normal_force.max(initial=0.0))
        if left[-1] <= enough or len(left) > SOLUTIONS:
            return _begun(method, balance), _said(left[0], left[-1], balance.capped)
        balance = _shifted(model, method, balance, solve(method.solver, system))


def _held_fast(model: Model) -> Model:
    """Return the model with springs, not dashpots, on its viscous edges: what they bear stays."""
    edges = model.viscous_edges
    never = np.full(len(edges), np.inf)
    return replace(model, viscous_edges=replace(edges, begins=never)) if len(edges) else model


def _still(method: Method) -> Method:
    """Return the method of what does not move."""
    return replace(method, dynamic_ratio=0.0, damping=Undamped())


def _at_first(model: Model, method: Method, state: State, share: float, step: float) -> Balance:
    """Return the forces of the mean stress of both blocks on the length of each contact.

    Which corners meet which edges depends on what bears already; so it is looked for again with
    the forces that the first look gives.
    """
    bearing = _of_stress(model, method, state, share, step)
    for _ in range(LOOKS):
        before = bearing.contacts
        known = replace(state, memory=_begun(method, bearing).memory)
        bearing = replace(_of_stress(model, method, known, share, step), state=state)
        after = bearing.contacts
        if np.array_equal(before.vertex, after.vertex) and np.array_equal(before.edge, after.edge):
            break
    return bearing


def _of_stress(model: Model, method: Method, state: State, share: float, step: float) -> Balance:
    """Return the forces of the mean stress on the contacts that there are with what bears."""
    begun = begin(model, _still(method), state, step, None)
    contacts = begun.contacts(search_within_step(method, travel_expected(begun)), begun.drift)
    mean = 0.5 * (state.stress[contacts.vertex_block] + state.stress[contacts.edge_block])
    force = share * contacts.length[:, None] * tractions(mean, contacts.normal)
    along = np.stack([-contacts.normal[:, 1], contacts.normal[:, 0]], axis=1)
    # sigma n is what the vertex's block pulls the edge's with: compression presses them together
    normal = np.maximum(0.0, -np.einsum("cx,cx->c", force, contacts.normal))
    shear = -np.einsum("cx,cx->c", force, along)
    most = largest_forces(contacts, normal)[1]
    return Balance(
        state=state,
        contacts=_with_forces(contacts, normal, shear),
        capped=int(np.count_nonzero(np.abs(shear) > most * (1.0 + 1e-9))),
    )


def _with_forces(contacts: Contacts, normal: Floats, shear: Floats) -> Contacts:
    """Return the contacts with N, and T as far as they can bear it, (m,) each, N/m."""
    most = largest_forces(contacts, normal)[1]
    return replace(contacts, normal_force=normal, shear_force=np.clip(shear, -most, most))


def _bearing(law: Penalty, contacts: Contacts) -> tuple[Contacts, ContactResponse]:
    """Return the contacts with rest forces by which they bear N at their gaps, and their answer."""
    normal, none = contacts.normal_force, np.zeros(len(contacts))
    held = replace(contacts, friction_base=normal, multiplier=none, rest_force=none)
    stiffness = law.limits(held).normal_stiffness
    # what bears nothing rests where it is, by the rounding of coordinates inside
    gap = np.where(normal > 0.0, contacts.gap, np.minimum(contacts.gap, 0.0))
    held = replace(held, rest_force=normal + stiffness * gap)
    return held, law.respond(held, contacts.gap, none)


def _equations(model: Model, method: Method, balance: Balance, step: float) -> BlockSystem:
    """Return the static equations: their right-hand side is what is out of balance."""
    begun = begin(model, _still(method), balance.state, step, None)
    long = float(np.sqrt(model.mass.max() / (RESTING * model.stiffest)))
    base = diagonal_terms(begun, np.zeros_like(begun.velocity), Scheme(theta=1.0, step=long))
    base = _with_springs(base, begun)
    contacts, response = _bearing(Penalty(model.stiffest), balance.contacts)
    none = np.zeros(len(contacts))
    return assemble(base, contacts, response, contacts.gap, none, model.fixed)


def _with_springs(base: DiagonalTerms, begun: Begun) -> DiagonalTerms:
    """Return the terms with the forces of springs between blocks, of bolts above all.

    Nothing moves in the static solution, so they bear what they were installed with.
    """
    springs, fixed = begun.springs, begun.model.fixed
    if springs is None:
        return base
    bear, graph = springs.at(springs.gap, springs.slip), graph_of(springs, len(fixed))
    forces = bear.normal_force, bear.shear_force
    return replace(base, force=with_contact_forces(base.force, springs, graph, fixed, *forces))


def _shifted(model: Model, method: Method, balance: Balance, unknowns: Floats) -> Balance:
    """Return forces and stresses after d (n, 6), which moves nothing."""
    size = float(np.sqrt(model.area.min()))
    far = np.hypot(unknowns[:, 0], unknowns[:, 1])
    if not far.max() <= FAR * size:
        worst = int(np.argmax(np.where(np.isfinite(far), far, np.inf)))
        raise ModelError(
            f"stress, weight and supports are not in balance: block '{model.block_name[worst]}' "
            f"would have to move by {far[worst]:.3g} m",
            where="in_situ",
            remedy='let the gradient be that of the weight (vertical = "overburden"), hold the '
            'outline with boundary = "roller", or say which sides are loaded',
        )
    state = balance.state
    contacts, found = _bearing(Penalty(model.stiffest), balance.contacts)
    opening, slip = contact_motions(contacts, unknowns)
    normal = np.maximum(0.0, found.normal_force - found.normal_stiffness * opening)
    shear = found.shear_force - found.shear_stiffness * slip
    return replace(
        balance,
        contacts=_with_forces(contacts, normal, shear),
        state=replace(
            state,
            stress=elasticity.strained(state.stress, model.elasticity, unknowns),
            points=_stretched(model, state, unknowns),
            actions=_held(model, method, state, unknowns),
        ),
    )


def _stretched(model: Model, state: State, unknowns: Floats) -> Floats:
    """Return the points with the fixed ones where their springs bear what they have to.

    Some nanometres off their place in the block, which stays.
    """
    fixed, points = model.point_slices.fixed, state.points.copy()
    block = model.fixed_points.block
    if len(block):
        centroid = _centroids(model, state)
        rows = basis(points[fixed] - centroid[block])
        points[fixed] += np.einsum("kxi,ki->kx", rows, unknowns[block])
    return points


def _held(model: Model, method: Method, state: State, unknowns: Floats) -> tuple[Any, ...]:
    """Return the own states of actions, the outline's with what its springs have to bear."""
    actions = actions_of(model, method.fixed_point_stiffness, method.damping)
    centroid = _centroids(model, state)
    found = []
    for action, own in zip(actions, state.actions, strict=True):
        if isinstance(action, Outline):
            rows = basis(state.vertices[own.vertex] - centroid[own.block])
            moved = np.einsum("kxi,ki->kx", rows, unknowns[own.block])
            own = replace(own, force=own.force - np.einsum("kxy,ky->kx", own.hold, moved))
        if isinstance(action, ViscousBoundary):
            own = action.after(model, own, state.vertices, centroid, unknowns)
        found.append(own)
    return tuple(found)


def _centroids(model: Model, state: State) -> Floats:
    return polygon.moments(state.vertices, model.block_start)[1]


def _begun(method: Method, balance: Balance) -> State:
    """Return the state with the contacts in its memory, and in its ledger what they hold."""
    state, law = balance.state, method.contact_law
    springs = Penalty(law.normal_stiffness, getattr(law, "shear_stiffness", None))
    contacts, response = _bearing(springs, balance.contacts)
    return replace(
        state,
        memory=renew(contacts, response, contacts.gap, method.critdis),
        ledger=replace(state.ledger, contact=float(response.energy.sum())),
    )


def _said(before: float, after: float, capped: int) -> tuple[str, ...]:
    """Return how far from balance the forces were, and which were beyond a joint's strength."""
    text = (
        f"in-situ stress: the largest force on a block that nothing balances was {before:.3g} N/m "
        f"with the forces of the stress, and is {after:.3g} N/m at the start"
    )
    if not capped:
        return (text,)
    return text, (
        f"in-situ stress: {capped} contacts would slip under it; they begin with what their joints "
        "bear"
    )
