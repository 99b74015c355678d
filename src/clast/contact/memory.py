"""Contact memory: found again by vertex and block, renewed after every accepted step."""

from __future__ import annotations

import numpy as np

from clast.contact.arrays import OPEN, ContactResponse, Contacts
from clast.kernels import memory as kernel
from clast.model import Floats, Ints
from clast.state import ContactMemory


def recall(memory: ContactMemory, vertex: Ints, block: Ints, edge: Ints) -> Ints:
    """Return the memory row of each contact (vertex, block of the edge, edge), or -1, (m,)."""
    return kernel.rows_of(vertex, block, edge, memory.vertex, memory.block, memory.edge)


def renew(
    contacts: Contacts, response: ContactResponse, gap: Floats, critdis: float
) -> ContactMemory:
    """Return the memory after a step; ``gap`` (m,) at its end, m.

    A contact that has opened forgets its shear force; one that is open further than critdis
    loses its bond.
    """
    order = np.lexsort((contacts.edge, contacts.edge_block, contacts.vertex))
    closed = response.mode != OPEN
    return ContactMemory(
        vertex=contacts.vertex[order],
        block=contacts.edge_block[order],
        edge=contacts.edge[order],
        gap=gap[order],
        normal_force=response.normal_force[order],
        shear_force=np.where(closed, response.shear_force, 0.0)[order],
        multiplier=contacts.multiplier[order],
        mode=response.mode[order],
        bonded=(response.bonded & (gap <= critdis))[order],
    )
