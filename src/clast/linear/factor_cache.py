"""One factorisation for all solves that share a matrix."""

from __future__ import annotations

import numpy as np

from clast.compute.reductions import alike
from clast.linear.pattern import Patterns
from clast.linear.solvers import Automatic, Factorisation, IteratedMatrix, LinearSolver
from clast.linear.system import BlockSystem, LinearisedForces
from clast.model.model import Floats, Ints


class FactorOfStep:
    """Solves the systems of one step, factorising again only where a stiffness has changed.

    Within a step the matrix depends on the contacts' stiffnesses alone: multiplier updates and
    friction updates of one active set change the right-hand side only.
    """

    def __init__(self, solver: LinearSolver, patterns: Patterns | None = None) -> None:
        self._solver, self.patterns = solver, patterns or Patterns()
        self._factor: Factorisation | None = None
        self._stiffness: tuple[Floats, ...] = ()
        self._pairs: Ints = np.zeros((0, 2), np.int64)
        self._other: LinearSolver | None = None
        self._pause = 0
        self._left = 0
        self._iterated = 0
        self.factorised = 0
        self.solved = 0

    def solve(self, system: BlockSystem, response: LinearisedForces) -> Floats:
        """Return d (n, 6) of a system that was assembled with ``response``."""
        return self._factor_of(system, response).solve(system.force)

    def nearer(
        self,
        system: BlockSystem,
        response: LinearisedForces,
        guess: Floats | None,
        tolerance: float,
    ) -> Floats:
        """Return d (n, 6) of a system; an iteration starts from ``guess`` (n, 6), None being zero.

        It ends where the residual has fallen to ``tolerance`` of the guess's.
        """
        factor = self._factor_of(system, response)
        if isinstance(factor, IteratedMatrix):
            return factor.nearer(system.force, guess, max(tolerance, factor.tolerance))
        return factor.solve(system.force)

    def _factor_of(self, system: BlockSystem, response: LinearisedForces) -> Factorisation:
        """Return the matrix made ready, or the last one where no stiffness has changed."""
        stiffness = (response.normal_stiffness, response.shear_stiffness)
        same = len(self._stiffness) == len(stiffness) and all(
            one is other or bool(alike(one, other))
            for one, other in zip(stiffness, self._stiffness, strict=True)
        )
        same = same and (system.pairs is self._pairs or np.array_equal(system.pairs, self._pairs))
        if self._factor is None or not same:
            solver = self._next_solver()
            self._iterated = self.iterations
            self._factor = solver.factor(system, self.patterns)
            self._stiffness, self._pairs = stiffness, system.pairs
            self.factorised += 1
        self.solved += 1
        return self._factor

    @property
    def chooses_solver(self) -> bool:
        """True where no solver is asked for: small systems may be solved by other means."""
        return isinstance(self._solver, Automatic)

    @property
    def iterations(self) -> int:
        """Iterations of an iterative solver so far."""
        return self._iterated + int(getattr(self._factor, "iterated", 0))

    def _next_solver(self) -> LinearSolver:
        """Return the solver for the next matrix.

        Where an iteration has stalled the next matrix is given to the solver that took over; if the
        one after it stalls too, the next two, then four: stalling never more than doubles the cost,
        and a few odd matrices do not spoil a step.
        """
        stalled = getattr(self._factor, "next_solver", None)
        if stalled is not None:
            self._other, self._pause = stalled, max(1, 2 * self._pause)
            self._left = self._pause
        elif self._other is None:
            self._pause = 0
        if self._left > 0 and self._other is not None:
            self._left -= 1
            return self._other
        self._other = None
        return self._solver
