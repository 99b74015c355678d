"""Pairs of blocks that are near each other, from one step to the next.

To find them anew in every step would cost as much as a fifth of a step in which most blocks rest
or fly.  So they are found with boxes wider than asked for and kept (a neighbour list; Verlet 1967).
As long as each box that is asked about lies within the one it had then, its pairs are among those
that are kept, and a look at these tells which.  The answer is that of a new search, to the pair.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block import polygon
from clast.contact import broad_phase
from clast.model.model import Bools, Floats, Ints

SPARE = 8.0
"""By how much boxes are wider than asked for, in units of their least widening: the steps, more or
less, that a moving block takes before pairs must be found again."""
WIDEST = 0.25
"""And in units of the mean side of the box itself at most, so that few pairs are kept in vain."""


@dataclass(frozen=True, kw_only=True)
class Neighbourhood:
    """The pairs of all blocks whose wide boxes overlap."""

    block_start: Ints
    """First vertex of each block, shape (n + 1,)."""
    fixed: Bools
    """Blocks that cannot move, pairs of which do not count, shape (n,)."""
    absent: Bools | None
    """Blocks that are near none, shape (n,)."""
    box: Floats
    """The wide boxes, (xmin, ymin, xmax, ymax), m, shape (n, 4)."""
    pairs: Ints
    """Pairs (lower, higher) of them that overlap, sorted, shape (q, 2)."""


def neighbourhood_of(
    block_start: Ints, fixed: Bools, box: Floats, half: Floats, absent: Bools | None = None
) -> Neighbourhood:
    """Return the neighbourhood of boxes (n, 4) that have been widened by ``half`` (n,), m.

    Blocks that are ``absent`` (n,) are near none.
    """
    sides = 0.5 * (box[:, 2] - box[:, 0] + box[:, 3] - box[:, 1]) - 2.0 * half
    spare = np.minimum(SPARE * half, WIDEST * sides)
    wide = box + spare[:, None] * np.array([-1.0, -1.0, 1.0, 1.0])
    pairs = broad_phase.overlapping_pairs(wide, fixed)
    if absent is not None and absent.any():
        pairs = np.ascontiguousarray(pairs[~absent[pairs].any(axis=1)])
    return Neighbourhood(block_start=block_start, fixed=fixed, absent=absent, box=wide, pairs=pairs)


class VerletList:
    """Pairs of blocks near each other, kept for as long as they serve (Verlet 1967).

    A run has one of its own, which may be thrown away at any time: its answer is a function of the
    arguments alone.
    """

    def __init__(self) -> None:
        self._last: Neighbourhood | None = None
        self.searches = 0

    def near_pairs(
        self,
        vertices: Floats,
        block_start: Ints,
        half: Floats,
        fixed: Bools,
        absent: Bools | None = None,
    ) -> Ints:
        """Return the pairs (q, 2) of blocks whose boxes, widened by ``half`` (n,), m, overlap."""
        box = polygon.boxes(vertices, block_start)
        broad_phase.widen(box, half)
        last = self._last
        if last is None or last.absent is not absent or not serves(last, block_start, fixed, box):
            last = neighbourhood_of(block_start, fixed, box, half, absent)
            self._last = last
            self.searches += 1
        return broad_phase.overlapping_of(last.pairs, box)


def serves(last: Neighbourhood, block_start: Ints, fixed: Bools, box: Floats) -> bool:
    """Return whether all that boxes (n, 4) of these blocks overlap is known already."""
    if last.block_start is not block_start or last.fixed is not fixed:
        return False
    return bool(broad_phase.all_within(box, last.box))


def near_pairs(
    near: VerletList,
    vertices: Floats,
    block_start: Ints,
    fixed: Bools,
    distance: float,
    travel: Floats | float = 0.0,
    absent: Bools | None = None,
) -> Ints:
    """Return pairs (lower, higher) of blocks that are near each other by their boxes, (q, 2).

    Nearer than ``distance``, m, plus the ``travel`` (n,) of each of the two, m.  Blocks that are
    ``absent`` (n,) are near none.
    """
    half = np.empty(len(block_start) - 1)
    half[:] = 0.5 * distance + travel
    return near.near_pairs(vertices, block_start, half, fixed, absent)
