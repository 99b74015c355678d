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
    """Forces that contacts remember from the last step, (m,) each."""

    bonded: Bools
    """True where a bond is left."""
    shear_force: Floats
    """T_old, N/m."""
    multiplier: Floats
    """Multiplier of the normal force, N/m."""
    rest_force: Floats
    """Normal force at a gap of zero, N/m."""
    friction_base: Floats
    """N that bounds friction, N/m; NaN: the normal force of the moment."""


class ShearMemory(NamedTuple):
    """Memory of the shear spring of one contact."""

    bonded: Any
    """Whether a bond is left."""
    shear_force: float
    """T_old, N/m."""
    friction_base: float
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
    """Share of the law's stiffness that each contact has, shape (m,)."""


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
    """True where a bond is left."""
    energy: Floats
    """Energy in the springs, J/m."""
    loss: Floats
    """Energy lost in sliding, J/m."""


Found = tuple[Floats, Floats, Floats, Floats, Floats, Any, Any, Floats, Floats]
"""Output of kernels for each contact (m,):  N, T, -dN/dgap, -dT/dslip, dT/dN, mode, bond, energy,
loss; the fields of a ContactResponse."""


def strengths_of(contacts: Contacts) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return tan(phi), c, sigma_t, Pa, L, m, and residual c, Pa, of contacts, for kernels.

    (m,) each. c and sigma_t are the remaining ones; the last is nan where slip leaves bonds whole.
    """
    strengths = contacts.friction, contacts.cohesion, contacts.tensile_strength
    return *strengths, contacts.length, contacts.residual_cohesion


def memory_of(contacts: Contacts) -> tuple[Any, Floats, Floats, Floats, Floats]:
    """Return bonds, T_old, multipliers, rest forces and the N that bounds friction, for kernels.

    (m,) each.  The last, N/m, is nan where friction is bounded by the normal force of the moment.
    """
    forces = contacts.shear_force, contacts.multiplier, contacts.rest_force
    return contacts.bonded, *forces, contacts.friction_base


def nothing_found(count: int) -> Found:
    """Return arrays for the answers of ``count`` contacts."""
    normal, shear, kn, ks, coupling, energy, loss = np.empty((7, count))
    mode, bonded = np.empty(count, np.int64), np.empty(count, np.bool_)
    return normal, shear, kn, ks, coupling, mode, bonded, energy, loss


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

    ``strengths`` and ``memory`` (ShearMemory) are the numbers of this contact, ``normal`` is its N,
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
def answer_with_friction(first, last, slip, k, strengths, memory, found):
    """Write the answer of contacts ``first`` to ``last`` - 1 to slips under a given N.

    N (m,) stands in ``found``, in N/m; energies become those of the shear spring alone.
    ``k`` are the stiffness of the law and those that joints give (m,), N/m per m, and the shares of
    the first that contacts have (m,).
    """
    k_of_law, k_of_joint, share = k
    of, known, answer = Strengths(*strengths), ContactForces(*memory), Answers(*found)
    friction, cohesion, tensile_strength = of.friction, of.cohesion, of.tensile_strength
    length, residual = of.length, of.residual_cohesion
    bonded, shear_force, friction_base = known.bonded, known.shear_force, known.friction_base
    normal, shear, ks = answer.normal_force, answer.shear_force, answer.shear_stiffness
    coupling, mode, intact = answer.coupling, answer.mode, answer.bonded
    energy, loss = answer.energy, answer.loss
    for c in range(first, last):
        carries = normal[c] != 0.0
        given = not np.isnan(friction_base[c])
        counts = carries | given | (tension_of(tensile_strength[c], length[c]) != 0.0)
        shear[c], ks[c], coupling[c], mode[c], intact[c], energy[c], loss[c] = resist(
            slip[c],
            of_joint_or_law(k_of_joint[c], share[c] * k_of_law),
            Strengths(friction[c], cohesion[c], tensile_strength[c], length[c], residual[c]),
            ShearMemory(bonded[c], shear_force[c], friction_base[c]),
            normal[c],
            carries,
            counts,
        )


@kernel()
def limits_of_contacts(stiffnesses, strengths, base):
    """Return p, k, N/m per m, tension and shear force, N/m, of the springs of contacts, (m,) each.

    ``base`` (m,) are the normal forces that bound friction, N/m.
    """
    count = len(base)
    found = np.empty(count), np.empty(count), np.empty(count), np.empty(count)
    _limits(count, stiffnesses, strengths, base, found)
    return found


@shared(CONTACTS)
def _limits(first, last, stiffnesses, strengths, base, found):
    """Write the springs of contacts ``first`` to ``last`` - 1, and their strength."""
    of, springs = Strengths(*strengths), Stiffnesses(*stiffnesses)
    p_of_law, p_of_joint = springs.normal_of_law, springs.normal_of_joint
    k_of_law, k_of_joint = springs.shear_of_law, springs.shear_of_joint
    friction, cohesion, tensile_strength = of.friction, of.cohesion, of.tensile_strength
    length, share = of.length, springs.share
    p, k, tension, strength = found
    for c in range(first, last):
        p[c] = of_joint_or_law(p_of_joint[c], share[c] * p_of_law)
        k[c] = of_joint_or_law(k_of_joint[c], share[c] * k_of_law)
        tension[c] = tension_of(tensile_strength[c], length[c])
        strength[c] = shear_strength(base[c], friction[c], cohesion[c], length[c], tension[c])


def largest_forces(contacts: Contacts, normal: Floats) -> tuple[Floats, Floats]:
    """Return the tension and the shear force that contacts carry at most, N/m, (m,) each.

    ``normal`` (m,) are the normal forces that bound friction, N/m.
    """
    of_joints = contacts.normal_stiffness, contacts.shear_stiffness, contacts.spring_share
    found = limits_of_contacts((1.0, 1.0, *of_joints), strengths_of(contacts), normal)
    return found[2], found[3]
