"""Forces of measured contacts, and how far they have opened and slipped, at the end of a step."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from clast.contact.contacts import SLIDE, ContactResponse, Contacts
from clast.contact.coulomb import largest_forces
from clast.contact.joints.bonds import strength_lost
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.state import State, contact_keys
from clast.step.method import StepResult

NONE = np.array([0.0, 0.0, *[np.nan] * 6, 0.0])
"""Row of a place or a joint without contacts."""


def contact_rows(model: Model) -> Callable[[StepResult, float, float], tuple[Any, ...]]:
    """Return the function of the row of the measured contacts of a model after a step."""
    measured = model.measured_contacts
    size = float(np.ptp(model.vertices, axis=0).max(initial=0.0))

    def row(result: StepResult, step: float, unbalanced: float) -> tuple[Any, ...]:
        contacts = result.contacts
        rows = np.tile(NONE, (len(measured.name), 1))
        for k, (at, joint) in enumerate(zip(measured.at, measured.joint, strict=True)):
            if joint >= 0:
                chosen = np.flatnonzero(contacts.joint == joint)
            else:
                chosen = nearest(model, result, at, 1e-9 * size)
            if len(chosen):
                rows[k] = sums(model, result, chosen)
        return result.state.time, *rows.T

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


def sums(model: Model, result: StepResult, rows: Ints) -> Floats:
    """Return a row of some contacts: forces per length, mean and extremes, fraction that slides."""
    contacts, response = result.contacts, result.response
    length = contacts.length[rows]
    weight = length if length.sum() > 0.0 else np.ones(len(rows))
    whole = weight.sum()
    slides = (response.mode[rows] == SLIDE) & (response.normal_force[rows] > 0.0)
    movements = [
        value
        for movement in opening_and_slip(model, result.state, contacts, rows)
        for value in (float(weight @ movement) / whole, movement.min(), movement.max())
    ]
    normal, shear = response.normal_force[rows].sum(), response.shear_force[rows].sum()
    return np.array([normal / whole, shear / whole, *movements, weight[slides].sum() / whole])


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
    """Return N tan(phi) + c L of some contacts in the step, N/m, (k,): the shear strength."""
    given = ~np.isnan(contacts.friction_base)
    normal = np.where(given, contacts.friction_base, response.normal_force)
    return largest_forces(contacts, normal)[1][rows]


def worn(model: Model, state: State, result: tuple[Contacts, Bools], rows: Ints) -> Floats:
    """Return the fraction of their strength that contacts have lost at the end of the step, (k,).

    ``result`` are the contacts, and which of them are bonded by then, (m,).
    """
    contacts, bonded = result
    (slid,) = _kept(model, state, contacts, rows, {"slide_length": contacts.slide_length})
    return strength_lost(model.joint_table, contacts.joint[rows], slid, bonded[rows])


def _kept(
    model: Model, state: State, contacts: Contacts, rows: Ints, starts: dict[str, Floats]
) -> list[Floats]:
    """Return numbers of contacts in the memory, (k,) each, of others those of ``starts``."""
    memory, count = state.memory, len(model.vertices)
    pair = contacts.vertex[rows], contacts.edge[rows], contacts.point[rows]
    key, known = contact_keys(*pair, count), memory.keys(count)
    at = np.minimum(np.searchsorted(known, key), max(0, len(known) - 1))
    remembered = known[at] == key if len(known) else np.zeros(len(key), np.bool_)
    return [
        np.where(remembered, getattr(memory, name)[at] if len(known) else 0.0, first[rows])
        for name, first in starts.items()
    ]


def places_of(model: Model, state: State, contacts: Contacts, rows: Ints) -> Floats:
    """Return where the points P of some contacts are, m, (k, 2)."""
    vertex, along = contacts.vertex[rows], contacts.along[rows, None]
    here = state.vertices
    return here[vertex] + along * (here[model.vertex_after[vertex]] - here[vertex])
