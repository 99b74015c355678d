"""Solvers of the block system."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

from clast.equations.system import BlockSystem
from clast.errors import StepOutcome, StepRejected
from clast.interfaces import Factor, LinearSolver
from clast.kernels import pcg
from clast.model import Floats, Ints


def _block_pattern(system: BlockSystem) -> tuple[Ints, Ints, Floats]:
    """Return row, column and 6 x 6 values of all non-zero blocks."""
    own = np.arange(len(system.diagonal))
    low, high = system.pairs[:, 0], system.pairs[:, 1]
    rows = np.concatenate([own, low, high])
    columns = np.concatenate([own, high, low])
    return rows, columns, np.concatenate([system.diagonal, system.upper, system.lower])


def sparse_matrix(system: BlockSystem) -> csc_array:
    """Return K as a scipy matrix (6n, 6n) in compressed columns."""
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
class PCGMatrix:
    """A symmetric system with the inverses of its diagonal blocks."""

    system: BlockSystem
    """The system."""
    inverse: Floats
    """Inverses of the diagonal blocks, shape (n, 6, 6)."""
    tolerance: float
    """Reduction of the residual that ends the iteration."""
    iterations: int
    """Iterations at most."""

    def solve(self, force: Floats) -> Floats:
        """Return d (n, 6) for F (n, 6); falls back on SuperLU where the iteration stalls."""
        system = self.system
        displacement, _, reduction = pcg.solve(
            system.diagonal,
            self.inverse,
            system.pairs,
            system.upper,
            force,
            self.tolerance,
            self.iterations,
        )
        if not reduction <= self.tolerance:
            return Scipy().factor(system).solve(force)
        return displacement


@dataclass(frozen=True)
class PCG:
    """Conjugate gradients with block-Jacobi preconditioning; symmetric systems.

    Unsymmetric systems (friction solved inside the step) and those on which it stalls go to
    SuperLU.
    """

    tolerance: float = 1e-8
    """Reduction of the residual, in the norm of the preconditioner, that ends the iteration."""
    iterations: int = 400
    """Iterations at most before SuperLU takes over."""

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        if not np.array_equal(system.lower, system.upper.transpose(0, 2, 1)):
            return Scipy().factor(system)
        inverse, bad = pcg.inverse_blocks(system.diagonal)
        if bad >= 0:
            raise StepRejected(StepOutcome.SINGULAR, f"equations of block {bad + 1}")
        return PCGMatrix(system, inverse, self.tolerance, self.iterations)


@dataclass(frozen=True)
class Automatic:
    """SuperLU for a few blocks, PCG for many."""

    few: int = 60
    """Up to this number of blocks a factorisation is quicker than starting an iteration."""

    def factor(self, system: BlockSystem) -> Factor:
        """Return the matrix made ready; raises StepRejected where it is singular."""
        solver = Scipy() if len(system.diagonal) <= self.few else PCG()
        return solver.factor(system)


def solve(solver: LinearSolver, system: BlockSystem) -> Floats:
    """Return d (n, 6) of a block system with its own right-hand side."""
    return solver.factor(system).solve(system.force)
