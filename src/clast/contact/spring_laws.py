"""What processes may know of laws whose forces are clipped straight lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clast.contact.contacts import Contacts, SpringLimits
from clast.contact.laws import ContactLaw, SpringLaw

if TYPE_CHECKING:
    from typing_extensions import TypeIs


def has_limits(law: ContactLaw) -> TypeIs[SpringLaw]:
    """Return True for laws of springs with bounds; isinstance of a protocol is slow."""
    return hasattr(law, "limits")


def limits_of(law: ContactLaw, contacts: Contacts) -> SpringLimits | None:
    """Return the law as springs with bounds, or None for any other law or without contacts."""
    return law.limits(contacts) if has_limits(law) and len(contacts) else None
