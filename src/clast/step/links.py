"""What couples blocks in an assembled solve: contacts, and the springs of actions beside them.

Contacts are linearised about gaps and slips that the process has seen, springs about displacements
of the blocks.  Without springs all is as contacts have it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clast.actions.action import Share
from clast.contact.clipped_spring import Rows, Springs, merged, springs_of
from clast.contact.contacts import ContactResponse, Contacts
from clast.linear.system import BlockSystem, DiagonalTerms, assemble, stretches
from clast.model.model import Bools, Floats


@dataclass(frozen=True, kw_only=True)
class Bearing:
    """What all links bear, in the order of their table; see ContactResponse."""

    normal_force: Floats
    shear_force: Floats
    normal_stiffness: Floats
    shear_stiffness: Floats
    coupling: Floats


def springs_between(shares: Sequence[Share]) -> Springs | None:
    """Return the springs of all actions as one table, None where there are none."""
    tables = [one.springs for one in shares if one.springs is not None and len(one.springs)]
    return merged(tables[0], tables[1:])[0] if tables else None


def coupled_system(
    base: DiagonalTerms,
    contacts: Contacts,
    response: ContactResponse,
    seen: tuple[Floats, Floats],
    springs: Springs | None,
    at: Floats,
    fixed: Bools,
) -> tuple[BlockSystem, ContactResponse | Bearing]:
    """Return the system of a solve, and what it was assembled with.

    The contacts' ``response`` was evaluated at the gaps and slips ``seen`` (m,), m, the springs are
    at the displacements ``at`` (n, 6).
    """
    if springs is None:
        return assemble(base, contacts, response, *seen, fixed), response
    table, (of_contacts, of_springs) = merged(springs_of(contacts), (springs,))
    gap, slip = stretches(springs, at)
    bear = springs.at(gap, slip)

    def joined(one: Floats, other: Floats) -> Floats:
        return _joined(len(table), (of_contacts, one), (of_springs, other))

    bearing = Bearing(
        normal_force=joined(response.normal_force, bear.normal_force),
        shear_force=joined(response.shear_force, bear.shear_force),
        normal_stiffness=joined(response.normal_stiffness, bear.normal_stiffness),
        shear_stiffness=joined(response.shear_stiffness, bear.shear_stiffness),
        coupling=joined(response.coupling, np.zeros(len(springs))),
    )
    # a link's slip in the equations counts from the start of the step, a spring's from its own
    own = gap, slip - springs.slip
    gaps, slips = (joined(one, other) for one, other in zip(seen, own, strict=True))
    return assemble(base, table, bearing, gaps, slips, fixed), bearing


def are_settled(springs: Springs | None, before: Floats, after: Floats) -> bool:
    """Return whether no spring is clipped otherwise at d ``after`` than ``before`` (n, 6)."""
    if springs is None:
        return True
    one, other = (springs.at(*stretches(springs, d)) for d in (before, after))
    return np.array_equal(one.normal_stiffness, other.normal_stiffness) and np.array_equal(
        one.shear_stiffness, other.shear_stiffness
    )


def _joined(count: int, *parts: tuple[Rows, Floats]) -> Floats:
    """Return an array (count,) of the values of parts of its rows."""
    result = np.empty(count)
    for rows, values in parts:
        result[rows] = values
    return result
