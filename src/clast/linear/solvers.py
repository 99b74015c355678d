"""Solvers of the block system."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.errors import StepOutcome, StepRejected
from clast.linear import coarse_kernels as coarse
from clast.linear import coarse_space as aggregated
from clast.linear import incomplete
from clast.linear import pcg as conjugate
from clast.linear.cholesky import Cholesky
from clast.linear.couplings import Precision
from clast.linear.factor import Factor, LinearSolver
from clast.linear.system import BlockSystem
from clast.model.model import Floats, Ints

if TYPE_CHECKING:
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import SuperLU


def _block_pattern(system: BlockSystem) -> tuple[Ints, Ints, Floats]:
    """Return row, column and 6 x 6 values of all non-zero blocks."""
    own = np.arange(len(system.diagonal))
    low, high = system.pairs[:, 0], system.pairs[:, 1]
    rows = np.concatenate([own, low, high])
    columns = np.concatenate([own, high, low])
    return rows, columns, np.concatenate([system.diagonal, system.upper, system.lower])


def sparse_matrix(system: BlockSystem) -> csc_array:
    """Return K as a scipy matrix (6n, 6n) in compressed columns."""
    from scipy.sparse import csc_array  # slow to import, and needed by this solver alone

    rows, columns, blocks = _block_pattern(system)
    # sorted by block column, then block row: each column of a block is six contiguous entries
    order = np.lexsort((rows, columns))
    rows, columns, blocks = rows[order], columns[order], blocks[order]
    count = len(system.diagonal)
    per_column = np.bincount(columns, minlength=count)
    first = np.concatenate([[0], np.cumsum(per_column)])
    position = np.arange(len(rows)) - first[columns]
    width = 6 * per_column
    pointer = np.concatenate([[0], np.cumsum(np.repeat(width, 6))])
    values = np.empty(pointer[-1])
    indices = np.empty(pointer[-1], np.int32)
    six = np.arange(6)
    start = pointer[6 * columns[:, None] + six] + 6 * position[:, None]
    target = start[:, :, None] + six
    values[target] = blocks.transpose(0, 2, 1)
    indices[target] = np.broadcast_to(
        (6 * rows[:, None, None] + six).astype(np.int32), target.shape
    )
    return csc_array((values, indices, pointer.astype(np.int32)), shape=(6 * count, 6 * count))


@dataclass(frozen=True)
class SuperLUFactor:
    """A matrix factorised by SuperLU."""

    factor: SuperLU
    """The factors."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); raises StepRejected where it is not finite."""
        displacement = self.factor.solve(force.ravel()).reshape(-1, 6)
        if not np.isfinite(displacement).all():
            raise StepRejected(StepOutcome.NOT_FINITE)
        return displacement


@dataclass(frozen=True)
class Scipy:
    """SuperLU through scipy, with the ordering and pivoting that suit a symmetric pattern."""

    def factor(self, system: BlockSystem) -> SuperLUFactor:
        """Return the factorised matrix; raises StepRejected where K is singular."""
        from scipy.sparse.linalg import splu

        try:
            return SuperLUFactor(
                splu(
                    sparse_matrix(system),
                    permc_spec="MMD_AT_PLUS_A",
                    diag_pivot_thresh=0.0,
                    options={"SymmetricMode": True},
                )
            )
        except RuntimeError as error:
            raise StepRejected(StepOutcome.SINGULAR, str(error)) from error


@dataclass(frozen=True)
class Direct:
    """Block Cholesky for symmetric systems, SuperLU for others."""

    def factor(self, system: BlockSystem) -> Factor:
        """Return the factorised matrix; raises StepRejected where it is singular."""
        return Cholesky().factor(system) if system.symmetric else Scipy().factor(system)


BREVITY: dict[Precision, type] = {np.float64: np.float32, np.float32: np.uint16}
"""How L is kept beside a K in either precision: as single numbers or short ones."""


def no_aggregates(precision: Precision) -> tuple[Any, ...]:
    """Return what linear/pcg.py takes for no coarse system."""
    none, start = np.zeros(0, np.int64), np.zeros(1, np.int64)
    rows = np.zeros(1, np.int32), np.zeros(1, np.int32), np.zeros(0, np.int32)
    inverse, scaled = np.zeros((0, 6, 6), precision), np.zeros((0, 6, 6), np.float32)
    factor = none, none, np.zeros((0, 2), np.int32), *rows, inverse, scaled
    return none, start, none, np.zeros((0, 2)), factor


NO_AGGREGATES = {kind: no_aggregates(kind) for kind in BREVITY}
"""No coarse system beside a K in either precision."""
NO_GUESS: Floats = np.zeros((0, 6))
"""What linear/pcg.py takes for a guess of zero."""
SHIFT, SAFE_SHIFT = 0.006, 0.02
"""Share by which diagonal blocks are larger in what is eliminated incompletely than they are in K,
and where pivots were next to singular all the same: there 15 to 40 iterations then do what took 50
to 900, or ended in numbers that are none; elsewhere it costs up to half as many more."""
TRIED = 8
"""Iterations after which the rate of convergence is judged."""


@dataclass(frozen=True, kw_only=True)
class WithIncomplete:
    """Conjugate gradients with an incomplete Cholesky factorisation and a coarse system."""

    incomplete: tuple[Any, ...]
    """The factorisation (linear/incomplete.py)."""
    matrix: tuple[Any, Any]
    """K in its order: the diagonal blocks, and those of coupled pairs."""
    coarse: tuple[Any, ...]
    """The coarse system (linear/coarse_kernels.py), or one of NO_AGGREGATES."""
    iterations: int
    """Iterations at most."""
    trial: int = TRIED
    """Iterations after which it is given up where far more than that seem needed."""

    def __call__(
        self, force: Floats, guess: Floats | None, tolerance: float
    ) -> tuple[Floats, int, float]:
        """Return d (n, 6), the iterations, and the share that is left of the guess's residual."""
        found: tuple[Floats, int, float] = conjugate.solve(
            self.incomplete,
            self.matrix,
            self.coarse,
            force,
            NO_GUESS if guess is None else guess,
            tolerance,
            self.iterations,
            self.trial,
        )
        return found

    @property
    def by_rows(self) -> tuple[Any, ...]:
        """K as it is multiplied with: what block_rows.multiply takes before x."""
        _, _, pairs, right, left, listed, _, _ = self.incomplete
        return (*self.matrix, pairs, right, left, listed)


def with_incomplete(
    system: BlockSystem,
    iterations: int,
    precision: Precision = np.float64,
    shift: float = SHIFT,
) -> WithIncomplete:
    """Return the iteration for a symmetric system; raises StepRejected where it is singular.

    K is read with ``precision`` in every iteration; ``shift`` is that of what is eliminated.
    """
    factor, matrix, bad = incomplete.factor(
        system.diagonal,
        system.couplings.known,
        system.couplings.coupled,
        system.pairs,
        system.rows,
        system.centroid,
        shift,
        np.empty(0, precision),
        np.empty(0, BREVITY[precision]),
    )
    if bad >= 0:
        raise StepRejected(StepOutcome.SINGULAR, f"equations of block {bad + 1}")
    none = NO_AGGREGATES[precision]
    return WithIncomplete(incomplete=factor, matrix=matrix, coarse=none, iterations=iterations)


def with_aggregates(
    system: BlockSystem,
    iterations: int,
    precision: Precision = np.float64,
    shift: float = SHIFT,
) -> WithIncomplete:
    """Return the same with a coarse system of aggregates added."""
    plain = with_incomplete(system, iterations, precision, shift)
    found, definite = coarse.factor(
        plain.incomplete, plain.matrix, aggregated.LAST.of(system).arrays
    )
    if not definite:
        raise StepRejected(StepOutcome.SINGULAR, "the matrix is not positive definite")
    return replace(plain, coarse=found)


class IteratedMatrix:
    """A symmetric system that is solved by iteration.

    Where that stalls another solver takes over, whom ``next_solver`` names from then on;
    ``iterated`` counts the iterations of both.
    """

    def __init__(
        self,
        system: BlockSystem,
        iteration: WithIncomplete,
        takes_over: LinearSolver,
        tolerance: float,
    ) -> None:
        self._system, self._iteration, self._takes_over = system, iteration, takes_over
        self.tolerance = tolerance
        self.next_solver: LinearSolver | None = None
        self._own = 0
        self._factor: Factor | None = None

    @property
    def by_rows(self) -> tuple[Any, ...]:
        """K as it is multiplied with: what block_rows.multiply takes before x."""
        return self._iteration.by_rows

    @property
    def iterated(self) -> int:
        """Iterations so far."""
        return self._own + int(getattr(self._factor, "iterated", 0))

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6)."""
        return self.nearer(force, None, self.tolerance)

    def nearer(self, force: Floats, guess: Floats | None, tolerance: float) -> Floats:
        """Return d (n, 6) whose residual is at most ``tolerance`` of that of ``guess`` (n, 6).

        None is a guess of zero.
        """
        if self._factor is None:
            displacement, iterations, left = self._iteration(force, guess, tolerance)
            self._own += iterations
            if left <= tolerance:
                return displacement
            self._factor = self._takes_over.factor(self._system)
        if not isinstance(self._factor, IteratedMatrix):
            self.next_solver = self._takes_over
            return self._factor.solve(force)
        displacement = self._factor.nearer(force, guess, tolerance)
        self.next_solver = self._factor.next_solver or self._takes_over
        return displacement


@dataclass(frozen=True)
class PCG:
    """Conjugate gradients for symmetric systems, preconditioned as strongly as they need.

    By an incomplete factorisation, and a coarse system of aggregates where inertia does not hold
    its own against the contacts.  Where that stalls a safer incomplete factorisation is made, and
    where that stalls, too, the system is factorised, as unsymmetric ones (friction solved inside
    the step) are.
    """

    tolerance: float = 1e-8
    """Reduction of the residual, in the norm of the preconditioner, that ends the iteration."""
    iterations: int = 400
    """Iterations with a coarse system at most, before a factorisation takes over."""
    plain: int = 100
    """Iterations without a coarse system at most, before one is added; 0: none."""

    def inexact(self, tolerance: float) -> PCG:
        """Return the same solver ending at ``tolerance``, if that is earlier."""
        return replace(self, tolerance=max(self.tolerance, tolerance))

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        if not system.symmetric:
            return Scipy().factor(system)
        share, least = inertia_shares(system)
        precision = precision_for(system, self.tolerance, least)
        if self.plain > 0 and suffices_alone(system, share, least):
            iteration = with_incomplete(system, self.plain, precision)
            return IteratedMatrix(system, iteration, replace(self, plain=0), self.tolerance)
        iteration = with_aggregates(system, self.iterations, precision, SHIFT)
        safer = Shifted(self.tolerance, self.iterations)
        return IteratedMatrix(system, iteration, safer, self.tolerance)


@dataclass(frozen=True)
class Shifted:
    """Conjugate gradients after others have stalled, with pivots kept away from being singular."""

    tolerance: float
    """Reduction of the residual that ends the iteration."""
    iterations: int
    """Iterations at most, as many as take as long as a factorisation."""

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        _, least = inertia_shares(system)
        precision = precision_for(system, self.tolerance, least)
        iteration = replace(
            with_aggregates(system, self.iterations, precision, SAFE_SHIFT),
            trial=max(TRIED, self.iterations // TENTH),
        )
        return IteratedMatrix(system, iteration, Direct(), self.tolerance)


TENTH = 10
"""One in so many iterations has been made before the last ones are judged: the first may gain
nothing, and what comes after them is a factorisation."""


def inertia_shares(system: BlockSystem) -> tuple[float, float]:
    """Return how much of the blocks' stiffness against translation is not that of contacts.

    A translation of all blocks together moves no contact between two of them, so that what is left
    of e.K e, e being all translations, is inertia, over the sum of the diagonal blocks' own.
    Blocks that are coupled to none, as fixed ones, do not count; 1 where all are such.  Second, the
    least such share of one block with its row of K, in the direction in which it is least.
    """
    return system.couplings.inertia_shares(system.diagonal, system.rows)


def is_chain(system: BlockSystem) -> bool:
    """Return whether there are fewer pairs than blocks: chains and trees for the most part."""
    return len(system.pairs) < len(system.diagonal)


def suffices_alone(system: BlockSystem, share: float, least: float) -> bool:
    """Return whether the incomplete factor alone takes few iterations: thirty at most.

    Of chains it is exact.  ``share`` and ``least`` are the :func:`inertia_shares` of the system.
    Springs to fixed blocks count as inertia there, so that a share may be large although most
    blocks have next to none; a small least one may be that of a single light block, and is of no
    account beside a large share.
    """
    return is_chain(system) or share > HEAVY or (share > SOFT and least > WEAK)


SOFT, HEAVY = 0.01, 0.1
"""Shares of inertia below which the incomplete factor does not suffice, and above which it does."""
WEAK = 5e-4
"""Least share of inertia of any block below which it does not suffice in between."""
ROUGH, LIGHT = 1e-5, 1e-6
"""Where the solution may be iterated in single precision, that is with a K rounded by 6e-8 of
itself: where the residual need not fall below ROUGH, and no block's share of inertia is below
LIGHT, so that rounding stays below a tenth of any inertia.  LIGHT is for Newton's directions; what
must be more accurate needs more inertia in proportion."""
DIRECTION = 1e-3
"""Accuracy of Newton's directions where they are found by iteration; the step's is unaffected.
LIGHT was measured with it (docs/decisions/0027)."""


def precision_for(system: BlockSystem, tolerance: float, least: float) -> Precision:
    """Return the precision of K for a solution to ``tolerance``, ``least`` being any's share.

    Of chains the incomplete factor is exact: one iteration then solves them to 1e-8, which ends
    Newton's in one as well.
    """
    enough = tolerance >= ROUGH and least * tolerance >= LIGHT * DIRECTION
    return np.float32 if enough and not is_chain(system) else np.float64


@dataclass(frozen=True)
class Automatic:
    """A factorisation for few blocks; for more PCG, as long as it is quicker than one."""

    few: int = 80
    """Up to this number of blocks all is done before an iteration would be worth while."""
    patience: float = 1.0
    """An iteration is given up after this share of the time that a factorisation takes."""
    tolerance: float = 1e-8
    """Reduction of the residual that ends an iteration."""

    def inexact(self, tolerance: float) -> Automatic:
        """Return the same solver with iterations ending at ``tolerance``, if that is earlier."""
        return replace(self, tolerance=max(self.tolerance, tolerance))

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        if len(system.diagonal) <= self.few or not system.symmetric:
            return Direct().factor(system)
        with_factor = self._limit(system, FACTOR_ITERATION)
        share, least = inertia_shares(system)
        if suffices_alone(system, share, least) and with_factor >= LEAST_ITERATIONS:
            precision = precision_for(system, self.tolerance, least)
            iteration = with_incomplete(system, with_factor, precision)
            return IteratedMatrix(system, iteration, self._stiff(system, least), self.tolerance)
        return self._stiff(system, least).factor(system)

    def _stiff(self, system: BlockSystem, least: float) -> LinearSolver:
        """Return the solver for a system with little inertia: PCG, if it can be quicker.

        ``least`` is the least share of inertia of any block.
        """
        limit = self._limit(system, COARSE_ITERATION)
        per_digit = COARSE_PER_DIGIT if least >= LIGHT else LIGHT_PER_DIGIT
        if limit < per_digit * -math.log10(self.tolerance):
            return Direct()
        return PCG(tolerance=self.tolerance, iterations=limit, plain=0)

    def _limit(self, system: BlockSystem, cost: float) -> int:
        """Return how many iterations of ``cost`` take as long as a factorisation."""
        count = len(system.diagonal)
        factorisation = self.patience * FACTOR_COST * count**FACTOR_POWER
        return int(min(factorisation / (cost * (count + len(system.pairs))), MOST_ITERATIONS))


FACTOR_COST, FACTOR_POWER = 3.1e-7, 1.6
"""Seconds that a factorisation of n blocks takes: cost n^power (walls and slopes, 60 to 3,000)."""
FACTOR_ITERATION, COARSE_ITERATION = 2.8e-8, 3.5e-8
"""Seconds that an iteration takes per block and per pair, without and with a coarse system."""
COARSE_PER_DIGIT = 3.0
"""Iterations with a coarse system that a decimal of the solution takes at least."""
LIGHT_PER_DIGIT = 50.0
"""The same where some block's share of inertia is below LIGHT: 100 to 140 for three decimals (walls
with p = 1,000 E), of which Newton's method makes less than of exact ones."""
LEAST_ITERATIONS, MOST_ITERATIONS = 20, 1000
"""Iterations without a coarse system that are worth a try, and limit of any iterations."""


def inexact(solver: LinearSolver, tolerance: float) -> LinearSolver:
    """Return the solver for systems within Newton's method: iterations may end at ``tolerance``."""
    return solver.inexact(tolerance) if isinstance(solver, PCG | Automatic) else solver


def solve(solver: LinearSolver, system: BlockSystem) -> Floats:
    """Return d (n, 6) of a block system with its own right-hand side."""
    return solver.factor(system).solve(system.force)
