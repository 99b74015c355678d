"""What processes need of a law that may or may not have Lagrange multipliers."""

from __future__ import annotations

from clast.contact.arrays import ContactResponse, Contacts
from clast.interfaces import ContactLaw, MultiplierLaw
from clast.model import Floats


def begin(law: ContactLaw, contacts: Contacts) -> Contacts:
    """Return the contacts as the first solve of a step sees them."""
    return law.begin(contacts) if isinstance(law, MultiplierLaw) else contacts


def renew(law: ContactLaw, contacts: Contacts, response: ContactResponse) -> Contacts:
    """Return the contacts with the multipliers that follow from the forces of a solve."""
    return law.renew(contacts, response) if isinstance(law, MultiplierLaw) else contacts


def enough(law: ContactLaw, solves: int, gap: Floats) -> bool:
    """Return True where no further multiplier solve is due after ``solves``; gap (m,) in m."""
    if not isinstance(law, MultiplierLaw):
        return True
    return solves >= law.solves or -gap.min(initial=0.0) <= law.penetration_tolerance
