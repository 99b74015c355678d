"""Closed outlines as users give them: checked, counter-clockwise, each corner once."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.model import Bools, Floats

Points = Sequence[Sequence[float]] | Floats
"""Points (k, 2), m."""

STRAIGHT = 1e-13
"""Corners that lie this near to a straight line, as a share of the outline's size, are none."""


@dataclass(frozen=True, kw_only=True)
class Outline:
    """A simple closed outline."""

    corners: Floats
    """Corners, counter-clockwise, each once, m, shape (k, 2)."""
    turned: bool
    """Whether it was given clockwise."""

    @property
    def edges(self) -> Floats:
        """Its edges, m, shape (k, 2, 2)."""
        return np.stack([self.corners, np.roll(self.corners, -1, axis=0)], axis=1)

    def polygon(self, origin: Floats) -> Any:
        """Return it as a shapely polygon about an origin (2,), m."""
        return shapely.polygons(self.corners - origin)


def points_of(points: Any, where: str, least: int) -> Floats:
    """Return points as an array (k, 2), m; ModelError where they are fewer, or no numbers."""
    try:
        array = np.array(points, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.zeros(0)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < least:
        raise ModelError(
            f"{shortened(repr(points))} is not a list of at least {least} points (x, y)",
            where=where,
            remedy="give them as [[x, y], [x, y], ...], in m",
        )
    for k in np.flatnonzero(~np.isfinite(array).all(axis=1))[:1]:
        raise ModelError(
            f"point {k + 1}, ({array[k, 0]}, {array[k, 1]}), is not finite",
            where=where,
            remedy="give finite coordinates, in m",
        )
    ranges.check_size(float(np.abs(array).max()), ranges.COORDINATE, where, "give coordinates in m")
    return array


def outline(points: Any, where: str) -> Outline:
    """Return a closed outline, counter-clockwise; the last point may repeat the first.

    ModelError where it has no area, or crosses or touches itself.
    """
    corners = points_of(points, where, 3)
    size = float(np.hypot(*np.ptp(corners, axis=0)))
    apart = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T) > STRAIGHT * size
    corners = corners[apart]
    if len(corners) >= 3:
        corners = corners[~_straight(corners, size)]
    middle = corners.mean(axis=0) if len(corners) else np.zeros(2)
    polygon = shapely.Polygon(corners - middle) if len(corners) >= 3 else shapely.Polygon()
    if not shapely.is_valid(polygon):
        raise ModelError(
            f"crosses or touches itself{_place(polygon, middle)}",
            where=where,
            remedy="order the points along the outline, each once",
        )
    if polygon.area <= 1e-12 * size**2:
        raise ModelError(
            f"has no area ({polygon.area:.3g} m2)",
            where=where,
            remedy="give at least 3 points that span an area",
        )
    turned = not shapely.is_ccw(polygon.exterior)
    return Outline(corners=corners[::-1].copy() if turned else corners, turned=turned)


def _straight(corners: Floats, size: float) -> Bools:
    """Return True for corners between their neighbours on a straight line, shape (k,)."""
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    one, other = corners - before, after - corners
    cross = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    chord = np.maximum(np.hypot(*(after - before).T), STRAIGHT * size)
    straight: Bools = (cross <= STRAIGHT * size * chord) & ((one * other).sum(axis=1) > 0.0)
    return straight


def _place(polygon: Any, middle: Floats) -> str:
    """Return where a polygon crosses itself, as words."""
    found = re.search(r"\[(\S+) (\S+)\]", str(shapely.is_valid_reason(polygon)))
    if found is None:
        return ""
    x, y = float(found[1]) + middle[0], float(found[2]) + middle[1]
    return f" at ({x:.9g}, {y:.9g})"
