"""Peak and residual strength: what is left of it after sliding.

    tan(phi) = tan(phi_p) + s (tan(phi_r) - tan(phi_p))        s = min(1, slid / slip_weakening)

and likewise cohesion, from all of it to the residual one, and tensile strength, to nothing.
``slid`` is how far a contact has slid, to and fro, by the start of the step: within a step
strengths are constant, so that the equations of a step stay those of Coulomb's law.

Contacts that are closed at the start of the run have their peak strength.  One that comes up
between two blocks that touch already has slid as far as these have; between blocks that meet anew
there is the residual strength: their faces have never fitted each other.
"""

from __future__ import annotations

import numpy as np

from clast.contact.joints.faces import Places
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory

LEAST = 1e-12
"""Way of sliding, m, after which a joint that weakens at once has its residual strength."""


def slide_lengths(
    carried: Floats, bonded: Bools, places: Places, memory: ContactMemory, model: Model
) -> Floats:
    """Return how far contacts have slid, m, (m,), given what they remember of themselves.

    ``carried`` (m,) is 0 and ``bonded`` (m,) False for contacts that come up after the start.
    """
    table = model.joint_table
    new = np.flatnonzero((places.row < 0) & ~bonded)
    if not len(new):
        return carried
    count, before = model.block_count, model.vertex_block.take(memory.vertex)
    known = _pair(before, memory.block, count)
    pairs, of_pair = np.unique(known, return_inverse=True)
    longest = np.zeros(len(pairs) + 1)
    np.maximum.at(longest, of_pair, memory.slide_length)
    wanted = _pair(places.vertex_block[new], places.edge_block[new], count)
    at = np.minimum(np.searchsorted(pairs, wanted), max(0, len(pairs) - 1))
    found = pairs[at] == wanted if len(pairs) else np.zeros(len(new), np.bool_)
    worn = np.maximum(table.slip_weakening, LEAST).take(places.joint[new])
    slid = carried.copy()
    slid[new] = np.where(found, longest[at], worn)
    return slid


def _pair(one: Ints, other: Ints, count: int) -> Ints:
    """Return a number for each pair of blocks (k,), whichever comes first."""
    return np.minimum(one, other) * count + np.maximum(one, other)


def weakened_friction(table: JointTable, places: Places, slid: Floats) -> Floats:
    """Return tan(phi) of contacts that have slid so far, m, shape (m,)."""
    peak = table.strengths[0].take(places.joint)
    if not table.weakens:
        return peak
    left = table.residual_friction.take(places.joint)
    return np.where(np.isnan(left), peak, peak + share_lost(table, places, slid) * (left - peak))


def share_lost(table: JointTable, places: Places, slid: Floats) -> Floats:
    """Return which share of the way from peak to residual strength contacts have gone, (m,)."""
    over = np.maximum(table.slip_weakening, LEAST).take(places.joint)
    return np.asarray(np.minimum(1.0, slid / over))
