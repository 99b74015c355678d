"""Steady flow in a network of channels, and a step of transient flow by backward Euler.

Newton's method goes from piece to piece of the balance.  It mostly ends in 10 to 30 iterations,
but may go round a few nodes for ever; then the path of ``path.py`` is followed from there, which
ends.  The law is that of ``balance.py`` alone: the upwind law, which Newton's method solves from
anywhere, only gives a start where none is near.

Steady states differ by water at rest that nothing feeds, in closed ends, and by the saturation of
dry nodes above columns that no water passes.  The smallest is returned, which dry joints come to:
joints that no water reaches are dry.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from clast.errors import CaseError
from clast.model.arrays import Bools, Floats, connected
from clast.model.flow.balance import GIVEN, INNER, SEEPAGE, Balance, Solved
from clast.model.flow.path import followed
from clast.model.flow.pieces import (
    HOLD,
    ROUNDING,
    TINY,
    Piece,
    Problem,
    error_of,
    piece_at,
    upwind_at,
    water_at,
)
from clast.model.flow.slopes import factored

MOST = 30
"""Most iterations of Newton's method before the path is followed."""
QUICK = 10
"""Most of them from a state that may be near."""
AGAIN = 15
"""Most of them after each part of the path."""
FIRST_PART = 50
"""Pieces of the path before Newton's method is tried again, each at a tenth of the cost of one of
its iterations; twice as many each time, so that in the end a part is as long as the whole path."""
FIRST_HOLD = 1e-9
"""Hold of nodes on the first part of the path: with less, its factor is kept for fewer kinks; a
tenth each time, until it is that of Newton's method."""
PIECES = 100_000
"""Most pieces in all: a limit of patience, not of the method."""
REPEATS = 6
"""Pieces that Newton's method comes back to before it is taken to go round."""
ROUNDED = 1e-8
"""Error that may be due to rounding."""
STANDS = 1e-9
"""By how much the column in a channel must be too high to rise out of it, as a share of it."""


class NoFlow(CaseError):
    """A flow of water that was not found."""


@dataclass(frozen=True, kw_only=True, repr=False)
class _Found:
    """Where a search is."""

    x: Floats
    """Unknowns, Pa, shape (m,)."""
    error: float
    """Largest error of the balance of a free node, as a share of the flow."""
    done: bool
    """Whether it is within rounding."""
    iterations: int
    """Linear systems solved."""


def steady(balance: Balance, start: Solved | None = None) -> Solved:
    """Return the smallest steady flow of a balance; ``start``, one that is near, saves time.

    Raises NoFlow where water has nowhere to go.
    """
    _refuse_closed_parts(balance)
    count = len(balance.kind)
    problem = Problem(
        balance=balance, pressure=np.zeros(count), saturation=np.zeros(count), rate=0.0
    )
    near = None if start is None else _unknowns(problem, start.pressure, start.saturation)
    found = _found(problem, near)
    x = found.x if balance.confined else _smallest(problem, found.x)
    return _result(problem, x, found.iterations)


def advanced(balance: Balance, before: Solved, step: float) -> Solved:
    """Return the flow at the end of a step, s, by backward Euler from the state ``before``."""
    pressure, saturation = before.pressure, before.saturation
    problem = Problem(balance=balance, pressure=pressure, saturation=saturation, rate=1.0 / step)
    found = _found(problem, _unknowns(problem, pressure, saturation))
    return _result(problem, found.x, found.iterations)


def _refuse_closed_parts(balance: Balance) -> None:
    """Raise NoFlow where the inflow of a connected part of the network cannot leave it."""
    part = connected(balance.node[:, 0], balance.node[:, 1], len(balance.kind))
    ways_out = np.bincount(part, balance.kind != INNER)
    left, turned_over = np.bincount(part, balance.inflow), np.bincount(part, np.abs(balance.inflow))
    # without a free surface pumps cannot lack water either
    too_much = np.abs(left) if balance.confined else left
    closed = np.flatnonzero((ways_out == 0) & (too_much > ROUNDED * turned_over))
    if len(closed):
        first = int(closed[0])
        raise NoFlow(
            f"water has nowhere to go: {left[first]:.3g} m2/s flow into a part of the joints, of "
            f"{int((part == first).sum())} ends and crossings, that no head or face lets out",
            where="flow",
            remedy="give these joints a [[flow_boundary]] with a head, a pressure or seepage",
        )


def _unknowns(problem: Problem, pressure: Floats, saturation: Floats) -> Floats:
    """Return the unknowns of a state of nodes, Pa, shape (m,)."""
    dry = (saturation < 1.0) & (not problem.balance.confined)
    return np.where(dry, (saturation - 1.0) * problem.scale, pressure)


def _found(problem: Problem, given: Floats | None) -> _Found:
    """Return the zero of the balance, near unknowns (m,), Pa, or by way of the upwind law."""
    balance = problem.balance
    if balance.confined:
        x = np.zeros(len(balance.kind)) if given is None else given
        return _on_path(problem, _newton(problem, x, MOST))
    if given is None:  # where joints that are full to the faces, which suck, are under pressure
        kind = np.where(balance.kind == SEEPAGE, GIVEN, balance.kind)
        full = replace(problem, balance=replace(balance, kind=kind, confined=True))
        first = _newton(full, np.zeros(len(kind)), 2)
        x = np.where(first.x > 0.0, first.x, -problem.scale)
    else:
        x, first = given, _newton(problem, given, QUICK)
        if first.done:
            return first
    near = _newton(problem, x, MOST, upwind_at)
    last = _newton(problem, near.x, MOST)
    used = first.iterations + near.iterations
    if given is not None and not last.done:
        used += last.iterations
        last = _newton(problem, first.x, MOST)
    return _on_path(problem, replace(last, iterations=used + last.iterations))


def _on_path(problem: Problem, found: _Found) -> _Found:
    """Return the zero of the balance, on the path from where Newton's method has not ended."""
    iterations, part, hold = found.iterations, FIRST_PART, FIRST_HOLD
    while not found.done:
        if iterations > PIECES:
            raise NoFlow(
                f"the flow of water in joints was not found: after {iterations} linear systems a "
                f"share of {found.error:.0e} of it is out of balance at a node",
                where="flow",
                remedy='let it come about in time: state = "transient", initial = "dry"',
            )
        x, pieces = followed(replace(problem, hold=hold), found.x, found.error, part)
        again = _newton(problem, x, AGAIN)
        on_path = error_of(problem, water_at(problem, piece_at(problem, x), x))
        found = again if again.done or again.error < on_path else replace(found, x=x, error=on_path)
        iterations, part = iterations + pieces + again.iterations, 2 * part
        hold = max(0.1 * hold, HOLD)
    return replace(found, iterations=iterations)


def _newton(
    problem: Problem, x: Floats, most: int, piece_of: Callable[..., Piece] = piece_at
) -> _Found:
    """Return where ``most`` iterations of Newton's method lead from x (m,), Pa.

    They stop at the kinks of nodes, and where nodes are empty.
    """
    free, error, done, repeats = problem.free, np.inf, False, 0
    factor = None
    seen: dict[bytes, int] = {}
    for iterations in range(most + 1):
        piece = piece_of(problem, x)
        water = water_at(problem, piece, x)
        before, error = error, error_of(problem, water)
        within = np.abs(water.left[free]) <= ROUNDING * water.terms[free]
        last = seen.get(key := piece.key, -2)
        # solved in its own piece, and no better: what is left is rounding
        same = last == iterations - 1 and error > 0.5 * before
        done = bool(within.all()) or (same and error < ROUNDED)
        repeats += 0 <= last < iterations - 1
        if done or iterations == most or repeats == REPEATS:
            break
        seen[key] = iterations
        if factor is None or last != iterations - 1:
            factor = factored(problem, piece)
        new = x - factor(water.left)
        x = new if problem.balance.confined else _stopped(problem, x, new)
    return _Found(x=x, error=error, done=done, iterations=iterations)


def _stopped(problem: Problem, x: Floats, new: Floats) -> Floats:
    """Return the way from x to new unknowns, Pa, (m,), no farther than to the kink or to empty."""
    new = np.where((x < 0.0) & (new > 0.0), 0.0, new)
    new = np.where((x > 0.0) & (new < 0.0), -1e-12 * problem.scale, new)
    return np.maximum(new, -problem.scale)


def _smallest(problem: Problem, x: Floats) -> Floats:
    """Return the unknowns of the smallest steady state that differs by no flow, Pa, (m,)."""
    balance, scale = problem.balance, problem.scale
    count = len(x)
    x = np.where(_reached(problem, x) | ~balance.free, x, -scale)
    pressure = water_at(problem, piece_at(problem, x), x).pressure
    down = balance.drop > 0.0
    upper, lower = balance.upper[down], balance.lower[down]
    standing = np.ones(count)
    np.minimum.at(standing, upper, pressure[lower] / balance.drop[down])
    loose = balance.free & (x <= 0.0) & (balance.inflow >= 0.0)
    return np.where(loose, np.minimum(x, -scale * standing), x)


def _reached(problem: Problem, x: Floats) -> Bools:
    """Return the nodes that water comes to in a steady state, shape (m,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order

    balance, count = problem.balance, len(x)
    pressure = water_at(problem, piece_at(problem, x), x).pressure
    over, under = pressure[balance.upper], pressure[balance.lower]
    falls = (balance.drop > 0.0) | (over > 0.0)
    rises = under > balance.drop * (1.0 + STANDS)
    source = np.flatnonzero((balance.kind == GIVEN) | (balance.inflow > 0.0))
    first = np.concatenate(
        [balance.upper[falls], balance.lower[rises], np.full(len(source), count)]
    )
    last = np.concatenate([balance.lower[falls], balance.upper[rises], source])
    ways = coo_array((np.ones(len(first)), (first, last)), shape=(count + 1, count + 1)).tocsr()
    reached = np.zeros(count + 1, np.bool_)
    reached[breadth_first_order(ways, count, return_predecessors=False)] = True
    return reached[:count]


def _result(problem: Problem, x: Floats, iterations: int) -> Solved:
    """Return the water in the network for the unknowns (m,), Pa, of a solution."""
    balance = problem.balance
    water = water_at(problem, piece_at(problem, x), x)
    free = balance.free
    given = np.where(free, 0.0, water.left)
    put_in = np.where(free, balance.inflow + water.missing, 0.0)
    raining = np.where(balance.kind == SEEPAGE, np.maximum(balance.inflow, 0.0), 0.0)
    runoff = np.minimum(water.outflow, raining)
    # what GIVEN nodes store is part of what flows in there
    stored = float(water.stored.sum())
    throughput = max(
        float(np.maximum(given, 0.0).sum() + np.maximum(put_in, 0.0).sum() + max(-stored, 0.0)),
        1e-3 * float((water.terms).max(initial=0.0)),
        TINY,
    )
    return Solved(
        pressure=water.pressure,
        saturation=np.clip(water.saturation, 0.0, 1.0),
        flow=np.where(balance.weight >= 0.0, water.flow, -water.flow),
        given=given,
        outflow=water.outflow - runoff,
        runoff=runoff,
        missing=np.where(free, water.missing, 0.0),
        stored=stored,
        unaccounted=float(given.sum() + put_in.sum() - water.outflow.sum() - stored),
        throughput=throughput,
        iterations=iterations,
    )
