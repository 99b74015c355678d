"""Wear of joints by a step of sliding: slides, their speeds, openings, and where work went.

A joint opens by tan(psi) of its slide, and closes as it slides back:

    u = tan(psi) min(|s|, until)                  psi = m(s/u_peak) i/2 of a rough one

with the stress of the moment, which is why increments are added up.  An opening is the rest gap of
the contact's spring in the next step.  It works against the normal force: that is what shearing
has put in beyond what friction loses, and the ledger takes it from what friction has lost.  So the
friction angle of a joint that opens is all of its angle, and no less than psi.  In dynamic steps of
the convex process contacts have opened by then (contact/joints/asperities.py).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared
from clast.compute.reductions import is_any
from clast.contact.contacts import LOCK, OPEN, SLIDE, ContactResponse, Contacts
from clast.contact.joints.asperities import Asperities
from clast.contact.joints.barton_bandis import (
    RoughContacts,
    mobilised,
    rough_contacts,
    stress_on,
)
from clast.contact.laws import has_multipliers, normal_stiffness_of
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints
from clast.read_only import changed, read_only

NONE = read_only(np.zeros(0, np.int64))
"""Rows of no contact."""
SLIP_MIN = 1e-6
"""Least slip of a step that counts as sliding, in units of that at the peak."""
LANDS = 1e-6
"""Share of its normal force with which a contact begins at most that lands in the step."""


@dataclass(frozen=True, kw_only=True)
class Wear:
    """Slides of contacts in a step, and how far these open them."""

    path: Floats
    """Length of the path of sliding in the step, m, shape (m,)."""
    slid: Floats
    """By how much the places that face each other move on, m, along t, shape (m,)."""
    speed: Floats
    """Speed of it, m/s, shape (m,)."""
    dilation: Floats
    """Opening by all sliding, m, shape (m,)."""


def at_rest(contacts: Contacts) -> Wear:
    """Return the wear of a step in which nothing slides."""
    none = np.zeros(len(contacts))
    return Wear(path=none, slid=none, speed=none, dilation=contacts.dilation)


def borne_already(table: JointTable, contacts: Contacts, response: ContactResponse) -> Wear:
    """Return the wear of contacts that have borne their forces for long, in situ.

    Rough ones have slid as far as it takes to mobilise their shear force.
    """
    wear, rough = at_rest(contacts), rough_contacts(table, contacts.joint)
    if rough is None:
        return wear
    rows, path = rough.rows, wear.path.copy()
    normal = response.normal_force[rows]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(normal > 0.0, np.abs(response.shear_force[rows]) / normal, 0.0)
    stress = stress_on(normal, contacts.spring_length[rows])
    path[rows] = rough.slide_to_mobilise(ratio, rough.roughness_angle(stress))
    return replace(wear, path=path)


def wear_of(
    table: JointTable, contacts: Contacts, response: ContactResponse, slip: Floats, rate: float
) -> Wear:
    """Return the wear of a step of sliding; ``slip`` (m,) is that of the step, m.

    ``rate`` is 1/h, 1/s, of a step in which blocks have velocities, 0 in statics.
    """
    forces = response.mode, response.shear_force, response.dissipation
    made = (contacts.slip != 0.0) | (contacts.mode != OPEN) | contacts.bonded
    path, slid = _slides(slip, forces, (contacts.mobilises, made))
    dilation = contacts.dilation
    if table.opens:
        dilation = dilation + opening(table, contacts, response.normal_force, slid)
    return Wear(path=path, slid=slid, speed=_speeds(contacts, path, slip, rate), dilation=dilation)


def _speeds(contacts: Contacts, path: Floats, slip: Floats, rate: float) -> Floats:
    """Return the speeds of sliding, m/s, (m,).

    What slides does so until it turns back: where the normal force rises the spring of a contact
    may catch up with its bound for a step, and friction would be static in the midst of a slide.
    """
    goes_on = (contacts.slide_speed > 0.0) & (contacts.shear_force * slip < 0.0)
    if not is_any(goes_on):
        return rate * path
    return rate * np.where(goes_on, np.maximum(path, np.abs(slip)), path)


@kernel()
def _slides(slip, forces, known):
    """Return paths and slides of contacts (m,), m: slip that no spring keeps."""
    path, slid = np.empty(len(slip)), np.empty(len(slip))
    _slide(len(slip), slip, forces, known, path, slid)
    return path, slid


@shared(CONTACTS)
def _slide(first, last, slip, forces, known, path, slid):
    """Write paths and slides of contacts ``first`` to ``last`` - 1, m.

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
        path[c] = abs(slid[c])
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
        mode = _mode_along(rough, contacts, response, sheared[1])
    work = np.maximum(normal, 0.0) * opened
    # that the opening comes on at once, and is yielded to in the next step, is the scheme's doing
    pressed = np.where(normal > 0.0, 0.5 * stiffness * opened**2, 0.0)
    return replace(response, mode=mode, energy=energy + work + pressed, dissipation=loss - work)


def _mode_along(
    rough: RoughContacts, contacts: Contacts, response: ContactResponse, slip: Floats
) -> Ints:
    """Return the modes of contacts (m,): contacts on the rising branch slide."""
    along = (response.shear_force * slip < 0.0) & (response.mode == LOCK) & contacts.mobilises
    along[rough.rows] &= np.abs(slip[rough.rows]) > SLIP_MIN * rough.peak_slip
    return np.where(along, SLIDE, response.mode)


@dataclass(frozen=True, kw_only=True)
class EndOfSlip:
    """Contacts at the end of a step in which they have opened by slip."""

    wear: Wear
    response: ContactResponse
    """Their forces in the step, and energies at its end."""
    normal_force: Floats
    """N that they go on with, N/m, shape (m,)."""
    shear_force: Floats
    """T that they go on with, N/m, shape (m,)."""


def after_slip(
    asperities: Asperities,
    contacts: Contacts,
    response: ContactResponse,
    ends: tuple[Floats, Floats],
    normal: Floats,
    rate: float,
) -> EndOfSlip:
    """Return the end of a step in which contacts have opened by their slip (asperities.py).

    ``ends`` are gap and slip (m,) at the end, m, ``normal`` (m,) is N of the equations, N/m, and
    ``rate`` is 1/h, 1/s.  What a slope of the start of the step has not known - a slide begins,
    turns back past its beginning, ends to open, or follows a curve - is made up for as far as
    friction has lost as much in the step.
    """
    table, slope, rows, (gap, slip) = asperities.joints, asperities.slope, asperities.rows, ends
    wear, slides = (
        wear_of(table, contacts, response, slip, rate),
        asperities.slides(contacts, *ends),
    )
    mode, path, slid, opened = (
        response.mode,
        wear.path.copy(),
        wear.slid.copy(),
        np.zeros(len(slip)),
    )
    bears = mode[rows] != OPEN
    rubs = bears & ~contacts.mobilises[rows]
    path[rows] = np.where(rubs, np.abs(slides.rubbed), path[rows])
    slid[rows] = np.where(rubs, slides.slid, slid[rows])
    opened[rows] = slope[rows] * slides.slid
    # by the angle of the stress that slopes are of
    bore = contacts.normal_force > LANDS * np.maximum(response.normal_force, 0.0)
    begun = np.where(bore, contacts.normal_force, response.normal_force)
    wanted = opening(table, contacts, begun, slid) - opened
    rest, reached, energy, loss = _made_up_for(asperities, contacts, response, gap - opened, wanted)
    dilation = np.maximum(contacts.dilation + opened + rest, 0.0)
    work = -normal * (gap - contacts.gap - opened)
    places = gap + contacts.rest_gap, dilation
    reached, energy = _closed(table, contacts, (reached, energy), places, work)
    # where T is not that of its spring, it goes on with what friction pays for
    shear, friction = response.shear_force.copy(), slides.friction**2
    more = np.where(slides.keeps, 0.0, shear[rows] ** 2 - friction)
    elastic = asperities.elastic[rows]
    more = np.minimum(more, 2.0 * elastic * loss[rows])
    shear[rows] = np.where(
        slides.keeps, shear[rows], np.copysign(np.sqrt(friction + more), shear[rows])
    )
    energy[rows] += 0.5 * more / elastic
    loss[rows] -= np.maximum(0.5 * more / elastic, 0.0)
    rough = rough_contacts(table, contacts.joint)
    if rough is not None:
        mode = _mode_along(rough, contacts, response, slip)
    speed = _speeds(contacts, path, slip, rate)
    return EndOfSlip(
        wear=Wear(path=path, slid=slid, speed=speed, dilation=dilation),
        response=changed(response, mode=mode, energy=energy, dissipation=loss),
        normal_force=reached,
        shear_force=shear,
    )


def _made_up_for(
    asperities: Asperities,
    contacts: Contacts,
    response: ContactResponse,
    gap: Floats,
    wanted: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return openings after the step, m, N then, N/m, energies and losses, J/m, (m,) each.

    ``wanted`` (m,), m, is by how much contacts are to open, or to close, ``gap`` (m,) where they
    are, m.  They open by no more than friction pays.
    """
    normal, loss = response.normal_force, np.maximum(response.dissipation, 0.0)
    p = normal_stiffness_of(contacts, asperities.law)
    free = np.where(normal == 0.0, np.maximum(gap, 0.0), 0.0)
    reach = free + (np.sqrt(normal**2 + 2.0 * p * loss) - normal) / p
    # a bond does not let a joint close under tension
    least = np.where(contacts.tensile_strength > 0.0, -np.maximum(normal, 0.0) / p, -np.inf)
    opened = np.clip(wanted, least, reach)
    pushed = np.where(opened > 0.0, np.maximum(opened - free, 0.0), opened)
    after = np.where(
        opened > 0.0, normal + p * pushed, np.maximum(np.minimum(normal, 0.0), normal + p * pushed)
    )
    gained = 0.5 * (after**2 - normal**2) / p
    if has_multipliers(asperities.law):
        own = ~np.isnan(contacts.normal_stiffness)
        after = np.where(own, after, normal)
    return opened, after, response.energy + gained, loss - np.clip(gained, 0.0, loss)


def _closed(
    table: JointTable,
    contacts: Contacts,
    ends: tuple[Floats, Floats],
    places: tuple[Floats, Floats],
    work: Floats,
) -> tuple[Floats, Floats]:
    """Return N, N/m, and energies, J/m, (m,) each, with rough contacts on their hyperbola.

    It lies above its tangent: to rise to it takes work, of which a step has no more than the
    ``work`` (m,), J/m, of closing.  ``ends`` are N and energies at the end of the tangent,
    ``places`` distances and openings, m.
    """
    rough = rough_contacts(table, contacts.joint)
    if rough is None:
        return ends
    rows, (normal, energy), (distance, dilation) = rough.rows, ends, places
    length = contacts.spring_length[rows]
    begun = contacts.rest_force + contacts.multiplier - contacts.normal_stiffness * contacts.gap
    before, now = (stress_on(one[rows], length) for one in (begun, normal))
    rest = rough.closed_by(np.maximum(contacts.rest_force[rows], 0.0) / length)
    most = rough.stress_at(rest + dilation[rows] - distance[rows])
    held = np.maximum(rough.energy(now), rough.energy(before) + work[rows] / length)
    reached = rough.stress_with(held, np.minimum(now, most), np.maximum(now, most))
    reached = np.minimum(np.maximum(reached, np.minimum(now, most)), np.maximum(now, most))
    normal, energy = normal.copy(), energy.copy()
    tension = np.minimum(normal[rows], 0.0)
    normal[rows] = length * reached + tension
    energy[rows] += length * (rough.energy(reached) - rough.energy(now))
    return normal, energy


def reaches_residual(table: JointTable, contacts: Contacts, path: Floats) -> Ints:
    """Return contacts of joints that wear off which are the first of theirs to do so, (r,).

    ``path`` (m,) is the path of sliding of the step, m.
    """
    if not table.weakens:
        return NONE
    worn_after: Floats = table.worn_after.take(contacts.joint)
    # Which joints lose strength over a path of sliding, (joints,).
    residual = ~np.isnan(table.residual_friction) | ~np.isnan(table.residual_cohesion)
    wears: Bools = np.asarray(table.rough | (residual & (table.slip_weakening > 0.0))).take(
        contacts.joint
    )
    before = contacts.slide_length
    now = wears & (before < worn_after) & (before + path >= worn_after)
    if not now.any():
        return np.zeros(0, np.int64)
    earlier = np.unique(contacts.joint[wears & contacts.known & (before >= worn_after)])
    return np.flatnonzero(now & ~np.isin(contacts.joint, earlier))
