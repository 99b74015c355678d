"""Solvers of the block system: an exact factor for few blocks, PCG for many."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from clast.errors import StepOutcome, StepRejected
from clast.linear import block_matrix, coarse_space, ldlt, pcg
from clast.linear.pattern import Patterns, exact_pattern, strips_of, without_fill
from clast.linear.system import BlockSystem
from clast.model.model import Bools, Floats


class Factorisation(Protocol):
    """A block system made ready to be solved for several right-hand sides."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        ...


class LinearSolver(Protocol):
    """Solves the 6 x 6 block system of a step."""

    def factor(self, system: BlockSystem, patterns: Patterns) -> Factorisation:
        """Return the matrix made ready; raises StepRejected where it is singular.

        ``patterns`` keeps data that depend on the pairs alone, not to be found again for every
        matrix; a solver that keeps nothing leaves it alone.
        """
        ...


@dataclass(frozen=True)
class ExactFactor:
    """A matrix K = L D L^T."""

    factor: tuple[Any, ...]
    """The factor (linear/ldlt.py)."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        displacement: Floats = ldlt.solve(self.factor, force)
        if not np.isfinite(displacement).all():
            raise StepRejected(StepOutcome.NOT_FINITE)
        return displacement


@dataclass(frozen=True)
class Direct:
    """Block LDL^T."""

    def factor(self, system: BlockSystem, patterns: Patterns) -> Factorisation:
        """Return the factorised matrix; raises StepRejected where it is singular."""
        pattern = patterns.of(system, exact_pattern)
        factor, bad = ldlt.exact(pattern, system.diagonal, system.upper)
        if bad >= 0:
            raise StepRejected(
                StepOutcome.SINGULAR,
                f"the matrix is not positive definite: equations of block {bad + 1}",
            )
        return ExactFactor(factor)


@dataclass(frozen=True, kw_only=True)
class Attempt:
    """How an iteration is preconditioned, and when it is given up."""

    coarse: bool
    """Whether there is a coarse space beside the factor without fill."""
    shift: float
    """Share by which diagonal blocks are larger in the eliminated matrix than in K."""
    iterations: int
    """Iterations at most."""
    trial: int
    """Iterations after which it is given up where far more than those at most seem needed."""

    def ready(
        self, system: BlockSystem, coupled: Bools, patterns: Patterns
    ) -> tuple[Any, ...] | None:
        """Return the factor for linear/pcg.py, or None where single precision is not enough.

        ``coupled`` (q,) says which pairs are.  Raises StepRejected where K is singular.
        """
        order, begin = patterns.of(system, strips_of)
        pattern = without_fill(order, begin, system.pairs, system.rows, coupled)
        factor, matrix, bad = ldlt.incomplete(pattern, system.diagonal, system.upper, self.shift)
        if bad >= 0:
            raise StepRejected(StepOutcome.SINGULAR, f"equations of block {bad + 1}")
        if not self.coarse:
            return factor, matrix, NO_AGGREGATES
        aggregates = patterns.of(system, coarse_space.aggregates_of)
        coarse, definite = coarse_space.factor(factor[0], matrix, aggregates)
        return (factor, matrix, coarse) if definite else None


NO_AGGREGATES = coarse_space.no_aggregates()
"""No coarse system."""
SHIFT, SAFE_SHIFT = 0.006, 0.02
"""Shares by which diagonal blocks are larger, at first and where pivots were next to singular all
the same: there 15 to 40 iterations then take the place of 50 to 900, or of numbers that are not
finite; elsewhere it costs up to half as many more."""
TRIAL_ITERATIONS = 8
"""Iterations after which the rate of convergence is judged."""
SINGLE_PRECISION_REDUCTION = 1e-5
"""Reduction of the residual that single precision is good for, before it is computed anew."""


class IteratedMatrix:
    """A system that is solved by iteration, and exactly where all attempts stall."""

    def __init__(
        self,
        system: BlockSystem,
        coupled: Bools,
        patterns: Patterns,
        tolerance: float,
        attempts: tuple[Attempt, ...],
    ) -> None:
        self._system, self._coupled, self._patterns = system, coupled, patterns
        self._attempts, self._stalled = attempts, False
        self._ready: tuple[Any, ...] | None = None
        self._exact: Factorisation | None = None
        self.tolerance = tolerance
        self.iterated = 0
        self._begin()

    @property
    def next_solver(self) -> LinearSolver | None:
        """Who would have solved this matrix without stalling; None where nothing has stalled."""
        if not self._stalled:
            return None
        return Iteration(self.tolerance, self._attempts) if self._attempts else Direct()

    @property
    def ready(self) -> tuple[Any, ...] | None:
        """The factor without fill, K in its order and the coarse system (linear/pcg.py)."""
        return self._ready

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6)."""
        return self.nearer(force, None, self.tolerance)

    def nearer(self, force: Floats, guess: Floats | None, tolerance: float) -> Floats:
        """Return d (n, 6) whose residual is at most ``tolerance`` of that of ``guess`` (n, 6).

        None is a guess of zero.
        """
        while self._exact is None:
            displacement = self._refined(force, guess, tolerance)
            if displacement is not None:
                return displacement
            self._give_up()
        return self._exact.solve(force)

    def _begin(self) -> None:
        """Make the matrix ready for the first attempt that is worth making, or exactly."""
        while self._attempts:
            self._ready = self._attempts[0].ready(self._system, self._coupled, self._patterns)
            if self._ready is not None:
                return
            self._attempts, self._stalled = self._attempts[1:], True
        self._exact = Direct().factor(self._system, self._patterns)

    def _give_up(self) -> None:
        """Go on to the next attempt."""
        self._attempts, self._stalled = self._attempts[1:], True
        self._begin()

    def _refined(self, force: Floats, guess: Floats | None, tolerance: float) -> Floats | None:
        """Return d (n, 6) by iterative refinement, or None where the iteration stalls."""
        attempt, displacement = self._attempts[0], guess
        left, goal, before = attempt.iterations, 0.0, math.inf
        rough, accuracy = (
            tolerance >= SINGLE_PRECISION_REDUCTION,
            max(tolerance, SINGLE_PRECISION_REDUCTION),
        )
        while True:
            residual = force if displacement is None else force - self._times(displacement)
            correction, iterations, size, rest = pcg.solve(
                self._ready, residual, 0.5 * goal, accuracy, left, attempt.trial
            )
            if displacement is not None and size <= goal:
                return displacement
            # Reduction of the residual, computed anew, without which single precision is not enough
            if not size <= 0.5 * before:
                return None
            self.iterated += iterations
            left, before = left - iterations, size
            goal, accuracy = goal or tolerance * size, SINGLE_PRECISION_REDUCTION
            displacement = correction if displacement is None else displacement + correction
            if rough and rest <= goal:
                return displacement
            if not rest <= max(SINGLE_PRECISION_REDUCTION * size, goal):
                return None

    def _times(self, displacement: Floats) -> Floats:
        """Return K d (n, 6) in double precision."""
        system = self._system
        return np.asarray(
            block_matrix.multiply(
                system.diagonal, system.upper, system.pairs, system.rows, displacement
            )
        )


@dataclass(frozen=True)
class Iteration:
    """Conjugate gradients by given attempts, one after the other."""

    tolerance: float
    """Reduction of the residual that ends the iteration."""
    attempts: tuple[Attempt, ...]
    """The first is tried first; after the last one the matrix is factorised."""

    def factor(self, system: BlockSystem, patterns: Patterns) -> Factorisation:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        coupled = np.asarray(block_matrix.coupled_pairs(system.upper))
        return IteratedMatrix(system, coupled, patterns, self.tolerance, self.attempts)


@dataclass(frozen=True)
class PCG:
    """Preconditioned conjugate gradients.

    By a factor without fill, and a coarse space of aggregates where inertia does not hold its own
    against the contacts.  Where that stalls a safer factor is made, and where that stalls, too, the
    system is factorised with all fill.
    """

    tolerance: float = 1e-8
    """Reduction of the residual, in the norm of the preconditioner, that ends the iteration."""
    iterations: int = 400
    """Iterations with a coarse space at most, before a factorisation takes over."""
    plain: int = 100
    """Iterations without a coarse space at most, before one is added; 0: none."""

    def inexact(self, tolerance: float) -> PCG:
        """Return the same solver ending at ``tolerance``, if that is earlier."""
        return replace(self, tolerance=max(self.tolerance, tolerance))

    def factor(self, system: BlockSystem, patterns: Patterns) -> Factorisation:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        coupled = np.asarray(block_matrix.coupled_pairs(system.upper))
        # the first iterations of the last attempt may gain nothing, and an exact factor comes after
        most, safe_trial = self.iterations, max(TRIAL_ITERATIONS, self.iterations // 10)
        attempts: tuple[Attempt, ...] = (
            Attempt(coarse=True, shift=SHIFT, iterations=most, trial=TRIAL_ITERATIONS),
            Attempt(coarse=True, shift=SAFE_SHIFT, iterations=most, trial=safe_trial),
        )
        if self.plain > 0 and suffices_alone(system, coupled):
            plain = Attempt(
                coarse=False, shift=SHIFT, iterations=self.plain, trial=TRIAL_ITERATIONS
            )
            attempts = (plain, *attempts)
        return IteratedMatrix(system, coupled, patterns, self.tolerance, attempts)


INERTIA_SHARE_MIN, INERTIA_SHARE_ENOUGH = 0.01, 0.1
"""Shares of inertia below which a factor without fill does not suffice, and above which it does."""
LEAST_INERTIA_SHARE = 5e-4
"""Least share of inertia of any block below which it does not suffice in between."""


def suffices_alone(system: BlockSystem, coupled: Bools) -> bool:
    """Return whether a factor without fill alone takes few iterations: thirty at most.

    A translation of all blocks together moves no contact between two of them, so that the remainder
    of e.K e, e being all translations, is inertia: its share of the diagonal blocks' own is the
    share of the blocks' stiffness that is not that of contacts.  Springs to fixed blocks count as
    inertia there, so that it may be large although most blocks have next to none; the least share
    of one block with its row of K may be that of a single light block, and is of no account beside
    a large one of all.
    """
    share, least = block_matrix.inertia_shares(system.diagonal, system.upper, system.rows, coupled)
    return bool(
        share > INERTIA_SHARE_ENOUGH or (share > INERTIA_SHARE_MIN and least > LEAST_INERTIA_SHARE)
    )


@dataclass(frozen=True)
class Automatic:
    """An exact factor for few blocks, chains and trees, and PCG for others."""

    few: int = 200
    """Blocks up to which the factor is exact."""
    tolerance: float = 1e-8
    """Reduction of the residual that ends an iteration."""

    def inexact(self, tolerance: float) -> Automatic:
        """Return the same solver with iterations ending at ``tolerance``, if that is earlier."""
        return replace(self, tolerance=max(self.tolerance, tolerance))

    def factor(self, system: BlockSystem, patterns: Patterns) -> Factorisation:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        count = len(system.diagonal)
        if count <= self.few or len(system.pairs) < count:
            return Direct().factor(system, patterns)
        most = int(ITERATIONS_PER_ROOT * math.sqrt(count))
        return PCG(self.tolerance, iterations=most, plain=most).factor(system, patterns)


ITERATIONS_PER_ROOT = 2.0
"""Iterations at most, in units of the root of the number of blocks n: an exact factor of blocks in
the plane takes as n^1.5, an iteration as n."""
DIRECTION_TOLERANCE = 1e-3
"""Accuracy of Newton's directions where they are found by iteration; the step's is unaffected."""


def inexact(solver: LinearSolver, tolerance: float) -> LinearSolver:
    """Return the solver for systems within Newton's method: iterations may end at ``tolerance``."""
    return solver.inexact(tolerance) if isinstance(solver, PCG | Automatic) else solver


def solve(solver: LinearSolver, system: BlockSystem) -> Floats:
    """Return d (n, 6) of a block system with its own right-hand side."""
    return solver.factor(system, Patterns()).solve(system.force)
