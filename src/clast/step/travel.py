"""How far contacts are looked for: whatever may close within the step.

A contact that closes within the step must be among those of the step, or the vertex ends up inside
the block unopposed.  Blocks near each other could move by max_displacement; but a fall of loose
blocks would then carry tens of contacts that stay open for every one that closes.  So contacts are
looked for as far as the velocities go, with critdis to spare, and once more where a block was found
to have moved further than that.  Behind an edge they are looked for as far, beyond what the pair of
blocks remembers: a limit that users lower to be careful must not make contacts harder to find.
"""

from __future__ import annotations

import numpy as np

from clast.block.displacement import farthest_moved
from clast.contact.candidates import SearchDistance
from clast.contact.contacts import Contacts
from clast.linear.system import gap_at_end
from clast.model.model import Floats
from clast.step.method import Method
from clast.step.start import Begun

SPARE = 0.4
"""Share of critdis that a block may move further than expected; half would be the whole."""
PUSH = 0.5
"""What others are expected to push a block, in units of critdis."""
JUMP = 4.0
"""How deep a vertex may get into a block within a step unseen, in units of critdis."""
GROWTH = 1.5
"""Where a block went too far it is expected to go so much further than it went."""


def search_within_step(method: Method, travel: Floats) -> SearchDistance:
    """Return the reach for blocks whose vertices move by ``travel`` (n,) at most, m."""
    return SearchDistance(
        front=method.critdis,
        depth=method.critdis,
        critdis=method.critdis,
        travel=travel,
    )


def travel_of(begun: Begun, displacement: Floats) -> Floats:
    """Return the largest movement of a vertex of each block by d (n, 6), m, shape (n,)."""
    start = begun.model.block_start
    return farthest_moved(begun.state.vertices, start, begun.frames.centroid, displacement)


def travel_expected(begun: Begun) -> Floats:
    """Return how far blocks go, m, shape (n,), by their velocities, weight and a push."""
    fall = float(np.hypot(*begun.model.gravity)) * begun.step**2
    if begun.method.clock is not None:
        # a static step is as long as it is because blocks hardly move
        fall = min(fall, begun.method.critdis)
    return travel_of(begun, begun.drift) + fall + PUSH * begun.method.critdis


def farther(method: Method, expected: Floats, travel: Floats) -> Floats | None:
    """Return the travel to expect instead, m, shape (n,), or None where none went too far.

    A block that is thrown further than max_displacement has the step cut if anything is near.
    """
    too_far = travel > expected + SPARE * method.critdis
    if not too_far.any() or not np.all(travel[too_far] <= method.max_displacement):
        return None
    return np.where(too_far, np.maximum(expected, GROWTH * travel), expected)


def closes_unseen(seen: Contacts, contacts: Contacts, displacement: Floats) -> bool:
    """Return True where d (n, 6) closes one of the ``contacts`` that is not among those ``seen``.

    While none does, d is the solution with all of them: an open contact bears nothing.
    """
    # points inside faces come with the vertices at their ends
    closed = contacts.corners & (gap_at_end(contacts, displacement) < 0.0)
    width = int(max(seen.edge.max(initial=0), contacts.edge.max(initial=0))) + 1
    known = (seen.vertex * width + seen.edge)[seen.corners]
    wanted = contacts.vertex[closed] * width + contacts.edge[closed]
    return not np.isin(wanted, known, assume_unique=True).all()
