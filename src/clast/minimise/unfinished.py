"""Which regions of blocks still have to come nearer to their minimum."""

from __future__ import annotations

import numpy as np

from clast.minimise import connected as regions
from clast.minimise.potential import Potential
from clast.minimise.subproblem import Part, part_of
from clast.model.model import Bools, Floats

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
    others = np.flatnonzero(~wanted & (distances > 0.0))
    left = distances.take(others)
    if float(left.sum()) > together:
        order = np.argsort(left, kind="stable")
        wanted[others[order][np.cumsum(left[order]) > together]] = True
    return wanted


def few_are_unfinished(potential: Potential, distances: Floats, enough: float) -> bool:
    """Return True where few blocks have what is too much of the ``distances`` of regions (r,)."""
    if len(potential.fixed) <= SMALL:
        return False
    _, count, free = _blocks_of(potential, unfinished(distances, enough))
    return free > SMALL and count < HALF * free


def unfinished_part(potential: Potential, distances: Floats, enough: float) -> tuple[Part, float]:
    """Return the regions that must come nearer, and what is enough for them, J/m."""
    wanted = unfinished(distances, enough)
    blocks, _, _ = _blocks_of(potential, wanted)
    return part_of(potential, blocks), enough - float(distances[~wanted].sum())


def _blocks_of(potential: Potential, wanted: Bools) -> tuple[Bools, int, int]:
    """Return the free blocks (n,) of the regions ``wanted`` (r,), their number, and that of all."""
    blocks, count, free = regions.free_blocks(wanted, potential.regions.of_blocks, potential.fixed)
    return blocks, int(count), int(free)
