"""Which regions of blocks still have to come nearer to their minimum."""

from __future__ import annotations

import numpy as np

from clast.model import Bools, Floats
from clast.stepping.parts import Part, part_of
from clast.stepping.potential import Potential

FINISHED = 0.25
"""Share of what is enough that regions may hold together which are not gone on with."""
HALF = 0.5
"""Where less than this share of the blocks is unfinished they go on by themselves."""
SMALL = 50
"""Blocks up to which all go on together: parting them would cost as much."""


def unfinished(distances: Floats, enough: float) -> Bools:
    """Return True for the regions (r,) without which the distance would still be too large."""
    together = FINISHED * enough
    wanted: Bools = ~(distances <= together)  # what is not finite is not finished
    others = np.flatnonzero(~wanted)
    if float(distances[others].sum()) > together:
        others = others[np.argsort(distances[others], kind="stable")]
        wanted[others[np.cumsum(distances[others]) > together]] = True
    return wanted


def few_are_unfinished(potential: Potential, distances: Floats, enough: float) -> bool:
    """Return True where few blocks have what is too much of the ``distances`` of regions (r,)."""
    free = ~potential.fixed
    size = np.count_nonzero(free)
    if size <= SMALL:
        return False
    wanted = unfinished(distances, enough)
    return bool(np.count_nonzero(wanted[potential.regions.of_blocks] & free) < HALF * size)


def unfinished_part(potential: Potential, distances: Floats, enough: float) -> tuple[Part, float]:
    """Return the regions that must come nearer, and what is enough for them, J/m."""
    wanted = unfinished(distances, enough)
    part = part_of(potential, wanted[potential.regions.of_blocks] & ~potential.fixed)
    return part, enough - float(distances[~wanted].sum())
