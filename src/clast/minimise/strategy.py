"""In which order the blocks come to their minimum, and by which method.

Small islands go one by one (islands.py): of a falling heap, of towers, of rock that comes down in
many places all together would take as many iterations as the slowest of them.

The others go on together by Newton's method.  It goes along its direction as far as the springs
allow that open, close, stick and slide along it: all blocks no farther than suits those few of
them that have most to settle, and the more blocks there are the more of those.  Yet nearly all that
is left to the minimum lies with few blocks.  So before a direction for all, these few and their
neighbours are minimised by themselves while the others stand still (a nonlinear elimination; Cai
and Li 2011).  The potential falls in either case, so that Newton's method converges as before.

Where it takes long all the same, the interior point method takes over (interior_point.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from clast.compute.reductions import is_any
from clast.errors import StepOutcome, StepRejected
from clast.minimise.few_blocks import FEW_BLOCKS, minimise_few
from clast.minimise.interior_point import InteriorPoint
from clast.minimise.islands import are_small, minimise_each
from clast.minimise.newton import Ending, Newton, SolverContext, iterate
from clast.minimise.potential import Point, Potential
from clast.minimise.subproblem import copied, subproblem, with_neighbours
from clast.model.model import Bools, Floats


@dataclass(frozen=True, kw_only=True)
class SmallIslands:
    """Newton's method on each small island by itself, its systems solved exactly."""

    few: int = 200
    """Blocks up to which any island is small; 0: none is."""
    like_trees: float = 1.3
    """Pairs for each block up to which larger ones are, too: they are solved with next to no
    fill."""
    iterations: int = 30
    """Iterations at most; islands that need more go on with the large ones."""
    finished: float = 0.25
    """Share of the tolerance that islands may hold together which are left as they are."""

    def minimise(
        self, potential: Potential, point: Point, tolerance: float, work: SolverContext
    ) -> tuple[Point, Floats]:
        """Return the point where small islands are at their minimum, and all distances, J/m, (r,).

        They come near enough for all to be within ``tolerance``, J/m, where all are small.
        Iterations are counted of the island that takes most.
        """
        islands, left = potential.islands, potential.island_distances(point)
        if potential.joined or potential.law is not None or self.few == 0:
            return point, left
        chosen = unfinished(left, self.finished * tolerance)
        if not is_any(chosen):
            return point, left
        if len(potential.fixed) > self.few:  # else all are small
            chosen &= self.small(potential)
        wanted = chosen.nonzero()[0]
        count = len(wanted)
        if count == 0:
            return point, left
        # the largest first: the others fill up what time is left
        size = np.diff(islands.listing[0]).take(wanted)
        order = np.argsort(-size, kind="stable")
        moved, large = copied(point), np.count_nonzero(size > FEW_BLOCKS)
        limits = np.array([self.finished * tolerance / count, self.iterations])
        taken = [
            minimise(some, islands.listing, potential.problem, moved.arrays, limits, left)
            for minimise, some in (
                (minimise_each, wanted[order[:large]]),
                (minimise_few, wanted[order[large:]]),
            )
            if len(some)
        ]
        work.count("passes", max(int(passes) for passes, _ in taken))
        work.count("line_search", max(int(evaluations) for _, evaluations in taken))
        return moved, left

    def small(self, potential: Potential) -> Bools:
        """Return which islands (r,) are small."""
        islands = potential.islands
        small: Bools = are_small(
            islands.of_blocks,
            islands.count,
            potential.springs.pairs,
            potential.graph[0],
            potential.fixed,
            self.few,
            self.like_trees,
        )
        return small


def unfinished(distances: Floats, together: float) -> Bools:
    """Return True for the islands (r,) without which the others are within ``together``, J/m.

    Those that are left alone are as many as may be.
    """
    wanted: Bools = ~(distances <= together)  # what is not finite is not finished
    others = (~wanted & (distances > 0.0)).nonzero()[0]
    if not len(others):
        return wanted
    left = distances.take(others)
    if np.add.reduce(left) > together:
        order = np.argsort(left, kind="stable")
        wanted[others[order][np.cumsum(left[order]) > together]] = True
    return wanted


@dataclass(frozen=True, kw_only=True)
class NonlinearElimination:
    """The blocks that are farthest from their minimum go first, while the others stand still."""

    large: int = 1500
    """Free blocks from which this is done: among fewer it costs as much as it saves."""
    few: float = 0.4
    """Share of the blocks above which they and their neighbours do not go by themselves."""
    iterations: int = 6
    """Iterations of theirs; where more are needed the others need to move as well."""
    nearly: float = 0.25
    """Share of the tolerance at which they are done in any case."""
    all_the_same: float = 0.05
    """Fixed cost of an iteration of few blocks, as a share of one of all blocks."""
    least: float = 1e-4
    """Smallest share of the distance that the iterations of few blocks can reach."""

    def lower(
        self, potential: Potential, point: Point, tolerance: float, work: SolverContext
    ) -> Point:
        """Return a lower point: the worst blocks are near their minimum, where they are few.

        They are done where they have no more left to it than all others together.
        """
        blocks = np.count_nonzero(~potential.fixed)
        if blocks <= self.large or (potential.joined or potential.law is not None):
            return point
        work.stages("law")
        worst, others = self.worst(point.distances)
        moves = with_neighbours(worst, potential.springs.pairs) & ~potential.fixed
        if not 0 < np.count_nonzero(moves) <= self.few * blocks:
            return point
        part = subproblem(potential, point, moves)
        moved, left = part.point, max(others, self.nearly * tolerance)
        for _ in range(self.iterations):
            if part.potential.distance(moved) <= left:
                break
            moved, _ = iterate(part.potential, moved, work)
            work.count("local")
        work.stages("law")
        return part.put_back(potential, point, moved)

    def worst(self, distances: Floats) -> tuple[Bools, float]:
        """Return which blocks (n,) are worth going first, and the distance of the others, J/m.

        They are those whose ``distances`` (n,), J/m, are of some power of two or a higher one: of
        the one with which most is gained, as a logarithm of the remaining distance, for the price
        of an iteration.  There are none where a distance is not finite.
        """
        total = float(distances.sum())
        if not 0.0 < total < np.inf:
            return np.zeros(len(distances), bool), total
        _, power = np.frexp(distances)
        place = power - int(power.min())
        together = np.bincount(place, weights=distances)
        number = np.bincount(place, weights=distances != 0.0)  # frexp gives 0 for 0 and for 1/2
        others = np.concatenate([[0.0], np.cumsum(together)[:-1]])
        gained = -np.log(np.maximum(others / total, self.least))
        price = self.all_the_same + np.cumsum(number[::-1])[::-1] / len(distances)
        best = int(np.argmax(gained / price))
        chosen: Bools = (place >= best) & (distances != 0.0)
        return chosen, float(others[best])


@dataclass(frozen=True, kw_only=True)
class MinimisationStrategy:
    """How a potential is minimised: small islands, the worst blocks, all of them."""

    newton: Newton = field(default_factory=Newton)
    """Newton's method on all blocks together."""
    small: SmallIslands = field(default_factory=SmallIslands)
    """The strategy of small islands, which come first."""
    elimination: NonlinearElimination = field(default_factory=NonlinearElimination)
    """The strategy of the worst blocks before each iteration."""
    inside: InteriorPoint | None = field(default_factory=InteriorPoint)
    """The method that takes over where Newton's method takes long; None: none."""
    patience: float = 60.0
    """Iterations to go that are worth a change to the interior point method, which needs 20 to 30:
    Newton's last iterations gain far more than those from which their number is foretold."""

    finished: float = 0.25
    """Share of the tolerance that islands may hold together which are left as they are."""
    most: float = 0.9
    """Share of the blocks up to which those of the other islands go on without them."""

    def minimise(
        self, potential: Potential, point: Point, tolerance: float, work: SolverContext
    ) -> Point:
        """Return the minimum of the potential, from ``point`` on.

        Done where twice the potential is within ``tolerance``, J/m, of its minimum.  Raises
        StepRejected where Newton's method needs more than its iterations.
        """
        work.stages("law")
        if potential.distance(point) <= tolerance:
            return point
        work.stages("small islands")
        point, left = self.small.minimise(potential, point, tolerance, work)
        if np.add.reduce(left) <= tolerance:
            return point
        work.stages("law")
        wanted = unfinished(left, self.finished * tolerance)
        moves = wanted[potential.islands.of_blocks] & ~potential.fixed
        free = np.count_nonzero(~potential.fixed)
        few = (
            not potential.joined
            and potential.law is None
            and np.count_nonzero(moves) <= self.most * free
        )
        part = subproblem(potential, point, moves) if few else None
        problem, at, rest = potential, point, tolerance
        if part is not None:
            problem, at = part.potential, part.point
            rest = tolerance - float(left[~wanted].sum())

        def before(point: Point) -> Point:
            return self.elimination.lower(problem, point, rest, work)

        ending = Ending.SLOW
        if self.inside is not None and not problem.joined and problem.law is None:
            hasty = replace(self.newton, patience=min(self.patience, self.newton.patience))
            at, ending = hasty.descend(problem, at, rest, work, before)
            if ending is not Ending.DONE:
                work.count("interior")
                at = self.inside.minimise(problem, at, rest, work)
        if ending is not Ending.DONE:
            at, ending = self.newton.descend(problem, at, rest, work, before)
        if ending is not Ending.DONE:
            raise StepRejected(
                StepOutcome.NOT_CONVERGED,
                f"{self.newton.iterations} Newton iterations left {problem.distance(at):.3g} "
                f"of {rest:.3g} J/m",
            )
        if part is None:
            return at
        work.stages("law")
        return part.put_back(potential, point, at)
