"""Systems whose K_ji is not the transpose of K_ij (friction solved inside the step): SuperLU."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from clast.errors import StepOutcome, StepRejected
from clast.linear.pattern import Patterns
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

    def factor(self, system: BlockSystem, patterns: Patterns) -> SuperLUFactor:
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
