"""Blocks that nothing touches go as their own forces take them: only the others are minimised.

Of a heap that still falls these are most.  The minimum of their part of the potential is K^-1 F.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.contact.contacts import Contacts
from clast.minimise.potential import Potential
from clast.minimise.subproblem import Part, part_of
from clast.minimise.unfinished import SMALL
from clast.model.model import Floats

MOST = 0.9
"""Share of the blocks up to which those that are touched are minimised by themselves."""


def touched_part(potential: Potential) -> Part | None:
    """Return the free blocks that have contacts, or None where they are most, or there are none.

    The part has all contacts, in their order.
    """
    free = ~potential.fixed
    touched = np.zeros(len(free), np.bool_)
    touched[potential.contacts.pairs.ravel()] = True
    touched &= free
    count = np.count_nonzero(touched)
    blocks = np.count_nonzero(free)
    if count == 0 or blocks <= SMALL or count > MOST * blocks:
        return None
    return part_of(potential, touched)


def with_flight(part: Part, flight: Floats, unknowns: Floats) -> Floats:
    """Return d of all blocks (n, 6) from that of untouched ones, ``flight``, and of a part's."""
    result = flight.copy()
    result[part.blocks] = unknowns
    return result


def as_numbered(contacts: Contacts, whole: Contacts) -> Contacts:
    """Return the contacts of a part with the numbers that blocks and pairs have in the whole."""
    return replace(
        contacts,
        vertex_block=whole.vertex_block,
        edge_block=whole.edge_block,
        pair=whole.pair,
        pairs=whole.pairs,
    )
