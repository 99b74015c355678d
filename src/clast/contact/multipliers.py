"""The interface of processes to a law that may or may not have Lagrange multipliers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.laws import AugmentedLagrangian, Carried, ContactLaw, MultiplierLaw
from clast.model.model import Floats, Model

if TYPE_CHECKING:
    from typing_extensions import TypeIs

CONTACTS_OF_A_BLOCK = 4.0
"""Contacts that are taken to share the mass of a block."""


def has_multipliers(law: ContactLaw) -> TypeIs[MultiplierLaw]:
    """Return True for laws with multipliers; isinstance of a protocol is slow in every step."""
    return hasattr(law, "renew")


def begin(law: ContactLaw, contacts: Contacts) -> Contacts:
    """Return the contacts as the first solve of a step sees them."""
    return law.begin(contacts) if has_multipliers(law) else contacts


def renew(law: ContactLaw, contacts: Contacts, response: ContactResponse) -> Contacts:
    """Return the contacts with the multipliers that follow from the forces of a solve."""
    return law.renew(contacts, response) if has_multipliers(law) else contacts


def with_energies(
    law: MultiplierLaw, contacts: Contacts, response: ContactResponse
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
