"""Impulses in contacts that strike together: normal ones that only push, shear within friction.

Impulse by impulse is renewed from its target (projected Gauss-Seidel).  That alone is slow where
impulses run along rows of blocks, so the changes that renewals make are taken as gradients, and
impulses go on along conjugate directions (Silcowitz-Hansen, Niebuhr and Erleben 2010, "A nonsmooth
nonlinear conjugate gradient method for interactive contact force problems").
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clast.compute.jit import kernel
from clast.compute.vec6 import numbers
from clast.contact.jacobian import force_on
from clast.model.model import Bools, Floats, Ints


class Bodies(NamedTuple):
    """Blocks of a step with impacts."""

    velocity: Floats
    """Velocities now, shape (n, 6)."""
    before: Floats
    """Velocities before the impact, shape (n, 6)."""
    shift: Floats
    """How far they are from where they were without impacts, m, shape (n, 6)."""
    last: Floats
    """Time of their last impact, s, shape (n,)."""
    acceleration: Floats
    """Accelerations, m/s2, shape (n, 2)."""
    mobility: Floats
    """Change of (u, v, r) by an impulse, shape (n, 3, 3)."""
    mass_matrix: Floats
    """Mass matrices, shape (n, 6, 6)."""


class Closing(NamedTuple):
    """Contacts that may close in a step."""

    gap: Floats
    """Gaps at its start, m, shape (m,)."""
    vertex_block: Ints
    """Block of the vertex, shape (m,)."""
    edge_block: Ints
    """Block of the edge, shape (m,)."""
    arms: Floats
    """Normal and moment arms (contact/jacobian.py), shape (m, 6)."""
    restitution: Floats
    """Restitution, shape (m,)."""
    friction: Floats
    """tan(phi), shape (m,)."""


class Strikes(NamedTuple):
    """When contacts strike, and how often they have."""

    moment: Floats
    """Moment at which a contact strikes, s, infinity if it does not, shape (m,)."""
    carries: Bools
    """True where it carries, shape (m,)."""
    hits: Ints
    """How often it has struck, shape (m,)."""
    waiting: Ints
    """Contacts that may wait to strike, the first ``number[0]`` of (m,)."""
    waits: Bools
    """True for those, shape (m,)."""
    number: Ints
    """How many there are, shape (1,)."""


class ContactsOfBlocks(NamedTuple):
    """Contacts of each block."""

    start: Ints
    """Where those of each block begin, shape (n + 1,)."""
    listed: Ints
    """The contacts, block by block."""


class ImpactLimits(NamedTuple):
    """Limits of the impacts of a step."""

    step: float
    """Length of the step, s."""
    threshold: float
    """Closing velocity from which contacts strike, m/s."""
    even: float
    """Gap at which a contact strikes along with another of its blocks, m."""


class ImpulseEquations(NamedTuple):
    """Equations of the impulses in contacts, one after the other in a list (k,)."""

    ends: Ints
    """Their two blocks, shape (k, 2)."""
    rows: Floats
    """By how much the velocities (u, v, r) of these lower the impulse along the normal and along
    the edge that brings the contact to rest, N s/m per m/s, shape (k, 2, 6)."""
    effects: Floats
    """How a unit impulse changes these velocities, shape (k, 2, 6)."""
    goal: Floats
    """The impulse that would do where the blocks stand still, N s/m, shape (k, 2)."""
    ease: Floats
    """Change of velocity along a unit impulse, m/s per N s/m, shape (k, 2)."""
    coupling: Floats
    """By how much a unit impulse along the normal lowers that along the edge, shape (k,)."""
    friction: Floats
    """tan(phi), shape (k,)."""


class ImpulseCourse(NamedTuple):
    """The course of the impulses of a list of contacts."""

    impulses: Floats
    """Impulses, N s/m, shape (k, 2)."""
    made: Floats
    """How much the last renewal has changed them, shape (k, 2)."""
    advance: Floats
    """How far they went on before that, shape (k, 2)."""


class ImpactGroup(NamedTuple):
    """Contacts and blocks that take part in one impact."""

    members: Ints
    """The contacts, as many as ``counts`` says of (m,)."""
    place: Ints
    """Place of each contact in that list, -1 if none, shape (m,)."""
    targets: Floats
    """Opening velocity they are to leave with at least, m/s, shape (m,)."""
    linear: ImpulseEquations
    """Equations of their impulses."""
    course: ImpulseCourse
    """The course of these."""
    blocks: Ints
    """The blocks, as many as ``counts`` says of (n,)."""
    among: Bools
    """True for those, shape (n,)."""
    counts: Ints
    """How many contacts and blocks, and how many impulses may still be renewed, shape (3,)."""


@kernel()
def room_for(count):
    """Return room for the equations of ``count`` impulses and for their course."""
    linear = ImpulseEquations(
        np.empty((count, 2), np.int64),
        np.empty((count, 2, 6)),
        np.empty((count, 2, 6)),
        np.empty((count, 2)),
        np.empty((count, 2)),
        np.empty(count),
        np.empty(count),
    )
    return linear, ImpulseCourse(np.empty((count, 2)), np.empty((count, 2)), np.empty((count, 2)))


@kernel(forceinline=True)
def _along(at, k, rows, i, j, velocity):
    """Return how the motion of its blocks i and j moves contact ``at`` along k."""
    rate = 0.0
    for a in range(3):
        rate += rows[at, k, a] * velocity[i, a] + rows[at, k, 3 + a] * velocity[j, a]
    return rate


@kernel(forceinline=True)
def _respond(at, k, side, b, mobility, force, linear):
    """Write how block b of contact ``at`` moves it along k and is moved by a unit impulse."""
    rows, effects, ease = linear.rows, linear.effects, linear.ease
    f0, f1, f2, _, _, _ = numbers(force)
    w, first = mobility[b], 3 * side
    rows[at, k, first], rows[at, k, first + 1], rows[at, k, first + 2] = f0, f1, f2
    for a in range(3):
        effects[at, k, first + a] = w[a, 0] * f0 + w[a, 1] * f1 + w[a, 2] * f2
        ease[at, k] += rows[at, k, first + a] * effects[at, k, first + a]


@kernel()
def describe(at, c, rates, target, velocity, mobility, contacts, linear):
    """Write contact c as contact ``at`` of the list.

    It opens and slips with ``rates``, m/s, where its blocks move with ``velocity`` (n, 6), and is
    to open with ``target``, m/s, at least and not to slip.
    """
    ends, rows, effects = linear.ends, linear.rows, linear.effects
    goal, ease, coupling = linear.goal, linear.ease, linear.coupling
    friction = linear.friction
    vertex_block, edge_block, arms = contacts.vertex_block, contacts.edge_block, contacts.arms
    tangents = contacts.friction
    i, j = vertex_block[c], edge_block[c]
    ends[at, 0], ends[at, 1], friction[at] = i, j, tangents[c]
    for k in range(2):
        normal, shear = 1.0 - k, 1.0 * k
        ease[at, k] = 0.0
        _respond(at, k, 0, i, mobility, force_on(arms, c, True, normal, shear), linear)
        _respond(at, k, 1, j, mobility, force_on(arms, c, False, normal, shear), linear)
        goal[at, k] = _along(at, k, rows, i, j, velocity) - rates[k]
    goal[at, 0] += target
    coupling[at] = 0.0
    for a in range(6):
        coupling[at] += rows[at, 1, a] * effects[at, 0, a]
    give = 0.0
    for k in range(2):
        give = 1.0 / ease[at, k] if ease[at, k] > 0.0 else 0.0
        goal[at, k] *= give
        for a in range(6):
            rows[at, k, a] *= give
    coupling[at] *= give


@kernel(forceinline=True)
def renew(first, last, linear, course, velocity):
    """Renew the impulses of contacts ``first`` to ``last`` - 1 of the list; blocks do not strain.

    Return how much that changes a velocity, m/s, and by how much all impulses changed, in units of
    energy.
    """
    ends, rows, effects = linear.ends, linear.rows, linear.effects
    goal, ease, coupling = linear.goal, linear.ease, linear.coupling
    friction = linear.friction
    impulses, made = course.impulses, course.made
    most, size = 0.0, 0.0
    for at in range(first, last):
        i, j = ends[at, 0], ends[at, 1]
        shear = impulses[at, 1] + goal[at, 1] - _along(at, 1, rows, i, j, velocity)
        normal = impulses[at, 0] + goal[at, 0] - _along(at, 0, rows, i, j, velocity)
        normal = max(0.0, normal)
        pushed, bound = normal - impulses[at, 0], friction[at] * normal
        shear = min(max(shear - coupling[at] * pushed, -bound), bound)
        rubbed = shear - impulses[at, 1]
        impulses[at, 0], impulses[at, 1] = normal, shear
        made[at, 0], made[at, 1] = pushed, rubbed
        if pushed == 0.0 and rubbed == 0.0:
            continue
        for a in range(3):
            velocity[i, a] += pushed * effects[at, 0, a] + rubbed * effects[at, 1, a]
            velocity[j, a] += pushed * effects[at, 0, 3 + a] + rubbed * effects[at, 1, 3 + a]
        pushed, rubbed = abs(pushed), abs(rubbed)
        one, other = pushed * ease[at, 0], rubbed * ease[at, 1]
        most, size = max(most, one, other), size + (one * pushed + other * rubbed)
    return most, size


@kernel(forceinline=True)
def _go_on(share, count, course, blocks, pace, velocity):
    """Let impulses go on by a share of their last advance, and add their effect.

    ``pace`` (b, 2, 3) are the velocities that this advance has changed the ``blocks`` (b,) by, and
    theirs when the last renewal began; both change with it.
    """
    impulses, made, advance = course.impulses, course.made, course.advance
    for at in range(count):
        for k in range(2):
            more = share * advance[at, k]
            advance[at, k] = more + made[at, k]
            impulses[at, k] += more
    for at in range(len(blocks)):
        b = blocks[at]
        for a in range(3):
            more = share * pace[at, 0, a]
            pace[at, 0, a] = more + velocity[b, a] - pace[at, 1, a]
            velocity[b, a] += more
            pace[at, 1, a] = velocity[b, a]


@kernel()
def find(enough, most, count, blocks, linear, course, velocity):
    """Find the impulses of the first ``count`` contacts; return how many renewals that took.

    Until velocities change by less than ``enough``, m/s, or ``most`` renewals.  The impulses and
    the velocities (n, 6) of the ``blocks`` (b,) of these contacts are written in place.
    """
    course.advance[:count] = 0.0
    pace = np.zeros((len(blocks), 2, 3))
    for at in range(len(blocks)):
        for a in range(3):
            pace[at, 1, a] = velocity[blocks[at], a]
    before = np.inf
    for renewals in range(1, most + 1):
        changed, size = renew(0, count, linear, course, velocity)
        if changed <= enough or renewals == most:
            break
        share = size / before if size < before else 0.0
        _go_on(share, count, course, blocks, pace, velocity)
        before = size
    return renewals
