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

from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.contact.contacts import LOCK, OPEN, SLIDE, Contacts
from clast.model.model import Floats

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
def resist(slip, k, strengths, memory, normal, bears, counts):
    """Return T, its stiffness and coupling to N, mode, bond, energy and loss of one contact.

    ``strengths`` are tan(phi), c, sigma_t, length and residual c, ``memory`` the bond, T_old and
    the N that bounds friction, numbers of one contact (``strengths_of``, ``memory_of``).
    ``normal`` is its N, N/m; ``bears``: whether it is pressed together; ``counts``: whether it may
    carry shear.  The part of a slip that the spring does not take up is lost.  Without any strength
    there is nothing to stick to, even at rest.
    """
    friction, cohesion, tensile_strength, length, residual = strengths
    bonded, shear_force, friction_base = memory
    given = not np.isnan(friction_base)
    base = friction_base if given else normal
    tension = tension_of(tensile_strength, length)
    bound = shear_strength(base, friction, cohesion, length, tension) if counts else 0.0
    trial = shear_force - k * slip if counts else 0.0
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
    slipped = slips & joined & has_strength & (not np.isnan(residual))
    unbroken = (bears | (tension == 0.0)) & (not slipped)
    return (
        t if bound > 0.0 else 0.0,
        k if sticks else 0.0,
        coupling,
        mode,
        bonded & unbroken,
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
    friction, cohesion, tensile_strength, length, residual = strengths
    bonded, shear_force, _, _, friction_base = memory
    normal, shear, _, ks, coupling, mode, intact, energy, loss = found
    for c in range(first, last):
        bears = normal[c] != 0.0
        given = not np.isnan(friction_base[c])
        counts = bears | given | (tension_of(tensile_strength[c], length[c]) != 0.0)
        shear[c], ks[c], coupling[c], mode[c], intact[c], energy[c], loss[c] = resist(
            slip[c],
            of_joint_or_law(k_of_joint[c], share[c] * k_of_law),
            (friction[c], cohesion[c], tensile_strength[c], length[c], residual[c]),
            (bonded[c], shear_force[c], friction_base[c]),
            normal[c],
            bears,
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
    p_of_law, k_of_law, p_of_joint, k_of_joint, share = stiffnesses
    friction, cohesion, tensile_strength, length, _ = strengths
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
