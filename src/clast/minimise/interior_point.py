"""The minimum of the incremental potential by a primal-dual interior point method.

Newton's method with a line search may need a hundred iterations where thousands of stiff contacts
open, close, stick and slide at once: each kink on its way holds it up.  The interior point method
(Mehrotra 1992) goes round the kinks.  The penalty law is the answer of these conditions, with N
shifted by the tension that a bond bears so that N >= 0, and -b <= T <= b:

    w = N/p + gap - lambda/p >= 0,                    N w = 0
    T/k + slip - T_old/k = w+ - w-,   w+, w- >= 0,    (T + b) w+ = 0,   (b - T) w- = 0

The products are held at a common mu > 0 that goes to zero.  Eliminating w, N and T leaves a system
like Newton's, in which every contact has a stiffness between zero and the spring's:

    K + sum 1/(1/p + w/N) n n^T + sum 1/(1/k + w+/(T + b) + w-/(b - T)) t t^T

Each iteration factorises it once and solves it twice (predictor and corrector).  Their number, 11
to 30 up to p = 50 E, hardly depends on the number of blocks.  Where systems are solved by iteration
a tenth is accurate enough for a way, as a rule; of stiff slopes with next to no inertia such ways
may lead nowhere, which shows in products that hardly fall, and then a hundredth is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clast.compute.stopwatch import Stages
from clast.contact.contacts import ContactResponse, SpringLimits
from clast.linear.reuse import FactorOfStep
from clast.linear.system import BlockSystem, contact_motions, symmetric_system
from clast.minimise import interior_kernels as kernel
from clast.minimise.potential import MOMENTUM_SHARE, Point, Potential
from clast.model.model import Floats

START = 0.1
"""Force at which the kinks are rounded to begin with, in units of the largest force on a block."""
TIGHT, FREE = 0.15, 0.5
"""Share of the first way below which hardly any of it is free, and share that then should be."""
WIDEST = 1e3
"""Times that they are rounded more at once."""
WIDENED = 2
"""Times that this is done at most."""
STEP_SHARE = 0.99
"""Share of the way to the nearest bound that an iteration goes at most."""
REDUCTION = 3
"""mu is aimed at (predicted mu / mu)^REDUCTION (Mehrotra 1992)."""
ITERATIONS = 60
"""Iterations at most."""
ROUGH, FINE = 0.1, 0.01
"""Accuracy of the predictor, and of the corrector, which begins with it, and what it becomes where
iterations gain little."""
HELD_UP = 0.8
"""Share of all products that two iterations in a row leave where they are held up."""
NEAR = 1e3
"""Sum of all products, in units of the energy that is enough, from which the law is asked.

On a slope an iterate's distance from the minimum was between 1/10 and 70 times that sum.
"""
SMALLEST = 1e-6
"""mu, in units of the energy that is enough, below which round-off has taken over."""


@dataclass(frozen=True, kw_only=True)
class Iterate:
    """Unknowns, the state of the contacts, and the conditions linearised about them."""

    unknowns: Floats
    """d, shape (n, 6)."""
    gaps: tuple[Floats, Floats]
    """Gap and slip of each contact at d, m, shape (m,) each."""
    state: Floats
    """N, w, T + b, b - T, w+ and w- of each contact (interior_kernels.py), shape (6, m)."""
    errors: tuple[Floats, Floats]
    """By how much gap and slip miss the conditions, m, shape (m,) each."""
    stiffnesses: tuple[Floats, Floats]
    """Of each contact against opening and slip, N/m2, shape (m,) each."""
    products: float
    """Sum of all products, J/m."""


@dataclass(frozen=True, kw_only=True)
class Way:
    """Where the conditions lead from an iterate, to first order."""

    unknowns: Floats
    """Change of d, shape (n, 6)."""
    changes: tuple[Floats, Floats]
    """Those of gap and slip, m, shape (m,) each."""
    contacts: Floats
    """Those of N, w, T, w+ and w-, shape (5, m), single precision."""
    limit: float
    """How far it may be gone before something that is positive becomes zero."""
    growth: tuple[float, float]
    """At a share s the sum of all products has grown by s times the first, s^2 the second, J/m."""


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """The conditions above for one potential."""

    potential: Potential
    limits: SpringLimits

    @cached_property
    def springs(self) -> tuple[float, float, Floats, Floats, Floats]:
        """p, k, the forces at gap and slip 0 and the shear strength (m,), as kernels take them."""
        limits, contacts = self.limits, self.potential.contacts
        return (
            limits.normal_stiffness,
            limits.shear_stiffness,
            contacts.multiplier + limits.tension,
            contacts.shear_force,
            limits.strength,
        )

    @cached_property
    def count(self) -> int:
        """How many products there are: of N, and of both bounds of T where there is strength."""
        strength = self.limits.strength
        return len(strength) + 2 * int(np.count_nonzero(strength > 0.0))

    def largest_force(self) -> float:
        """Return the largest force on a block, N/m; momentum counts with MOMENTUM_SHARE of it.

        It is all there is where blocks collide without any weight.
        """
        momentum = self.potential.base.momentum[:, :2]
        others = self.potential.base.force[:, :2] - momentum
        return float(max(np.abs(others).max(), MOMENTUM_SHARE * np.abs(momentum).max()))

    def centred(self, point: Point, rounding: float) -> Iterate:
        """Return the iterate at ``point`` whose normal products are all the same.

        They are mu = rounding^2/(4 p), ``rounding`` being a force, N/m.
        """
        gaps = point.gap, point.slip
        state, errors, stiffnesses, products = kernel.centred(gaps, rounding, self.springs)
        return Iterate(
            unknowns=point.unknowns,
            gaps=gaps,
            state=state,
            errors=errors,
            stiffnesses=stiffnesses,
            products=products,
        )

    def advanced(self, at: Iterate, way: Way, share: float) -> Iterate:
        """Return the iterate ``share`` of the ``way`` on."""
        gaps, state, errors, stiffnesses, products = kernel.advanced(
            at.state, at.gaps, way.contacts, way.changes, share, self.springs
        )
        return Iterate(
            unknowns=at.unknowns + share * way.unknowns,
            gaps=gaps,
            state=state,
            errors=errors,
            stiffnesses=stiffnesses,
            products=products,
        )


@dataclass(frozen=True, kw_only=True)
class Linearised:
    """The conditions linearised about an iterate: one matrix, several right-hand sides."""

    conditions: Conditions
    at: Iterate
    response: ContactResponse
    """The contacts' stiffnesses."""
    system: BlockSystem
    """The matrix; its right-hand side comes with the way."""

    def towards(
        self,
        target: float,
        before: Way | None,
        accuracy: float,
        factor: FactorOfStep,
        stages: Stages,
    ) -> Way:
        """Return the way to where all products are ``target``, J/m, to first order.

        The bend that the way ``before`` has shown is corrected for, and where systems are solved by
        iteration it is begun from, and done where what it leaves has fallen to ``accuracy`` of
        itself.
        """
        at, potential, limits = self.at, self.conditions.potential, self.conditions.limits
        about = at.state, target, None if before is None else before.contacts, at.errors
        with stages("law"):
            forces = kernel.aimed(*about, at.stiffnesses, limits.tension)
            load, _ = potential.unbalanced(at.unknowns, *forces)
        with stages("solve"):
            guess = None if before is None else before.unknowns
            system = replace(self.system, force=load)
            unknowns = factor.nearer(system, self.response, guess, accuracy)
        with stages("law"):
            changes = contact_motions(potential.contacts, unknowns)
            way, limit, growth, bend = kernel.way_of(
                *about, at.stiffnesses, changes, limits.normal_stiffness
            )
        return Way(
            unknowns=unknowns, changes=changes, contacts=way, limit=limit, growth=(growth, bend)
        )


def linearised(conditions: Conditions, at: Iterate, stages: Stages) -> Linearised:
    """Return the conditions linearised about an iterate."""
    potential, contacts = conditions.potential, conditions.potential.contacts
    response = replace(
        potential.at_rest,
        normal_stiffness=at.stiffnesses[0],
        shear_stiffness=at.stiffnesses[1],
    )
    base = potential.base
    with stages("assembly"):
        system = symmetric_system(
            base, contacts, response, base.force, potential.fixed, potential.graph
        )
    return Linearised(conditions=conditions, at=at, response=response, system=system)


@dataclass(frozen=True, kw_only=True)
class Predicted:
    """The conditions about an iterate, and what goes to zero products from there."""

    system: Linearised
    predictor: Way


def predicted(
    conditions: Conditions,
    at: Iterate,
    accuracy: float,
    factor: FactorOfStep,
    counts: dict[str, int],
    stages: Stages,
) -> Predicted:
    """Return the system about ``at`` with its predictor; ``counts`` is added to."""
    system = linearised(conditions, at, stages)
    counts["passes"] += 1
    return Predicted(system=system, predictor=system.towards(0.0, None, accuracy, factor, stages))


def begun(
    conditions: Conditions,
    point: Point,
    factor: FactorOfStep,
    counts: dict[str, int],
    stages: Stages,
) -> Predicted:
    """Return the first system about ``point`` with its predictor.

    Where mu is small beside what is out of balance hardly anything of the way is free: contacts
    that should open have next to no clearance, and the iterations creep along the bounds.  The
    kinks are then rounded so much more that about FREE of the way should be.
    """
    rounding = START * conditions.largest_force()

    def rounded(rounding: float) -> Predicted:
        at = conditions.centred(point, rounding)
        return predicted(conditions, at, ROUGH, factor, counts, stages)

    first = rounded(rounding)
    for _ in range(WIDENED):
        limit = first.predictor.limit
        if limit >= TIGHT:
            break
        rounding *= FREE / max(limit, FREE / WIDEST)
        first = rounded(rounding)
    return first


def corrected(
    conditions: Conditions,
    now: Predicted,
    accuracy: float,
    factor: FactorOfStep,
    stages: Stages,
) -> Iterate:
    """Return the next iterate: the predictor tells how far mu can fall, and how products bend."""
    system, predictor = now.system, now.predictor
    products, share = system.at.products, min(1.0, predictor.limit)
    left = products + share * (predictor.growth[0] + share * predictor.growth[1])
    sigma = max(0.0, left / products) ** REDUCTION
    target = sigma * products / conditions.count
    way = system.towards(target, predictor, accuracy, factor, stages)
    with stages("law"):
        return conditions.advanced(system.at, way, min(1.0, STEP_SHARE * way.limit))


def minimise_inside(
    potential: Potential,
    limits: SpringLimits,
    point: Point,
    factor: FactorOfStep,
    enough: float,
    counts: dict[str, int],
    stages: Stages,
) -> Point:
    """Return the best point that was found from ``point`` on; ``counts`` is added to.

    Ends where the potential's distance from its minimum is ``enough`` (J/m), where mu has fallen
    into round-off, or after ITERATIONS.
    """
    conditions = Conditions(potential=potential, limits=limits)
    best, distance = point, potential.distance(point)
    now = begun(conditions, point, factor, counts, stages)
    accuracy, held_up = ROUGH, False
    for left in reversed(range(ITERATIONS)):
        before = now.system.at.products
        mu = before / conditions.count
        at = corrected(conditions, now, accuracy, factor, stages)
        if at.products <= NEAR * enough or left == 0:
            with stages("law"):
                point = potential.at(at.unknowns)
                found = potential.distance(point)
            if found < distance:
                best, distance = point, found
        if distance <= enough or mu < SMALLEST * enough:
            break
        held_up, again = at.products > HELD_UP * before, held_up
        if held_up and again:
            accuracy = FINE
        now = predicted(conditions, at, accuracy, factor, counts, stages)
    return best
