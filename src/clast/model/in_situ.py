"""The stress that is in the rock before anything is dug."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class InSituStress:
    """Stress as a function of depth: stress + gradient x (datum - y).

    Blocks begin with the stress at their centroids, and contacts with the forces that belong to it.
    The outline of the system is loaded by the stress, and held beside that by springs.
    """

    stress: tuple[float, float, float]
    """Stress (xx, yy, xy) at the datum, Pa, tension positive."""
    gradient: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Its change by metre of depth, Pa/m."""
    datum: float = 0.0
    """Height y at which ``stress`` holds, m, in the coordinates of the case."""
    in_contacts: float = 1.0
    """Share of the stress that contacts carry at the start: 1, or 0 where they are to find it."""
    held: tuple[float, float] = (1.0, 0.0)
    """Springs of the outline along its normal and along itself, in units of those of fixed points.

    (1, 0) are rollers, (1, 1) hold it altogether, (0, 0) leave it to the stress alone.
    """
    sides: tuple[str, ...] = ()
    """Sides of the box around all blocks that are loaded; empty: the convex hull, and the notches
    within it where the stress at the top of the model says that it lies at depth."""
    voids: tuple[int, ...] = ()
    """Edges of openings that are there from the start, by their first vertices: these are free."""

    def at(self, y: Floats) -> Floats:
        """Return the stress (xx, yy, xy) at heights y (k,), m, in Pa, shape (k, 3)."""
        depth = self.datum - np.asarray(y, float)
        return np.asarray(self.stress) + depth[:, None] * np.asarray(self.gradient)
