"""Small regions are minimised one by one before what is left goes on together.

Of a falling heap, of towers, of rock that comes down in many places, no part touches another.  All
together take as many iterations as the slowest of them, and what each needs of the work of an
iteration is little beside its being called for.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.minimise import island_kernels as small_regions
from clast.minimise.potential import Point, Potential
from clast.minimise.subproblem import ANSWERS
from clast.minimise.unfinished import FINISHED, unfinished
from clast.model.model import Floats

ITERATIONS = 30
"""Iterations at most; what needs more has other ways to go (minimise/newton.py)."""


def with_small_regions(
    potential: Potential, point: Point, enough: float, counts: dict[str, int]
) -> tuple[Point, float]:
    """Return the point where small regions are minimised, and what all have left, J/m.

    They come near enough for all to be within ``enough``, J/m, where all are small.  The potential
    must be that of a law of springs with bounds; of any other nothing is minimised.  Iterations
    are counted of the region that takes most.
    """
    left = potential.distances(point)
    limits, regions = potential.limits, potential.regions
    chosen = unfinished(left, enough) & potential.small_regions()
    if limits is None or not chosen.any():
        return point, float(left.sum())
    start, _, _ = regions.listing
    wanted = np.flatnonzero(chosen)
    # the largest first: the others fill up what time is left
    wanted = wanted[np.argsort(-np.diff(start)[wanted], kind="stable")]
    moved = copied(potential, point)
    found = small_regions.minimise(
        wanted,
        regions.listing,
        potential.problem(limits),
        arrays_of(moved),
        FINISHED * enough / len(wanted),
        ITERATIONS,
        left,
    )
    passes, evaluations = found.max(axis=0)
    counts["passes"] += int(passes)
    counts["line_search"] += int(evaluations)
    return moved, float(left.sum())


def copied(potential: Potential, point: Point) -> Point:
    """Return a copy of a point, with what Newton's method needs of the law's answer."""
    answers = {name: getattr(point.response, name).copy() for name in ANSWERS}
    return Point(
        unknowns=point.unknowns.copy(),
        gap=point.gap.copy(),
        slip=point.slip.copy(),
        response=replace(potential.at_rest, **answers),
        residual=point.residual.copy(),
        left=point.left.copy(),
    )


def arrays_of(point: Point) -> tuple[Floats, ...]:
    """Return a point as kernels take it (minimise/one_island.py)."""
    answers = (getattr(point.response, name) for name in ANSWERS)
    return point.unknowns, point.gap, point.slip, *answers, point.residual, point.left
