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
to 30 up to p = 50 E, hardly depends on the number of blocks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clast.contact.arrays import ContactResponse, SpringLimits
from clast.equations.reuse import FactorOfStep
from clast.equations.system import BlockSystem, contact_motions, symmetric_system
from clast.kernels import interior as kernel
from clast.kernels.interior import NORMAL, SHEAR
from clast.model import Floats
from clast.stepping.potential import MOMENTUM_SHARE, Point, Potential
from clast.stepping.stages import Stages

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
ROUGH = 0.1
"""Accuracy of the predictor, and of the corrector, which begins with it."""


@dataclass(frozen=True, kw_only=True)
class Iterate:
    """Unknowns and the state of the contacts."""

    unknowns: Floats
    """d, shape (n, 6)."""
    state: Floats
    """N, w, T, T + b, b - T, w+ and w- of each contact (kernels/interior.py), shape (7, m)."""

    def moved(self, way: Iterate, share: float) -> Iterate:
        """Return the iterate ``share`` of the ``way`` on."""
        return Iterate(
            unknowns=kernel.moved(self.unknowns, way.unknowns, share),
            state=kernel.moved(self.state, way.state, share),
        )


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """The conditions above for one potential."""

    potential: Potential
    limits: SpringLimits

    @property
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
        p, k, normal_at_zero, shear_at_zero, b = self.springs
        mu = rounding**2 / (4.0 * p)
        trial = normal_at_zero - p * point.gap
        root = np.sqrt(trial**2 + rounding**2)
        normal = np.where(trial > 0.0, 0.5 * (trial + root), 2.0 * mu * p / (root - trial))
        shear = shear_at_zero - k * point.slip
        rounded = 0.5 * (np.hypot(shear + b, rounding) - np.hypot(shear - b, rounding))
        inside = np.clip(rounded, -NEARLY * b, NEARLY * b)
        on = b > 0.0
        above, below = b + inside, b - inside
        lower, upper = (mu * on / np.where(on, force, 1.0) for force in (above, below))
        state = np.stack([normal, mu / normal, inside, above, below, lower, upper])
        return Iterate(unknowns=point.unknowns, state=state)

    @cached_property
    def no_way(self) -> Iterate:
        """Staying where one is."""
        unknowns = np.zeros_like(self.potential.base.force)
        return Iterate(unknowns=unknowns, state=np.zeros((7, len(self.potential.contacts))))

    def mean_product(self, at: Iterate, way: Iterate, share: float) -> float:
        """Return mu, the mean of all products ``share`` of the ``way`` on, J/m."""
        return float(kernel.mean_product(at.state, way.state, share, self.limits.strength))


NEARLY = 1.0 - 1e-9
"""Share of the shear strength that the first shear force may reach."""


@dataclass(frozen=True, kw_only=True)
class Linearised:
    """The conditions linearised about an iterate: one matrix, several right-hand sides."""

    conditions: Conditions
    at: Iterate
    unbalanced: Floats
    """Forces out of balance, shape (n, 6)."""
    errors: tuple[Floats, Floats]
    """By how much gap and slip miss the conditions, m, shape (m,) each."""
    response: ContactResponse
    """The contacts' stiffnesses."""
    system: BlockSystem
    """The matrix."""

    def towards(
        self, target: float, before: Iterate, factor: FactorOfStep, stages: Stages
    ) -> tuple[Iterate, float]:
        """Return the way to where all products are ``target``, J/m, to first order.

        And how far it may be gone before something that is positive becomes zero.
        The bend that the way ``before`` has shown is corrected for, and where systems are solved by
        iteration it is begun from, and done where what it leaves has fallen to ROUGH of itself.
        """
        state, strength = self.at.state, self.conditions.limits.strength
        potential = self.conditions.potential
        stiffnesses = self.response.normal_stiffness, self.response.shear_stiffness
        wanted, free, loads = kernel.aimed(
            state, target, before.state, self.errors, stiffnesses, strength
        )
        load = potential.loaded(self.unbalanced, *loads)
        with stages("solve"):
            unknowns = factor.nearer(
                replace(self.system, force=load), self.response, before.unknowns, ROUGH
            )
        changes = contact_motions(potential.contacts, unknowns)
        p = self.conditions.limits.normal_stiffness
        way, limit = kernel.way_of(
            state, changes, wanted, free, self.errors, stiffnesses, p, strength
        )
        return Iterate(unknowns=unknowns, state=way), float(limit)


def linearised(conditions: Conditions, at: Iterate, stages: Stages) -> Linearised:
    """Return the conditions linearised about an iterate."""
    potential, contacts = conditions.potential, conditions.potential.contacts
    normal, shear = at.state[NORMAL], at.state[SHEAR]
    opening, slip = contact_motions(contacts, at.unknowns)
    errors, (normal_stiffness, shear_stiffness) = kernel.linearised(
        at.state, contacts.gap + opening, slip, conditions.springs
    )
    unbalanced = potential.unbalanced(at.unknowns, normal - conditions.limits.tension, shear)
    nothing = potential.at_rest.coupling
    response = ContactResponse(
        normal_force=normal,
        shear_force=shear,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
        coupling=nothing,
        mode=contacts.mode,
        bonded=contacts.bonded,
        energy=nothing,
        dissipation=nothing,
    )
    with stages("assembly"):
        system = symmetric_system(
            potential.base, contacts, response, unbalanced, potential.fixed, potential.graph
        )
    return Linearised(
        conditions=conditions,
        at=at,
        unbalanced=unbalanced,
        errors=errors,
        response=response,
        system=system,
    )


@dataclass(frozen=True, kw_only=True)
class Predicted:
    """The conditions about an iterate, and what goes to zero products from there."""

    system: Linearised
    predictor: Iterate
    limit: float
    """How far the predictor may be gone before something that is positive becomes zero."""


def predicted(
    conditions: Conditions,
    at: Iterate,
    factor: FactorOfStep,
    counts: dict[str, int],
    stages: Stages,
) -> Predicted:
    """Return the system about ``at`` with its predictor; ``counts`` is added to."""
    system = linearised(conditions, at, stages)
    counts["passes"] += 1
    predictor, limit = system.towards(0.0, conditions.no_way, factor, stages)
    return Predicted(system=system, predictor=predictor, limit=limit)


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
    first = predicted(conditions, conditions.centred(point, rounding), factor, counts, stages)
    for _ in range(WIDENED):
        if first.limit >= TIGHT:
            break
        rounding *= FREE / max(first.limit, FREE / WIDEST)
        first = predicted(conditions, conditions.centred(point, rounding), factor, counts, stages)
    return first


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
    for _ in range(ITERATIONS):
        system, predictor = now.system, now.predictor
        mu = conditions.mean_product(system.at, predictor, 0.0)
        left = conditions.mean_product(system.at, predictor, min(1.0, now.limit))
        way, limit = system.towards(mu * (left / mu) ** REDUCTION, predictor, factor, stages)
        at = system.at.moved(way, min(1.0, STEP_SHARE * limit))
        with stages("law"):
            point = potential.at(at.unknowns)
        found = potential.distance(point)
        if found < distance:
            best, distance = point, found
        if distance <= enough or mu < SMALLEST * enough:
            break
        now = predicted(conditions, at, factor, counts, stages)
    return best


SMALLEST = 1e-6
"""mu, in units of the energy that is enough, below which round-off has taken over."""
