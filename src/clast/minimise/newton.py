"""Newton's method with exact line search on the incremental potential, and when it is enough.

The tolerance of a minimisation is an energy of all blocks together: where a few of them carry the
most, it leaves others with forces that are small beside those and large beside their own.  A static
stage has the minimum sought more sharply until every block is in balance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from clast.compute.compilation import Stages
from clast.compute.reductions import is_any
from clast.linear.block_matrix import dot
from clast.linear.factor_cache import FactorOfStep
from clast.minimise.potential import Point, Potential
from clast.model.model import Floats, Ints

SHARPENINGS_MAX = 4
"""Times that the tolerance is made sharper at most."""


@dataclass(frozen=True, kw_only=True)
class EachBlock:
    """Required balance of each block."""

    share: float
    """Force that may stay out of balance, as a share of the sizes of all forces on the block."""
    gyration: Floats
    """Radius of gyration of each block, by which moments are divided, and 1 of the ground, m,
    shape (n + 1,)."""
    noise: float
    """Force that rounding makes, N/m."""
    floor: float
    """Distance from the minimum that rounding allows, J/m; no smaller one is required."""

    def of(self, blocks: Ints) -> EachBlock:
        """Return the same for some of the blocks (k,), and one more that stands still."""
        return EachBlock(
            share=self.share,
            gyration=np.append(self.gyration[blocks], 1.0),
            noise=self.noise,
            floor=self.floor,
        )

    def sharper(self, potential: Potential, point: Point, tolerance: float) -> float | None:
        """Return the tolerance, J/m, with which to go on; None where each block is in balance."""
        over = self.excess(potential, point)
        if tolerance <= self.floor or not (worst := float(over.max(initial=0.0))) > 1.0:
            return None
        # Tolerance of the next try, in units of the last, at most
        return max(self.floor, min(1e-2, 1.0 / worst**2) * tolerance)

    def excess(self, potential: Potential, point: Point) -> Floats:
        """Return the imbalance of each block, in units of the tolerance, shape (n,)."""
        return self.shares(potential, point) / self.share

    def shares(self, potential: Potential, point: Point) -> Floats:
        """Return the imbalance of each block, as a share of the forces on it, (n,).

        Forces of which rounding alone makes more than may be out of balance count as larger.
        """
        base, springs = potential.base, potential.springs
        count = len(potential.fixed)
        own = base.force - base.momentum
        size = np.hypot(own[:, 0], own[:, 1])
        between = np.hypot(point.forces.normal_force, point.forces.shear_force)
        for block in (springs.vertex_block, springs.edge_block):
            size += np.bincount(block, between, count)
        left = point.residual
        out = np.hypot(np.hypot(left[:, 0], left[:, 1]), left[:, 2] / self.gyration[:count])
        return np.asarray(out / (size + self.noise / self.share))


@dataclass(frozen=True, kw_only=True)
class SolverContext:
    """The shared data of the minimisations of a step."""

    factor: FactorOfStep
    """Solves the systems, and keeps the last matrix."""
    counts: dict[str, int]
    """Iterations by their kind, added to."""
    stages: Stages
    """Where the time goes."""

    def count(self, kind: str, number: int = 1) -> None:
        """Add to the iterations of a kind."""
        self.counts[kind] = self.counts.get(kind, 0) + number


class Ending(Enum):
    """How Newton's method comes to its end."""

    DONE = "near enough"
    SLOW = "far too many iterations to go"


@dataclass(frozen=True, kw_only=True)
class Newton:
    """Newton's method, and when it is given up."""

    iterations: int = 200
    """Iterations at most."""
    patience: float = np.inf
    """Iterations to go, at the present rate, from which it is given up."""
    window: int = 4
    """Iterations from which the rate of convergence is taken."""

    def descend(
        self,
        potential: Potential,
        point: Point,
        tolerance: float,
        work: SolverContext,
        before: Callable[[Point], Point],
    ) -> tuple[Point, Ending]:
        """Return where it comes to, and how it ends.

        Done where twice the potential is within ``tolerance``, J/m, of its minimum: by the bound
        without a system, or by the Newton decrement r.dd.  ``before`` each iteration a point at
        least as low may be found by other means.
        """
        distances: list[float] = []
        for _ in range(self.iterations):
            distances.append(potential.distance(point))
            if distances[-1] <= tolerance:
                return point, Ending.DONE
            if self.remaining(distances, tolerance) > self.patience:
                return point, Ending.SLOW
            point = before(point)
            if potential.distance(point) <= tolerance:
                return point, Ending.DONE
            point, decrement = iterate(potential, point, work)
            work.count("passes")
            if decrement <= tolerance:
                return point, Ending.DONE
        near = potential.distance(point) <= tolerance
        return point, Ending.DONE if near else Ending.SLOW

    def remaining(self, distances: list[float], tolerance: float) -> float:
        """Return how many iterations are still needed at the rate of the last few; 0: unknown."""
        if len(distances) <= self.window:
            return 0.0
        gained = np.log(distances[-1 - self.window] / distances[-1]) / self.window
        needed = np.log(distances[-1] / tolerance)
        return float(needed / gained) if gained > 0.0 else np.inf


def iterate(potential: Potential, point: Point, work: SolverContext) -> tuple[Point, float]:
    """Return the point that an iteration leads to, and the decrement r.dd before it, J/m."""
    direction = potential.direction(point, work.factor, work.stages)
    decrement = float(dot(point.residual, direction))
    work.stages("line search")
    line, evaluations = potential.line_search(point, direction)
    work.count("line_search", evaluations)
    work.stages("law")
    return potential.moved(point, line), decrement


def best_of(potential: Potential, starts: tuple[Floats, ...]) -> Point:
    """Return the point that each island has from the best of ``starts``, (n, 6) each."""
    points = [potential.at(one) for one in starts]
    choice = np.array([potential.island_distances(one) for one in points]).argmin(axis=0)
    if not is_any(choice != choice[0]):
        return points[choice[0]]
    of_blocks = choice[potential.islands.of_blocks]
    return potential.at(np.array(starts)[of_blocks, np.arange(len(of_blocks))])
