"""The minimum of the incremental potential: Newton's method, and what follows where it is slow."""

from __future__ import annotations

import numpy as np

from clast.contact.springs import limits_of
from clast.equations.reuse import FactorOfStep
from clast.errors import StepOutcome, StepRejected
from clast.model import Floats
from clast.stepping.interior import minimise_inside
from clast.stepping.potential import Point, Potential
from clast.stepping.stages import Stages

WINDOW = 4
"""Iterations from which the rate of convergence is taken."""
INTERIOR = 30
"""Iterations that are worth a change to the interior point method, which needs some 20."""


def minimise(
    potential: Potential,
    starts: tuple[Floats, ...],
    factor: FactorOfStep,
    tolerance: float,
    iterations: int,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return the minimum of the potential, from the best of ``starts``, each (n, 6).

    Done where the potential is within tolerance^2 x yardstick of its minimum: by the
    bound without a system, or by the Newton decrement r.dd.  A law of springs with bounds is
    handed to the interior point method where Newton's takes long.  ``counts`` is added to.
    Raises StepRejected after ``iterations``.
    """
    with stages("law"):
        point = min((potential.at(start) for start in starts), key=potential.distance)
        enough = tolerance**2 * potential.yardstick()
    limits = limits_of(potential.law, potential.contacts)
    patience = np.inf if limits is None else INTERIOR
    point, done = newton(potential, point, factor, enough, iterations, patience, counts, stages)
    if not done and limits is not None:
        counts["interior"] = counts.get("interior", 0) + 1
        point = minimise_inside(potential, limits, point, factor, enough, counts, stages)
        point, done = newton(potential, point, factor, enough, iterations, np.inf, counts, stages)
    if not done:
        raise StepRejected(
            StepOutcome.NOT_CONVERGED,
            f"{iterations} Newton iterations left {potential.distance(point):.3g} "
            f"of {enough:.3g} J/m",
        )
    return point


def newton(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    iterations: int,
    patience: float,
    counts: dict[str, int],
    stages: Stages,
) -> tuple[Point, bool]:
    """Return where Newton's method with exact line search comes to, and whether that is enough.

    It gives up after ``iterations``, or where at its present rate it needs more than ``patience``.
    """
    distances: list[float] = []
    for _ in range(iterations):
        distances.append(potential.distance(point))
        if distances[-1] <= enough:
            return point, True
        if remaining(distances, enough) > patience:
            return point, False
        direction = potential.direction(point, factor, stages)
        counts["passes"] += 1
        decrement = float(np.sum(point.residual * direction))
        with stages("line search"):
            length, evaluations = potential.line_search(point, direction)
            counts["line_search"] += evaluations
        with stages("law"):
            point = potential.at(point.unknowns + length * direction)
        if decrement <= enough:
            return point, True
    return point, potential.distance(point) <= enough


def remaining(distances: list[float], enough: float) -> float:
    """Return how many iterations are still needed at the rate of the last few; 0: unknown."""
    if len(distances) <= WINDOW:
        return 0.0
    gained = np.log(distances[-1 - WINDOW] / distances[-1]) / WINDOW
    needed = np.log(distances[-1] / enough)
    return float(needed / gained) if gained > 0.0 else np.inf
