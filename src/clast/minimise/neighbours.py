"""Which blocks are neighbours, and which contacts some blocks have."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


@kernel()
def with_neighbours(chosen, pairs):
    """Return True for blocks ``chosen`` (n,) and for those with which they share ``pairs``."""
    grown = chosen.copy()
    for q in range(len(pairs)):
        if chosen[pairs[q, 0]] or chosen[pairs[q, 1]]:
            grown[pairs[q, 0]] = grown[pairs[q, 1]] = True
    return grown


@kernel()
def touching(chosen, pairs, start):
    """Return the pairs (k,) that have a block ``chosen`` (n,), and their contacts (c,).

    Contacts ``start[q]`` to ``start[q + 1]`` - 1 are those of pair q.  Last, for each of these
    contacts, which of the k pairs is its own (c,).
    """
    of_pairs, count = np.empty(len(pairs), np.int64), 0
    contacts = 0
    for q in range(len(pairs)):
        if chosen[pairs[q, 0]] or chosen[pairs[q, 1]]:
            of_pairs[count] = q
            count += 1
            contacts += start[q + 1] - start[q]
    of_contacts, own = np.empty(contacts, np.int64), np.empty(contacts, np.int64)
    at = 0
    for k in range(count):
        for c in range(start[of_pairs[k]], start[of_pairs[k] + 1]):
            of_contacts[at], own[at] = c, k
            at += 1
    return of_pairs[:count], of_contacts, own
