"""Solvers of the block system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from clast.equations.cholesky import Cholesky
from clast.equations.multilevel import Levels, levels_of
from clast.equations.system import BlockSystem
from clast.errors import StepOutcome, StepRejected
from clast.interfaces import Factor, LinearSolver
from clast.kernels import multilevel
from clast.model import Floats, Ints

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


class PCGMatrix:
    """A symmetric system with the levels that precondition it.

    Once an iteration has stalled the matrix is factorised after all, and ``next_solver`` says by
    whom; ``iterated`` counts iterations.
    """

    def __init__(
        self, system: BlockSystem, levels: Levels, tolerance: float, iterations: int
    ) -> None:
        self.system = system
        self.levels = levels
        self.tolerance = tolerance
        self.iterations = iterations
        self.iterated = 0
        self.next_solver: LinearSolver | None = None
        self._factor: Factor | None = None

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); by a factorisation where the iteration stalls."""
        if self._factor is not None:
            return self._factor.solve(force)
        displacement, iterations, reduction = multilevel.solve(
            self.levels.levels,
            self.levels.last,
            self.levels.factor,
            self.levels.work,
            force,
            self.tolerance,
            self.iterations,
        )
        self.iterated += iterations
        if not reduction <= self.tolerance:
            self.next_solver = Direct()
            self._factor = self.next_solver.factor(self.system)
            return self._factor.solve(force)
        return displacement


@dataclass(frozen=True)
class PCG:
    """Conjugate gradients with a cycle over levels of larger blocks; symmetric systems.

    Unsymmetric systems (friction solved inside the step) and those on which it stalls are
    factorised.
    """

    tolerance: float = 1e-8
    """Reduction of the residual, in the norm of the preconditioner, that ends the iteration."""
    iterations: int = 400
    """Iterations at most before a factorisation takes over."""

    def inexact(self, tolerance: float) -> PCG:
        """Return the same solver ending at ``tolerance``, if that is earlier."""
        return replace(self, tolerance=max(self.tolerance, tolerance))

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        if not system.symmetric:
            return Scipy().factor(system)
        return PCGMatrix(system, levels_of(system), self.tolerance, self.iterations)


@dataclass(frozen=True)
class Automatic:
    """A factorisation for few blocks; for many PCG, as long as it is quicker than one."""

    few: int = 300
    """Up to this number of blocks a factorisation is quicker than starting an iteration."""
    patience: float = 1.0
    """An iteration is given up after this share of the time that a factorisation takes."""
    tolerance: float = 1e-8
    """Reduction of the residual that ends an iteration."""

    def inexact(self, tolerance: float) -> Automatic:
        """Return the same solver with iterations ending at ``tolerance``, if that is earlier."""
        return replace(self, tolerance=max(self.tolerance, tolerance))

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        count = len(system.diagonal)
        if count <= self.few or not system.symmetric:
            return Direct().factor(system)
        one = ITERATION_COST * (count + len(system.pairs))
        limit = self.patience * FACTOR_COST * count**FACTOR_POWER / one
        most = int(np.clip(limit, LEAST_ITERATIONS, MOST_ITERATIONS))
        return PCG(tolerance=self.tolerance, iterations=most).factor(system)


FACTOR_COST, FACTOR_POWER = 3.1e-7, 1.6
"""Seconds that a factorisation of n blocks takes: cost n^power (walls of 100 to 10,000 bricks)."""
ITERATION_COST = 2e-7
"""Seconds that an iteration takes per block and per pair of blocks."""
LEAST_ITERATIONS, MOST_ITERATIONS = 30, 1000
"""Limits of the iterations tried before a factorisation."""


def inexact(solver: LinearSolver, tolerance: float) -> LinearSolver:
    """Return the solver for systems within Newton's method: iterations may end at ``tolerance``."""
    return solver.inexact(tolerance) if isinstance(solver, PCG | Automatic) else solver


def solve(solver: LinearSolver, system: BlockSystem) -> Floats:
    """Return d (n, 6) of a block system with its own right-hand side."""
    return solver.factor(system).solve(system.force)
