"""Steady flow in a network of channels, and a step of transient flow by backward Euler.

One unknown x at a node holds its pressure and its saturation: p = max(x, 0), s = 1 + min(x, 0)/P,
with P the weight of the highest column below the node.  At SEEPAGE nodes p ends at the pressure
there, and x above it stands for the outflow.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.errors import ClastError
from clast.model.arrays import Floats
from clast.model.flow.balance import GIVEN, SEEPAGE, Balance, Solved

MOST = 400
"""Most linear systems of a solution."""


class NoFlow(ClastError):
    """A flow of water that was not found."""


@dataclass(frozen=True, kw_only=True)
class _Nodes:
    """Pressure, saturation and outflow of nodes by their unknowns, and slopes, (m,) each."""

    pressure: Floats
    saturation: Floats
    outflow: Floats
    by_pressure: Floats
    by_saturation: Floats
    by_outflow: Floats


@dataclass(frozen=True, kw_only=True)
class _Problem:
    """A balance with what was stored before."""

    balance: Balance
    scale: Floats
    """Pressure P at which a node is empty, below 0, shape (m,)."""
    leak: Floats
    """Outflow of SEEPAGE nodes by x above their pressure, m2/(s Pa), shape (m,)."""
    before: tuple[Floats, Floats]
    """Pressure and saturation at the beginning of the step, (m,) each."""
    rate: float
    """One by the step, 1/s; 0: steady."""


def steady(balance: Balance, start: Floats | None = None) -> Solved:
    """Return the steady flow of a balance, from dry joints, or from pressures (m,), Pa."""
    count = len(balance.kind)
    before = (np.zeros(count), np.zeros(count))
    problem = _posed(balance, before, 0.0)
    first = -problem.scale if start is None else np.where(start > 0.0, start, -problem.scale)
    return _solved(problem, np.zeros(count) if balance.confined else first)


def advanced(balance: Balance, before: Solved, step: float) -> Solved:
    """Return the flow at the end of a step, s, by backward Euler from the state ``before``."""
    pressure, saturation = before.pressure, before.saturation
    problem = _posed(balance, (pressure, saturation), 1.0 / step)
    dry = (saturation < 1.0) & (not balance.confined)
    return _solved(problem, np.where(dry, (saturation - 1.0) * problem.scale, pressure))


def _posed(balance: Balance, before: tuple[Floats, Floats], rate: float) -> _Problem:
    """Return a balance with what its unknowns are measured by."""
    count = len(balance.kind)
    scale = np.full(count, max(float(balance.drop.max(initial=0.0)), 1.0))
    leak: Floats = np.asarray(
        np.bincount(balance.node.ravel(), np.repeat(balance.conductance, 2), count), np.float64
    )
    return _Problem(balance=balance, scale=scale, leak=leak, before=before, rate=rate)


def _nodes(problem: _Problem, x: Floats) -> _Nodes:
    """Return the state of nodes for their unknowns, Pa, shape (m,)."""
    balance = problem.balance
    given, seeps = balance.kind == GIVEN, balance.kind == SEEPAGE
    above = seeps & (x >= balance.pressure)
    if balance.confined:
        pressure, saturation, wet = x, np.ones_like(x), np.ones(len(x), np.bool_)
    else:
        pressure, saturation = np.maximum(x, 0.0), 1.0 + np.minimum(x, 0.0) / problem.scale
        wet = x >= 0.0
    return _Nodes(
        pressure=np.where(given | above, balance.pressure, pressure),
        saturation=np.where(given, 1.0, saturation),
        outflow=np.where(above, problem.leak * (x - balance.pressure), 0.0),
        by_pressure=(wet & ~given & ~above).astype(np.float64),
        by_saturation=np.where(wet | given, 0.0, 1.0 / problem.scale),
        by_outflow=np.where(above, problem.leak, 0.0),
    )


def _flows(balance: Balance, nodes: _Nodes) -> tuple[Floats, Floats, Floats]:
    """Return the flow of channels from upper to lower node, and its slopes by x of both, (k,)."""
    upper, lower, drop, conductance = (
        balance.upper,
        balance.lower,
        balance.drop,
        balance.conductance,
    )
    over, under = nodes.pressure[upper], nodes.pressure[lower]
    running = nodes.saturation[upper] * drop
    standing = drop - under
    runs = (running < standing) & (not balance.confined)
    flow = conductance * (over + np.where(runs, running, standing))
    by_upper = nodes.by_pressure[upper] + np.where(runs, drop * nodes.by_saturation[upper], 0.0)
    by_lower = np.where(runs, 0.0, -nodes.by_pressure[lower])
    return flow, conductance * by_upper, conductance * by_lower


def _left(problem: _Problem, nodes: _Nodes, flow: Floats) -> tuple[Floats, Floats, Floats]:
    """Return what leaves each node, what it stores and what its pump lacks, m2/s, (m,) each."""
    balance, count = problem.balance, len(nodes.pressure)
    pressure, saturation = problem.before
    stored = problem.rate * (
        balance.volume * (nodes.saturation - saturation)
        + balance.volume / balance.bulk_modulus * (nodes.pressure - pressure)
        + balance.opened * saturation
    )
    missing = np.maximum(-balance.inflow, 0.0) * (1.0 - nodes.saturation)
    out = np.bincount(balance.upper, flow, count) - np.bincount(balance.lower, flow, count)
    return out + stored + nodes.outflow - balance.inflow - missing, stored, missing


def _slopes(problem: _Problem, nodes: _Nodes, by_upper: Floats, by_lower: Floats) -> Any:
    """Return how what leaves each node grows with x of each, m2/(s Pa), sparse, (m, m)."""
    from scipy.sparse import coo_array

    balance, count = problem.balance, len(nodes.pressure)
    upper, lower, every = balance.upper, balance.lower, np.arange(count)
    volume = problem.rate * balance.volume
    own = (
        np.bincount(upper, by_upper, count)
        - np.bincount(lower, by_lower, count)
        + nodes.by_outflow
        + (volume + np.maximum(-balance.inflow, 0.0)) * nodes.by_saturation
        + volume / balance.bulk_modulus * nodes.by_pressure
    )
    value = np.concatenate([by_lower, -by_upper, own])
    row = np.concatenate([upper, lower, every])
    column = np.concatenate([lower, upper, every])
    return coo_array((value, (row, column)), shape=(count, count)).tocsr()


def _solved(problem: _Problem, x: Floats) -> Solved:
    """Return the flow found by Newton's method from unknowns (m,), Pa."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import splu

    balance = problem.balance
    free = np.flatnonzero(balance.free)
    for iterations in range(MOST):
        nodes = _nodes(problem, x)
        flow, by_upper, by_lower = _flows(balance, nodes)
        left = _left(problem, nodes, flow)[0]
        size = _throughput(problem, nodes, flow)
        if np.abs(left[free]).max(initial=0.0) <= 1e-13 * size:
            return _result(problem, nodes, flow, iterations)
        slopes = _slopes(problem, nodes, by_upper, by_lower)[free][:, free]
        least = np.maximum(1e-12 * problem.leak[free], 1e-300)
        slopes = slopes + diags_array(least)
        new = x[free] - splu(slopes.tocsc()).solve(left[free])
        if not balance.confined:
            new = np.where((x[free] < 0.0) & (new > 0.0), 0.0, new)
            new = np.where((x[free] > 0.0) & (new < 0.0), -1e-12 * problem.scale[free], new)
            new = np.maximum(new, -problem.scale[free])
        x = x.copy()
        x[free] = new
    raise NoFlow(f"the flow of water in joints was not found in {MOST} iterations")


def _throughput(problem: _Problem, nodes: _Nodes, flow: Floats) -> float:
    """Return what flows through, or 1e-3 C p where that is larger, m2/s."""
    balance = problem.balance
    size = balance.conductance * (np.abs(nodes.pressure)[balance.node].sum(axis=1) + balance.drop)
    return max(
        float(np.abs(flow).max(initial=0.0)),
        float(np.abs(balance.inflow).max(initial=0.0)),
        1e-3 * float(size.max(initial=0.0)),
        1e-300,
    )


def _result(problem: _Problem, nodes: _Nodes, flow: Floats, iterations: int) -> Solved:
    """Return a solution as it is handed on."""
    balance = problem.balance
    left, stored, missing = _left(problem, nodes, flow)
    given = np.where(balance.free, 0.0, left)
    entering = np.where(balance.kind == SEEPAGE, np.maximum(balance.inflow, 0.0), 0.0)
    runoff = np.minimum(nodes.outflow, entering)
    put_in = balance.inflow + missing
    total = float(stored[balance.free].sum())
    return Solved(
        pressure=nodes.pressure,
        saturation=nodes.saturation,
        flow=np.where(balance.weight >= 0.0, flow, -flow),
        given=given,
        outflow=nodes.outflow - runoff,
        runoff=runoff,
        missing=missing,
        stored=total,
        unaccounted=float(given.sum() + put_in[balance.free].sum() - nodes.outflow.sum() - total),
        throughput=_throughput(problem, nodes, flow),
        iterations=iterations,
    )
