"""Water in joints that blocks open and close, as one term of the potential of a step.

Blocks open the joints at a node by v = V d.  The water that a node holds, the flow to it over the
time h and the void w that remains balance where

    w = A p + v - b,   A = S + h C,   low <= p <= high,

with S = V/K the compressibility of the water at each node, C the conductances between them, and b
the inflow that does not depend on p and the water held before.  Nodes between their bounds have no
void, w = 0; at the lower bound, 0, water cannot follow and w >= 0 is void; at the upper one, that
of a face in air, the excess runs out, w <= 0.  Where a pressure is given both bounds are that.  The
energy

    psi(v) = max over p of  -p.(v - b) - 1/2 p.A p

is convex, and its slope is -p: the term in d is convex and once continuously differentiable, as the
springs of contacts are.  A is an M-matrix, so that the nodes between their bounds are found in a
few solutions (primal-dual active sets; Hintermueller, Ito & Kunisch 2003).

Nodes are taken together by six, as many as a block has unknowns, so that the matrices of blocks
(linear/ldlt.py) serve for them: their pattern depends on the network alone, and a node at a bound
has a row and a column of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.vec6 import UNKNOWNS
from clast.errors import StepOutcome, StepRejected
from clast.linear import ldlt
from clast.linear.pattern import with_fill
from clast.model.arrays import Bools, Floats, Ints

SETS_MAX = 60
"""Sets of nodes between their bounds that are tried."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Channels:
    """Which nodes k channels join, and which blocks open them in e places."""

    ends: Ints
    """Nodes of each channel, shape (k, 2)."""
    node: Ints
    """Node of each place, shape (e,)."""
    block: Ints
    """Block that opens it there, shape (e,)."""
    groups: int
    """Groups of nodes g."""
    place: Ints
    """Place of each node, 6 x group + place within it, shape (m,)."""
    pairs: Ints
    """Groups (i, j), i < j, that channels join, shape (q, 2)."""
    pair: Ints
    """Pair of each channel, -1 within a group, shape (k,)."""
    touched: Ints
    """Pairs of a block and a group, shape (r, 2)."""
    touch: Ints
    """Which of these each place has, shape (e,)."""
    pattern: tuple[Any, ...]
    """Pattern of the groups with all fill (linear/pattern.py)."""

    @classmethod
    def of(cls, count: int, ends: Ints, node: Ints, block: Ints) -> Channels:
        """Return those between ``count`` nodes."""
        place = _placed(count, ends)
        group = place // UNKNOWNS
        groups = int(group.max(initial=-1)) + 1
        both = np.sort(group[ends], axis=1)
        joins = both[:, 0] != both[:, 1]
        number, of_pair = np.unique(both[joins] @ [groups, 1], return_inverse=True)
        pairs = np.stack(np.divmod(number, groups), axis=1)
        pair = np.full(len(ends), -1)
        pair[joins] = of_pair
        number, touch = np.unique(block * groups + group[node], return_inverse=True)
        touched = np.stack(np.divmod(number, groups), axis=1)
        return cls(
            ends=ends,
            node=node,
            block=block,
            groups=groups,
            place=place,
            pairs=pairs,
            pair=pair,
            touched=touched,
            touch=touch,
            pattern=with_fill(groups, pairs, np.ones(len(pairs), np.bool_)),
        )


@kernel()
def _placed(count, ends):
    """Return places of nodes (m,): groups of neighbours, each around its first node."""
    start = np.zeros(count + 1, np.int64)
    for k in range(len(ends)):
        start[ends[k, 0] + 1] += 1
        start[ends[k, 1] + 1] += 1
    for n in range(count):
        start[n + 1] += start[n]
    at, neighbour = start[:-1].copy(), np.empty(start[count], np.int64)
    for k in range(len(ends)):
        for end in range(2):
            neighbour[at[ends[k, end]]] = ends[k, 1 - end]
            at[ends[k, end]] += 1
    place, queue, group = np.full(count, -1), np.empty(UNKNOWNS, np.int64), 0
    for first in range(count):
        if place[first] >= 0:
            continue
        queue[0], number, head = first, 1, 0
        place[first] = UNKNOWNS * group
        while head < number:
            for near in range(start[queue[head]], start[queue[head] + 1]):
                other = neighbour[near]
                if place[other] < 0 and number < UNKNOWNS:
                    queue[number], place[other] = other, UNKNOWNS * group + number
                    number += 1
            head += 1
        group += 1
    return place


@kernel()
def _opened(node, block, rows, displacement, count):
    """Return by how much nodes open, (m,)."""
    result = np.zeros(count)
    for e in range(len(node)):
        s = 0.0
        for a in range(UNKNOWNS):
            s += rows[e, a] * displacement[block[e], a]
        result[node[e]] += s
    return result


@kernel()
def pushed(block, rows, weight, count):
    """Return the sums (n, 6) of ``rows`` (e, 6) times ``weight`` (e,) on blocks."""
    result = np.zeros((count, UNKNOWNS))
    for e in range(len(block)):
        for a in range(UNKNOWNS):
            result[block[e], a] += weight[e] * rows[e, a]
    return result


@kernel()
def _times(ends, between, own, pressure):
    """Return A p."""
    result = own * pressure
    for k in range(len(ends)):
        i, j = ends[k, 0], ends[k, 1]
        result[i] -= between[k] * pressure[j]
        result[j] -= between[k] * pressure[i]
    return result


@kernel()
def _grouped(ends, between, own, free, plan):
    """Return A as blocks of groups (g, 6, 6) and of their pairs (q, 6, 6)."""
    groups, place, pair, number = plan
    diagonal, upper = np.zeros((groups, UNKNOWNS, UNKNOWNS)), np.zeros((number, UNKNOWNS, UNKNOWNS))
    for g in range(groups):
        for a in range(UNKNOWNS):
            diagonal[g, a, a] = own[0]
    for n in range(len(own)):
        diagonal[place[n] // UNKNOWNS, place[n] % UNKNOWNS, place[n] % UNKNOWNS] = own[n]
    for k in range(len(ends)):
        if free[ends[k, 0]] and free[ends[k, 1]]:
            i, j = place[ends[k, 0]], place[ends[k, 1]]
            if pair[k] < 0:
                diagonal[i // UNKNOWNS, i % UNKNOWNS, j % UNKNOWNS] -= between[k]
                diagonal[i // UNKNOWNS, j % UNKNOWNS, i % UNKNOWNS] -= between[k]
            else:
                low, high = min(i, j), max(i, j)
                upper[pair[k], low % UNKNOWNS, high % UNKNOWNS] -= between[k]
    return diagonal, upper


@kernel()
def _put(place, free, values, groups):
    """Return values of free nodes (m,) by groups, (g, 6), 0 elsewhere."""
    result = np.zeros((groups, UNKNOWNS))
    for n in range(len(place)):
        if free[n]:
            result[place[n] // UNKNOWNS, place[n] % UNKNOWNS] = values[n]
    return result


@kernel()
def _openings(touch, place, rows, free, fixed, number):
    """Return -V^T as blocks (r, 6, 6) of pairs of a block and a group."""
    (pair, node, block), result = touch, np.zeros((number, UNKNOWNS, UNKNOWNS))
    for e in range(len(pair)):
        if free[node[e]] and not fixed[block[e]]:
            for a in range(UNKNOWNS):
                result[pair[e], a, place[node[e]] % UNKNOWNS] -= rows[e, a]
    return result


class Factors:
    """The last factors and pressures of a step: starts for its next solution, nothing else."""

    def __init__(self) -> None:
        self.free, self.factor = b"", None
        self.pressure: Floats = np.zeros(0)
        self.blocks: Any = None
        """That of blocks and water together (minimise/joint_water.py)."""


@dataclass(frozen=True, kw_only=True)
class Pressures:
    """The pressures at nodes when joints have opened."""

    pressure: Floats
    """p, Pa, shape (m,)."""
    free: Bools
    """Which are between their bounds, shape (m,)."""
    rest: Floats
    """w = A p + v - b, m2: void at the lower bound, less the excess at the upper, shape (m,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class OpeningJoints:
    """Water in the joints of n blocks in a step, at m nodes."""

    channels: Channels
    rows: Floats
    """V: how the node of each place opens by d of its block there, m2/m, shape (e, 6)."""
    between: Floats
    """h C of each channel, less than 0 in A off its diagonal, m2/Pa, shape (k,)."""
    own: Floats
    """The diagonal of A, m2/Pa, shape (m,)."""
    known: Floats
    """b, m2, shape (m,)."""
    low: Floats
    """Least pressure, Pa, shape (m,)."""
    high: Floats
    """Largest pressure, Pa, shape (m,)."""
    acting: Floats
    """Pressure whose forces are in those on blocks already, Pa, shape (m,)."""
    factors: Factors = field(default_factory=Factors)

    def opened(self, displacement: Floats) -> Floats:
        """Return by how much nodes open, v (m,), m2, by d of blocks (n, 6), and the ground."""
        at = self.channels
        return np.asarray(_opened(at.node, at.block, self.rows, displacement, len(self.own)))

    def forces(self, pressure: Floats, blocks: int) -> Floats:
        """Return the forces of p (m,) on ``blocks`` blocks, (blocks, 6), N/m and N."""
        at = self.channels
        return np.asarray(pushed(at.block, self.rows, pressure[at.node], blocks))

    def held(self, pressure: Floats) -> Floats:
        """Return A p, m2, (m,)."""
        return np.asarray(_times(self.channels.ends, self.between, self.own, pressure))

    def matrices(self, free: Bools, fixed: Bools) -> tuple[Floats, Floats, Floats]:
        """Return A of groups (g, 6, 6) and their pairs (q, 6, 6), and -V^T (r, 6, 6).

        Of nodes that are ``free`` (m,) and blocks that are not ``fixed`` (n,).
        """
        at = self.channels
        touch = at.touch, at.node, at.block
        opens = _openings(touch, at.place, self.rows, free, fixed, len(at.touched))
        return (*self._grouped(free), opens)

    def _grouped(self, free: Bools) -> tuple[Floats, Floats]:
        at = self.channels
        plan = at.groups, at.place, at.pair, len(at.pairs)
        diagonal, upper = _grouped(at.ends, self.between, self.own, free, plan)
        return diagonal, upper

    def by_groups(self, values: Floats, free: Bools) -> Floats:
        """Return values of free nodes (m,) as groups have them, (g, 6)."""
        at = self.channels
        return np.asarray(_put(at.place, free, values, at.groups))

    def _solved(self, free: Bools, right: Floats) -> Floats:
        """Return A^-1 of the free nodes times ``right`` (m,), 0 elsewhere."""
        known = self.factors
        if known.factor is None or known.free != free.tobytes():
            factor, bad = ldlt.exact(self.channels.pattern, *self._grouped(free))
            if bad >= 0:
                raise StepRejected(StepOutcome.SINGULAR, "water in joints")
            known.free, known.factor = free.tobytes(), factor
        found = ldlt.solve(known.factor, self.by_groups(right, free))
        return np.asarray(found.ravel()[self.channels.place])

    def pressures(self, opened: Floats) -> Pressures:
        """Return the pressures where joints have opened by v (m,), m2."""
        low, high, known = self.low, self.high, self.known - opened
        last = self.factors.pressure
        pressure = np.clip(last if len(last) == len(low) else self.acting, low, high)
        before: tuple[bytes, bytes] | None = None
        for _ in range(SETS_MAX):
            rest = self.held(pressure) - known
            aim = pressure - rest / self.own
            # the bounds count where they are reached, so that given pressures are never free
            at_low, at_high = aim <= low, aim >= high
            free = ~(at_low | at_high)
            now = at_low.tobytes(), at_high.tobytes()
            if now == before:
                break
            before = now
            pressure = np.where(at_low, low, np.where(at_high, high, 0.0))
            pressure += self._solved(free, known - self.held(pressure))
        else:
            raise StepRejected(StepOutcome.NOT_CONVERGED, "nodes of water in joints")
        self.factors.pressure = pressure
        return Pressures(pressure=pressure, free=free, rest=np.where(free, 0.0, rest))

    def energy(self, opened: Floats) -> float:
        """Return psi(v) and the energy of the forces that are in those on blocks, J/m."""
        found = self.pressures(opened)
        p = found.pressure
        held = -p @ (opened - self.known) - 0.5 * p @ self.held(p)
        return float(held + self.acting @ opened)

    def rates(self, found: Pressures, opened: Floats) -> Floats:
        """Return how p of nodes changes with a change of v (m,), m2: -A^-1 v of those free."""
        return -self._solved(found.free, opened)

    def beside(self, displacement: Floats) -> OpeningJoints:
        """Return the same for displacements on top of ``displacement`` (n, 6), m."""
        return replace(self, known=self.known - self.opened(displacement), factors=Factors())

    def __repr__(self) -> str:
        return f"OpeningJoints({len(self.known)} nodes)"
