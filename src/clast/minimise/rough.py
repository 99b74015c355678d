"""A minimum as near as the friction bound can make use of.

The friction bound follows the normal force: a step is minimised, the bound is renewed from the
normal forces found, and it is minimised again.  What is left open the first time is no more than a
start for the second, whose bounds push the minimum away in any case.  So the first need not be
nearer to its minimum than a small share of how far the new bounds push it: they cannot tell more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from clast.compute.stopwatch import Stages
from clast.minimise.potential import Point, Potential
from clast.model.model import Floats

COARSE = 1e8
"""Energy left open to begin with, in units of what may be left open of the step."""
SHARE = 1e-2
"""Energy left open in the end, in units of what new friction bounds bring in."""
SHARPER = 0.1
"""Energy left open at the next try, in units of that at the last, at most."""

Minimise = Callable[[Potential, Point, float], Point]
"""Returns the minimum of a potential from a point on, but for an energy left open, J/m."""


def with_new_bounds(
    minimise: Minimise, potential: Potential, point: Point, enough: float, stages: Stages
) -> tuple[Potential, Point]:
    """Return the potential whose friction is bound by the forces of its rough minimum, and that.

    Each region is as near as its own new bounds ask for; others may be far larger.  No more is
    asked for than a distance of ``enough``, J/m, at which the step is solved.
    """
    asked = COARSE * enough
    while True:
        point = minimise(potential, point, asked)
        with stages("law"):
            renewed = bound_by(potential, point.response.normal_force)
            moved = renewed.again(point)
            left, tolerated = potential.distances(point), SHARE * renewed.distances(moved)
        if asked <= enough or float(left[~(left <= tolerated)].sum()) <= enough:
            return renewed, moved
        asked = max(enough, min(SHARPER * asked, float(tolerated.sum())))


def bound_by(potential: Potential, normal_force: Floats) -> Potential:
    """Return the potential with friction bound by normal forces (m,), N/m."""
    return replace(potential, contacts=replace(potential.contacts, friction_base=normal_force))
