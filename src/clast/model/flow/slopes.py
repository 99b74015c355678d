"""Slopes of the balance of water in a piece, factored.

They are an M-matrix: beside a positive diagonal nothing is positive, and no column has a negative
sum.  Elimination needs no pivots then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.model.arrays import Floats, Ints
from clast.model.flow.pieces import Piece, Problem

PIVOT = 1e-10
"""Least and, upside down, largest share by which a change may alter the determinant of a factor."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Change:
    """A change of the slopes by the product of a column and a row."""

    way: Floats
    """Changes of unknowns due to the column by the slopes before the change, shape (m,)."""
    at: Ints
    """Nodes where the row is not 0, shape (r,)."""
    row: Floats
    """The row there, shape (r,)."""
    pivot: float
    """Factor by which the determinant grows."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Factor:
    """The factored slopes of a piece, or of one that it came to by changes."""

    solve: Callable[[Floats], Floats]
    """Return the changes of unknowns that raise net outflows of nodes by so much, (m,) each."""
    changes: tuple[Change, ...] = ()

    def __call__(self, left: Floats) -> Floats:
        """Return the changes of unknowns, Pa, that raise net outflows by ``left``, (m,)."""
        x = self.solve(left)
        for one in self.changes:
            x = x - one.way * ((one.row @ x[one.at]) / one.pivot)
        return x

    def changed(self, column: Floats, at: Ints, row: Floats) -> Factor | None:
        """Return the factor of slopes to which a column (m,) times a row is added.

        None where digits would be lost (Sherman & Morrison 1950).
        """
        way = self(column)
        pivot = 1.0 + float(row @ way[at])
        if not PIVOT < pivot < 1.0 / PIVOT:
            return None
        change = Change(way=way, at=at, row=row, pivot=pivot)
        return replace(self, changes=(*self.changes, change))


def factored(problem: Problem, piece: Piece) -> Factor:
    """Return the factored slopes of a piece."""
    from scipy.sparse.linalg import splu  # slow to load, and few cases need it

    free, count = problem.free, len(piece.wet)
    if not len(free):
        return Factor(solve=np.zeros_like)
    factor = splu(
        slopes(problem, piece),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )

    def solve(left: Floats) -> Floats:
        x = np.zeros(count)
        x[free] = factor.solve(left[free])
        return x

    return Factor(solve=solve)


def slopes(problem: Problem, piece: Piece) -> Any:
    """Return how F at free nodes grows with their unknowns in a piece, sparse, (n, n)."""
    from scipy.sparse import coo_array

    balance, count, free = problem.balance, len(piece.wet), problem.free
    upper, lower, every = balance.upper, balance.lower, np.arange(count)
    by_upper, by_lower = of_channels(problem, piece, np.arange(len(upper)))
    own = (
        np.bincount(upper, by_upper, count)
        + np.bincount(lower, by_lower, count)
        + of_nodes(problem, piece, every)
    )
    value = np.concatenate([-by_lower, -by_upper, own])
    place = np.concatenate([upper, lower, every]), np.concatenate([lower, upper, every])
    matrix = coo_array((value, place), shape=(count, count)).tocsc()
    return matrix if len(free) == count else matrix[:, free][free]


def of_channels(problem: Problem, piece: Piece, which: Ints) -> tuple[Floats, Floats]:
    """Return how flows of channels (r,) grow with x of the upper node, and fall with the lower's.

    In m2/(s Pa), shape (r,) each.
    """
    balance = problem.balance
    upper, lower = balance.upper[which], balance.lower[which]
    pressed = piece.wet & ~piece.above
    running = np.where(piece.runs[which] & ~piece.wet[upper], balance.drop[which], 0.0)
    by_upper = np.where(pressed[upper], 1.0, running / problem.scale)
    by_lower = np.where(piece.pushes[which] & pressed[lower], 1.0, 0.0)
    return balance.conductance[which] * by_upper, balance.conductance[which] * by_lower


def of_nodes(problem: Problem, piece: Piece, which: Ints) -> Floats:
    """Return how storage, pumping and outflow of nodes (r,) grow with their x, m2/(s Pa), (r,)."""
    balance = problem.balance
    wet, above = piece.wet[which], piece.above[which]
    volume = problem.rate * balance.volume[which]
    by_saturation = volume + np.maximum(-balance.inflow[which], 0.0)
    dry = by_saturation / problem.scale
    full = np.where(above, problem.around[which], volume / balance.bulk_modulus)
    return np.where(wet, full, dry) + problem.hold * problem.around[which]


def of_node(problem: Problem, piece: Piece, node: int) -> Floats:
    """Return how F grows with x of one node in a piece, m2/(s Pa), shape (m,)."""
    balance = problem.balance
    down, up = np.flatnonzero(balance.upper == node), np.flatnonzero(balance.lower == node)
    by_node = of_channels(problem, piece, down)[0], of_channels(problem, piece, up)[1]
    column = np.zeros(len(piece.wet))
    np.subtract.at(column, balance.lower[down], by_node[0])
    np.subtract.at(column, balance.upper[up], by_node[1])
    column[node] = by_node[0].sum() + by_node[1].sum()
    column[node] += of_nodes(problem, piece, np.array([node]))[0]
    return column
