"""The minimum of the incremental potential: Newton's method, and what follows where it is slow."""

from __future__ import annotations

from enum import Enum

import numpy as np

from clast.equations.reuse import FactorOfStep
from clast.errors import StepOutcome, StepRejected
from clast.kernels.block_rows import dot
from clast.model import Bools, Floats
from clast.stepping.interior import minimise_inside
from clast.stepping.numbering import order_of
from clast.stepping.potential import Part, Point, Potential
from clast.stepping.stages import Stages

WINDOW = 4
"""Iterations from which the rate of convergence is taken."""
INTERIOR = 60
"""Iterations that are worth a change to the interior point method, which needs 20 to 30: Newton's
last iterations gain far more than those from which their number is foretold."""
FINISHED = 0.25
"""Share of what is enough that regions may hold together which are not gone on with."""
HALF = 0.5
"""Where less than this share of the blocks is unfinished they go on by themselves."""
SMALL = 50
"""Blocks up to which all go on together: parting them would cost as much."""


class Ending(Enum):
    """How Newton's method comes to its end."""

    DONE = "near enough"
    SLOW = "far too many iterations to go"
    FEW = "only few blocks have not come to rest"


def minimise(
    potential: Potential,
    starts: tuple[Floats, ...],
    factor: FactorOfStep,
    tolerance: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return the minimum of the potential, each region from the best of ``starts``, (n, 6) each.

    Done where the potential is within tolerance^2 x yardstick of its minimum: by the bound
    without a system, or by the Newton decrement r.dd.  ``counts`` is added to.
    Raises StepRejected where some region needs more than ``iterations``.
    """
    with stages("law"):
        point = best_of(potential, starts)
        enough = tolerance**2 * potential.yardstick()
        if potential.distance(point) <= enough:
            return point
        contacts = potential.contacts
        order = order_of(potential.base.centroid, contacts.pairs, potential.fixed)
    if order is None:
        unknowns = descend(potential, point, factor, enough, iterations, counts, stages)
    else:
        with stages("law"):
            part = potential.renumbered(order)
        unknowns = descend_within(part, point, factor, enough, iterations, counts, stages)
    with stages("law"):
        return potential.at(unknowns)


def best_of(potential: Potential, starts: tuple[Floats, ...]) -> Point:
    """Return the point of which each region is where it is nearest to its minimum."""
    points = [potential.at(start) for start in starts]
    choice = np.argmin([potential.distances(point) for point in points], axis=0)
    if np.all(choice == choice[0]):
        return points[choice[0]]
    of_blocks = choice[potential.regions.of_blocks]
    return potential.at(np.stack(starts)[of_blocks, np.arange(len(of_blocks))])


def descend(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Floats:
    """Return unknowns (n, 6) within ``enough``, J/m, of the minimum.

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
            return point.unknowns
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
) -> Floats:
    """Return unknowns (n, 6) within ``enough``, J/m, of the minimum: unfinished regions move."""
    with stages("law"):
        distances = potential.distances(point)
        wanted = unfinished(distances, enough)
        part = potential.part(wanted)
    left = enough - float(distances[~wanted].sum())
    return descend_within(part, point, factor, left, iterations, counts, stages)


def descend_within(
    part: Part,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Floats:
    """Return unknowns (n, 6) of the whole of which a part is within ``enough`` of its minimum."""
    with stages("law"):
        start = part.potential.at(point.unknowns[part.blocks])
    unknowns = point.unknowns.copy()
    unknowns[part.blocks] = descend(
        part.potential, start, factor, enough, iterations, counts, stages
    )
    return unknowns


def unfinished(distances: Floats, enough: float) -> Bools:
    """Return True for the regions (r,) without which the distance would still be too large."""
    together = FINISHED * enough
    wanted: Bools = ~(distances <= together)  # what is not finite is not finished
    others = np.flatnonzero(~wanted)
    if float(distances[others].sum()) > together:
        others = others[np.argsort(distances[others], kind="stable")]
        wanted[others[np.cumsum(distances[others]) > together]] = True
    return wanted


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
    size = blocks_in(potential, np.ones(potential.regions.count, np.bool_))
    for _ in range(iterations):
        by_region = potential.distances(point)
        distances.append(float(by_region.sum()))
        if distances[-1] <= enough:
            return point, Ending.DONE
        if size > SMALL and blocks_in(potential, unfinished(by_region, enough)) < HALF * size:
            return point, Ending.FEW
        if remaining(distances, enough) > patience:
            return point, Ending.SLOW
        direction = potential.direction(point, factor, stages)
        counts["passes"] += 1
        decrement = float(dot(point.residual, direction))
        with stages("line search"):
            line, evaluations = potential.line_search(point, direction)
            counts["line_search"] += evaluations
        with stages("law"):
            point = potential.moved(point, line)
        if decrement <= enough:
            return point, Ending.DONE
    near = potential.distance(point) <= enough
    return point, Ending.DONE if near else Ending.SLOW


def blocks_in(potential: Potential, wanted: Bools) -> int:
    """Return how many blocks the regions ``wanted`` (r,) have; fixed ones do not count."""
    return int(np.count_nonzero(wanted[potential.regions.of_blocks] & ~potential.fixed))


def remaining(distances: list[float], enough: float) -> float:
    """Return how many iterations are still needed at the rate of the last few; 0: unknown."""
    if len(distances) <= WINDOW:
        return 0.0
    gained = np.log(distances[-1 - WINDOW] / distances[-1]) / WINDOW
    needed = np.log(distances[-1] / enough)
    return float(needed / gained) if gained > 0.0 else np.inf
