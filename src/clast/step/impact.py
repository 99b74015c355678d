"""Impacts: velocities where a contact closes that carried no force.

No time scheme gives back a wanted share of the closing velocity by a spring: constant acceleration
reflects a stiff contact whatever the step, a soft one rebounds as it likes.  So an impact is an
event.  Blocks fly, as the scheme has them fly, until the first contact closes; there they meet as
rigid bodies, impulses change their velocities, n.v+ >= -e n.v with e the restitution and Coulomb's
friction, and they fly on until the next contact closes (step/collisions.py).  The step's equations
then have the velocities after the impacts and how far they would take each block in the step, its
drift.  Neither the contact's spring nor the step's length plays any part in it, momentum is
exchanged exactly, and the lost energy is known.

Contacts that carry already pass impulses on, as far as these can be felt: a stack that is hit does
not rebound from the springs between its blocks.  Blocks that touch and carry nothing are hit one
after the other (Newton's cradle).

A contact that closes more slowly than its block falls in one step is none of this.  It is its
spring that stops it; but the constant acceleration scheme, v+ = (2/h) d - v, would have blocks at
rest swing for ever on stiff springs.  The motions of a block that such contacts stop are therefore
taken with theta = 1 (step/integration.py): those along their normals, and along edges with
friction, whether they stick or slide: changes with that cost accuracy.  All other motions, and
these in their next step, keep the scheme of the run.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.block.inertia import BlockFrames
from clast.compute.jit import kernel
from clast.compute.reductions import is_any, least
from clast.contact.contacts import Contacts
from clast.contact.joints.along_joint import range_of_springs
from clast.contact.laws import ContactLaw, has_multipliers, normal_stiffness_of
from clast.contact.memory import order_by
from clast.linear.system import Graph, contact_motions, gap_rate, with_contact_forces
from clast.model.model import Bools, Floats, Model
from clast.model.state import State
from clast.read_only import changed
from clast.step import collisions, inertia_projection
from clast.step.integration import HalfWay, Scheme
from clast.step.start import StepContext

IMPACT_SHARE_OF_FASTEST = 1e-4
"""The same in units of the fastest approach, which is all there is without weight."""
EVEN_GAP_SIZES = 1e-5
"""Gap at which a contact strikes along with another of its blocks, in units of the smallest block.

No rock is more even; one that falls flat would else strike with one corner and turn about it.
"""
SQUEEZE_ROUNDS_MAX = 8
"""Times at most that contacts which no impulse stops are left to their springs."""
STOPPING_SPEED_GH = 1e-6
"""Closing velocity of contacts that stop their blocks, in units of g h."""
RESETTING_SPEED_GH = 1.0
"""The same for laws whose multipliers start anew in every step.

Their penetration at rest depends on theta: a block that changes theta is kicked by some hundredths
of g h, which must not count again.
"""


@dataclass(frozen=True, kw_only=True)
class ImpactResult:
    """The result of the impacts of a step for its equations."""

    velocity: Floats
    """Velocity after the impacts, shape (n, 6)."""
    drift: Floats
    """How far the velocities of the step would take the blocks, m, shape (n, 6)."""
    lost: float
    """Kinetic energy lost, J/m."""
    before: tuple[Floats, Floats]
    """How fast contacts open and slip before any impact, m/s, (m,) each."""
    rate: Floats
    """How fast contacts open after them, m/s, shape (m,)."""
    impact: float
    """Closing velocity from which contacts were struck, m/s."""
    fastest: float
    """Largest closing velocity after them, m/s, 0 where none closes."""
    pressed: Bools | None = None
    """Contacts left to their springs beside bodies that are driven, (m,); None without these."""
    driven: Floats | None = None
    """Impulses of bodies with a prescribed motion on bodies they struck, N s/m, (n, 6)."""


def after_impacts(
    context: StepContext, contacts: Contacts, graph: Graph, restitution: float
) -> ImpactResult:
    """Return the result of the impacts of a step that has begun for its equations."""
    model = context.model
    velocity, step, held = context.velocity, context.step, context.held
    if held is not None:
        velocity = held.put(velocity, held.displacement / step)
    before = contact_motions(contacts, velocity)
    rate = before[0]
    fastest = -least(rate, 0.0)
    slow = slowest_impact(model, context.method.contact_law, step)
    impact = max(slow, IMPACT_SHARE_OF_FASTEST * fastest)
    unchanged = ImpactResult(
        velocity=context.velocity,
        drift=context.drift,
        lost=0.0,
        before=before,
        rate=rate,
        impact=impact,
        fastest=fastest,
    )
    # gravity may add g h to what a contact closes by
    if fastest <= 0.0:
        return unchanged
    back = restitutions(model, contacts, restitution)
    even = EVEN_GAP_SIZES * float(np.sqrt(model.smallest))
    carries = (contacts.normal_force > 0.0) | (contacts.tensile_strength > 0.0)
    # one that gives nothing back passes an impulse on as if it were struck right after
    carries |= (back == 0.0) & (contacts.gap <= even) & (rate >= -impact)
    flight, limits = (velocity, flying(context, contacts, graph)), (step, impact, even)
    if held is None:
        return _struck(context, unchanged, contacts, (back, carries), flight, limits)
    pressed = _pressed(context, contacts, rate) & ~carries
    result = _struck(context, unchanged, contacts, (back, carries | pressed), flight, limits)
    for _ in range(SQUEEZE_ROUNDS_MAX):
        # no impulse stops what is squeezed between a body that is driven and one that stands
        moved, _ = contact_motions(contacts, result.drift)
        squeezed = closing(contacts.gap, moved, result.rate, impact) & ~(carries | pressed)
        if result is unchanged or not is_any(squeezed):
            break
        pressed |= squeezed
        result = _struck(context, unchanged, contacts, (back, carries | pressed), flight, limits)
    if result is unchanged:
        return changed(result, pressed=pressed)
    return changed(
        result,
        velocity=held.put(result.velocity, context.velocity),
        drift=held.put(result.drift, context.drift),
        driven=held.driven(context.frames.mass_matrix, velocity, result.velocity),
        pressed=pressed,
    )


def _struck(
    context: StepContext,
    unchanged: ImpactResult,
    contacts: Contacts,
    answers: tuple[Floats, Bools],
    flight: tuple[Floats, Floats],
    limits: tuple[float, float, float],
) -> ImpactResult:
    """Return the result where contacts strike, else ``unchanged``.

    ``answers`` are the restitution of contacts (m,) and which carry (m,), ``flight`` velocities
    (n, 6) and accelerations (n, 2) of the blocks, ``limits`` those of ``impulses.ImpactLimits``.
    """
    model, frames, held = context.model, context.frames, context.held
    restitution, carries = answers
    # of vertices alone: a face that lands does so on its ends
    some = contacts.corners if is_any(contacts.point) else slice(None)
    of_all = contacts.gap, contacts.vertex_block, contacts.edge_block, contacts.arms
    struck: tuple[Any, ...] = tuple(one[some] for one in (*of_all, restitution, contacts.friction))
    carries = carries[some]
    if not collisions.any_strikes(*flight, struck, carries, limits):
        return unchanged
    # An order that no numbering of blocks changes: impulses are found one after the other, and
    # those of many contacts not to the last digit.
    rank, edge = model.vertex_rank, contacts.edge[some]
    ends = rank.take(edge), rank.take(model.vertex_after.take(edge))
    order = order_by(rank.take(contacts.vertex[some]), np.minimum(*ends), np.maximum(*ends))
    struck = tuple(one.take(order, axis=0) for one in struck)
    carries = carries.take(order)
    inertia = mobilities(model, frames, context.state), frames.mass_matrix
    if held is not None:
        inertia = held.heavy(*inertia)
    after, shift, lost = collisions.strike(*flight, *inertia, struck, carries, limits)
    rate = gap_rate(contacts, after)
    return changed(
        unchanged,
        velocity=after,
        drift=context.step * after + shift,
        lost=float(lost),
        rate=rate,
        fastest=-least(rate, 0.0),
    )


def slowest_impact(model: Model, law: ContactLaw, step: float) -> float:
    """Return the closing velocity from which contacts strike, m/s.

    The speed of one step of fall, g h; where the step resolves the contacts that of a block that
    swings about its sag on them, g/w with w^2 = 2 p/m.  A block at rest on soft springs opens and
    closes by less than it sags, and its springs answer that.
    """
    return model.size_of_gravity * _resting(model, law, step)


def _resting(model: Model, law: ContactLaw, step: float) -> float:
    """Return over which time a force speeds up blocks that rest all the same, s."""
    mass = model.lightest
    softest = range_of_springs(model, law.normal_stiffness)[0]
    swings = math.sqrt(mass / (2.0 * softest)) if math.isfinite(mass) else 0.0
    return max(step, swings)


def _pressed(context: StepContext, contacts: Contacts, rate: Floats) -> Bools:
    """Return which contacts (m,) close so slowly that they rest under the pressure on their blocks.

    The limit is g h for blocks that carry their weight, m g = sum of N; for those that are squeezed
    it is the speed that the sum of N on a block gives it in that time (``slowest_impact``).
    """
    model, count = context.model, context.model.block_count
    time = _resting(model, context.method.contact_law, context.step)
    ends = contacts.vertex_block, contacts.edge_block
    force = sum(np.bincount(one, contacts.normal_force, count) for one in ends)
    speed = np.where(model.fixed, np.inf, time * force / model.mass)
    return np.asarray((rate < 0.0) & (rate >= -np.minimum(*(speed[one] for one in ends))))


def restitutions(model: Model, contacts: Contacts, restitution: float) -> Floats:
    """Return the restitution of each contact, shape (m,): its joint's, or the one given."""
    given = model.joint_table.restitutions
    return np.where(np.isnan(given), restitution, given).take(contacts.joint)


def flying(context: StepContext, contacts: Contacts, graph: Graph) -> Floats:
    """Return the acceleration of each block between impacts, m/s2, shape (n, 2).

    It is that of weight, as far as contacts did not carry it at the end of the last step.
    """
    model = context.model
    borne = with_contact_forces(
        np.zeros((model.block_count, 6)),
        contacts,
        graph,
        model.fixed,
        contacts.normal_force,
        contacts.shear_force,
    )
    free: Floats = collisions.flying(borne, model.mass, model.fixed, context.acceleration)
    free[model.fixed_points.block] = 0.0
    return free


def mobilities(model: Model, frames: BlockFrames, state: State) -> Floats:
    """Return the change of the (u, v, r) of each block by an impulse, shape (n, 3, 3).

    A block with a fixed point turns about it, one with several does not move.
    """
    mobility: Floats = collisions.mobilities(frames.mass_matrix, model.fixed)
    block = model.fixed_points.block
    if len(block):
        x, y = (state.points[model.point_slices.fixed] - frames.centroid[block]).T
        turn = np.stack([y, -x, np.ones(len(x))], axis=1)
        about = frames.mass_matrix[block, 2, 2] + model.mass[block] * (x**2 + y**2)
        mobility[block] = np.einsum("ki,kj->kij", turn, turn) / about[:, None, None]
        mobility[np.bincount(block, minlength=model.block_count) > 1] = 0.0
        mobility[model.fixed] = 0.0
    return mobility


def advice_without(model: Model) -> tuple[str, ...]:
    """Say which joints have a restitution, for processes that know of none."""
    named = [one.name for one in model.joint_table.joints if one.restitution is not None]
    if not named:
        return ()
    return (
        f"restitution of joint {', '.join(map(repr, named))} plays no part: impacts rebound "
        'from the contact springs. Use process = "convex".',
    )


def scheme_of(
    context: StepContext,
    contacts: Contacts,
    graph: Graph,
    impacts: ImpactResult,
    taken: HalfWay | None,
    slope: Floats | None,
) -> Scheme:
    """Return how the blocks take a step: where contacts close that stop them with theta = 1.

    Contacts whose forces are ``taken`` half way stop nothing.  ``slope`` (m,) is by how much
    contacts open by their slip; None: it is known only when the step is over.
    """
    model, scheme = context.model, context.scheme
    law = context.method.contact_law
    resets = has_multipliers(law) and not law.carries
    slowest = RESETTING_SPEED_GH if resets else STOPPING_SPEED_GH
    threshold = slowest * model.size_of_gravity * context.step
    rate, fastest = impacts.rate, impacts.fastest
    if slope is not None:
        rate = rate - slope * contact_motions(contacts, impacts.velocity)[1]
    elif model.joint_table.opens:
        rate = rate - opening_rate(context, contacts)
    if model.joint_table.opens:
        fastest = float(-rate.min(initial=0.0))
    if scheme.theta == 1.0 or not fastest > threshold:
        return scheme
    moved, slips = contact_motions(contacts, impacts.drift)
    if slope is not None:
        moved = moved - slope * slips
    closes = closing(contacts.gap, moved, rate, threshold)
    if taken is not None:
        closes &= ~taken.bearing(contacts)
    if not is_any(closes):
        return scheme
    carries = closes | (contacts.normal_force > 0.0)
    stopped = inertia_projection.stopped_blocks(
        context.frames.mass_matrix,
        model.fixed,
        graph,
        (contacts.vertex_block, contacts.arms),
        (closes, carries, carries & (contacts.friction > 0.0)),
    )
    if context.held is not None:
        stopped = context.held.unstopped(stopped)
    return changed(scheme, stopped=stopped)


def opening_rate(context: StepContext, contacts: Contacts) -> Floats:
    """Return how fast joints open as they slide, m/s, shape (m,), of contacts that carry.

    By how much more their springs are pressed than when the last step ended.
    """
    law, table = context.method.contact_law, context.model.joint_table
    opens = table.dilates.take(contacts.joint) & (contacts.normal_force > 0.0)
    if has_multipliers(law):
        opens &= ~np.isnan(contacts.normal_stiffness)
    pressed = contacts.rest_force - normal_stiffness_of(contacts, law) * contacts.gap
    opened = (pressed - contacts.normal_force) / normal_stiffness_of(contacts, law)
    return np.where(opens, np.maximum(0.0, opened), 0.0) / context.step


def bearing(contacts: Contacts, impacts: ImpactResult, normal_force: Floats) -> Floats:
    """Return the normal forces (m,), N/m, by which contacts carry in the next step.

    None where a contact strikes only then, and has closed by a hair before: the equations know of
    more than the approach does.
    """
    if not impacts.fastest > impacts.impact:
        return normal_force
    early = (contacts.normal_force == 0.0) & (impacts.rate < -impacts.impact)
    if impacts.pressed is not None:
        early &= ~impacts.pressed
    return np.where(early, 0.0, normal_force)


@kernel()
def closing(gap, moved, rate, threshold):
    """Return which contacts (m,) close faster than ``threshold``, m/s, and within the step.

    ``gap`` (m,), m, and its ``rate`` (m,), m/s, are those at the start; ``moved`` (m,), m, is the
    change of the gap by velocities in the step.
    """
    closes = np.empty(len(gap), np.bool_)
    for c in range(len(gap)):
        closes[c] = (rate[c] < -threshold) & (gap[c] + moved[c] < 0.0)
    return closes


@kernel()
def first_bases(normal_force, gap, rates, slow, landing, step, begins, largest):
    """Return the normal forces (m,), N/m, that bound friction at first (step/convex.py).

    That of the last step where there was any; else ``largest`` where a contact lands without
    slipping or, where the run ``begins``, is without slipping; else none.  It slips at more than
    ``slow``, m/s, and lands where it closes faster than ``landing``, m/s, and within the step.
    """
    opening, slip = rates
    base = np.empty(len(gap))
    for c in range(len(gap)):
        lands = (opening[c] < -landing) & (gap[c] + step * opening[c] < 0.0)
        holds = (abs(slip[c]) <= slow) & (lands | begins)
        base[c] = normal_force[c] if normal_force[c] > 0.0 else largest if holds else 0.0
    return base
