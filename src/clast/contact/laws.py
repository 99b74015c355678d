"""Contact laws: forces between a vertex and its entrance edge, with or without multipliers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

from clast.compute.parallel import CONTACTS, shared
from clast.contact.clipped_spring import Clipped
from clast.contact.contacts import ContactResponse, Contacts, SpringLimits
from clast.contact.coulomb import (
    Answers,
    ContactForces,
    Stiffnesses,
    Strengths,
    answer_with_friction,
    forces_at,
    limits_of_contacts,
    memory_of,
    of_joint_or_law,
    resist,
    room_for_answers,
    strengths_at,
    strengths_of,
    tension_of,
)
from clast.errors import CaseError
from clast.model.model import Floats, Model

if TYPE_CHECKING:
    from typing_extensions import TypeIs


@shared(CONTACTS, error_model="numpy")
def answer_of_springs(first, last, gap, slip, stiffnesses, strengths, memory, answers):
    """Write the answer of contacts ``first`` to ``last`` - 1 to gaps and slips: see ``springs``.

    In a minimisation (friction bound given) a contact that just touches counts with its stiffness:
    at the kink either is a derivative, and it is about to close.
    """
    of, springs = Strengths(*strengths), Stiffnesses(*stiffnesses)
    known, answer = ContactForces(*memory), Answers(*answers)
    shear, ks, coupling = answer.shear_force, answer.shear_stiffness, answer.coupling
    mode, intact, loss = answer.mode, answer.bonded, answer.dissipation
    share = springs.share
    for c in range(first, last):
        one, remembered = strengths_at(c, of), forces_at(c, known)
        multiplier = remembered.multiplier
        given = not np.isnan(remembered.friction_base)
        p = of_joint_or_law(springs.normal_of_joint[c], share[c] * springs.normal_of_law)
        k = of_joint_or_law(springs.shear_of_joint[c], share[c] * springs.shear_of_law)
        trial = remembered.rest_force + multiplier - p * gap[c]
        tension = tension_of(one.tensile_strength, one.length)
        carries = (trial > -tension) | (given & (trial == -tension))
        counts = carries | given | (tension != 0.0)
        # -tension is the cut-off; the bond is lost when the step is over
        n = trial if carries else -tension
        n = n if counts else 0.0
        answer.normal_force[c] = n
        answer.normal_stiffness[c] = p if carries else 0.0
        pressed = 0.5 * (n - max(0.0, multiplier)) ** 2 / p if counts else 0.0
        shear[c], ks[c], coupling[c], mode[c], intact[c], sheared, loss[c] = resist(
            slip[c], k, one, remembered, n, carries, counts
        )
        answer.energy[c] = pressed + sheared


def springs(
    contacts: Contacts,
    gap: Floats,
    slip: Floats,
    normal_stiffness: float,
    shear_stiffness: float | None,
) -> ContactResponse:
    """Return the forces of linear springs with Coulomb friction, cohesion and tension cut-off.

    N = max(-sigma_t L, N_0 + lambda - p d_n), sigma_t being 0 where no bond is left and N_0 the
    rest force; friction is that of contact/coulomb.py.  Gaps and slips (m,) at the end of the step,
    m; stiffnesses p and k in N/m per m, of contacts whose joint gives none.
    """
    answers = room_for_answers(len(gap))
    stiffnesses = _stiffnesses(contacts, normal_stiffness, shear_stiffness)
    answer_of_springs(
        len(gap), gap, slip, stiffnesses, strengths_of(contacts), memory_of(contacts), answers
    )
    return ContactResponse(**Answers(*answers)._asdict())


def with_friction(
    contacts: Contacts,
    slip: Floats,
    *,
    normal_force: Floats,
    normal_stiffness: Floats,
    energy: Floats,
    shear_stiffness: float,
) -> ContactResponse:
    """Return any normal force with a shear spring and Coulomb friction, for laws of one's own.

    The shear force is that of ``springs``, bounded by |T| <= N tan(phi) + c L with N the
    ``normal_force`` (m,), N/m, or that of ``contacts.friction_base``.  ``normal_stiffness`` (m,) is
    -dN/dgap, N/m per m, ``energy`` (m,) the work that N has stored, J/m; that of the shear spring
    is added.  ``slip`` (m,) in m, ``shear_stiffness`` in N/m per m, where the joint of a contact
    gives none.
    """
    answers = room_for_answers(len(slip))
    answers[0][:] = normal_force
    k = float(shear_stiffness), contacts.shear_stiffness, contacts.spring_share
    answer_with_friction(len(slip), slip, k, strengths_of(contacts), memory_of(contacts), answers)
    response = ContactResponse(**Answers(*answers)._asdict())
    return replace(response, normal_stiffness=normal_stiffness, energy=energy + response.energy)


def normal_stiffness_of(contacts: Contacts, law: ContactLaw) -> Floats:
    """Return p of each contact, N/m per m, shape (m,): that of its joint, else the law's."""
    of_joint = contacts.normal_stiffness
    return np.where(np.isnan(of_joint), contacts.spring_share * law.normal_stiffness, of_joint)


def _stiffnesses(
    contacts: Contacts, normal: float, shear: float | None
) -> tuple[float, float, Floats, Floats, Floats]:
    """Return the arrays of ``Stiffnesses``."""
    k = normal if shear is None else shear
    of_joints = contacts.normal_stiffness, contacts.shear_stiffness
    return float(normal), float(k), *of_joints, contacts.spring_share


@dataclass(frozen=True)
class Penalty:
    """Linear springs, N = max(0, -p d_n), with Coulomb friction, cohesion, tension cut-off."""

    normal_stiffness: float = 1e9
    """p, N/m per m; "auto" picks it for the process chosen."""
    shear_stiffness: float | None = None
    """Stiffness of the shear spring, N/m per m; equal to ``normal_stiffness`` if not given."""

    def __post_init__(self) -> None:
        # Raise CaseError for stiffnesses, N/m per m, that are not above 0.
        for name, value in (
            ("normal_stiffness", self.normal_stiffness),
            ("shear_stiffness", self.shear_stiffness),
        ):
            if value is not None and not value > 0.0:
                raise CaseError(
                    f"{name} must be above 0, not {value}",
                    where=type(self).__name__,
                    remedy="give the stiffness of the contact spring in N/m per m, e.g. 1e9",
                )

    def respond(self, contacts: Contacts, gap: Floats, slip: Floats) -> ContactResponse:
        """Return forces and stiffnesses for gaps (m,) and slips (m,) at the end of the step, m."""
        return springs(contacts, gap, slip, self.normal_stiffness, self._shear)

    def limits(self, contacts: Contacts) -> SpringLimits:
        """Return the same as springs with bounds, for contacts whose friction bound is given."""
        # The bounds of ``springs`` for contacts whose friction bound is given.
        stiffnesses = _stiffnesses(contacts, self.normal_stiffness, self._shear)
        return SpringLimits(
            *limits_of_contacts(stiffnesses, strengths_of(contacts), contacts.friction_base)
        )

    @property
    def _shear(self) -> float | None:
        """Stiffness of the shear spring, N/m per m; None: the normal one."""
        return self.shear_stiffness


@dataclass(frozen=True)
class Reset:
    """Every step begins without multipliers (the paper)."""

    carries: ClassVar[bool] = False

    def first(self, remembered: Floats) -> Floats:
        """Return zeros, shape (m,)."""
        return np.zeros(len(remembered))


@dataclass(frozen=True)
class Carried:
    """Every step begins with the multipliers that the last one ended with."""

    carries: ClassVar[bool] = True

    def first(self, remembered: Floats) -> Floats:
        """Return the remembered multipliers, shape (m,)."""
        return remembered


@dataclass(frozen=True)
class AugmentedLagrangian(Penalty):
    """N = max(0, lambda - p d_n), solved several times a step with lambda <- N between solves.

    Reset at each step, n solves leave beta/((1 + beta)^n - 1) of the penalty law's penetration,
    beta = p h2/(2 m) with m the mass per contact: 1/n for a soft spring.  A joint with a normal
    stiffness of its own gives way by that: its contacts have no multipliers.
    """

    normal_stiffness: float = 1e9
    """p, N/m per m; "auto" picks it for the process chosen."""
    shear_stiffness: float | None = None
    """Stiffness of the shear spring, N/m per m; ``solves`` x ``normal_stiffness`` if not given.

    The solves make the contact that much stiffer in effect; a softer shear spring would mobilise
    friction later than the normal force (decision 15).
    """
    solves: int = 4
    """Solves per step, at most."""
    penetration_tolerance: float = 0.0
    """Penetration at which the solves of a step end early, m."""
    multipliers: Reset | Carried = field(default_factory=Reset)
    """Reset at each step (the paper) or carried over."""

    @property
    def _shear(self) -> float:
        """Stiffness of the shear spring, N/m per m."""
        if self.shear_stiffness is None:
            return self.solves * self.normal_stiffness
        return self.shear_stiffness

    @property
    def carries(self) -> bool:
        """True where a step begins with the multipliers of the last."""
        return self.multipliers.carries

    def begin(self, contacts: Contacts) -> Contacts:
        """Return the contacts with the multipliers of the first solve."""
        own = np.isnan(contacts.normal_stiffness)
        first = self.multipliers.first(contacts.multiplier)
        return replace(contacts, multiplier=np.where(own, first, contacts.multiplier))

    def renew(self, contacts: Contacts, response: ContactResponse) -> Contacts:
        """Return the contacts with lambda <- N, where their joint has no stiffness of its own."""
        own = np.isnan(contacts.normal_stiffness)
        beyond_rest = response.normal_force - contacts.rest_force
        return replace(contacts, multiplier=np.where(own, beyond_rest, contacts.multiplier))


class ContactLaw(Protocol):
    """Forces between blocks from gap and slip.  Evaluating a law never changes its memory."""

    @property
    def normal_stiffness(self) -> float:
        """Normal contact stiffness p (the penalty), N/m per m."""
        ...

    def respond(self, contacts: Contacts, gap: Floats, slip: Floats) -> ContactResponse:
        """Return forces and stiffnesses for gaps (m,) and slips (m,) at the end of the step, m."""
        ...


class SpringLaw(ContactLaw, Protocol):
    """A contact law that is nothing but linear springs with bounds."""

    def limits(self, contacts: Contacts) -> SpringLimits:
        """Return stiffnesses and bounds, for contacts whose friction bound is given."""
        ...


def has_limits(law: ContactLaw) -> TypeIs[SpringLaw]:
    """Return True for laws of springs with bounds; isinstance of a protocol is slow."""
    return hasattr(law, "limits")


def clipped(law: SpringLaw, contacts: Contacts) -> tuple[Clipped, Clipped]:
    """Return the contacts' normal springs, N in [-tension, inf), and shear springs, T in +-b."""
    limits = law.limits(contacts)
    at_zero, endless = contacts.rest_force + contacts.multiplier, limits.tension + np.inf
    return (
        Clipped(at_zero, limits.normal_stiffness, -limits.tension, endless),
        Clipped(contacts.shear_force, limits.shear_stiffness, -limits.strength, limits.strength),
    )


CONTACTS_OF_A_BLOCK = 4.0
"""Contacts that are taken to share the mass of a block."""


def has_multipliers(law: ContactLaw) -> TypeIs[AugmentedLagrangian]:
    """Return True for laws with multipliers; isinstance of a protocol is slow in every step."""
    return hasattr(law, "renew")


def begin(law: ContactLaw, contacts: Contacts) -> Contacts:
    """Return the contacts as the first solve of a step sees them."""
    return law.begin(contacts) if has_multipliers(law) else contacts


def renew(law: ContactLaw, contacts: Contacts, response: ContactResponse) -> Contacts:
    """Return the contacts with the multipliers that follow from the forces of a solve."""
    return law.renew(contacts, response) if has_multipliers(law) else contacts


def with_energies(
    law: AugmentedLagrangian, contacts: Contacts, response: ContactResponse
) -> ContactResponse:
    """Return the ``response`` with the energies of contacts that have multipliers, J/m.

    At the penetration u that their last solve leaves they have given way as springs do that carry N
    there, 1/2 N u, while the spring of that solve alone holds 1/2 p u^2.
    """
    own = np.isnan(contacts.normal_stiffness) & (response.normal_force > 0.0)
    p = contacts.spring_share * law.normal_stiffness
    deep = np.maximum(0.0, response.normal_force - np.maximum(0.0, contacts.multiplier)) / p
    more = 0.5 * deep * (response.normal_force - p * deep)
    return replace(response, energy=response.energy + np.where(own, more, 0.0))


def carried_over(law: ContactLaw) -> ContactLaw:
    """Return the law with multipliers that begin a step as they ended the last, where it has any.

    A step from rest adds no momentum that could make them swing up.
    """
    return replace(law, multipliers=Carried()) if isinstance(law, AugmentedLagrangian) else law


def advice(law: ContactLaw, model: Model, step: float) -> tuple[str, ...]:
    """Warn where multipliers that are carried over would make blocks swing up.

    They add up penetration from step to step; the time scheme damps that only where
    n beta = n p h2/(2 m) is at least 1, m being the mass per contact (decision 10).
    """
    if not has_multipliers(law) or not law.carries or model.fixed.all():
        return ()
    share = float(model.mass[~model.fixed].max()) / CONTACTS_OF_A_BLOCK
    gain = law.solves * law.normal_stiffness * step**2 / (2.0 * share)
    if gain >= 1.0:
        return ()
    return (
        f'multipliers = "carried" oscillates where n p h2/(2 m) is below 1; it is {gain:.2g} for '
        f"the heaviest block. Use normal_stiffness >= {law.normal_stiffness / gain:.2g}, more "
        'solves, or multipliers = "reset".',
    )


def enough(law: ContactLaw, solves: int, contacts: Contacts, gap: Floats) -> bool:
    """Return True where no further multiplier solve is due after ``solves``; gap (m,) in m.

    Joints with a stiffness of their own are to give way.
    """
    if not has_multipliers(law) or solves >= law.solves:
        return True
    gap = np.where(np.isnan(contacts.normal_stiffness), gap, 0.0)
    return bool(-gap.min(initial=0.0) <= law.penetration_tolerance)
