"""Bonds of contacts: their places, and their loss by slip and tension.

Contacts along a joint with strength are bonded where the joint is closed at the start of the run.
A bond has the cohesion c and the tensile strength sigma_t of its joint.

- Tension beyond sigma_t, or a gap beyond critdis, ends both for good.
- Slip ends nothing where the joint is ideally plastic: |T| <= N tan(phi) + c L however far it
  slips, as limit equilibrium has it.  A joint with a residual cohesion is brittle: the first slip
  ends the bond, and leaves that cohesion until the contact opens; or it goes with the way of
  sliding (contact/joints/weakening.py), and the bond ends when none of that is left.

Cohesion belongs to the plane, not to the corner that was there first.  A face that slides on takes
its bonds along: a contact that comes up where faces lie on each other is bonded as they are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.joints.faces import Places
from clast.contact.joints.flush import flush_edges
from clast.contact.joints.weakening import friction_of, share_lost, slide_lengths
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory


@dataclass(frozen=True)
class Bonds:
    """The remaining bonds of contacts."""

    bonded: Bools
    """True while cohesion and tensile strength are intact, shape (m,)."""
    cohesive: Bools
    """True while bonded, or slipped but not opened since, shape (m,)."""


def torn(contacts: Contacts, response: ContactResponse) -> Bools:
    """Return which bonds end because of tension, shape (m,)."""
    ended = contacts.bonded & ~response.bonded
    in_tension: Bools = ended & (response.normal_force < 0.0)
    return in_tension


def without_bonds(contacts: Contacts, response: ContactResponse) -> Contacts:
    """Return the contacts without the bonds that the ``response`` says have ended."""
    ended, cohesive = contacts.bonded & ~response.bonded, contacts.cohesive
    cohesive = cohesive & ~torn(contacts, response)
    residual = contacts.residual_cohesion
    # a law of one's own may end bonds that slip leaves whole
    slipped = np.where(np.isnan(residual), contacts.cohesion, residual)
    left = np.where(cohesive, slipped, 0.0)
    return replace(
        contacts,
        bonded=contacts.bonded & response.bonded,
        cohesive=cohesive,
        cohesion=np.where(ended, left, contacts.cohesion),
        tensile_strength=np.where(ended, 0.0, contacts.tensile_strength),
    )


def bonds_of(
    bonds: Bonds,
    slid: Floats,
    speed: Floats,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    model: Model,
) -> dict[str, Any]:
    """Return friction, bonds and the strengths that they have left, (m,) each by its name.

    ``bonds`` are those that the contacts at ``places`` have of themselves, ``slid`` (m,) is how far
    they remember to have slid, m, ``speed`` (m,) how fast in the last step, m/s;
    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    table, joint = model.joint_table, places.joint
    _, cohesion, tensile_strength = table.strengths
    if table.weakens:
        slid = slide_lengths(slid, bonds.bonded, places, memory, direction, model)
    residual = table.residual_cohesion
    if not table.binds:
        none = np.zeros(len(joint))
        return {
            "bonded": bonds.bonded,
            "cohesive": bonds.cohesive,
            "slide_length": slid,
            "friction": friction_of(table, places, slid, speed),
            "cohesion": none,
            "residual_cohesion": residual.take(joint),
            "tensile_strength": none,
        }
    if memory.cohesive.any():
        lasts = (cohesion > 0.0) & ~(residual == 0.0)
        new = np.flatnonzero((places.row < 0) & lasts.take(joint) & ~bonds.bonded)
        if len(new):
            bonds = _taken_along(bonds, new, places, memory, direction, model.block_start)
    bonded, left = bonds.bonded, np.where(np.isnan(residual), cohesion, residual)
    whole, ended, tension = (one.take(joint) for one in (cohesion, left, tensile_strength))
    slips = residual.take(joint)
    gradual = (table.slip_weakening > 0.0).take(joint) & ~np.isnan(slips)
    if gradual.any():
        lost = np.where(gradual, share_lost(table, places.joint, slid), 0.0)
        whole, tension = whole + lost * (ended - whole), (1.0 - lost) * tension
        slips = np.where(gradual & (lost < 1.0), np.nan, slips)
    return {
        "bonded": bonded,
        "cohesive": bonds.cohesive,
        "slide_length": slid,
        "friction": friction_of(table, places, slid, speed),
        "cohesion": np.where(bonded, whole, np.where(bonds.cohesive, ended, 0.0)),
        "residual_cohesion": slips,
        "tensile_strength": np.where(bonded, tension, 0.0),
    }


def _taken_along(
    bonds: Bonds,
    new: Ints,
    places: Places,
    memory: ContactMemory,
    direction: Floats,
    block_start: Ints,
) -> Bonds:
    """Return the bonds with those of contacts ``new`` (k,) that their faces had elsewhere.

    A face has those of the contacts that it lay on another face with.
    """
    along = flush_edges(memory.vertex, memory.edge, direction, block_start)
    vertex, edge = places.vertex[new], places.edge[new]
    mine = flush_edges(vertex, edge, direction, block_start)
    result = []
    for kept, had in ((bonds.bonded, memory.bonded), (bonds.cohesive, memory.cohesive)):
        # of every edge, and of -1, which is none
        face = np.zeros(len(direction) + 1, np.bool_)
        for own in along:
            face[np.where(had & (own >= 0), own, -1)] = True
            face[np.where(had & (own >= 0), memory.edge, -1)] = True
        face[-1] = False
        found = [(own >= 0) & (face[own] | face[edge]) for own in mine]
        kept = kept.copy()
        kept[new] |= found[0] | found[1]
        result.append(kept)
    return Bonds(*result)
