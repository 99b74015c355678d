"""The minimum of the incremental potential: Newton's method, and what follows where it is slow."""

from __future__ import annotations

from enum import Enum

import numpy as np

from clast.compute.stopwatch import Stages
from clast.errors import StepOutcome, StepRejected
from clast.linear.reuse import FactorOfStep
from clast.minimise.interior_point import minimise_inside
from clast.minimise.islands import with_small_regions
from clast.minimise.iteration import iterate
from clast.minimise.numbering import order_of
from clast.minimise.potential import Point, Potential
from clast.minimise.schedule import LARGE, worst_first
from clast.minimise.subproblem import Part, renumbered, with_part
from clast.minimise.unfinished import few_are_unfinished, unfinished_part
from clast.model.model import Floats

WINDOW = 4
"""Iterations from which the rate of convergence is taken."""
INTERIOR = 60
"""Iterations that are worth a change to the interior point method, which needs 20 to 30: Newton's
last iterations gain far more than those from which their number is foretold."""


class Ending(Enum):
    """How Newton's method comes to its end."""

    DONE = "near enough"
    SLOW = "far too many iterations to go"
    FEW = "only few blocks have not come to rest"


def minimise(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return the minimum of the potential, from ``point`` on.

    Done where twice the potential is within ``enough``, J/m, of its minimum: by the bound
    without a system, or by the Newton decrement r.dd.  Of a law of springs with bounds the answer
    is what Newton's method needs (Potential.moved).  ``counts`` is added to.
    Raises StepRejected where some region needs more than ``iterations``.
    """
    with stages("law"):
        if potential.distance(point) <= enough:
            return point
    if factor.is_free:
        with stages("small regions"):
            point, left = with_small_regions(potential, point, enough, counts)
        if left <= enough:
            return point
    with stages("law"):
        contacts = potential.contacts
        order = order_of(potential.base.centroid, contacts.pairs, potential.fixed)
    if order is None:
        return descend(potential, point, factor, enough, iterations, counts, stages)
    with stages("law"):
        part = renumbered(potential, order)
    return descend_within(potential, part, point, factor, enough, iterations, counts, stages)


def best_of(potential: Potential, starts: tuple[Floats, ...]) -> Point:
    """Return the point that each region has from the best of ``starts``, (n, 6) each."""
    every = np.stack(starts)
    choice = np.argmin(potential.distances_at(every), axis=0)
    if np.all(choice == choice[0]):
        return potential.at(starts[choice[0]])
    of_blocks = choice[potential.regions.of_blocks]
    return potential.at(every[of_blocks, np.arange(len(of_blocks))])


def descend(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return a point within ``enough``, J/m, of the minimum.

    A law of springs with bounds is handed to the interior point method where Newton's takes long;
    where most blocks are done, the others go on by themselves.  Raises StepRejected after
    ``iterations``.
    """
    limits = potential.limits
    patience = np.inf if limits is None else INTERIOR
    while True:
        point, ending = newton(
            potential, point, factor, enough, iterations, patience, counts, stages
        )
        if ending is Ending.DONE:
            return point
        if ending is Ending.FEW:
            return descend_in_part(potential, point, factor, enough, iterations, counts, stages)
        if limits is None or patience == np.inf:
            raise StepRejected(
                StepOutcome.NOT_CONVERGED,
                f"{iterations} Newton iterations left {potential.distance(point):.3g} "
                f"of {enough:.3g} J/m",
            )
        counts["interior"] = counts.get("interior", 0) + 1
        point = minimise_inside(potential, limits, point, factor, enough, counts, stages)
        patience = np.inf


def descend_in_part(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return a point within ``enough``, J/m, of the minimum: unfinished regions move."""
    with stages("law"):
        part, left = unfinished_part(potential, potential.distances(point), enough)
    return descend_within(potential, part, point, factor, left, iterations, counts, stages)


def descend_within(
    potential: Potential,
    part: Part,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return the whole's point of which a part is within ``enough`` of its minimum."""
    with stages("law"):
        start = part.within(point)
    moved = descend(part.potential, start, factor, enough, iterations, counts, stages)
    with stages("law"):
        return with_part(potential, point, part, moved)


def newton(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    patience: float,
    counts: dict[str, int],
    stages: Stages,
) -> tuple[Point, Ending]:
    """Return where Newton's method with exact line search comes to, and how it ends.

    It gives up after ``iterations``, or where at its present rate it needs more than ``patience``,
    and where only a part of the blocks is still of any account.
    """
    distances: list[float] = []
    size = int(np.count_nonzero(~potential.fixed))
    for _ in range(iterations):
        by_region = potential.distances(point)
        distances.append(float(by_region.sum()))
        if distances[-1] <= enough:
            return point, Ending.DONE
        if few_are_unfinished(potential, by_region, enough):
            return point, Ending.FEW
        if remaining(distances, enough) > patience:
            return point, Ending.SLOW
        if size > LARGE:
            point = worst_first(potential, point, factor, enough, counts, stages)
            if potential.distance(point) <= enough:
                return point, Ending.DONE
        point, decrement = iterate(potential, point, factor, counts, stages)
        counts["passes"] += 1
        if decrement <= enough:
            return point, Ending.DONE
    near = potential.distance(point) <= enough
    return point, Ending.DONE if near else Ending.SLOW


def remaining(distances: list[float], enough: float) -> float:
    """Return how many iterations are still needed at the rate of the last few; 0: unknown."""
    if len(distances) <= WINDOW:
        return 0.0
    gained = np.log(distances[-1 - WINDOW] / distances[-1]) / WINDOW
    needed = np.log(distances[-1] / enough)
    return float(needed / gained) if gained > 0.0 else np.inf
