"""Strength of the section of a lining: the normal forces and moments that it can carry.

A rectangular section of thickness t that has yielded throughout, over a part c of it in compression
f_c and over the rest in tension f_t, carries

    N = f_t (t - c) - f_c c,    M = (f_c + f_t) c (t - c)/2,    0 <= c <= t

(N positive in tension): a parabola over N, and its mirror image below.  Without tension it is that
of plain concrete, N = -f_c (t - 2 e) with the eccentricity e = M/|N| (EN 1992-1-1, 12.6.1).  A
polygon with its corners on the curve stands for it, on the safe side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.model.model import Floats

STEEP = 0.02
"""Moment, in units of the largest, below which the curve is near one of its ends."""
CORNERS = 33
"""Corners of the polygon on each side, denser towards its ends: 64 sides in all."""


@dataclass(frozen=True, kw_only=True)
class InteractionCurve:
    """The upper half of the polygon of normal force and moment; the lower is its mirror image."""

    normal: Floats
    """Normal force of its corners, ascending, tension positive, N/m, shape (c,)."""
    moment: Floats
    """Moment of each, N, shape (c,)."""

    @property
    def largest(self) -> float:
        """Largest moment of the section, N."""
        return float(self.moment.max())

    def moment_at(self, normal: Floats) -> Floats:
        """Return the largest moments (k,), N, of the section under normal forces (k,), N/m."""
        return np.asarray(np.interp(normal, self.normal, self.moment))

    def utilisation(self, normal: Floats, moment: Floats) -> Floats:
        """Return the share of the strength that is used, 1 on the curve, shape (k,).

        The moment over that which the section carries with this normal force, or the normal force
        over that which it carries without a moment, whichever is more.
        """
        least, most = self.normal[0], self.normal[-1]
        pressed = np.where(normal < 0.0, normal / least, 0.0)
        pulled = np.where(normal > 0.0, normal / max(most, np.finfo(float).tiny), 0.0)
        # at its ends the curve is steep, and the normal force says how near it is
        carries = np.maximum(self.moment_at(normal), STEEP * self.largest)
        return np.maximum(np.abs(moment) / carries, np.maximum(pressed, pulled))


def interaction_curve(thickness: float, tension: float, compression: float) -> InteractionCurve:
    """Return the curve of a rectangular section, m, with strengths in Pa, all above 0."""
    pressed = 0.5 * thickness * (1.0 + np.cos(np.linspace(0.0, np.pi, CORNERS)))
    pulled = thickness - pressed
    return InteractionCurve(
        normal=tension * pulled - compression * pressed,
        moment=0.5 * (tension + compression) * pressed * pulled,
    )


def edge_stress(normal: Floats, moment: Floats, thickness: float) -> Floats:
    """Return the largest elastic stress at the two faces, N/t + 6 |M|/t^2, Pa, shape (k,)."""
    return np.asarray(normal / thickness + 6.0 * np.abs(moment) / thickness**2)
