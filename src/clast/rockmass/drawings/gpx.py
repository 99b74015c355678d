"""GPX files in: a track as a section of the ground.

Points of the ellipsoid WGS 84 are seen from above on the plane that touches it in the first one,
where lengths up to 10 km are right to 1e-6.  x is the distance from the first point along the
straight line to the last one, y the elevation.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.model.arrays import Floats
from clast.rockmass.drawings.xml_tree import Element, tree_of

EQUATOR, ECCENTRICITY = 6378137.0, 6.69437999014e-3
"""Radius at the equator, m, and the square of the eccentricity of WGS 84."""
ASIDE = 0.1
"""Distance of points beside the straight line, or back, at most, in units of its length."""
REMEDY = "record the track straight down the slope, or give a table with x, y and surface"


def section_of(path: Path) -> Floats:
    """Return the points of the track, or else of the route, of a file, m, (n, 2), x rising from 0.

    Points that lead no farther than those before them are left out.  Raises CaseError with the line
    of the fault.
    """
    root = tree_of(path)
    if root.name != "gpx":
        what = f"its root is {root.name}, not gpx"
        raise CaseError(what, where=f"{path}: line {root.line}", remedy="give a GPX file")
    marks = [*root.all("trkpt")] or [*root.all("rtept")]
    if len(marks) < 2:
        what = f"has {len(marks)} point(s) of a track or a route"
        raise CaseError(what, where=str(path), remedy="give at least 2")
    places = np.array([[*_numbers(one)] for one in marks])
    x, aside = _along_and_aside(places)
    before = np.maximum.accumulate(np.append(0.0, x[:-1]))
    for number in np.flatnonzero(np.maximum(np.abs(aside), before - x) > ASIDE * x[-1])[:1]:
        what = (
            f"is {abs(aside[number]):.3g} m beside the straight line from the first point to the "
            f"last, and {max(0.0, before[number] - x[number]):.3g} m back: no section"
        )
        raise marks[number].fault(what, REMEDY)
    farther = np.append(True, x[1:] > before[1:])
    return np.stack([x, places[:, 2]], axis=1)[farther]


def _numbers(mark: Element) -> Iterator[float]:
    """Give latitude and longitude, degrees, and elevation, m, of a point."""
    for key, limit in (("lat", 90.0), ("lon", 180.0)):
        if key not in mark.attributes:
            raise mark.fault(f"has no {key}", "give its latitude lat and longitude lon, degrees")
        value = mark.number(mark.attributes[key], key)
        if abs(value) > limit:
            what = f"{key} is {value:g}"
            raise mark.fault(what, f"give degrees, from {-limit:g} to {limit:g}")
        yield value
    height = mark.first("ele")
    if height is None:
        remedy = "add elevations to the track, e.g. with the terrain model of a map service"
        raise mark.fault("has no elevation", remedy)
    value = height.number(height.text, "the elevation")
    if abs(value) > 1e4:
        raise height.fault(f"is {value:g}", "give metres above the sea")
    yield value


def _along_and_aside(places: Floats) -> tuple[Floats, Floats]:
    """Return places (n, 3) along the line from the first to the last, and to its left, m, (n,)."""
    lat, lon = np.radians(places[:, 0]), np.radians(places[:, 1] - places[0, 1])
    radius = EQUATOR / np.sqrt(1.0 - ECCENTRICITY * np.sin(lat) ** 2)
    out, east = radius * np.cos(lat) * np.cos(lon), radius * np.cos(lat) * np.sin(lon)
    up = (1.0 - ECCENTRICITY) * radius * np.sin(lat)
    north = np.cos(lat[0]) * (up - up[0]) - np.sin(lat[0]) * (out - out[0])
    length = float(np.hypot(east[-1], north[-1]))
    if length == 0.0:
        return np.zeros(len(places)), np.hypot(east, north)
    a, b = east[-1] / length, north[-1] / length
    return a * east + b * north, a * north - b * east
