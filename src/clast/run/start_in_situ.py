"""The start of a run under in-situ stress: contact forces that belong to the stress of blocks.

A contact begins with the traction of the mean stress of its two blocks on the length of joint that
it stands for, as its rest force N_0 and as its shear force; no block has to sink or slip first.
For uniform stress that is in balance to the last bit, however the rock is cut.  With weight and a
gradient, or beside openings and slopes, it is not: static solutions, in which nothing is moved,
then take the remainder into the forces and stresses, until they change no more.  A solution is the
minimum of the incremental potential (minimise/), with friction bounded by the forces of the last.
Its contacts are as stiff as the rock, whatever those of the run are: it looks for forces, so that
it does not matter how far blocks would move.  Water and the pretension of bolts that are there from
the start count among the forces: contacts then carry the effective stress, and the pressure of
bolts.

A block that nothing holds, a wedge in the roof of an opening, stays out of balance by its own
weight; all others have their forces beside it.  Such blocks are named, and move from the first
step on.  Where most of the rock is not in balance stress, weight and supports do not belong
together, and the case is refused.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.actions.active import actions_of, states_of
from clast.actions.damping import Undamped
from clast.actions.in_situ import InSituBoundary, tractions
from clast.actions.viscous_edges import BoundaryDashpots
from clast.block import equations, polygon
from clast.block.displacement import basis
from clast.compute.compilation import Stages
from clast.contact.candidates import SearchDistance
from clast.contact.clipped_spring import Springs, merged, springs_of
from clast.contact.contacts import ContactResponse, Contacts, chosen
from clast.contact.coulomb import largest_forces
from clast.contact.joints.bonds import are_closed
from clast.contact.joints.wear import borne_already
from clast.contact.laws import Penalty, has_limits
from clast.contact.memory import renew
from clast.errors import ModelError
from clast.linear.factor_cache import FactorOfStep
from clast.linear.solvers import DIRECTION_TOLERANCE, inexact
from clast.linear.system import BlockSystem, DiagonalTerms, assemble, graph_of, with_contact_forces
from clast.minimise.newton import SolverContext
from clast.minimise.potential import Potential
from clast.minimise.strategy import MinimisationStrategy
from clast.model.model import Bools, Floats, Model
from clast.model.state import State
from clast.step.convex import FrictionLoop, Search
from clast.step.integration import Scheme
from clast.step.method import Method
from clast.step.start import StepContext, begin, diagonal_terms, springs_between

SOLUTIONS_MAX, SEARCHES_MAX = 200, 5
"""Static solutions, for contacts that slip or open shift their load, and searches of contacts."""
FORCE_CHANGE_MAX = 1e-12
"""Force, in units of the largest one, that is none."""
ROUNDING = 1e-6
"""Change, in the same units, that may be rounding if it does not halve any more."""
STALLED = 10
"""Solutions in which it would have to."""
OPEN_FORCE_MAX = 1e-10
"""Force that a solution may leave open, in the same units: the next one goes on from there."""
INERTIA = 1e-9
"""Inertia in the static solutions, in units of the stiffness of contacts: nothing floats away."""
NAMED = 5
"""Blocks that a message names at most."""


@dataclass(frozen=True, kw_only=True)
class Balance:
    """Forces and stresses from solution to solution; nothing has moved."""

    state: State
    """Blocks with their stress, and the own states of actions with the reactions of supports."""
    contacts: Contacts
    """Contacts, with N as their normal force and T as their shear force."""
    capped: int = 0
    """Contacts whose shear force was beyond their strength at first."""


def in_equilibrium(
    model: Model, method: Method, state: State, step: float
) -> tuple[State, tuple[str, ...]]:
    """Return the state with the forces of in-situ stress in its contacts, and the warnings.

    ``step`` is the length of the run's first step, s.  Raises ModelError where stress, weight and
    supports are not in balance.
    """
    stress = model.in_situ
    if stress is None or stress.in_contacts == 0.0:
        return state, ()
    if not has_limits(method.contact_law):
        raise ModelError(
            f"the contact law {type(method.contact_law).__name__} does not support initial "
            "contact forces",
            where="in_situ",
            remedy='use the law "penalty" or "augmented-lagrangian", or contacts = "none"',
        )
    # The model with springs, not dashpots, on its viscous edges: their forces stay.
    edges = model.viscous_edges
    never = np.full(len(edges), np.inf)
    model = replace(model, viscous_edges=replace(edges, begins=never)) if len(edges) else model
    actions = actions_of(model, method.fixed_point_stiffness, method.damping)
    state = replace(state, actions=states_of(actions, model, state))
    balance = _at_first(model, method, state, stress.in_contacts, step)
    before = _unbalanced(model, _equations(model, method, balance, step)).max(initial=0.0)
    for _ in range(SEARCHES_MAX):
        balance = _settled(model, method, balance, step)
        known = replace(balance.state, memory=_begun(model, method, balance).memory)
        contacts = _contacts_of(model, method, known, step)
        if _same(contacts, balance.contacts):
            break
        balance = replace(balance, contacts=contacts)
    force = _unbalanced(model, _equations(model, method, balance, step))
    notes = _notes(float(before), float(force.max(initial=0.0)), balance.capped)
    return _begun(model, method, balance), (*notes, *_loose(model, balance, force))


def _settled(model: Model, method: Method, balance: Balance, step: float) -> Balance:
    """Return the forces and stresses of the static solution: another one changes them no more."""
    factor, changes = FactorOfStep(inexact(method.solver, DIRECTION_TOLERANCE)), [np.inf] * STALLED
    for _ in range(SOLUTIONS_MAX):
        context = _static(model, method, balance.state, step)
        before = balance.contacts
        balance = _shifted(context, balance, _minimum(context, balance, factor))
        after, largest = balance.contacts, _largest(model, balance)
        change = np.abs(after.normal_force - before.normal_force)
        change = np.maximum(change, np.abs(after.shear_force - before.shear_force))
        changes.append(float(change.max(initial=0.0)))
        # beside a block that falls away, far in these equations, rounding is what is left
        stalls = changes[-1] > 0.5 * changes[-1 - STALLED] and changes[-1] <= ROUNDING * largest
        if changes[-1] <= FORCE_CHANGE_MAX * largest or stalls:
            break
    return balance


def _minimum(
    context: StepContext, balance: Balance, factor: FactorOfStep
) -> tuple[Floats, Contacts, ContactResponse]:
    """Return d (n, 6) of a static solution, its contacts, of which bonds may break, and answer."""
    model, law = context.model, Penalty(context.model.stiffest)
    contacts, _ = _bearing(law, balance.contacts)
    # The springs whose forces static solutions change, and those that keep them.
    settles = [hasattr(action, "settled") for action in context.actions]
    both = [
        springs_between(
            [one for one, its in zip(context.contributions, settles, strict=True) if its is k]
        )
        for k in (True, False)
    ]
    yielding, others = () if both[0] is None else (both[0],), both[1]
    springs, (rows, *_) = merged(springs_of(contacts), yielding)
    base = _with_springs(_static_terms(context), others, model.fixed)
    search = Search(
        law=law,
        rows=rows,
        schedule=MinimisationStrategy(),
        friction=FrictionLoop(),
        # by the bound that holds without springs, for which there is nothing but inertia
        tolerance=(OPEN_FORCE_MAX * _largest(model, balance)) ** 2 / (INERTIA * model.stiffest),
        work=SolverContext(factor=factor, counts={}, stages=Stages()),
    )
    potential = Potential.of(base, model.fixed, springs)
    return search.minimum(potential, contacts, (np.zeros((model.block_count, 6)),))


def _at_first(model: Model, method: Method, state: State, share: float, step: float) -> Balance:
    """Return the forces of the mean stress of both blocks on the length of each contact."""
    balance = _of_stress(model, method, state, share, step)
    # which corners meet which edges depends on the contacts in force
    for _ in range(SEARCHES_MAX):
        before = balance.contacts
        known = replace(state, memory=_begun(model, method, balance).memory)
        balance = replace(_of_stress(model, method, known, share, step), state=state)
        if _same(before, balance.contacts):
            break
    return balance


def _static(model: Model, method: Method, state: State, step: float) -> StepContext:
    """Return the context of a static step without damping."""
    return begin(model, replace(method, dynamic_ratio=0.0, damping=Undamped()), state, step, None)


def _same(one: Contacts, other: Contacts) -> bool:
    return np.array_equal(one.vertex, other.vertex) and np.array_equal(one.edge, other.edge)


def _contacts_of(model: Model, method: Method, state: State, step: float) -> Contacts:
    """Return the contacts that carry at a state which does not move.

    Not those of corners that only meet a corner: on which of its edges is a matter of rounding.
    """
    context = _static(model, method, state, step)
    critdis = method.critdis
    reach = SearchDistance(front=critdis, depth=critdis, critdis=critdis)
    contacts = context.contacts(reach, context.drift)
    closed = are_closed(contacts, model, polygon.edges(state.vertices, model.block_start)[0])
    at = state.vertices[contacts.vertex]
    ends = contacts.edge, model.vertex_after[contacts.edge]
    inside = [np.hypot(*(at - state.vertices[end]).T) > critdis for end in ends]
    return chosen(contacts, closed & ((contacts.length > 0.0) | (inside[0] & inside[1])))


def _of_stress(model: Model, method: Method, state: State, share: float, step: float) -> Balance:
    """Return the forces of the mean stress on the contacts with the forces known now."""
    contacts = _contacts_of(model, method, state, step)
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
    """Return the contacts with N, and T as far as they can carry it, (m,) each, N/m."""
    most = largest_forces(contacts, normal)[1]
    return replace(contacts, normal_force=normal, shear_force=np.clip(shear, -most, most))


def _bearing(law: Penalty, contacts: Contacts) -> tuple[Contacts, ContactResponse]:
    """Return the contacts with rest forces that give N at their gaps, and their answer."""
    normal, none = contacts.normal_force, np.zeros(len(contacts))
    held = replace(contacts, friction_base=normal, multiplier=none, rest_force=none)
    stiffness = law.limits(held).normal_stiffness
    # what carries nothing rests where it is, by the rounding of coordinates inside
    gap = np.where(normal != 0.0, contacts.gap, np.minimum(contacts.gap, 0.0))
    held = replace(held, rest_force=normal + stiffness * gap)
    return held, law.respond(held, contacts.gap, none)


def _equations(model: Model, method: Method, balance: Balance, step: float) -> BlockSystem:
    context = _static(model, method, balance.state, step)
    base = _with_springs(_static_terms(context), context.springs, model.fixed)
    contacts, response = _bearing(Penalty(model.stiffest), balance.contacts)
    none = np.zeros(len(contacts))
    return assemble(base, contacts, response, contacts.gap, none, model.fixed)


def _static_terms(context: StepContext) -> DiagonalTerms:
    """Return the static equations of each block; inertia holds otherwise free blocks."""
    model = context.model
    base = diagonal_terms(context, np.zeros_like(context.velocity), Scheme(theta=1.0, step=np.inf))
    # the same for blocks of any size, by which the equations are as well posed for all
    inertia = INERTIA * model.stiffest / model.mass[:, None, None] * context.frames.mass_matrix
    return replace(base, diagonal=base.diagonal + inertia)


def _largest(model: Model, balance: Balance) -> float:
    """Return the largest force that a contact or a block carries, or a block's weight, N/m."""
    in_blocks = np.abs(balance.state.stress).max(axis=1) * np.sqrt(model.area)
    weight = model.mass * float(np.hypot(*model.gravity))
    in_contacts = float(balance.contacts.normal_force.max(initial=0.0))
    return max(in_contacts, float(in_blocks.max()), float(weight.max()), 1e-100)


def _unbalanced(model: Model, system: BlockSystem) -> Floats:
    """Return the force on each block that nothing balances, N/m, shape (n,); 0 on fixed ones."""
    return np.asarray(np.where(model.fixed, 0.0, np.hypot(*system.force[:, :2].T)))


def _with_springs(base: DiagonalTerms, springs: Springs | None, fixed: Bools) -> DiagonalTerms:
    """Return the terms with the forces of springs between blocks, where they are."""
    if springs is None:
        return base
    of_springs, graph = springs.at(springs.gap, springs.slip), graph_of(springs, len(fixed))
    forces = of_springs.normal_force, of_springs.shear_force
    return replace(base, force=with_contact_forces(base.force, springs, graph, fixed, *forces))


def _shifted(
    context: StepContext, balance: Balance, solution: tuple[Floats, Contacts, ContactResponse]
) -> Balance:
    """Return forces and stresses after a static solution, which moves nothing."""
    unknowns, contacts, response = solution
    model, state = context.model, balance.state
    return replace(
        balance,
        contacts=_with_forces(contacts, response.normal_force, response.shear_force),
        state=replace(
            state,
            stress=equations.strained(state.stress, model.elasticity, unknowns),
            points=_stretched(model, state, unknowns),
            actions=_held(context, unknowns),
        ),
    )


def _stretched(model: Model, state: State, unknowns: Floats) -> Floats:
    """Return the points, the fixed ones nanometres off so that springs carry their reactions."""
    fixed, points = model.point_slices.fixed, state.points.copy()
    block = model.fixed_points.block
    if len(block):
        centroid = polygon.moments(state.vertices, model.block_start)[1]
        rows = basis(points[fixed] - centroid[block])
        points[fixed] += np.einsum("kxi,ki->kx", rows, unknowns[block])
    return points


def _held(context: StepContext, unknowns: Floats) -> tuple[Any, ...]:
    """Return the states of actions, the outline's with the reactions of its springs."""
    model, state, centroid = context.model, context.state, context.frames.centroid
    after = []
    for action, one, share in zip(
        context.actions, state.actions, context.contributions, strict=True
    ):
        if isinstance(action, InSituBoundary):
            rows = basis(state.vertices[one.vertex] - centroid[one.block])
            moved = np.einsum("kxi,ki->kx", rows, unknowns[one.block])
            one = replace(one, force=one.force - np.einsum("kxy,ky->kx", one.hold, moved))
        if isinstance(action, BoundaryDashpots):
            one = action.after(model, one, state.vertices, centroid, unknowns)
        if hasattr(action, "settled"):
            one = action.settled(context.at, one, share, unknowns)
        after.append(one)
    return tuple(after)


def _begun(model: Model, method: Method, balance: Balance) -> State:
    state, law = balance.state, method.contact_law
    springs = Penalty(law.normal_stiffness, getattr(law, "shear_stiffness", None))
    contacts, response = _bearing(springs, balance.contacts)
    none = np.zeros(len(contacts))
    wear = borne_already(model.joint_table, contacts, response)
    return replace(
        state,
        memory=renew(contacts, response, contacts.gap, none, method.critdis, wear),
        ledger=replace(state.ledger, contact=float(response.energy.sum())),
    )


def _notes(before: float, after: float, capped: int) -> tuple[str, ...]:
    text = (
        f"in-situ stress: the largest force on a block that nothing balances was {before:.3g} N/m "
        f"with the forces of the stress, and is {after:.3g} N/m at the start"
    )
    slips = (
        f"in-situ stress: {capped} contacts would slip under it; they begin with the strength of "
        "their joints"
    )
    return (text, slips) if capped else (text,)


def _loose(model: Model, balance: Balance, force: Floats) -> tuple[str, ...]:
    """Return which blocks begin to move under unbalanced ``force`` (n,), N/m; raises ModelError."""
    contacts, presses = balance.contacts, model.mass * float(np.hypot(*model.gravity))
    borne = np.hypot(contacts.normal_force, contacts.shear_force)
    np.add.at(presses, contacts.vertex_block, borne)
    np.add.at(presses, contacts.edge_block, borne)
    loose = force > np.maximum(1e-3 * presses, 1e-9 * _largest(model, balance))
    if not loose.any():
        return ()
    worst = np.argsort(-force, kind="stable")[: np.count_nonzero(loose)]
    names = ", ".join(f"'{model.block_name[b]}'" for b in worst[:NAMED])
    more = f" and {len(worst) - NAMED} more" if len(worst) > NAMED else ""
    first = model.block_name[worst[0]]
    text = f"{force[worst[0]]:.3g} N/m on block '{first}' are balanced by nothing"
    free = ~model.fixed
    if model.mass[loose].sum() <= 0.5 * model.mass[free].sum():
        return (f"in-situ stress: nothing holds block {names}{more}: {text}; it begins to move",)
    stress = model.in_situ
    remedies = []
    if stress is not None and model.gravity.any() and not np.any(stress.gradient):
        remedies.append('let the stress grow with depth (vertical = "overburden", or gradient)')
    if stress is not None and stress.held[0] == 0.0:
        remedies.append('hold the outline with boundary = "roller"')
    elif stress is not None and stress.held[1] == 0.0:
        remedies.append('hold the outline along itself too, with boundary = "fixed"')
    if not (model.fixed.any() or len(model.fixed_points.block)):
        remedies.append("fix blocks or sides")
    if stress is not None and stress.sides:
        remedies.append("name the other sides that are loaded, or leave sides out")
    remedies.append(
        "give the joints the strength that holds the rock, or excavate in a later stage"
    )
    raise ModelError(
        f"stress, weight and supports are not in balance: {text}",
        where="in_situ",
        remedy=", ".join(remedies[:-1]) + (" or " if remedies[:-1] else "") + remedies[-1],
    )
