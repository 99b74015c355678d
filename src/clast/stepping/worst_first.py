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

from clast.equations.reuse import FactorOfStep
from clast.kernels.neighbours import with_neighbours
from clast.model import Bools, Floats
from clast.stepping.iteration import iterate
from clast.stepping.parts import part_of, with_part
from clast.stepping.potential import Point, Potential
from clast.stepping.stages import Stages

LARGE = 1500
"""Blocks from which the worst go first: among fewer it costs as much as it saves."""
WORST = 0.8
"""Share of what is left to the minimum that the worst blocks have together."""
FEW = 0.2
"""Where they and their neighbours are a larger share of the blocks all go on together."""
LEFT = 1e-2
"""Share of what is left to the minimum at which the worst blocks are done."""
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
    """Return a lower point: the worst blocks are at their minimum, where they are few."""
    with stages("law"):
        total = potential.distance(point)
        wanted = with_neighbours(worst(point.left, total), potential.contacts.pairs)
        wanted &= ~potential.fixed
        if np.count_nonzero(wanted) > FEW * np.count_nonzero(~potential.fixed):
            return point
        part = part_of(potential, wanted)
        inner = part.within(point)
    left = max(LEFT * total, NEARLY * enough)
    for _ in range(ITERATIONS):
        if part.potential.distance(inner) <= left:
            break
        inner, _ = iterate(part.potential, inner, factor, counts, stages)
        counts["local"] = counts.get("local", 0) + 1
    with stages("law"):
        return with_part(potential, point, part, inner)


def worst(distances: Floats, total: float) -> Bools:
    """Return True for the blocks, by powers of two of their ``distances`` (n,), that have WORST."""
    _, power = np.frexp(distances)
    lowest = int(power.min())
    by_power = np.bincount(power - lowest, weights=distances)
    others = np.cumsum(by_power) < (1.0 - WORST) * total
    found: Bools = ~others[power - lowest] & (distances != 0.0)  # frexp gives 0 for 0 and for 1/2
    return found
