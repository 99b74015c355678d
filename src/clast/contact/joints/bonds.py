"""Bonds of contacts: their places, and their loss by slip and tension.

Contacts along a joint with strength are bonded where the joint is closed at the start of the run:
where coordinates leave no gap but that of their rounding.  One that is open holds nothing, however
little, and whatever closes it later.  A bond has the cohesion c and the tensile strength sigma_t
of its joint.

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
from clast.contact.joints.flush import flush_edges, had_by_faces
from clast.contact.joints.weakening import friction_of, share_lost, slide_lengths
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory

ROUNDED = 1e-5
"""Gap of faces that are drawn as one line, in units of the size of the smaller block.

Coordinates with five decimals on blocks of 1 m leave as much; cut rock is closed to 1e-15.
"""


@dataclass(frozen=True)
class Bonds:
    """The remaining bonds of contacts."""

    bonded: Bools
    """True while cohesion and tensile strength are intact, shape (m,)."""
    cohesive: Bools
    """True while bonded, or slipped but not opened since, shape (m,)."""


def bonded_at_start(places: Places, model: Model, direction: Floats) -> Bools:
    """Return which contacts that have no memory are bonded when the run starts, (m,).

    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    return are_closed(places, model, direction) & (places.row < 0)


def are_closed(places: Places | Contacts, model: Model, direction: Floats) -> Bools:
    """Return along which contacts a joint is closed, over the length that each stands for, (m,).

    ``direction`` (nv, 2) are the unit vectors of edges.
    """
    wedge = np.zeros(len(places.gap))
    along = flush_edges(places.vertex, places.edge, direction, model.block_start)
    for own in (np.where(places.point > 0, places.vertex, one) for one in along):
        one, other = direction[own], direction[places.edge]
        sine = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
        wedge = np.maximum(wedge, np.where(own >= 0, sine, 0.0))
    return np.asarray(places.gap + wedge * places.length <= _rounded(places, model))


def _rounded(places: Places | Contacts, model: Model) -> Floats:
    """Return the gaps that rounding of coordinates leaves at contacts, m, (m,)."""
    blocks = places.vertex_block, places.edge_block
    return np.asarray(ROUNDED * np.sqrt(np.minimum(*(model.area.take(one) for one in blocks))))


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
            bonds = _taken_along(bonds, new, places, memory, direction, model)
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
    model: Model,
) -> Bonds:
    """Return the bonds with those of contacts ``new`` (k,) that their faces had elsewhere.

    A face has those of the contacts that it lay on another face with, and takes them to a face
    that is no farther away than these give way.
    """
    ends = places.vertex[new], places.edge[new]
    had = tuple(np.where(kept, memory.gap, np.nan) for kept in (memory.bonded, memory.cohesive))
    given = had_by_faces(had, memory, ends, direction, model.block_start)
    closed = _rounded(places, model)[new]
    result = []
    for kept, gap in zip((bonds.bonded, bonds.cohesive), given, strict=True):
        kept = kept.copy()
        # NaN, where the faces had none, is no bound
        kept[new] |= places.gap[new] <= np.maximum(np.abs(gap), closed)
        result.append(kept)
    return Bonds(*result)
