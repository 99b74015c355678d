"""The minimum of the incremental potential by a primal-dual interior point method.

Newton's method with a line search may need a hundred iterations where thousands of stiff contacts
open, close, stick and slide at once: each kink on its line holds it up.  The interior point method
(Mehrotra 1992) goes round the kinks.  A clipped spring, f = clip(f0 - k x, low, high), answers
these conditions:

    f/k + x - f0/k = w- - w+,   w-, w+ >= 0,    (f - low) w- = 0,    (high - f) w+ = 0

The products are held at a common mu > 0 that goes to zero.  Eliminating w-, w+ and f leaves a
system like Newton's, in which every spring has a stiffness between zero and its own:

    K + sum 1/(1/k + w-/(f - low) + w+/(high - f)) n n^T       (and the same with t t^T)

Each iteration factorises it once and solves it twice (predictor and corrector).  Their number, 11
to 30 up to p = 50 E, hardly depends on the number of blocks.

A state of springs is an array (5, m): f, f - low, high - f, w- and w+; both numbers of a bound that
is not there are 0, and those of both where they are equal, for then f is given.  A direction from
there is an array (3, m): the changes of f, w- and w+.  It is kept in single precision: systems are
solved to a tenth, and the residual of a direction is part of the next one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.compute.jit import kernel
from clast.compute.parallel import CONTACTS, shared, summed
from clast.compute.reductions import PART, sum_of
from clast.contact.clipped_spring import Forces, in_piece
from clast.linear.system import BlockSystem, contact_motions, symmetric_system
from clast.minimise.newton import SolverContext
from clast.minimise.potential import MOMENTUM_SHARE, Point, Potential
from clast.model.model import Floats

Both = tuple[Floats, Floats]
"""One array for the normal springs and one for the shear springs."""
NEARLY = 1.0 - 1e-9
"""Share of the distance from the middle to its bounds that the first force may be off it."""


@dataclass(frozen=True, kw_only=True)
class Iterate:
    """Unknowns, the state of the springs, and the conditions linearised about them."""

    unknowns: Floats
    """d, shape (n, 6)."""
    stretches: Both
    """Gap and slip of each link at d, m, shape (m,) each."""
    states: Both
    """State of the springs, shape (5, m) each."""
    errors: Both
    """By how much gap and slip miss the conditions, m, shape (m,) each."""
    stiffnesses: Both
    """Of the springs against gap and slip, N/m2, shape (m,) each."""
    products: float
    """Sum of all products, J/m."""


@dataclass(frozen=True, kw_only=True)
class Direction:
    """Where the conditions lead from an iterate, to first order."""

    unknowns: Floats
    """Change of d, shape (n, 6)."""
    changes: Both
    """Those of gap and slip, m, shape (m,) each."""
    of_springs: Any
    """Those of f, w- and w+, shape (3, m) each, single precision."""
    limit: float
    """Largest step that keeps all slacks positive."""
    growth: tuple[float, float]
    """At a share s the sum of all products has grown by s times the first, s^2 the second, J/m."""


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """The conditions above for one potential."""

    potential: Potential
    work: SolverContext

    @property
    def bounds(self) -> int:
        """How many products there are: one for each bound that a force may reach."""
        springs = self.potential.springs
        return sum(
            int(np.count_nonzero(np.isfinite(bound) & (one.low < one.high) & (one.stiffness > 0.0)))
            for one in (springs.normal, springs.shear)
            for bound in (one.low, one.high)
        )

    def largest_force(self) -> float:
        """Return the largest force on a block, N/m; momentum counts with MOMENTUM_SHARE of it.

        It is all there is where blocks collide without any weight.
        """
        momentum = self.potential.base.momentum[:, :2]
        others = self.potential.base.force[:, :2] - momentum
        return float(max(np.abs(others).max(), MOMENTUM_SHARE * np.abs(momentum).max()))

    def centred(self, point: Point, mu: float) -> Iterate:
        """Return the iterate at ``point`` whose products are ``mu``, J/m, where one bound is."""
        stretches, count = (point.gap, point.slip), len(point.gap)
        states = np.empty((5, count)), np.empty((5, count))
        _centre_both(count, stretches, mu, self.potential.springs.arrays, states)
        return self.at(point.unknowns, stretches, states)

    def advanced(self, at: Iterate, direction: Direction, share: float) -> Iterate:
        """Return the iterate ``share`` of the ``direction`` on."""
        count = len(at.stretches[0])
        stretches, states = _two(count), (np.empty((5, count)), np.empty((5, count)))
        along = *at.stretches, *direction.changes
        _move_both(count, at.states, states, along, direction.of_springs, share, stretches)
        return self.at(at.unknowns + share * direction.unknowns, stretches, states)

    def at(self, unknowns: Floats, stretches: Both, states: Both) -> Iterate:
        """Return the iterate with the conditions linearised about it."""
        count, springs = len(stretches[0]), self.potential.springs.arrays
        errors, stiffnesses = _two(count), _two(count)
        products = _linearise_both(count, stretches, springs, states, errors, stiffnesses)
        return Iterate(
            unknowns=unknowns,
            stretches=stretches,
            states=states,
            errors=errors,
            stiffnesses=stiffnesses,
            products=float(products),
        )

    def linearised(self, at: Iterate) -> BlockSystem:
        """Return the matrix of the conditions linearised about an iterate."""
        whole = self.potential
        self.work.stages("assembly")
        return symmetric_system(
            whole.base,
            whole.springs,
            self.bearing(at),
            whole.base.force,
            whole.fixed,
            whole.graph,
        )

    def bearing(self, at: Iterate) -> Forces:
        """Return the forces of the springs at an iterate."""
        return Forces(at.states[0][0], at.states[1][0], *at.stiffnesses)

    def towards(
        self,
        at: Iterate,
        system: BlockSystem,
        target: float,
        before: Direction | None,
        accuracy: float,
    ) -> Direction:
        """Return the direction to where all products are ``target``, J/m, to first order.

        The bend that the direction ``before`` has shown is corrected for; an iteration begins from
        that, and ends where its residual has fallen to ``accuracy`` of itself.
        """
        potential, work, count = self.potential, self.work, len(at.stretches[0])
        about = *at.errors, *at.stiffnesses
        shown = NOTHING_SHOWN if before is None else before.of_springs
        work.stages("law")
        forces = _two(count)
        _aim_both(count, at.states, about, target, shown, forces)
        load, _ = potential.unbalanced(at.unknowns, *forces)
        work.stages("solve")
        guess = None if before is None else before.unknowns
        unknowns = work.factor.nearer(
            replace(system, force=load), self.bearing(at), guess, accuracy
        )
        work.stages("law")
        changes = contact_motions(potential.springs, unknowns)
        of_springs = np.empty((3, count), np.float32), np.empty((3, count), np.float32)
        direction = np.zeros((max(1, (count + PART - 1) // PART), 3))
        _go_both(count, at.states, (*about, *changes), target, shown, of_springs, direction)
        haste = float(direction[:, 0].max())
        return Direction(
            unknowns=unknowns,
            changes=changes,
            of_springs=of_springs,
            limit=1.0 / haste if haste > 0.0 else np.inf,
            growth=(float(direction[:, 1].sum()), float(direction[:, 2].sum())),
        )


NOTHING_SHOWN = np.zeros((3, 0), np.float32), np.zeros((3, 0), np.float32)
"""A direction that has shown no bend."""


@dataclass(frozen=True, kw_only=True)
class Predicted:
    """The conditions linearised about an iterate, and the step to zero products from there."""

    at: Iterate
    system: BlockSystem
    predictor: Direction


@dataclass(frozen=True, kw_only=True)
class InteriorPoint:
    """Mehrotra's predictor and corrector."""

    iterations: int = 60
    """Iterations at most."""
    start: float = 0.1
    """Force at which the kinks are rounded to begin with, in units of the largest on a block."""
    tight: float = 0.15
    """Share of the first direction below which hardly any of it is free,"""
    free: float = 0.5
    """and share that then should be: kinks are rounded"""
    widest: float = 1e3
    """up to so many times more at once, and this is done"""
    widened: int = 2
    """so many times at most."""
    step_share: float = 0.99
    """Share of the distance to the nearest bound that an iteration goes at most."""
    reduction: int = 3
    """mu is aimed at (predicted mu / mu)^reduction (Mehrotra 1992)."""
    rough: float = 0.1
    """Accuracy of directions where systems are solved by iteration,"""
    fine: float = 0.01
    """and its value where products hardly fall, as of stiff slopes with little inertia."""
    held_up: float = 0.8
    """Share of all products that two iterations in a row leave where they are held up."""
    near: float = 1e3
    """Sum of all products, in units of the tolerance, from which the law is asked: on a slope an
    iterate's distance from the minimum was between 1/10 and 70 times that sum."""
    smallest: float = 1e-6
    """mu, in units of the tolerance, below which round-off has taken over."""

    def minimise(
        self, potential: Potential, point: Point, tolerance: float, work: SolverContext
    ) -> Point:
        """Return the best point reached from ``point`` on, to within ``tolerance``, J/m."""
        conditions = Conditions(potential=potential, work=work)
        bounds = conditions.bounds
        if bounds == 0:
            return point
        best, distance = point, potential.distance(point)
        now = self.begun(conditions, point)
        if now.at.products == 0.0:
            return point  # no force to go by: all that is left is round-off
        accuracy, held_up = self.rough, False
        for left in reversed(range(self.iterations)):
            before = now.at.products
            at = self.corrected(conditions, now, accuracy)
            if at.products <= self.near * tolerance or left == 0:
                work.stages("law")
                point = potential.at(at.unknowns)
                reached = potential.distance(point)
                if reached < distance:
                    best, distance = point, reached
            if distance <= tolerance or before / bounds < self.smallest * tolerance:
                break
            held_up, again = at.products > self.held_up * before, held_up
            if held_up and again:
                accuracy = self.fine
            now = self.predicted(conditions, at, accuracy)
        return best

    def begun(self, conditions: Conditions, point: Point) -> Predicted:
        """Return the first system about ``point`` with its predictor.

        Where mu is small beside the imbalance hardly anything of the direction is free, and
        iterations would creep along the bounds.  The kinks are then rounded so much more that about
        ``free`` of it should be.
        """
        rounding = self.start * conditions.largest_force()
        stiffest = float(conditions.potential.springs.normal.stiffness.max())

        def rounded(rounding: float) -> Predicted:
            at = conditions.centred(point, rounding**2 / (4.0 * stiffest))
            return self.predicted(conditions, at, self.rough)

        first = rounded(rounding)
        for _ in range(self.widened):
            limit = first.predictor.limit
            if limit >= self.tight:
                break
            rounding *= self.free / max(limit, self.free / self.widest)
            first = rounded(rounding)
        return first

    def predicted(self, conditions: Conditions, at: Iterate, accuracy: float) -> Predicted:
        """Return the system about an iterate with its predictor."""
        system = conditions.linearised(at)
        conditions.work.count("passes")
        predictor = conditions.towards(at, system, 0.0, None, accuracy)
        return Predicted(at=at, system=system, predictor=predictor)

    def corrected(self, conditions: Conditions, now: Predicted, accuracy: float) -> Iterate:
        """Return the next iterate: the predictor tells how far mu can fall, how products bend."""
        predictor, products = now.predictor, now.at.products
        share = min(1.0, predictor.limit)
        left = products + share * (predictor.growth[0] + share * predictor.growth[1])
        sigma = max(0.0, left / products) ** self.reduction
        target = sigma * products / conditions.bounds
        direction = conditions.towards(now.at, now.system, target, predictor, accuracy)
        conditions.work.stages("law")
        share = min(1.0, self.step_share * direction.limit)
        return conditions.advanced(now.at, direction, share)


def _two(count: int) -> Both:
    """Return room for a number of each normal and each shear spring."""
    return np.empty(count), np.empty(count)


@kernel(forceinline=True)
def _of_state(state, first, last):
    """Return f, f - low, high - f, w- and w+ of the springs ``first`` to ``last`` - 1."""
    force, above, below = state[0, first:last], state[1, first:last], state[2, first:last]
    return force, above, below, state[3, first:last], state[4, first:last]


@kernel(error_model="numpy")
def _linearise(stretch, springs, state, error, stiffness):
    """Write errors and stiffnesses of springs in a state; return the sum of their products."""
    at_zero, k, low, high = springs
    force, above, below, lower, upper = state
    products = np.empty(len(stretch))
    for c in range(len(stretch)):
        a, b, under, over = above[c], below[c], lower[c], upper[c]
        missed = (force[c] - at_zero[c]) / k[c]
        error[c] = (missed if k[c] > 0.0 else 0.0) + stretch[c] - under + over
        give = 1.0 / k[c] + (under / a if a > 0.0 else 0.0) + (over / b if b > 0.0 else 0.0)
        stiffness[c] = 1.0 / give if low[c] < high[c] else 0.0
        products[c] = a * under + b * over
    return sum_of(products)


@summed(CONTACTS)
def _linearise_both(first, last, stretches, springs, states, errors, stiffnesses):
    """Write errors and stiffnesses of all springs; return the sum of all products."""
    products = 0.0
    for kind in range(2):
        stretch, own = stretches[kind][first:last], in_piece(springs, kind, first, last)
        error, stiffness = errors[kind][first:last], stiffnesses[kind][first:last]
        state = _of_state(states[kind], first, last)
        products += _linearise(stretch, own, state, error, stiffness)
    return products


@kernel(error_model="numpy")
def _positive(x, square):
    """Return the a > 0 with a (a - x) = square/4, without cancellation."""
    root = np.sqrt(x * x + square)
    return 0.5 * (x + root) if x > 0.0 else 0.5 * square / (root - x)


@kernel(error_model="numpy")
def _centre(stretch, springs, mu, state):
    """Write the state with products of ``mu``; where there are two bounds they are about that."""
    at_zero, stiffness, low, high = springs
    force, above, below, lower, upper = state
    for c in range(len(stretch)):
        k, least, most = stiffness[c], low[c], high[c]
        straight, square = at_zero[c] - k * stretch[c], 4.0 * k * mu
        above[c], below[c] = 0.0, 0.0
        force[c] = min(max(straight, least), most)
        if k > 0.0 and least < most:
            if least > -np.inf and most < np.inf:
                middle, half = 0.5 * (least + most), 0.5 * (most - least)
                t = straight - middle
                t = 0.5 * (np.sqrt((t + half) ** 2 + square) - np.sqrt((t - half) ** 2 + square))
                t = min(max(t, -NEARLY * half), NEARLY * half)
                force[c], above[c], below[c] = middle + t, half + t, half - t
            elif least > -np.inf:
                above[c] = _positive(straight - least, square)
                force[c] = least + above[c]
            elif most < np.inf:
                below[c] = _positive(most - straight, square)
                force[c] = most - below[c]
        lower[c] = mu / above[c] if above[c] > 0.0 else 0.0
        upper[c] = mu / below[c] if below[c] > 0.0 else 0.0


@shared(CONTACTS)
def _centre_both(first, last, stretches, mu, springs, states):
    """Write the centred state of all springs."""
    for kind in range(2):
        stretch, own = stretches[kind][first:last], in_piece(springs, kind, first, last)
        _centre(stretch, own, mu, _of_state(states[kind], first, last))


@kernel()
def _bent(shown, first, last):
    """Return by how much a direction has bent the products of both bounds, J/m, (m,) each."""
    low, high = np.zeros(last - first), np.zeros(last - first)
    if shown.shape[1] > 0:
        force, lower, upper = shown[0, first:last], shown[1, first:last], shown[2, first:last]
        for c in range(len(force)):
            t = np.float64(force[c])
            low[c], high[c] = t * lower[c], -t * upper[c]
    return low, high


@kernel(forceinline=True, error_model="numpy")
def _slips(above, below, lower, upper, target, bent_low, bent_high):
    """Return the changes of w- and w+, m, if f stayed."""
    below_it = (target - above * lower - bent_low) / above if above > 0.0 else 0.0
    return below_it, (target - below * upper - bent_high) / below if below > 0.0 else 0.0


@kernel()
def _aim(state, target, bent, error, stiffness, force):
    """Write the forces on blocks that do not move where all products are to be ``target``."""
    known, above, below, lower, upper = state
    bent_low, bent_high = bent
    for c in range(len(error)):
        low, high = _slips(
            above[c], below[c], lower[c], upper[c], target, bent_low[c], bent_high[c]
        )
        force[c] = known[c] + stiffness[c] * (low - high - error[c])


@shared(CONTACTS)
def _aim_both(first, last, states, about, target, shown, forces):
    """Write N and T, N/m, (m,) each, on blocks that do not move.

    ``about`` are errors and stiffnesses, (m,) each.
    """
    for kind in range(2):
        state, bent = _of_state(states[kind], first, last), _bent(shown[kind], first, last)
        error, stiffness = about[kind][first:last], about[2 + kind][first:last]
        _aim(state, target, bent, error, stiffness, forces[kind][first:last])


@kernel(error_model="numpy")
def _go(state, aim, error, stiffness, stretching, direction):
    """Write the changes of f, w- and w+; return the greatest loss, and how products grow."""
    _, above, below, lower, upper = state
    target, (bent_low, bent_high) = aim
    of_force, of_lower, of_upper = direction[0], direction[1], direction[2]
    count = len(error)
    haste, growth, bend = np.empty(count), np.empty(count), np.empty(count)
    for c in range(count):
        a, b, low, high = above[c], below[c], lower[c], upper[c]
        d_low, d_high = _slips(a, b, low, high, target, bent_low[c], bent_high[c])
        t = stiffness[c] * (d_low - d_high - error[c] - stretching[c])
        t_a, t_b = (t / a if a > 0.0 else 0.0), (t / b if b > 0.0 else 0.0)
        d_low, d_high = d_low - low * t_a, d_high + high * t_b
        of_force[c], of_lower[c], of_upper[c] = t, d_low, d_high
        of_slips = max(-d_low / low if a > 0.0 else 0.0, -d_high / high if b > 0.0 else 0.0)
        haste[c] = max(max(-t_a, t_b), of_slips)
        growth[c] = a * d_low + b * d_high + (low - high) * t
        bend[c] = t * (d_low - d_high)
    return haste.max(), sum_of(growth), sum_of(bend)


@shared(CONTACTS)
def _go_both(first, last, states, about, target, shown, of_springs, directions):
    """Write the directions of all springs, and by parts the results of ``_go``.

    ``about`` are errors, stiffnesses and the changes of gap and slip, (m,) each.
    """
    part = directions[first // PART]
    for kind in range(2):
        state, own = _of_state(states[kind], first, last), (target, _bent(shown[kind], first, last))
        error, stiffness = about[kind][first:last], about[2 + kind][first:last]
        stretching, direction = about[4 + kind][first:last], of_springs[kind][:, first:last]
        haste, growth, bend = _go(state, own, error, stiffness, stretching, direction)
        part[0], part[1], part[2] = max(part[0], haste), part[1] + growth, part[2] + bend


@kernel()
def _move(old, stretch, direction, stretching, share, state, new):
    """Write the state and the stretches ``share`` of a direction on."""
    force, above, below, lower, upper = old
    of_force, of_lower, of_upper = direction[0], direction[1], direction[2]
    new_force, new_above, new_below, new_lower, new_upper = state
    for c in range(len(stretch)):
        t = share * of_force[c]
        new_force[c] = force[c] + t
        new_above[c] = above[c] + t if above[c] > 0.0 else 0.0
        new_below[c] = below[c] - t if below[c] > 0.0 else 0.0
        new_lower[c] = lower[c] + share * of_lower[c]
        new_upper[c] = upper[c] + share * of_upper[c]
        new[c] = stretch[c] + share * stretching[c]


@shared(CONTACTS)
def _move_both(first, last, old, states, stretches, of_springs, share, new):
    """Write states and stretches ``share`` of a direction on.

    ``old`` are the states, ``stretches`` gap and slip and their changes, ``new`` gap and slip then.
    """
    for kind in range(2):
        known, state = _of_state(old[kind], first, last), _of_state(states[kind], first, last)
        stretch, stretching = stretches[kind][first:last], stretches[2 + kind][first:last]
        direction = of_springs[kind][:, first:last]
        _move(known, stretch, direction, stretching, share, state, new[kind][first:last])
