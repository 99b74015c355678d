"""A contact law tried on contacts of many strengths.

assert not clast.check_law(MyLaw())
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.block import polygon
from clast.contact.candidates import SearchDistance
from clast.contact.contacts import Contacts
from clast.contact.corner_rules import Bisector
from clast.contact.detection import detect
from clast.contact.laws import ContactLaw
from clast.inputs.builder import InputBuilder
from clast.model.state import initial_state
from clast.run.law_check import faults_of

BLOCKS_TRIED = 60
"""Blocks whose contacts a law is tried on; each has two."""


def check_law(law: ContactLaw) -> tuple[str, ...]:
    """Return the faults of a contact law, a sentence each; none where all holds.

    The law is evaluated at penetrations of 1e-8 to 3e-3 m and slips of that order.  It must leave
    its contacts as they are; N = -dE/dgap, T = -d(E + loss)/dslip, stiffnesses and coupling must be
    derivatives of the forces, no loss negative; |T| <= N tan(phi) + c L with its own N, which
    sliding contacts must reach.  A law with another friction than Coulomb's fails the last.
    """
    return faults_of(law, _some_contacts())


def _some_contacts() -> Contacts:
    """Return contacts of many strengths: blocks side by side on a floor."""
    builder = InputBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    floor = np.array(
        [[-1.0, -1.0], [2.0 * BLOCKS_TRIED, -1.0], [2.0 * BLOCKS_TRIED, 0.0], [-1.0, 0.0]]
    )
    builder.block(vertices=floor, fixed=True)
    builder.blocks(
        vertices=square + 2.0 * np.arange(BLOCKS_TRIED)[:, None, None] * np.array([1.0, 0.0])
    )
    model = builder.build()
    centroid = polygon.moments(model.vertices, model.block_start)[1]
    reach = SearchDistance(front=0.01, depth=0.01, critdis=0.01)
    contacts = detect(model, Bisector(), initial_state(model), centroid, reach)
    rng = np.random.default_rng(2)
    count = len(contacts)
    cohesion = np.where(rng.random(count) < 0.3, 10.0 ** rng.uniform(2.0, 6.0, count), 0.0)
    friction = np.where(rng.random(count) < 0.1, 0.0, rng.uniform(0.05, 1.5, count))
    return replace(contacts, friction=friction, cohesion=cohesion, bonded=cohesion > 0.0)
