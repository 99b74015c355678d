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

PATIENCE = 8
"""Newton iterations after which the interior point method takes over."""


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
    first = iterations if limits is None else min(PATIENCE, iterations)
    point, done = newton(potential, point, factor, enough, first, counts, stages)
    if done:
        return point
    if limits is not None:
        counts["interior"] = counts.get("interior", 0) + 1
        point = minimise_inside(potential, limits, point, factor, enough, counts, stages)
        point, done = newton(potential, point, factor, enough, iterations - first, counts, stages)
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
    counts: dict[str, int],
    stages: Stages,
) -> tuple[Point, bool]:
    """Return where Newton's method with exact line search comes to, and whether that is enough."""
    for _ in range(iterations):
        if potential.distance(point) <= enough:
            return point, True
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
