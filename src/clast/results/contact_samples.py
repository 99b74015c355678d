"""Forces of measured contacts, and how far they have opened and slipped, at the end of a step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.coulomb import largest_forces
from clast.contact.joints.weakening import strength_lost
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import State, contact_keys
from clast.step.method import StepResult

SLIDES = 1
"""Mode of a contact that slides."""
TOGETHER = 1e-9
"""Contacts whose distances from a place differ by this share of the model are at one place."""
NONE = np.array([0.0, 0.0, *[np.nan] * 6, 0.0])
"""Row of a place or a joint without contacts."""


def contact_rows(model: Model) -> Callable[[StepResult, float, float], tuple[Any, ...]]:
    """Return the function of the row of the measured contacts of a model after a step."""
    measured = model.measured_contacts
    size = float(np.ptp(model.vertices, axis=0).max(initial=0.0))

    def row(result: StepResult, step: float, unbalanced: float) -> tuple[Any, ...]:
        contacts = result.contacts
        found = np.tile(NONE, (len(measured.name), 1))
        for k, (at, joint) in enumerate(zip(measured.at, measured.joint, strict=True)):
            if joint >= 0:
                own = np.flatnonzero(contacts.joint == joint)
            else:
                own = nearest(model, result, at, TOGETHER * size)
            if len(own):
                found[k] = sums(model, result, own)
        return result.state.time, *found.T

    return row


def nearest(model: Model, result: StepResult, at: Floats, apart: float) -> Ints:
    """Return the contact nearest to a place (2,), m, as an array of one; none without contacts.

    Of those that are no further ``apart``, m, it is the one with the largest force.
    """
    contacts = result.contacts
    if not len(contacts):
        return np.zeros(0, np.int64)
    every = np.arange(len(contacts))
    away = np.hypot(*(places_of(model, result.state, contacts, every) - at).T)
    near = np.flatnonzero(away <= away.min() + apart)
    return near[[int(result.response.normal_force[near].argmax())]]


def sums(model: Model, result: StepResult, own: Ints) -> Floats:
    """Return a row of some contacts: forces per length, mean and extremes, share that slides."""
    contacts, response = result.contacts, result.response
    length = contacts.length[own]
    weight = length if length.sum() > 0.0 else np.ones(len(own))
    whole = weight.sum()
    opening, slip = opening_and_slip(model, result.state, contacts, own)
    slides = (response.mode[own] == SLIDES) & (response.normal_force[own] > 0.0)
    ways = [
        value
        for way in (opening, slip)
        for value in (float(weight @ way) / whole, way.min(), way.max())
    ]
    normal, shear = response.normal_force[own].sum(), response.shear_force[own].sum()
    return np.array([normal / whole, shear / whole, *ways, weight[slides].sum() / whole])


def opening_and_slip(
    model: Model, state: State, contacts: Contacts, rows: Ints
) -> tuple[Floats, Floats]:
    """Return gap and slip of some contacts at the end of the step, m, (k,) each.

    The memory has them; contacts that it does not know have those of the start of the step.
    """
    gap = contacts.gap + contacts.rest_gap
    opening, slip = _kept(model, state, contacts, rows, {"gap": gap, "slip": contacts.slip})
    return opening, slip


def shear_strengths(contacts: Contacts, response: ContactResponse, rows: Ints) -> Floats:
    """Return N tan(phi) + c L of some contacts in the step, N/m, (k,): what sliding ones carry."""
    given = ~np.isnan(contacts.friction_base)
    normal = np.where(given, contacts.friction_base, response.normal_force)
    return largest_forces(contacts, normal)[1][rows]


def worn(model: Model, state: State, result: tuple[Contacts, Bools], rows: Ints) -> Floats:
    """Return which share of their strength some contacts have lost at the end of the step, (k,).

    ``result`` are the contacts, and which of them are bonded by then, (m,).
    """
    contacts, bonded = result
    begun = {"slide_length": contacts.slide_length}
    (slid,) = _kept(model, state, contacts, rows, begun)
    return strength_lost(model.joint_table, contacts.joint[rows], slid, bonded[rows])


def _kept(
    model: Model, state: State, contacts: Contacts, rows: Ints, begun: dict[str, Floats]
) -> list[Floats]:
    """Return numbers of some contacts that the memory has, (k,) each, others as they ``begun``."""
    memory, count = state.memory, len(model.vertices)
    own = contacts.vertex[rows], contacts.edge[rows], contacts.point[rows]
    key, known = contact_keys(*own, count), memory.keys(count)
    at = np.minimum(np.searchsorted(known, key), max(0, len(known) - 1))
    found = known[at] == key if len(known) else np.zeros(len(key), np.bool_)
    return [
        np.where(found, getattr(memory, name)[at] if len(known) else 0.0, first[rows])
        for name, first in begun.items()
    ]


def places_of(model: Model, state: State, contacts: Contacts, rows: Ints) -> Floats:
    """Return where the points P of some contacts are, m, (k, 2)."""
    vertex, along = contacts.vertex[rows], contacts.along[rows, None]
    here = state.vertices
    return here[vertex] + along * (here[model.vertex_after[vertex]] - here[vertex])
