"""How far contacts are looked for: whatever may close within the step.

A contact that closes within the step must be among those of the step, or the vertex ends up inside
the block unopposed.  Blocks near each other could move by max_displacement; but a fall of loose
blocks would then carry tens of contacts that stay open for every one that closes.  So contacts are
looked for as far as the velocities go, with critdis to spare, and once more where a block was found
to have moved further than that.  Behind an edge they are looked for as far, beyond the memory of
the pair of blocks: a limit that users lower to be careful must not make contacts harder to find.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block.displacement import farthest_moved
from clast.compute.reductions import is_any
from clast.contact.candidates import SearchDistance
from clast.contact.contacts import Contacts
from clast.linear.system import gap_at_end
from clast.model.model import Floats
from clast.step.method import Method
from clast.step.start import StepContext

SPARE_CRITDIS = 0.4
"""Share of critdis that a block may move further than expected; half would be the whole."""
PUSH_CRITDIS = 0.5
"""Expected push of others on a block, in units of critdis."""
DEPTH_CRITDIS = 4.0
"""How deep a vertex may get into a block within a step unseen, in units of critdis."""
TRAVEL_GROWTH = 1.5
"""Where a block went too far it is expected to go so much further than it went."""


@dataclass(frozen=True, kw_only=True)
class ContactSearch:
    """How far the contacts of a step are looked for."""

    distance: SearchDistance
    """How far from the edges of a block."""
    drift: Floats | None
    """Displacements that the velocities would bring, m, (n, 6): tips that would cross an edge then
    are contacts, too; None: they are not."""
    depth: float
    """How deep a vertex may get into a block within the step, m; else the step is rejected."""

    def contacts(self, context: StepContext) -> Contacts:
        """Return the contacts that are found."""
        context.stages("contacts")
        return context.contacts(self.distance, self.drift)


def search_as_far_as(context: StepContext, travel: Floats) -> ContactSearch:
    """Return the search for blocks whose vertices move by ``travel`` (n,) at most, m."""
    method = context.method
    return ContactSearch(
        distance=search_within_step(method, travel),
        drift=context.drift,
        depth=DEPTH_CRITDIS * method.critdis,
    )


def searched_again(
    context: StepContext, search: ContactSearch, seen: Contacts, displacement: Floats
) -> tuple[ContactSearch, Contacts] | None:
    """Return a wider search and its contacts where d (n, 6) closes some that were not ``seen``.

    None where the ``search`` was wide enough, or was not limited by the travel of the blocks.
    """
    context.stages("contacts")
    expected = search.distance.travel
    if expected is None:
        return None
    travel = farther(context.method, expected, travel_of(context, displacement))
    if travel is None:
        return None
    wider = search_as_far_as(context, travel)
    contacts = wider.contacts(context)
    # True where d (n, 6) closes one of the ``contacts`` that is not among those ``seen``.
    # points inside faces come with the vertices at their ends
    closed = contacts.corners & (gap_at_end(contacts, displacement) < 0.0)
    width = int(max(seen.edge.max(initial=0), contacts.edge.max(initial=0))) + 1
    known = (seen.vertex * width + seen.edge)[seen.corners]
    wanted = contacts.vertex[closed] * width + contacts.edge[closed]
    return None if np.isin(wanted, known, assume_unique=True).all() else (wider, contacts)


def search_within_step(method: Method, travel: Floats) -> SearchDistance:
    """Return the reach for blocks whose vertices move by ``travel`` (n,) at most, m."""
    return SearchDistance(
        front=method.critdis, depth=method.critdis, critdis=method.critdis, travel=travel
    )


def travel_of(context: StepContext, displacement: Floats) -> Floats:
    """Return the largest movement of a vertex of each block by d (n, 6), m, shape (n,)."""
    start = context.model.block_start
    return farthest_moved(context.state.vertices, start, context.frames.centroid, displacement)


def travel_expected(context: StepContext) -> Floats:
    """Return how far blocks go, m, shape (n,), by their velocities, weight and a push."""
    fall = context.model.size_of_gravity * context.step**2
    if context.method.clock is not None:
        # a static step is as long as it is because blocks hardly move
        fall = min(fall, context.method.critdis)
    return travel_of(context, context.drift) + fall + PUSH_CRITDIS * context.method.critdis


def farther(method: Method, expected: Floats, travel: Floats) -> Floats | None:
    """Return the travel to expect instead, m, shape (n,), or None where none went too far.

    A block that is thrown further than max_displacement has the step cut if anything is near.
    """
    too_far = travel > expected + SPARE_CRITDIS * method.critdis
    if not is_any(too_far) or not np.all(travel[too_far] <= method.max_displacement):
        return None
    return np.where(too_far, np.maximum(expected, TRAVEL_GROWTH * travel), expected)
