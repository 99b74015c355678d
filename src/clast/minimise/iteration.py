"""One iteration of Newton's method with exact line search."""

from __future__ import annotations

from clast.compute.stopwatch import Stages
from clast.linear.block_matrix import dot
from clast.linear.reuse import FactorOfStep
from clast.minimise.potential import Point, Potential


def iterate(
    potential: Potential,
    point: Point,
    factor: FactorOfStep,
    counts: dict[str, int],
    stages: Stages,
) -> tuple[Point, float]:
    """Return the point that an iteration leads to, and the decrement r.dd before it, J/m."""
    direction = potential.direction(point, factor, stages)
    decrement = float(dot(point.residual, direction))
    with stages("line search"):
        line, evaluations = potential.line_search(point, direction)
        counts["line_search"] += evaluations
    with stages("law"):
        return potential.moved(point, line), decrement
