"""The levels of larger blocks by which the iterative solver is preconditioned."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.equations.couplings import Precision, Rows
from clast.equations.system import BlockSystem, inverse_of_blocks
from clast.errors import StepOutcome, StepRejected
from clast.kernels import aggregates, block_rows, conjugate, dense
from clast.kernels.multilevel import LEVELS
from clast.model import Floats, Ints

COARSEST = 32
"""A level of no more blocks than this is inverted in full."""
STALLED = 0.8
"""Blocks that aggregates may leave, as a share, for another level to be worth it."""


@dataclass(frozen=True, kw_only=True)
class Level:
    """A block system by rows, and the aggregates that its blocks form; in the kernels' order."""

    diagonal: Any
    """K_ii, shape (n, 6, 6), in the precision of the cycle as all blocks."""
    inverse: Any
    """Inverses of the diagonal blocks, shape (n, 6, 6)."""
    upper: Any
    """K_ij, shape (q, 6, 6)."""
    pairs: Ints
    """Coupled blocks (i, j), i < j, sorted, shape (q, 2)."""
    right: Ints
    """First pair (i, .) of each row, shape (n + 1,)."""
    left: Ints
    """First of ``listed`` of each row, shape (n + 1,)."""
    listed: Ints
    """Pairs (., i), row by row, shape (q,)."""
    parent: Ints
    """Aggregate of each block, -1 for none, shape (n,)."""
    start: Ints
    """First of each aggregate's ``members``, shape (number of aggregates + 1,)."""
    members: Ints
    """Blocks of the aggregates."""
    offset: Floats
    """Centroid of each block less the centre of its aggregate, m, shape (n, 2)."""


@dataclass(frozen=True, kw_only=True)
class Levels:
    """All levels, the finest first, as the kernels take them."""

    matrix: tuple[Any, ...]
    """K itself: diagonal, upper, pairs, right, left, listed."""
    levels: tuple[tuple[Any, ...], ...]
    """For each field of Level the arrays of all levels, filled up to LEVELS."""
    last: int
    """Index of the coarsest level."""
    inverse: Floats
    """Its inverse in full, or nothing where it is too large for one."""
    work: tuple[tuple[Floats, ...], ...]
    """Eight vectors per level, in the precision of the cycle."""


WORK = 8
"""Arrays that a cycle needs on each level."""


def levels_of(
    system: BlockSystem, cycle: Precision = np.float64, product: Precision = np.float64
) -> Levels:
    """Return the levels of a symmetric system; raises StepRejected where it is singular.

    The cycle and the product with K itself have these precisions, the product that of the cycle or
    a better one.
    """
    found: list[Level] = []
    diagonal, upper = system.diagonal, system.couplings.in_precision(cycle)
    pairs = system.pairs
    rows, centroid = system.rows, system.centroid
    while True:
        level, centre = _level(diagonal, upper, pairs, rows, centroid)
        found.append(level)
        count, aggregated = len(diagonal), len(level.start) - 1
        if len(found) == LEVELS or aggregated == 0:
            break
        if count <= COARSEST or aggregated > STALLED * count:
            break
        coarse = aggregates.coarse_pairs(
            pairs, level.right, level.left, level.listed, level.parent, level.start, level.members
        )
        diagonal, upper = aggregates.coarse_matrix(
            diagonal,
            upper,
            pairs,
            level.right,
            level.left,
            level.listed,
            level.parent,
            level.start,
            level.members,
            level.offset,
            coarse,
        )
        pairs, centroid = coarse, centre
        rows = block_rows.row_pointers(len(diagonal), pairs)
    inverse = np.zeros((0, 0))
    if len(diagonal) <= COARSEST:
        inverse, definite = dense.invert_blocks(diagonal, pairs, upper)
        if not definite:
            raise StepRejected(StepOutcome.SINGULAR, "the matrix is not positive definite")
    filled = [_in_precision(cycle, one) for one in [*found, *[_EMPTY] * (LEVELS - len(found))]]
    return Levels(
        matrix=_matrix(filled[0]) if product is cycle else _whole(system),
        levels=tuple(tuple(column) for column in zip(*map(_fields, filled), strict=True)),
        last=len(found) - 1,
        inverse=inverse,
        work=tuple(
            tuple(conjugate.vector(len(one.diagonal), one.diagonal) for one in filled)
            for _ in range(WORK)
        ),
    )


def _in_precision(cycle: Precision, level: Level) -> Level:
    """Return the level with its blocks in the precision of the cycle, and the pairs that go by it.

    Short integers go with single precision: they are read as often as the blocks.
    """
    whole = np.int32 if cycle is np.float32 else np.int64
    of_blocks = {name: getattr(level, name).astype(cycle, copy=False) for name in _BLOCKS}
    of_pairs = {name: getattr(level, name).astype(whole, copy=False) for name in _PAIRS}
    return replace(level, **of_blocks, **of_pairs)


def _whole(system: BlockSystem) -> tuple[Any, ...]:
    """Return what block_rows.multiply takes of a system, in double precision."""
    return (system.diagonal, system.upper, system.pairs, *system.rows)


def _matrix(level: Level) -> tuple[Any, ...]:
    """Return what block_rows.multiply takes of a level."""
    return (level.diagonal, level.upper, *(getattr(level, name) for name in _PAIRS))


_BLOCKS, _PAIRS = ("diagonal", "inverse", "upper"), ("pairs", "right", "left", "listed")


def _fields(level: Level) -> tuple[Any, ...]:
    return tuple(vars(level).values())


def _level(
    diagonal: Floats, upper: Floats, pairs: Ints, rows: Rows, centroid: Floats
) -> tuple[Level, Floats]:
    """Return a level and the centres (N, 2) of its aggregates, m."""
    inverse = inverse_of_blocks(diagonal)
    right, left, listed = rows
    strong = aggregates.strong_pairs(diagonal, pairs, upper)
    parent, number = aggregates.aggregate(len(diagonal), pairs, right, left, listed, strong)
    start, members = aggregates.members_of(parent, number)
    centre, offset = aggregates.centres(start, members, centroid)
    level = Level(
        diagonal=diagonal,
        inverse=inverse,
        upper=upper,
        pairs=pairs,
        right=right,
        left=left,
        listed=listed,
        parent=parent,
        start=start,
        members=members,
        offset=offset,
    )
    return level, centre


_EMPTY = Level(
    diagonal=np.zeros((0, 6, 6)),
    inverse=np.zeros((0, 6, 6)),
    upper=np.zeros((0, 6, 6)),
    pairs=np.zeros((0, 2), np.int64),
    right=np.zeros(1, np.int64),
    left=np.zeros(1, np.int64),
    listed=np.zeros(0, np.int64),
    parent=np.zeros(0, np.int64),
    start=np.zeros(1, np.int64),
    members=np.zeros(0, np.int64),
    offset=np.zeros((0, 2)),
)
"""What stands for levels that are not there."""
