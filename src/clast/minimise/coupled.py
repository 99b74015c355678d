"""Newton's method on the equations of a step whose friction follows the normal forces.

    r(d) = F - K d + sum N n + T t = 0,    N = N(gap + n.d),    |T| <= mu N + c L

With friction bounds that are given r is minus the gradient of a potential, which has one minimum.
With bounds that follow N there is no potential: where a contact slides the tangent has a term
mu k_n t n^T, which is not symmetric (Alart and Curnier 1991).  While contacts keep their modes r is
a straight line, so that an iteration ends at the solution to rounding once these are those of the
solution.  There may be none, and it may not be found.

Directions are those of a flexible GMRES (Saad 1993) with the symmetric part, which the solver of
the step has ready, as preconditioner: it takes as many solutions as there are contacts that slide,
at most, and far fewer where these are many.

Where that fails friction bounds are renewed from the forces, a fixed point (linear/guesses.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from clast.compute.reductions import is_any
from clast.errors import StepRejected
from clast.linear.system import contact_motions, with_contact_forces
from clast.minimise.newton import EachBlock, SolverContext
from clast.minimise.potential import Point, Potential
from clast.model.model import Floats

STEP_SHARES = 1.0, 0.5, 0.25, 0.125, 0.03, 0.01
"""Shares of a direction that are tried where the residual is not less at its end.  Where none does,
either, a contact is about to change its mode, and all of it is taken."""
ITERATIONS_UNJUDGED, GROWTH_MAX, DISTANCE_LEFT_MAX = 4, 10.0, 0.1
"""Iterations after which the distance must be less than a tenth of the first, and by how much it
may be more before: where contacts go to and fro between modes none of them ends."""
GMRES_TOLERANCE, GMRES_ITERATIONS_MAX = 1e-6, 60
"""Residual at which GMRES ends, as a share of the first, and its iterations at most."""


@dataclass(frozen=True, kw_only=True)
class CoupledNewton:
    """Solves the equations of a step from a point near their solution."""

    iterations: int = 12
    """Iterations at most."""
    agrees: float = 1e-9
    """Imbalance of each block at the solution, as a share of the forces on it."""

    def solve(
        self, potential: Potential, point: Point, each: EachBlock, work: SolverContext
    ) -> Point | None:
        """Return the solution near ``point``, None where it is not found.

        The law of the ``potential`` has friction that follows the normal force.
        """
        each, at = replace(each, share=self.agrees), potential.again(point)
        begin = potential.distance(at)
        for done in range(self.iterations):
            if each.excess(potential, at).max(initial=0.0) <= 1.0:
                return at
            try:
                direction = _direction(potential, at, work)
            except StepRejected:
                return None
            work.count("passes")
            at = _along(potential, at, direction)
            if (
                potential.distance(at)
                > (GROWTH_MAX if done < ITERATIONS_UNJUDGED else DISTANCE_LEFT_MAX) * begin
            ):
                return None
        return None


def _along(potential: Potential, at: Point, direction: Floats) -> Point:
    """Return the point along a direction (n, 6) at which the residual is less, or hardly more."""
    left = potential.distance(at)
    best, least = at, np.inf
    for share in STEP_SHARES:
        part = potential.at(at.unknowns + share * direction)
        size = potential.distance(part)
        if size < least:
            best, least = part, size
        if size < left:
            break
    return best


def _direction(potential: Potential, at: Point, work: SolverContext) -> Floats:
    """Return Newton's direction (n, 6); raises StepRejected where it is not found."""
    coupling = at.forces.coupling * at.forces.normal_stiffness
    if not is_any(coupling != 0.0):
        return potential.direction(at, work.factor, work.stages)
    work.stages("assembly")
    springs, graph, fixed = potential.springs, potential.graph, potential.fixed
    symmetric, solved = potential.tangent(at, work.factor)

    def times(direction: Floats) -> Floats:
        """Return the tangent times a direction: T falls by mu k_n n.d more than its spring's."""
        opening, _ = contact_motions(springs, direction)
        known = symmetric(direction)
        none = np.zeros(len(springs))
        return with_contact_forces(known, springs, graph, fixed, none, coupling * opening)

    work.stages("solve")
    direction = gmres(times, solved, at.residual)
    work.stages("law")
    return direction


def gmres(
    times: Callable[[Floats], Floats], solved: Callable[[Floats], Floats], force: Floats
) -> Floats:
    """Return x (n, 6) of ``times(x) = force``; ``solved`` gives it nearly, not always alike."""
    size = float(np.linalg.norm(force))
    turns: list[tuple[float, float]] = []
    basis, tried, left = [force / size], [], size
    products = np.zeros((GMRES_ITERATIONS_MAX + 1, GMRES_ITERATIONS_MAX))
    for k in range(GMRES_ITERATIONS_MAX):
        tried.append(solved(basis[k]))
        new = times(tried[k])
        for j, one in enumerate(basis):
            products[j, k] = np.vdot(one, new)
            new = new - products[j, k] * one
        products[k + 1, k] = np.linalg.norm(new)
        # the residual by Givens rotations, which take the column to a triangle's
        column = products[: k + 2, k].tolist()
        for j, (cos, sin) in enumerate(turns):
            upper, lower = column[j], column[j + 1]
            column[j], column[j + 1] = cos * upper + sin * lower, cos * lower - sin * upper
        diagonal = math.hypot(column[k], column[k + 1])
        turns.append((column[k] / diagonal, column[k + 1] / diagonal) if diagonal else (1.0, 0.0))
        left *= abs(turns[k][1])
        if left <= GMRES_TOLERANCE * size or products[k + 1, k] == 0.0:
            break
        basis.append(new / products[k + 1, k])
    count = len(tried)
    right = np.zeros(count + 1)
    right[0] = size
    shares = np.linalg.lstsq(products[: count + 1, :count], right, rcond=None)[0]
    return np.asarray(np.einsum("k,knd->nd", shares, np.array(tried)))
