"""The stress that is in the rock before anything is dug."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from clast.errors import ModelError

Floats = NDArray[np.float64]

SIDES = ("left", "right", "bottom", "top")
"""Sides of the box around all blocks."""


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
    """Share of the stress that contacts bear at the start: 1, or 0 where they are to find it."""
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


@dataclass(frozen=True, kw_only=True)
class Overburden:
    """The stress of the rock's own weight: rho g z down and k0 rho g z across, compression."""

    k0: float
    """Horizontal by vertical stress."""
    datum: float | None = None
    """Height y of the ground surface, m; None: the highest point of all blocks."""
    in_contacts: float = 1.0
    """As InSituStress has it."""
    held: tuple[float, float] = (1.0, 0.0)
    """As InSituStress has it."""
    sides: tuple[str, ...] = ()
    """As InSituStress has it."""

    def stress(self, density: float, gravity: Floats, top: float) -> InSituStress:
        """Return the stress for a mean density, kg/m3, gravity (x, y), m/s2, and a top, m."""
        if gravity[0] != 0.0 or gravity[1] >= 0.0:
            raise ModelError(
                f"gravity is [{gravity[0]:g}, {gravity[1]:g}], not downwards",
                where="in_situ, vertical",
                remedy="give stress and gradient instead of the overburden",
            )
        if self.datum is not None and self.datum < top:
            raise ModelError(
                f"{self.datum:g} m is below the highest block, {top:g} m: the rock above it would "
                "be in tension",
                where="in_situ, datum",
                remedy="give the height y of the ground surface, or leave it out",
            )
        vertical = density * float(gravity[1])
        return InSituStress(
            stress=(0.0, 0.0, 0.0),
            gradient=(self.k0 * vertical, vertical, 0.0),
            datum=top if self.datum is None else self.datum,
            in_contacts=self.in_contacts,
            held=self.held,
            sides=self.sides,
        )


def check_in_situ(given: InSituStress) -> None:
    """Raise ModelError for a stress that is none."""
    where = "in_situ"
    for key in ("stress", "gradient"):
        values = getattr(given, key)
        if len(values) != 3 or not np.isfinite(values).all():
            raise ModelError(
                f"{values} is no stress",
                where=f"{where}, {key}",
                remedy="give three finite numbers (xx, yy, xy), in Pa, or Pa by metre of depth",
            )
    if not np.isfinite(given.datum):
        raise ModelError("is not finite", where=f"{where}, datum", remedy="give a height in m")
    for side in given.sides:
        if side not in SIDES:
            raise ModelError(
                f"there is no side '{side}'",
                where=f"{where}, sides",
                remedy=f"the sides are {', '.join(SIDES)}",
            )


def stress_in_situ(
    given: InSituStress | Overburden | None, mass: Floats, area: Floats, gravity: Floats, top: float
) -> InSituStress | None:
    """Return the stress before anything is dug, checked; that of the weight by the mean density.

    ``mass``, kg/m, and ``area``, m2, are those of the blocks (n,), ``gravity`` (2,) in m/s2,
    ``top`` is their highest point, m.
    """
    if isinstance(given, Overburden):
        given = given.stress(float(mass.sum() / area.sum()), gravity, top)
    if given is not None:
        check_in_situ(given)
    return given
