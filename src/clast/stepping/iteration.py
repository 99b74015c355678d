"""One iteration of Newton's method with exact line search."""

from __future__ import annotations

from clast.equations.reuse import FactorOfStep
from clast.kernels.block_rows import dot
from clast.stepping.potential import Point, Potential
from clast.stepping.stages import Stages


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
