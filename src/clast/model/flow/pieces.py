"""The balance of water as a function that is linear in pieces.

One unknown x at a node holds its pressure and its saturation: p = max(x, 0), s = 1 + min(x, 0)/P,
with one P for all, the weight of the highest column of a channel.  At SEEPAGE nodes p ends at the
pressure there, and x above it stands for the outflow.  The net outflow of the nodes, F(x), storage
included, is linear where no node changes between dry, wet and giving off, and no channel between
running and standing full:

    running   q = C (p_u + s_u G), of which l knows nothing;
    full      q = C (p_u + G - p_l), of which u knows nothing while it is dry.

F is an M-function: the x of a node raises its own net outflow, and lowers those of its neighbours
by no more in sum.  So with storage it has one zero, and slopes of positive determinant everywhere
(``slopes.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clast.model.arrays import Bools, Floats
from clast.model.flow.balance import GIVEN, SEEPAGE, Balance

HOLD = 1e-14
"""Slope by which each node is held, as a share of the conductance around it: without storage its
balance may depend on no unknown, as that of a dry node above standing columns."""
ROUNDING = 1 * float(np.finfo(np.float64).eps)
"""By how much a sum of flows may differ from none, as a share of its terms."""
TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, kw_only=True, repr=False)
class Problem:
    """A balance with the water stored at the beginning of the step."""

    balance: Balance
    pressure: Floats
    """Pressure at the beginning, Pa, shape (m,)."""
    saturation: Floats
    """Saturation at the beginning, shape (m,)."""
    rate: float
    """One by the step, 1/s; 0: steady."""
    hold: float = HOLD
    """Slope by which nodes are held, as a share of the conductance around them."""

    @cached_property
    def scale(self) -> float:
        """Return P, which x of an empty node lies below 0, Pa."""
        return max(float(self.balance.drop.max(initial=0.0)), 1.0)

    @cached_property
    def around(self) -> Floats:
        """Return the conductance of the channels at each node, m2/(s Pa), above 0, shape (m,)."""
        balance = self.balance
        both = np.repeat(balance.conductance, 2)
        sums = np.bincount(balance.node.ravel(), both, len(balance.kind))
        return np.where(sums > 0.0, sums, max(float(sums.max(initial=0.0)), TINY))

    @cached_property
    def free(self) -> Any:
        """Return the nodes whose pressure is not given, shape (n,)."""
        return np.flatnonzero(self.balance.free)


@dataclass(frozen=True, kw_only=True, repr=False)
class Piece:
    """Where F is linear."""

    wet: Bools
    """Nodes that are full: s = 1, shape (m,)."""
    above: Bools
    """SEEPAGE nodes that may give water off, shape (m,)."""
    runs: Bools
    """Channels whose flow depends on the saturation of their upper node, shape (k,)."""
    pushes: Bools
    """Channels whose flow depends on the pressure of their lower node, shape (k,)."""

    @property
    def key(self) -> bytes:
        """Return a key that tells it from other pieces."""
        return b"".join(np.packbits(part).tobytes() for part in self.__dict__.values())


@dataclass(frozen=True, kw_only=True, repr=False)
class Water:
    """Pressures, saturations and flows for given unknowns."""

    pressure: Floats
    """Pressure at nodes, Pa, shape (m,)."""
    saturation: Floats
    """Saturation of nodes, shape (m,)."""
    outflow: Floats
    """Outflow R of SEEPAGE nodes, m2/s, shape (m,)."""
    flow: Floats
    """Flow of channels from upper to lower node, m2/s, shape (k,)."""
    stored: Floats
    """Rate of storage of nodes, m2/s, shape (m,)."""
    missing: Floats
    """Unmet demand of pumps, m2/s, shape (m,)."""
    left: Floats
    """Net outflow of nodes, storage included, F, m2/s, shape (m,)."""
    terms: Floats
    """Size of the terms of F before they cancel, m2/s, shape (m,)."""


def piece_at(problem: Problem, x: Floats) -> Piece:
    """Return the piece that unknowns (m,), Pa, lie in: on the wetter side of a kink."""
    balance = problem.balance
    given = balance.kind == GIVEN
    wet = given | (x >= 0.0) | balance.confined
    above = (balance.kind == SEEPAGE) & (x >= balance.pressure)
    pressure = np.where(given | above, balance.pressure, np.maximum(x, 0.0))
    lacking = (-x / problem.scale)[balance.upper] * balance.drop
    runs = ~wet[balance.upper] & (lacking > pressure[balance.lower])
    return Piece(wet=wet, above=above, runs=runs, pushes=~runs)


def upwind_at(problem: Problem, x: Floats) -> Piece:
    """Return the piece of the law q = C (p_u - p_l + s_u G), which is easier to solve.

    It has no kinks but those of nodes; water at rest is not at rest by it.  Good to start from.
    """
    every = np.ones(len(problem.balance.node), np.bool_)
    at = piece_at(problem, x)
    return Piece(wet=at.wet, above=at.above, runs=every, pushes=every)


def water_at(problem: Problem, piece: Piece, x: Floats) -> Water:
    """Return pressures and flows for unknowns (m,), Pa, by the linear function of a piece."""
    balance, rate, count = problem.balance, problem.rate, len(x)
    pressure = np.where(piece.wet, x, 0.0)
    pressure = np.where((balance.kind == GIVEN) | piece.above, balance.pressure, pressure)
    saturation = np.where(piece.wet, 1.0, 1.0 + x / problem.scale)
    over, under = pressure[balance.upper], pressure[balance.lower]
    falling = np.where(piece.runs, saturation[balance.upper], 1.0) * balance.drop
    flow = balance.conductance * (falling + (over - np.where(piece.pushes, under, 0.0)))
    outflow = np.where(piece.above, problem.around * (x - balance.pressure), 0.0)
    elastic = balance.volume / balance.bulk_modulus
    stored = rate * (
        balance.volume * (saturation - problem.saturation)
        + elastic * (pressure - problem.pressure)
        + balance.opened * problem.saturation
    )
    missing = np.maximum(-balance.inflow, 0.0) * (1.0 - saturation)
    out = np.bincount(balance.upper, flow, count) - np.bincount(balance.lower, flow, count)
    size = balance.conductance * (np.abs(over) + np.abs(under) + balance.drop)
    around = np.bincount(balance.node.ravel(), np.repeat(size, 2), count)
    terms = around + rate * (balance.volume + elastic * np.abs(pressure)) + np.abs(balance.inflow)
    return Water(
        pressure=pressure,
        saturation=saturation,
        outflow=outflow,
        flow=flow,
        stored=stored,
        missing=missing,
        left=out + stored + outflow - balance.inflow - missing,
        terms=terms + outflow,
    )


def error_of(problem: Problem, water: Water) -> float:
    """Return the largest error of the balance of a free node, as a share of the flow."""
    flows = np.abs(water.flow).max(initial=0.0), np.abs(problem.balance.inflow).max(initial=0.0)
    size = max(*flows, 1e-3 * water.terms.max(initial=0.0), TINY)
    return float(np.abs(water.left[problem.free]).max(initial=0.0) / size)
