"""Peak and residual strength: the strength after sliding.

    tan(phi) = tan(phi_p) + s (tan(phi_r) - tan(phi_p))        s = min(1, slid / slip_weakening)

and likewise cohesion, from all of it to the residual one, and tensile strength, to nothing.
``slid`` is how far a contact has slid, to and fro, by the start of the step: within a step
strengths are constant, so that the equations of a step stay those of Coulomb's law.

Contacts that are closed at the start of the run have their peak strength.  How far they have slid
belongs to their faces, as bonds do (contact/joints/bonds.py): a contact that comes up where a face
slides on, to the next piece of its plane as well, has slid as far as the face has.  Where neither
face has carried there is the residual strength: they have never fitted each other.
"""

from __future__ import annotations

import numpy as np

from clast.contact.joints.faces import Places
from clast.contact.joints.flush import flush_edges
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Model
from clast.model.state import ContactMemory

LEAST = 1e-12
"""Way of sliding, m, after which a joint that weakens at once has its residual strength."""


def slide_lengths(
    carried: Floats,
    bonded: Bools,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> Floats:
    """Return how far contacts have slid, m, (m,), given their memory.

    ``carried`` (m,) is 0 and ``bonded`` (m,) False for contacts that come up after the start;
    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    new = np.flatnonzero((places.row < 0) & ~bonded)
    if not len(new):
        return carried
    # of every edge, and of -1, which is none; negative where nothing is known of it
    way = np.full(len(direction) + 1, -1.0)
    for own in flush_edges(memory.vertex, memory.edge, direction, model.block_start):
        flush = own >= 0
        np.maximum.at(way, own[flush], memory.slide_length[flush])
        np.maximum.at(way, memory.edge[flush], memory.slide_length[flush])
    vertex, edge = places.vertex[new], places.edge[new]
    known = np.full(len(new), -1.0)
    for own in flush_edges(vertex, edge, direction, model.block_start):
        known = np.maximum(known, np.where(own >= 0, np.maximum(way[own], way[edge]), -1.0))
    worn = np.maximum(model.joint_table.slip_weakening, LEAST).take(places.joint[new])
    slid = carried.copy()
    slid[new] = np.where(known >= 0.0, known, worn)
    return slid


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
