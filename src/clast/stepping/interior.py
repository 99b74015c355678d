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
to 27, hardly depends on the number of blocks or on the stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clast.contact.arrays import ContactResponse, SpringLimits
from clast.equations.reuse import FactorOfStep
from clast.equations.system import BlockSystem, contact_motions, symmetric_system
from clast.model import Floats
from clast.stepping.potential import Point, Potential
from clast.stepping.stages import Stages

START = 0.1
"""Force at which the kinks are rounded to begin with, in units of the largest force on a block."""
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
    """Unknowns and multipliers; all but ``unknowns`` and ``shear`` are positive, shape (m,).

    Contacts without shear strength have zeros in place of all that belongs to shear.
    """

    unknowns: Floats
    """d, shape (n, 6)."""
    normal: Floats
    """Normal force above the tension of the bond, N/m."""
    clearance: Floats
    """w, m."""
    shear: Floats
    """Shear force T, N/m, between -b and b."""
    above: Floats
    """T + b, N/m, kept beside T so that it does not end in round-off."""
    below: Floats
    """b - T, N/m."""
    lower: Floats
    """w+, the slip beyond the lower bound of the shear force, m."""
    upper: Floats
    """w-, the slip beyond the upper bound, m."""

    def moved(self, way: Iterate, share: float) -> Iterate:
        """Return the iterate ``share`` of the ``way`` on."""
        return Iterate(
            **{name: one + share * getattr(way, name) for name, one in vars(self).items()}
        )


@dataclass(frozen=True, kw_only=True)
class Products:
    """N w, (T + b) w+ and (b - T) w-, J/m, shape (m,) each; without strength the last two are 0."""

    normal: Floats
    lower: Floats
    upper: Floats

    def mean(self, frictional: np.ndarray) -> float:
        """Return mu, the mean of all products, J/m."""
        total = self.normal.sum() + self.lower.sum() + self.upper.sum()
        return float(total) / (len(self.normal) + 2 * int(frictional.sum()))


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """The conditions above for one potential."""

    potential: Potential
    limits: SpringLimits

    @property
    def frictional(self) -> np.ndarray:
        """True for contacts that have any shear strength, shape (m,)."""
        return self.limits.strength > 0.0

    def centred(self, point: Point) -> Iterate:
        """Return the iterate at ``point`` whose normal products are all the same."""
        forces = self.potential.base.force - self.potential.momentum
        limits, contacts = self.limits, self.potential.contacts
        p, k, b = limits.normal_stiffness, limits.shear_stiffness, limits.strength
        rounding = START * float(np.abs(forces[:, :2]).max())
        mu = rounding**2 / (4.0 * p)
        trial = contacts.multiplier + limits.tension - p * point.gap
        root = np.sqrt(trial**2 + rounding**2)
        normal = np.where(trial > 0.0, 0.5 * (trial + root), 2.0 * mu * p / (root - trial))
        shear = contacts.shear_force - k * point.slip
        rounded = 0.5 * (np.hypot(shear + b, rounding) - np.hypot(shear - b, rounding))
        inside = np.clip(rounded, -NEARLY * b, NEARLY * b)
        return Iterate(
            unknowns=point.unknowns,
            normal=normal,
            clearance=mu / normal,
            shear=inside,
            above=b + inside,
            below=b - inside,
            lower=self.where_frictional(mu, b + inside),
            upper=self.where_frictional(mu, b - inside),
        )

    def products(self, at: Iterate) -> Products:
        """Return the products that are to become zero."""
        return Products(
            normal=at.normal * at.clearance,
            lower=at.above * at.lower,
            upper=at.below * at.upper,
        )

    def length(self, at: Iterate, way: Iterate) -> float:
        """Return how far ``way`` may be gone before something that is positive becomes zero."""
        on = self.frictional
        limit = np.inf
        for value, change in (
            (at.normal, way.normal),
            (at.clearance, way.clearance),
            (at.above[on], way.above[on]),
            (at.below[on], way.below[on]),
            (at.lower[on], way.lower[on]),
            (at.upper[on], way.upper[on]),
        ):
            falling = change < 0.0
            limit = min(limit, float((-value[falling] / change[falling]).min(initial=np.inf)))
        return limit

    def where_frictional(self, above: Floats | float, below: Floats) -> Floats:
        """Return above/below for contacts with shear strength, else 0, shape (m,)."""
        on = self.frictional
        return np.where(on, above, 0.0) / np.where(on, below, 1.0)


NEARLY = 1.0 - 1e-9
"""Share of the shear strength that the first shear force may reach."""


class Linearised:
    """The conditions linearised about an iterate: one matrix, several right-hand sides."""

    def __init__(
        self, conditions: Conditions, at: Iterate, factor: FactorOfStep, stages: Stages
    ) -> None:
        self._conditions, self._at = conditions, at
        self._factor, self._stages = factor, stages
        potential, limits = conditions.potential, conditions.limits
        contacts, p, k = potential.contacts, limits.normal_stiffness, limits.shear_stiffness
        opening, slip = contact_motions(contacts, at.unknowns)
        gap = contacts.gap + opening
        self._unbalanced = potential.unbalanced(at.unknowns, at.normal - limits.tension, at.shear)
        trial = contacts.multiplier + limits.tension
        self._normal_error = (at.normal - trial) / p + gap - at.clearance
        self._shear_error = (at.shear - contacts.shear_force) / k + slip - at.lower + at.upper
        softer = conditions.where_frictional(at.lower, at.above)
        softer = softer + conditions.where_frictional(at.upper, at.below)
        self._normal_stiffness = 1.0 / (1.0 / p + at.clearance / at.normal)
        self._shear_stiffness = np.where(conditions.frictional, 1.0 / (1.0 / k + softer), 0.0)
        self._system, self._response = self._matrix()

    def towards(self, wanted: Products, guess: Floats) -> Iterate:
        """Return the way to where the products have changed by ``wanted``, to first order.

        Where systems are solved by iteration it begins with the unknowns ``guess`` (n, 6) and ends
        where what they leave has fallen to ROUGH of itself.
        """
        at, conditions = self._at, self._conditions
        p, divided = conditions.limits.normal_stiffness, conditions.where_frictional
        contacts = conditions.potential.contacts
        opening = wanted.normal / at.normal - self._normal_error
        sliding = (
            divided(wanted.lower, at.above) - divided(wanted.upper, at.below) - self._shear_error
        )
        load = conditions.potential.loaded(
            self._unbalanced, self._normal_stiffness * opening, self._shear_stiffness * sliding
        )
        with self._stages("solve"):
            unknowns = self._factor.nearer(
                replace(self._system, force=load), self._response, guess, ROUGH
            )
        gap, slip = contact_motions(contacts, unknowns)  # their changes
        normal = self._normal_stiffness * (opening - gap)
        shear = self._shear_stiffness * (sliding - slip)
        return Iterate(
            unknowns=unknowns,
            normal=normal,
            clearance=normal / p + gap + self._normal_error,
            shear=shear,
            above=shear,
            below=-shear,
            lower=divided(wanted.lower - at.lower * shear, at.above),
            upper=divided(wanted.upper + at.upper * shear, at.below),
        )

    def _matrix(self) -> tuple[BlockSystem, ContactResponse]:
        potential, at = self._conditions.potential, self._at
        nothing = np.zeros(len(potential.contacts))
        response = ContactResponse(
            normal_force=at.normal,
            shear_force=at.shear,
            normal_stiffness=self._normal_stiffness,
            shear_stiffness=self._shear_stiffness,
            coupling=nothing,
            mode=nothing.astype(np.int64),
            bonded=potential.contacts.bonded,
            energy=nothing,
            dissipation=nothing,
        )
        with self._stages("assembly"):
            system = symmetric_system(
                potential.base,
                potential.contacts,
                response,
                self._unbalanced,
                potential.fixed,
                potential.graph,
            )
        return system, response


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
    at = conditions.centred(point)
    best, distance = point, potential.distance(point)
    for _ in range(ITERATIONS):
        now = conditions.products(at)
        mu = now.mean(conditions.frictional)
        linearised = Linearised(conditions, at, factor, stages)
        counts["passes"] += 1
        predictor = linearised.towards(
            aimed(conditions, now, 0.0, None), np.zeros_like(at.unknowns)
        )
        reached = at.moved(predictor, min(1.0, conditions.length(at, predictor)))
        predicted = conditions.products(reached).mean(conditions.frictional)
        target = mu * (predicted / mu) ** REDUCTION
        way = linearised.towards(aimed(conditions, now, target, predictor), predictor.unknowns)
        at = at.moved(way, min(1.0, STEP_SHARE * conditions.length(at, way)))
        with stages("law"):
            point = potential.at(at.unknowns)
        found = potential.distance(point)
        if found < distance:
            best, distance = point, found
        if distance <= enough or mu < SMALLEST * enough:
            break
    return best


SMALLEST = 1e-6
"""mu, in units of the energy that is enough, below which round-off has taken over."""


def aimed(
    conditions: Conditions, now: Products, target: float, predictor: Iterate | None
) -> Products:
    """Return the change of the products to ``target``, J/m, corrected for the predictor's bend."""
    on = np.where(conditions.frictional, target, 0.0)
    if predictor is None:
        return Products(normal=target - now.normal, lower=on - now.lower, upper=on - now.upper)
    return Products(
        normal=target - now.normal - predictor.normal * predictor.clearance,
        lower=on - now.lower - predictor.shear * predictor.lower,
        upper=on - now.upper + predictor.shear * predictor.upper,
    )
