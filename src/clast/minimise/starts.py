"""How far several starts of a minimisation are from its end, island by island."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.contact.clipped_spring import forces_at
from clast.linear.assembly import contact_motions
from clast.linear.residual import left_at
from clast.minimise.line_search import island_sums


@kernel()
def left_at_starts(system, graph, contacts, table, islands, starts):
    """Return the distance to the minimum that each island has at each start, J/m, (k, islands).

    ``system``, ``graph`` and ``contacts`` as linear/residual.py has them; ``table`` are the edge
    blocks, gaps, slips (m,) and springs of the links (Springs.arrays), ``islands`` those of the
    blocks (n,) and their number, ``starts`` (k, n, 6) the unknowns.
    """
    vertex_block, arms = contacts
    edge_block, gap, slip, springs = table
    of_blocks, count = islands
    normal = np.empty((len(starts), len(gap)))
    shear = np.empty_like(normal)
    for k in range(len(starts)):
        opening, sliding = contact_motions(vertex_block, edge_block, arms, starts[k])
        answer = forces_at(gap + opening, slip + sliding, springs)
        normal[k], shear[k] = answer[0], answer[1]
    left = left_at(system, graph, contacts, starts, normal, shear)
    found = np.empty((len(starts), count))
    for k in range(len(starts)):
        found[k] = island_sums(left[k], of_blocks, count)
    return found
