"""Rough joints after Barton and Bandis: closure, strength, and their mobilisation by sliding.

Closure under the normal stress sigma is a hyperbola (Bandis, Lumsden & Barton 1983)

    sigma = k_ni u/(1 - u/V_m)        tangent k_ni (1 + sigma/(k_ni V_m))^2

and a step takes its tangent at the stress that the last one ended with: a spring that begins at the
closure u^2/V_m.  A tangent at a stress holds for whatever load; one at a closure might be beyond
V_m.  Friction follows the roughness (Barton & Choubey 1977), i never above 70 degrees less phi_r,

    |T| <= N tan(phi_r + m(x) i)        i = JRC log10(JCS/sigma)        x = slid/u_peak

with m(x) = JRC_mob/JRC by the table of Barton, Bandis & Bakhtar (1985).  It rises from no friction
at x = 0 to the peak at x = 1: there the shear spring is a chord of this curve, which slips as the
load asks.  Unloaded, it is the spring of its joint or of the law.  Beyond the peak strength is that
of the start of the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.contact.contacts import SLIDE, Places
from clast.model.joints import MOBILISED, JointTable
from clast.model.model import Bools, Floats, Ints

STEEPEST = np.radians(70.0)
"""Largest friction angle, rad (Barton 1976)."""
CURVE_TOLERANCE = 1e-9
"""Share of the strength by which a shear force may be below it and still be on the curve."""
CLOSURE_MIN = 1e-8
"""Closure that is none, in units of the slip at the peak: forces by rounding mobilise nothing."""
SLIDING_CURVE_TOLERANCE = 0.1
"""The same of a contact that went along the curve in the last step."""
BISECTIONS = 50
"""Halvings of the range of a stress that is sought."""


@dataclass(frozen=True)
class RoughContacts:
    """Rough contacts and the numbers of their joints, shape (k,) each."""

    rows: Ints | slice
    """Which of the contacts they are."""
    jrc: Floats
    jcs: Floats
    residual: Floats
    peak_slip: Floats
    stiffness: Floats
    closure: Floats
    reduction: Floats

    def closed_by(self, stress: Floats) -> Floats:
        """Return the closure u under a normal stress, Pa, m, shape (k,)."""
        return stress * self.closure / (self.stiffness * self.closure + stress)

    def tangent(self, stress: Floats) -> Floats:
        """Return the normal stiffness under a normal stress, Pa, Pa/m, shape (k,)."""
        return self.stiffness * (1.0 + stress / (self.stiffness * self.closure)) ** 2

    def energy(self, stress: Floats) -> Floats:
        """Return the work of closing to a normal stress, Pa, J/m2, shape (k,)."""
        most = self.stiffness * self.closure
        share = stress / most
        return most * self.closure * (np.log1p(share) - share / (1.0 + share))

    def stress_at(self, closure: Floats) -> Floats:
        """Return the normal stress, Pa, at a closure, m, (k,): 0 to inf."""
        left = 1.0 - closure / self.closure
        with np.errstate(divide="ignore"):
            stress = self.stiffness * np.maximum(closure, 0.0) / np.maximum(left, 0.0)
        return np.asarray(stress)

    def stress_with(self, energy: Floats, least: Floats, most: Floats) -> Floats:
        """Return the normal stress, Pa, up to which closing takes an ``energy``, J/m2, (k,).

        Between two others, Pa; the work up to the ``least`` is no more.
        """
        low, high = least, np.minimum(most, 2.0 * np.maximum(least, self.stiffness * self.closure))
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            is_less = self.energy(middle) <= energy
            low, high = np.where(is_less, middle, low), np.where(is_less, high, middle)
        return low

    def roughness_angle(self, stress: Floats) -> Floats:
        """Return i = JRC log10(JCS/sigma), 0 to 70 degrees less phi_r, rad, shape (k,)."""
        with np.errstate(divide="ignore"):
            angle = np.radians(self.jrc * np.log10(self.jcs / stress))
        return np.clip(angle, 0.0, np.maximum(0.0, STEEPEST - self.residual))

    def friction(self, slid: Floats, angle: Floats) -> Floats:
        """Return tan(phi) mobilised, (k,), after sliding so far, m; ``angle`` (k,) is i, rad."""
        x, first = slid / self.peak_slip, MOBILISED[0, 0]
        mobilised_angle = self.residual * np.minimum(1.0, x / first) + mobilised(x) * angle
        return np.tan(mobilised_angle) / self.reduction

    def slide_to_mobilise(self, ratio: Floats, angle: Floats) -> Floats:
        """Return after which slide, up to that at the peak, tan(phi) is a ``ratio`` (k,), m, (k,).

        To 1 % of that at the peak, from above.
        """
        slid = np.zeros(len(ratio))
        for share in np.linspace(0.0, 1.0, 101)[:-1]:
            less = self.friction(share * self.peak_slip, angle) < ratio
            slid = np.where(less, (share + 0.01) * self.peak_slip, slid)
        return slid


def mobilised(x: Floats) -> Floats:
    """Return JRC_mob/JRC, not below 0, at slips x, in units of that at the peak, shape (k,)."""
    return np.asarray(np.interp(x, *MOBILISED))


def rough_contacts(table: JointTable, joint: Ints) -> RoughContacts | None:
    """Return those of contacts along ``joint`` (m,) that are rough, None where none is."""
    rough = table.rough.take(joint)
    if not rough.any():
        return None
    rows = slice(None) if rough.all() else np.flatnonzero(rough)
    of, which = table.roughness, joint[rows]
    numbers = of.jrc, of.jcs, of.residual, of.peak_slip, of.stiffness, of.closure, of.reduction
    return RoughContacts(rows, *(one.take(which) for one in numbers))


def stress_on(normal: Floats, length: Floats) -> Floats:
    """Return the normal stress, Pa, (k,): force, N/m, over length, m; inf where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(normal > 0.0, normal / length, 0.0)


def with_roughness(
    table: JointTable, places: Places, slid: Floats, contacts: dict[str, Any]
) -> dict[str, Any]:
    """Return contacts with the springs and the friction that roughness gives them in a step.

    ``contacts`` are the numbers known of them by name, (m,) each, ``slid`` (m,) is how far they
    have slid, m.
    """
    rough = rough_contacts(table, places.joint)
    if rough is None:
        return contacts
    rows = rough.rows
    normal, shear = contacts["normal_force"][rows], contacts["shear_force"][rows]
    changed = {
        name: contacts[name].copy()
        for name in ("rest_gap", "normal_stiffness", "shear_stiffness", "shear_force", "friction")
    }
    length = places.spring_length[rows]
    changed["rest_gap"][rows] += begins_at(rough, normal, contacts["rest_force"][rows], length)
    stiffness = length * rough.tangent(stress_on(normal, length))
    changed["normal_stiffness"][rows] = stiffness
    angle = rough.roughness_angle(stress_on(normal, length))
    slide = slid[rows]
    now = rough.friction(slide, angle)
    peak = rough.friction(rough.peak_slip, angle)
    # Slip ahead, in units of that at the peak, to where the spring meets the curve
    ahead = np.minimum(0.02 * rough.peak_slip, rough.peak_slip - slide)
    # Share of phi_r by which friction has to rise in one u_peak for there to be a curve to follow
    rises = (ahead > 0.0) & (peak - now > 1e-6)
    bound, size = np.maximum(normal, 0.0) * now, np.abs(shear)
    went = (contacts["mode"][rows] == SLIDE) & (size >= (1.0 - SLIDING_CURVE_TOLERANCE) * bound)
    carries = normal > CLOSURE_MIN * stiffness * rough.peak_slip
    follows = rises & carries & (went | (size >= (1.0 - CURVE_TOLERANCE) * bound))
    begun = np.minimum(size, bound)
    ahead = np.where(rises, ahead, 1.0)
    along = (normal * rough.friction(slide + ahead, angle) - begun) / ahead
    follows &= along > 0.0
    own = changed["shear_stiffness"][rows]
    changed["shear_stiffness"][rows] = np.where(follows, along, own)
    changed["shear_force"][rows] = np.where(follows, np.copysign(begun, shear), shear)
    changed["friction"][rows] = np.where(rises, peak, now)
    follows_all: Bools = np.zeros(len(places.joint), np.bool_)
    follows_all[rows] = follows
    return {**contacts, **changed, "mobilises": follows_all}


def begins_at(rough: RoughContacts, normal: Floats, rest: Floats, length: Floats) -> Floats:
    """Return the opening, m, (k,), at which the tangents of closure carry no more than ``rest``.

    ``normal`` are the forces of the last step, ``rest`` those at zero gap, N/m, ``length``, m, that
    of the springs.
    """
    stress, at_rest = stress_on(normal, length), rest / length
    begun = rough.closed_by(stress) ** 2 / rough.closure
    return rough.closed_by(at_rest) - at_rest / rough.tangent(stress) - begun
