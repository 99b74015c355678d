"""Peak and residual strength, static and kinetic friction: strength after sliding.

    tan(phi) = tan(phi_p) + s (tan(phi_r) - tan(phi_p))        s = min(1, slid / slip_weakening)

and likewise cohesion, from all of it to the residual one, and tensile strength, to nothing.
``slid`` is how far a contact has slid, to and fro, by the start of the step: within a step
strengths are constant, so that the equations of a step stay those of Coulomb's law.

Friction of a contact that slid in the last step, at a speed v, falls further, to the kinetic one:

    tan(phi) = tan(phi_s) + min(1, v/v_c) (tan(phi_k) - tan(phi_s))

with v_c = 0 at once.  In statics nothing has a speed.

Contacts that are closed at the start of the run have their peak strength.  How far they have slid
belongs to their faces, as bonds do (contact/joints/bonds.py): a contact that comes up where a face
slides on, to the next piece of its plane as well, has slid as far as the face has.  Where neither
face has carried there is the residual strength: they have never fitted each other.
"""

from __future__ import annotations

import numpy as np

from clast.contact.joints.barton_bandis import mobilised, rough_contacts
from clast.contact.joints.faces import Places
from clast.contact.joints.flush import had_by_faces
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import ContactMemory


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
    ends = places.vertex[new], places.edge[new]
    (known,) = had_by_faces((memory.slide_length,), memory, ends, direction, model.block_start)
    worn = model.joint_table.worn_after.take(places.joint[new])
    slid = carried.copy()
    slid[new] = np.where(known >= 0.0, known, worn)
    return slid


def friction_of(table: JointTable, places: Places, slid: Floats, speed: Floats) -> Floats:
    """Return tan(phi) of contacts that have slid so far, m, and slide at a speed, m/s, (m,)."""
    static = _weakened(table, places, slid)
    if not table.has_kinetic_friction:
        return static
    kinetic = table.kinetic_friction.take(places.joint)
    critical = table.critical_speed.take(places.joint)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(speed > 0.0, np.minimum(1.0, speed / critical), 0.0)
    slower = static + share * (np.minimum(kinetic, static) - static)
    return np.where(np.isnan(kinetic), static, slower)


def _weakened(table: JointTable, places: Places, slid: Floats) -> Floats:
    """Return tan(phi) of contacts that have slid so far, m, and stand, shape (m,)."""
    peak = table.strengths[0].take(places.joint)
    if not table.weakens:
        return peak
    left = table.residual_friction.take(places.joint)
    lost = share_lost(table, places.joint, slid)
    return np.where(np.isnan(left), peak, peak + lost * (left - peak))


def share_lost(table: JointTable, joint: Ints, slid: Floats) -> Floats:
    """Return by which share contacts have fallen from peak to residual strength, (m,)."""
    return np.asarray(np.minimum(1.0, slid / table.worn_after.take(joint)))


def strength_lost(table: JointTable, joint: Ints, slid: Floats, bonded: Bools) -> Floats:
    """Return which share of what they can lose contacts along ``joint`` (k,) have lost, (k,).

    0 at the peak, 1 at the residual strength; ``slid`` (k,) is how far they have slid, m.  Bonds
    that are broken are lost; of a rough joint beyond its peak it is the roughness that is lost.
    """
    loses = ~np.isnan(table.residual_friction)
    loses |= ~np.isnan(table.residual_cohesion) & (table.slip_weakening > 0.0)
    lost = np.where(loses.take(joint), share_lost(table, joint, slid), 0.0)
    rough = rough_contacts(table, joint)
    if rough is not None:
        x = slid[rough.rows] / rough.peak_slip
        lost[rough.rows] = np.where(x > 1.0, 1.0 - mobilised(x), 0.0)
    _, cohesion, tensile_strength = table.strengths
    binds = ((cohesion > 0.0) | (tensile_strength > 0.0)).take(joint)
    return np.where(binds & ~bonded, 1.0, lost)
