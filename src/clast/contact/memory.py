"""Contact memory: found again by vertex and block, renewed after every accepted step."""

from __future__ import annotations

from clast.contact import memory_kernels as kernel
from clast.contact.contacts import ContactResponse, Contacts
from clast.model.model import Floats, Ints
from clast.model.state import ContactMemory


def recall(memory: ContactMemory, vertex: Ints, block: Ints, edge: Ints) -> Ints:
    """Return the memory row of each contact (vertex, block of the edge, edge), or -1, (m,)."""
    rows: Ints = kernel.rows_of(vertex, block, edge, memory.vertex, memory.block, memory.edge)
    return rows


def renew(
    contacts: Contacts, response: ContactResponse, gap: Floats, critdis: float
) -> ContactMemory:
    """Return the memory after a step; ``gap`` (m,) at its end, m.

    A contact that has opened forgets its shear force; one that is open further than critdis
    loses its bond.
    """
    columns = kernel.renewed(
        contacts.vertex,
        contacts.edge_block,
        contacts.edge,
        gap,
        response.normal_force,
        response.shear_force,
        contacts.multiplier,
        response.mode,
        response.bonded,
        critdis,
    )
    names = ("vertex", "block", "edge", "gap", "normal_force", "shear_force", "multiplier")
    return ContactMemory(**dict(zip((*names, "mode", "bonded"), columns, strict=True)))
