"""Wear of joints by a step of sliding: slides, their speeds, openings, and where work went.

A joint opens by tan(psi) of its slide, and closes as it slides back:

    u = tan(psi) min(|s|, until)                  psi = m(s/u_peak) i/2 of a rough one

with the stress of the moment, which is why increments are added up.  An opening is the rest gap of
the contact's spring in the next step.  It works against the normal force: that is what shearing
has put in beyond what friction loses, and the ledger takes it from what friction has lost.  So the
friction angle of a joint that opens is all of its angle, and no less than psi.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.compute.reductions import is_any
from clast.contact.contacts import LOCK, OPEN, SLIDE, ContactResponse, Contacts
from clast.contact.joints.barton_bandis import mobilised, rough_contacts, stress_on
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints
from clast.read_only import read_only

NONE = read_only(np.zeros(0, np.int64))
"""Rows of no contact."""
SEEN = 1e-6
"""Least slip of a step that counts as sliding, in units of that at the peak."""


@dataclass(frozen=True, kw_only=True)
class Wear:
    """Slides of contacts in a step, and how far these open them."""

    way: Floats
    """Length of the way of sliding in the step, m, shape (m,)."""
    slid: Floats
    """By how much the places that face each other move on, m, along t, shape (m,)."""
    speed: Floats
    """Speed of it, m/s, shape (m,)."""
    dilation: Floats
    """Opening by all sliding, m, shape (m,)."""


def at_rest(contacts: Contacts) -> Wear:
    """Return the wear of a step in which nothing slides."""
    none = np.zeros(len(contacts))
    return Wear(way=none, slid=none, speed=none, dilation=contacts.dilation)


def borne_already(table: JointTable, contacts: Contacts, response: ContactResponse) -> Wear:
    """Return the wear of contacts that have borne their forces for long, in situ.

    Rough ones have slid as far as it takes to mobilise their shear force.
    """
    wear, rough = at_rest(contacts), rough_contacts(table, contacts.joint)
    if rough is None:
        return wear
    rows, way = rough.rows, wear.way.copy()
    normal = response.normal_force[rows]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(normal > 0.0, np.abs(response.shear_force[rows]) / normal, 0.0)
    stress = stress_on(normal, contacts.spring_length[rows])
    way[rows] = rough.slide_to_mobilise(ratio, rough.roughness_angle(stress))
    return replace(wear, way=way)


def wear_of(
    table: JointTable, contacts: Contacts, response: ContactResponse, slip: Floats, rate: float
) -> Wear:
    """Return the wear of a step of sliding; ``slip`` (m,) is that of the step, m.

    ``rate`` is 1/h, 1/s, of a step in which blocks have velocities, 0 in statics.
    """
    forces = response.mode, response.shear_force, response.dissipation
    made = (contacts.slip != 0.0) | (contacts.mode != OPEN) | contacts.bonded
    way, slid = _slides(slip, forces, (contacts.mobilises, made))
    dilation = contacts.dilation
    if table.opens:
        dilation = dilation + opening(table, contacts, response.normal_force, slid)
    return Wear(way=way, slid=slid, speed=_speeds(contacts, way, slip, rate), dilation=dilation)


def _speeds(contacts: Contacts, way: Floats, slip: Floats, rate: float) -> Floats:
    """Return the speeds of sliding, m/s, (m,).

    What slides does so until it turns back: where the normal force rises the spring of a contact
    may catch up with its bound for a step, and friction would be static in the midst of a slide.
    """
    goes_on = (contacts.slide_speed > 0.0) & (contacts.shear_force * slip < 0.0)
    if not is_any(goes_on):
        return rate * way
    return rate * np.where(goes_on, np.maximum(way, np.abs(slip)), way)


@kernel()
def _slides(slip, forces, known):
    """Return ways and slides of contacts (m,), m: slip that no spring keeps."""
    way, slid = np.empty(len(slip)), np.empty(len(slip))
    _slide(len(slip), slip, forces, known, way, slid)
    return way, slid


@shared(CONTACTS)
def _slide(first, last, slip, forces, known, way, slid):
    """Write ways and slides of contacts ``first`` to ``last`` - 1, m.

    An open contact does not wear, but it has other places in front of it when it closes.
    """
    mode, shear, loss = forces
    mobilises, made = known
    for c in range(first, last):
        slid[c] = 0.0
        if mode[c] == SLIDE:
            # of the slip, what the shear force has worked on
            slid[c] = -loss[c] / shear[c] if shear[c] != 0.0 else slip[c]
        if mobilises[c] and mode[c] != OPEN:
            slid[c] = slip[c]
        way[c] = abs(slid[c])
        if mode[c] == OPEN and made[c]:
            slid[c] = slip[c]


def opening(table: JointTable, contacts: Contacts, normal: Floats, slid: Floats) -> Floats:
    """Return how far contacts open as they slide, m, (m,), negative where they close again.

    ``normal`` (m,) are their forces, N/m, ``slid`` (m,) is the slide of the step, m.
    """
    joint = contacts.joint
    tangent, until = (one.take(joint) for one in table.dilation)
    before, after = np.abs(contacts.slide), np.abs(contacts.slide + slid)
    opened = tangent * (np.minimum(after, until) - np.minimum(before, until))
    rough = rough_contacts(table, joint)
    if rough is not None:
        rows = rough.rows
        angle = rough.roughness_angle(stress_on(normal[rows], contacts.spring_length[rows]))
        halfway = 0.5 * (before + after)[rows] / rough.peak_slip
        half = 0.5 * mobilised(halfway) * angle
        opened[rows] = np.tan(half) * (after - before)[rows]
    return np.maximum(opened, -contacts.dilation)


def with_work_of_joints(
    table: JointTable,
    contacts: Contacts,
    response: ContactResponse,
    stiffness: Floats,
    sheared: tuple[Floats, Floats],
    opened: Floats,
) -> ContactResponse:
    """Return the answer of a law with the energies of rough joints, and of those that open, J/m.

    ``stiffness`` (m,) are those of normal springs, N/m per m, 0 where multipliers stand in for
    them; ``sheared`` are the shear forces of the equations, N/m, and slips, m, (m,) each, and
    ``opened`` (m,), m, is by how much the contacts open before the next step.
    The energy of a rough joint is that of its closure; all work of shearing it is lost, less what
    the shear force gives back.
    """
    energy, loss = response.energy.copy(), response.dissipation.copy()
    normal, mode = response.normal_force, response.mode
    rough = rough_contacts(table, contacts.joint)
    if rough is not None:
        rows = rough.rows
        length = contacts.spring_length[rows]
        energy[rows] = length * rough.energy(stress_on(normal[rows], length))
        loss[rows] = -(sheared[0] * sheared[1])[rows]
        # what goes along the rising branch of its strength slides
        along = (sheared[0] * sheared[1] < 0.0) & (response.mode == LOCK) & contacts.mobilises
        along[rows] &= np.abs(sheared[1][rows]) > SEEN * rough.peak_slip
        mode = np.where(along, SLIDE, response.mode)
    work = np.maximum(normal, 0.0) * opened
    # that the opening comes on at once, and is given way to in the next step, is the scheme's doing
    pressed = np.where(normal > 0.0, 0.5 * stiffness * opened**2, 0.0)
    return replace(response, mode=mode, energy=energy + work + pressed, dissipation=loss - work)


def reaches_residual(table: JointTable, contacts: Contacts, way: Floats) -> Ints:
    """Return contacts of joints that wear off which are the first of theirs to do so, (r,).

    ``way`` (m,) is the way of sliding of the step, m.
    """
    if not table.weakens:
        return NONE
    worn_after: Floats = table.worn_after.take(contacts.joint)
    wears: Bools = _wears(table).take(contacts.joint)
    before = contacts.slide_length
    now = wears & (before < worn_after) & (before + way >= worn_after)
    if not now.any():
        return np.zeros(0, np.int64)
    earlier = np.unique(contacts.joint[wears & contacts.known & (before >= worn_after)])
    return np.flatnonzero(now & ~np.isin(contacts.joint, earlier))


def _wears(table: JointTable) -> Bools:
    """Return which joints lose strength over a way of sliding, (joints,)."""
    residual = ~np.isnan(table.residual_friction) | ~np.isnan(table.residual_cohesion)
    return np.asarray(table.rough | (residual & (table.slip_weakening > 0.0)))
