"""The blocks that are farthest from rest go first, while the others stand still.

Newton's method goes along its direction as far as the contacts allow that open, close, stick and
slide on the way: all blocks together no farther than suits those few of them that have most to
settle, and the more blocks there are the more of those.  Yet nearly all that is left to the minimum
lies with few blocks.  So before a direction for all, these few and their neighbours are minimised
by themselves.  Each place where they are has a length of its own along the direction, and costs
what it has blocks.  The potential falls in either case, so that Newton's method converges as
before (a nonlinear elimination; Cai and Li 2011).
"""

from __future__ import annotations

import numpy as np

from clast.compute.stopwatch import Stages
from clast.linear.reuse import FactorOfStep
from clast.minimise.iteration import iterate
from clast.minimise.neighbours import with_neighbours
from clast.minimise.potential import Point, Potential
from clast.minimise.subproblem import part_of, with_part
from clast.model.model import Bools, Floats

LARGE = 1500
"""Blocks from which the worst go first: among fewer it costs as much as it saves."""
ALL_THE_SAME = 0.05
"""What an iteration of few blocks costs in any case, as a share of one of all blocks."""
LEAST = 1e-4
"""Share of what is left that the iterations of few blocks come to at best."""
FEW = 0.4
"""Where they and their neighbours are a larger share of the blocks all go on together."""
NEARLY = 0.25
"""Share of what is enough at which they are done in any case."""
ITERATIONS = 6
"""Iterations of theirs; where more are needed the others need to move as well."""


def worst_first(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return a lower point: the worst blocks are near their minimum, where they are few.

    They are done where they have no more left to it than all others together.
    """
    with stages("law"):
        found, others = worst(point.left)
        wanted = with_neighbours(found, potential.contacts.pairs)
        wanted &= ~potential.fixed
        if not 0 < np.count_nonzero(wanted) <= FEW * np.count_nonzero(~potential.fixed):
            return point
        part = part_of(potential, wanted)
        inner = part.within(point)
    left = max(others, NEARLY * enough)
    for _ in range(ITERATIONS):
        if part.potential.distance(inner) <= left:
            break
        inner, _ = iterate(part.potential, inner, factor, counts, stages)
        counts["local"] = counts.get("local", 0) + 1
    with stages("law"):
        return with_part(potential, point, part, inner)


def worst(distances: Floats) -> tuple[Bools, float]:
    """Return True for the blocks that are worth going first, and what the others have left, J/m.

    They are those whose ``distances`` (n,), J/m, are of some power of two or a higher one: of the
    one with which most is gained, as a logarithm of what is left, for the price of an iteration.
    There are none where a distance is not finite.
    """
    total = float(distances.sum())
    if not 0.0 < total < np.inf:
        return np.zeros(len(distances), bool), total
    _, power = np.frexp(distances)
    place = power - int(power.min())
    together = np.bincount(place, weights=distances)
    number = np.bincount(place, weights=distances != 0.0)  # frexp gives 0 for 0 and for 1/2
    others = np.concatenate([[0.0], np.cumsum(together)[:-1]])
    gained = -np.log(np.maximum(others / total, LEAST))
    price = ALL_THE_SAME + np.cumsum(number[::-1])[::-1] / len(distances)
    best = int(np.argmax(gained / price))
    found: Bools = (place >= best) & (distances != 0.0)
    return found, float(others[best])
