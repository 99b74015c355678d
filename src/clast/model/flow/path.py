"""The path to the zero of a function that is linear in pieces: it always ends.

From any x0 it is the line of points at which the same share of F(x0) is left in every component,

    F(x(t)) = (1 - t) F(x0),  0 <= t <= 1

(Katzenelson 1965; Fujisawa & Kuh 1972).  Within a piece it is straight, along Newton's direction.
All slopes of an M-function have positive determinants, so that it crosses each kink to the other
side and goes on with t.  A piece is convex and its slopes are regular: the points where F has one
of the values (1 - t) F(x0) are one segment of it, so the path comes to no piece twice; and pieces
are finite in number.  A kink is met alone from all x0 but those of a set of no measure, for which a
small shift of x0 is made.  As many linear systems are solved as pieces are crossed: few, where
Newton's method has left the balance of a few nodes, and it leaves no more where it does not end.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.model.arrays import Bools, Floats
from clast.model.flow.balance import GIVEN, SEEPAGE
from clast.model.flow.pieces import Piece, Problem, Water, piece_at, water_at
from clast.model.flow.slopes import Factor, factored, of_channels, of_node

SHIFT = 1e-3
"""Shift of the start against kinks that are met together, as a share of the error."""

CHANGES = 40
"""Kinks after which slopes are factored anew."""


def followed(problem: Problem, x: Floats, error: float, most: int) -> tuple[Floats, int]:
    """Return where the path from x (m,), Pa, is after ``most`` pieces or ends, and their number.

    ``error`` is that of the balance, as a share of the flow.
    """
    random = np.random.default_rng(0)
    x = x + SHIFT * min(error, 1.0) * problem.scale * (random.random(len(x)) - 0.5)
    x[problem.balance.kind == GIVEN] = 0.0
    start, piece, factor = x, piece_at(problem, x), None
    for crossed in range(most):
        water = water_at(problem, piece, x)
        if factor is None or len(factor.changes) == CHANGES:
            factor = factored(problem, piece)
        along = -factor(water.left + problem.hold * problem.around * (x - start))
        share, kink = _first(problem, piece, water, x, along)
        x = x + share * along
        if kink is None:
            return x, crossed + 1
        before, piece = piece, _other_side(problem, piece, kink, water, x)
        factor = _changed(problem, factor, kink, before, piece)
    return x, most


def _changed(
    problem: Problem, factor: Factor, kink: tuple[str, int], before: Piece, after: Piece
) -> Factor | None:
    """Return the factor of the slopes after a kink; None where digits would be lost."""
    balance = problem.balance
    name, one = kink
    if name != "runs":
        column = of_node(problem, after, one) - of_node(problem, before, one)
        return factor.changed(column, np.array([one]), np.ones(1))
    at = np.array([balance.upper[one], balance.lower[one]])
    column = np.zeros(len(before.wet))
    column[at] = 1.0, -1.0
    which = np.array([one])
    was, now = of_channels(problem, before, which), of_channels(problem, after, which)
    row = np.concatenate([now[0] - was[0], was[1] - now[1]])
    return factor.changed(column, at, row)


def _first(
    problem: Problem, piece: Piece, water: Water, x: Floats, along: Floats
) -> tuple[float, tuple[str, int] | None]:
    """Return the share of a way (m,), Pa, up to the first kink, and that kink."""
    balance = problem.balance
    kind, drop, upper, lower = balance.kind, balance.drop, balance.upper, balance.lower
    free = (kind != GIVEN) & (not balance.confined)
    pressure_of = np.where(piece.wet & ~piece.above & (kind != GIVEN), along, 0.0)
    dry = ~piece.wet[upper] & (drop > 0.0)
    lack = np.where(piece.wet, 0.0, -x / problem.scale)[upper] * drop - water.pressure[lower]
    lack_of = np.where(piece.wet, 0.0, -along / problem.scale)[upper] * drop - pressure_of[lower]
    first, kink = 1.0, None
    for name, high, value, by, where in (
        ("wet", piece.wet, x, along, free),
        ("above", piece.above, x - balance.pressure, along, kind == SEEPAGE),
        ("runs", piece.runs, lack, lack_of, dry),
    ):
        share = _shares(high, value, by, where)
        one = int(share.argmin()) if len(share) else -1
        if one >= 0 and share[one] < first:
            first, kink = float(share[one]), (name, one)
    return first, kink


def _shares(high: Bools, value: Floats, by: Floats, where: Bools) -> Floats:
    """Return the share of a way at which each value is 0, from above where ``high``; inf: none."""
    toward = where & np.where(high, by < 0.0, by > 0.0)
    share = np.full(len(value), np.inf)
    share[toward] = np.maximum(-value[toward] / by[toward], 0.0)
    return share


def _other_side(
    problem: Problem, piece: Piece, kink: tuple[str, int], water: Water, x: Floats
) -> Piece:
    """Return the piece on the other side of a kink, and put x (m,), Pa, on the kink."""
    balance = problem.balance
    name, one = kink
    if name == "above":
        above = piece.above.copy()
        above[one] = not above[one]
        x[one] = balance.pressure[one]
        return replace(piece, above=above)
    runs = piece.runs.copy()
    if name == "runs":
        runs[one] = not runs[one]
        return replace(piece, runs=runs, pushes=~runs)
    wet = piece.wet.copy()
    wet[one] = not wet[one]
    x[one] = 0.0
    below = (balance.upper == one) & (balance.drop > 0.0)
    # of a node that has just run dry: where nothing stands
    runs[below] = ~wet[one] & (water.pressure[balance.lower[below]] <= 0.0)
    return replace(piece, wet=wet, runs=runs, pushes=~runs)
