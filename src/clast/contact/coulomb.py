"""Coulomb's law with cohesion and tension cut-off: strength, return mapping, mode, energy, loss.

    N >= -sigma_t L        |T| <= N tan(phi) + c L

L is the length of joint that a contact stands for; compression is positive.  Cohesion counts where
the joint is pressed together, or carries tension: |T| = 0 where N = 0 and sigma_t = 0, by whatever
normal force friction is bounded, so that a face has nothing to lose as it opens.  The shear force
follows its spring from the remembered one, T = T_old - k s, and is returned to the bound (Shi 1988:
lock, slide, open).  A bond ends with the step in which it reaches its tension, or, if the joint is
brittle, slips (contact/joints/bonds.py).  Every law of contacts ends here, whatever its normal
force.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.contact.contacts import LOCK, OPEN, SLIDE, Contacts
from clast.model.model import Bools, Floats, Ints


class Strengths(NamedTuple):
    """Strengths of contacts, (m,) each, or the numbers of one of them."""

    friction: Floats
    """tan(phi)."""
    cohesion: Floats
    """c that is left, Pa."""
    tensile_strength: Floats
    """sigma_t that is left, Pa."""
    length: Floats
    """Length of joint L that a contact stands for, m."""
    residual_cohesion: Floats
    """c after slip, Pa; NaN where slip leaves the bond whole."""


class ContactForces(NamedTuple):
    """Forces that contacts remember from the last step, (m,) each, or the numbers of one."""

    bonded: Any
    """True where a bond is left."""
    shear_force: Floats
    """T_old, N/m."""
    multiplier: Floats
    """Multiplier of the normal force, N/m."""
    rest_force: Floats
    """Normal force at a gap of zero, N/m."""
    friction_base: Floats
    """N that bounds friction, N/m; NaN: the normal force of the moment."""


class Stiffnesses(NamedTuple):
    """Stiffnesses of the springs of contacts."""

    normal_of_law: float
    """p of the contact law, N/m per m."""
    shear_of_law: float
    """k of the contact law, N/m per m."""
    normal_of_joint: Floats
    """p of the joint of each contact, N/m per m, NaN where it has none, shape (m,)."""
    shear_of_joint: Floats
    """k of the joint of each contact, likewise, shape (m,)."""
    share: Floats
    """Fraction of the law's stiffness that each contact has, shape (m,)."""


class Answers(NamedTuple):
    """Answers of contacts to gaps and slips, (m,) each: the fields of a ContactResponse."""

    normal_force: Floats
    """N, N/m."""
    shear_force: Floats
    """T, N/m."""
    normal_stiffness: Floats
    """-dN/dgap, N/m per m."""
    shear_stiffness: Floats
    """-dT/dslip, N/m per m."""
    coupling: Floats
    """dT/dN."""
    mode: Ints
    """OPEN, SLIDE or LOCK."""
    bonded: Bools
    """True while the bond is left."""
    energy: Floats
    """Energy in the springs, J/m."""
    dissipation: Floats
    """Energy lost in sliding, J/m."""


def strengths_of(contacts: Contacts) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return the arrays of ``Strengths``."""
    strengths = contacts.friction, contacts.cohesion, contacts.tensile_strength
    return *strengths, contacts.length, contacts.residual_cohesion


def memory_of(contacts: Contacts) -> tuple[Any, Floats, Floats, Floats, Floats]:
    """Return the arrays of ``ContactForces``."""
    forces = contacts.shear_force, contacts.multiplier, contacts.rest_force
    return contacts.bonded, *forces, contacts.friction_base


def room_for_answers(count: int) -> tuple[Any, ...]:
    """Return arrays for ``Answers`` of ``count`` contacts."""
    mode, bonded = np.empty(count, np.int64), np.empty(count, np.bool_)
    *of_forces, energy, loss = np.empty((7, count))
    return *of_forces, mode, bonded, energy, loss


@kernel(forceinline=True)
def strengths_at(c, strengths):
    """Return the strengths of one contact."""
    return Strengths(
        strengths.friction[c],
        strengths.cohesion[c],
        strengths.tensile_strength[c],
        strengths.length[c],
        strengths.residual_cohesion[c],
    )


@kernel(forceinline=True)
def forces_at(c, memory):
    """Return the remembered forces of one contact."""
    return ContactForces(
        memory.bonded[c],
        memory.shear_force[c],
        memory.multiplier[c],
        memory.rest_force[c],
        memory.friction_base[c],
    )


@kernel(forceinline=True)
def shear_strength(normal, friction, cohesion, length, tension):
    """Return N tan(phi) + c L, N/m, not below 0; NaN propagates.

    A contact that is not pressed together and has no ``tension``, N/m, has no cohesion either.
    """
    bound = normal * friction + cohesion * length
    return 0.0 if (bound < 0.0) | ((normal <= 0.0) & (tension == 0.0)) else bound


@kernel(forceinline=True)
def tension_of(tensile_strength, length):
    """Return the largest tension that a contact carries, sigma_t L, N/m."""
    return tensile_strength * length


@kernel(forceinline=True)
def resist(slip, k, strengths, memory, normal, carries, counts):
    """Return T, its stiffness and coupling to N, mode, bond, energy and loss of one contact.

    ``strengths`` and ``memory`` are the numbers of this contact, ``normal`` is its N,
    N/m; ``carries``: whether it is pressed together; ``counts``: whether it may carry shear.  The
    part of a slip that the spring does not take up is lost.  Without any strength
    there is nothing to stick to, even at rest.
    """
    friction, cohesion, length = strengths.friction, strengths.cohesion, strengths.length
    given = not np.isnan(memory.friction_base)
    base = memory.friction_base if given else normal
    tension = tension_of(strengths.tensile_strength, length)
    bound = shear_strength(base, friction, cohesion, length, tension) if counts else 0.0
    trial = memory.shear_force - k * slip if counts else 0.0
    sign = 1.0 if trial > 0.0 else -1.0
    size = sign * trial
    slips = size > bound
    sticks = (not slips) & (bound > 0.0)
    t = trial if sticks else sign * bound
    coupling = sign * friction if slips & (bound > 0.0) & (not given) else 0.0
    loss = bound * (size - bound) / k if slips else 0.0
    away = (not counts) | ((normal == 0.0) & (tension == 0.0))
    mode = OPEN if away else LOCK if sticks else SLIDE
    has_strength = (cohesion * length != 0.0) | (tension != 0.0)
    joined = (base > 0.0) | (tension != 0.0)
    slipped = slips & joined & has_strength & (not np.isnan(strengths.residual_cohesion))
    unbroken = (carries | (tension == 0.0)) & (not slipped)
    return (
        t if bound > 0.0 else 0.0,
        k if sticks else 0.0,
        coupling,
        mode,
        memory.bonded & unbroken,
        0.5 * t * t / k,
        loss,
    )


@kernel(forceinline=True)
def of_joint_or_law(of_joint, of_law):
    """Return the stiffness that a joint gives, else that of the law."""
    return of_law if np.isnan(of_joint) else of_joint


@shared(CONTACTS, error_model="numpy")
def answer_with_friction(first, last, slip, k, strengths, memory, answers):
    """Write the answer of contacts ``first`` to ``last`` - 1 to slips under a given N.

    N (m,) stands in ``answers``, in N/m; energies become those of the shear spring alone.  ``k``
    are the stiffness of the law and those that joints give (m,), N/m per m, and the fractions of
    the first that contacts have (m,).
    """
    k_of_law, k_of_joint, share = k
    of, known, answer = Strengths(*strengths), ContactForces(*memory), Answers(*answers)
    shear, ks, coupling = answer.shear_force, answer.shear_stiffness, answer.coupling
    mode, intact, energy, loss = answer.mode, answer.bonded, answer.energy, answer.dissipation
    for c in range(first, last):
        one, remembered, normal = strengths_at(c, of), forces_at(c, known), answer.normal_force[c]
        stiffness = of_joint_or_law(k_of_joint[c], share[c] * k_of_law)
        carries, given = normal != 0.0, not np.isnan(remembered.friction_base)
        counts = carries | given | (tension_of(one.tensile_strength, one.length) != 0.0)
        shear[c], ks[c], coupling[c], mode[c], intact[c], energy[c], loss[c] = resist(
            slip[c], stiffness, one, remembered, normal, carries, counts
        )


@kernel()
def limits_of_contacts(stiffnesses, strengths, base):
    """Return p, k, N/m per m, tension and shear force, N/m, of the springs of contacts, (m,) each.

    ``base`` (m,) are the normal forces that bound friction, N/m.
    """
    count = len(base)
    limits = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    _limits(count, stiffnesses, strengths, base, limits)
    return limits


@shared(CONTACTS)
def _limits(first, last, stiffnesses, strengths, base, limits):
    """Write the springs of contacts ``first`` to ``last`` - 1, and their strength."""
    strengths_of_all, springs = Strengths(*strengths), Stiffnesses(*stiffnesses)
    p, k, tension, strength = limits
    for c in range(first, last):
        of = strengths_at(c, strengths_of_all)
        p[c] = of_joint_or_law(springs.normal_of_joint[c], springs.share[c] * springs.normal_of_law)
        k[c] = of_joint_or_law(springs.shear_of_joint[c], springs.share[c] * springs.shear_of_law)
        tension[c] = tension_of(of.tensile_strength, of.length)
        strength[c] = shear_strength(base[c], of.friction, of.cohesion, of.length, tension[c])


def largest_forces(contacts: Contacts, normal: Floats) -> tuple[Floats, Floats]:
    """Return the tension and the shear force that contacts carry at most, N/m, (m,) each.

    ``normal`` (m,) are the normal forces that bound friction, N/m.
    """
    of_joints = contacts.normal_stiffness, contacts.shear_stiffness, contacts.spring_share
    _, _, tension, shear = limits_of_contacts(
        (1.0, 1.0, *of_joints), strengths_of(contacts), normal
    )
    return tension, shear
