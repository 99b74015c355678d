"""How contacts are approached at the start of a step: which collide, and which hold at first."""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel


@kernel()
def collide(gap, rate, threshold, step, ends, value, of_blocks):
    """Write ``value`` for the blocks of contacts that collide, in place.

    These close faster than ``threshold``, m/s, and within the ``step``, s.  ``gap`` (m,) in m and
    its ``rate`` (m,) in m/s are those at the start, ``ends`` the contacts' two blocks (m,).
    """
    vertex_block, edge_block = ends
    for c in range(len(gap)):
        if rate[c] < -threshold and gap[c] + step * rate[c] < 0.0:
            of_blocks[vertex_block[c]] = of_blocks[edge_block[c]] = value


@kernel()
def first_bases(normal_force, gap, rates, slow, landing, step, begins, largest):
    """Return the normal forces (m,), N/m, that bound friction at first (stepping/convex.py).

    That of the last step where there was any; else ``largest`` where a contact lands without
    slipping or, where the run ``begins``, is without slipping; else none.  It slips at more than
    ``slow``, m/s, and lands where it closes faster than ``landing``, m/s, and within the step.
    """
    opening, slip = rates
    base = np.empty(len(gap))
    for c in range(len(gap)):
        lands = (opening[c] < -landing) & (gap[c] + step * opening[c] < 0.0)
        holds = (abs(slip[c]) <= slow) & (lands | begins)
        base[c] = normal_force[c] if normal_force[c] > 0.0 else largest if holds else 0.0
    return base
