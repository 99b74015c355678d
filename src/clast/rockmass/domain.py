"""The domain to cut: its boundary, its regions of rock, its openings, and lines drawn by hand."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.model import Floats


@dataclass(frozen=True, kw_only=True)
class Domain:
    """The rock mass that is cut into blocks.

    A clockwise ``boundary`` is turned round, and the report says so.
    """

    boundary: Any
    """Corners of its outline, m, shape (k, 2)."""
    rock: str = "rock"
    """Rock of all blocks that lie in no region."""
    tolerance: float | None = None
    """Grid to which all lines are rounded, m; None: the power of ten below 1e-6 x the diagonal."""
    smallest_edge: float | None = None
    """Shorter edges are collapsed, m; None: 0.01 x the median spacing of the sets, and not more
    than half the root of ``smallest_block``."""
    smallest_block: float | None = None
    """Smaller blocks are merged, m2; None: (2 x ``smallest_edge``)^2."""
    most_blocks: int = 200_000
    """More blocks are refused before anything is cut."""
    section_azimuth: float | None = None
    """Direction of +x, degrees clockwise from north; needed by dip and dip_direction."""

    def outline(self) -> Outline:
        """Return its outline, counter-clockwise; ModelError where it crosses itself."""
        return outline(self.boundary, "domain, boundary")

    def grid(self) -> float:
        """Return the tolerance, m; ModelError where it is out of all proportion."""
        diagonal = float(np.hypot(*np.ptp(self.outline().corners, axis=0)))
        if self.tolerance is None:
            # A power of ten leaves coordinates with few decimals what they are.
            return 10.0 ** math.floor(math.log10(1e-6 * diagonal) + 1e-9)
        share = _number(self.tolerance, "domain, tolerance") / diagonal
        # Finer ones would leave areas that are no exact whole numbers.
        if not 1e-8 <= share <= 1e-3:
            raise ModelError(
                f"{self.tolerance:g} m is {share:.3g} times the diagonal of the domain",
                where="domain, tolerance",
                remedy=f"give {1e-8 * diagonal:.3g} to {1e-3 * diagonal:.3g} m, or leave it "
                f"out for {1e-6 * diagonal:.3g} m",
            )
        return float(self.tolerance)

    def check(self) -> None:
        """Refuse numbers that a domain cannot have."""
        for key in ("smallest_edge", "smallest_block"):
            value = getattr(self, key)
            if value is not None and not 0.0 <= _number(value, f"domain, {key}"):
                raise ModelError(
                    f"{value:g} is below 0", where=f"domain, {key}", remedy="give 0 or more"
                )
        if self.section_azimuth is not None:
            _number(self.section_azimuth, "domain, section_azimuth")
        if not _number(self.most_blocks, "domain, most_blocks") >= 1:
            what = f"{self.most_blocks} is not a valid number of blocks"
            raise ModelError(what, where="domain, most_blocks", remedy="give 1 or more")


def _number(value: Any, where: str) -> float:
    """Return a finite number; ModelError where it is none."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ModelError(f"{value!r} is not a finite number", where=where, remedy="give SI units")
    return number


@dataclass(frozen=True, kw_only=True)
class Region:
    """Rock by place: a block is of the region in which most of it lies.

    The outline is not a joint unless ``joint`` names one; then it is cut, too.
    """

    name: str
    """Name, to which ``JointSet.within`` may refer."""
    polygon: Any
    """Corners, m, shape (k, 2)."""
    rock: str | None = None
    """Rock of its blocks; None: that of the domain."""
    joint: str | None = None
    """Joint along its outline; None: the outline is not cut."""
    one_block: bool = False
    """True: no line crosses it, so that it is one block: a lintel, a boulder.  Its outline is cut,
    with the joint of the pair of blocks, the rocks, or the default where ``joint`` is None."""

    @property
    def where(self) -> str:
        """How messages call it."""
        return f"region '{self.name}'"

    @property
    def cut(self) -> bool:
        """Whether its outline is cut."""
        return self.one_block or self.joint is not None

    def outline(self) -> Outline:
        """Return its outline, counter-clockwise."""
        return outline(self.polygon, f"{self.where}, polygon")


@dataclass(frozen=True, kw_only=True)
class Trace:
    """A joint as it was drawn: a polyline."""

    points: Any
    """Its points in order, m, shape (k, 2)."""
    joint: str | None = None
    """Joint along it; None: that of the pair of blocks, the rocks, or the default."""
    set: str = "traces"
    """Set that it is counted with, and that other sets may end at."""

    def pieces(self, where: str) -> Floats:
        """Return its straight pieces, m, shape (k - 1, 2, 2)."""
        points = points_of(self.points, where, 2)
        return np.stack([points[:-1], points[1:]], axis=1)


def _positive(value: Any, where: str) -> float:
    number = _number(value, where)
    if number <= 0.0:
        raise ModelError(f"{number:g} must be above 0", where=where, remedy="give m")
    ranges.check_size(number, ranges.LENGTH, where, "give m")
    return number


CHORDS_MAX = 10_000
"""Most straight edges of a circle."""


def _chords(value: int, where: str, least: int) -> int:
    if not isinstance(value, int | np.integer) or not least <= value <= CHORDS_MAX:
        remedy = f"give {least} to {CHORDS_MAX}"
        raise ModelError(f"{value!r} is not a valid number of chords", where=where, remedy=remedy)
    return int(value)


def _pair(value: Any, where: str) -> Floats:
    return points_of([value], where, 1)[0]


@dataclass(frozen=True, kw_only=True)
class Circle:
    """A circle as a polygon of equal area.

    A polygon of n chords has the area n/2 r^2 sin(2 pi/n); its corners lie at
    r sqrt(2 pi/(n sin(2 pi/n))), so that it has the area of the circle of radius r.
    """

    center: Any
    """Centre, m, shape (2,)."""
    radius: float
    """Radius of the circle of the same area, m."""
    chords: int = 32
    """Number of straight edges."""

    def corners(self, where: str) -> Floats:
        """Return its corners, m, shape (chords, 2)."""
        count = _chords(self.chords, f"{where}, chords", 3)
        radius = _positive(self.radius, f"{where}, radius")
        radius *= math.sqrt(2.0 * math.pi / (count * math.sin(2.0 * math.pi / count)))
        angle = 2.0 * math.pi * np.arange(count) / count
        return _pair(self.center, f"{where}, center") + radius * np.stack(
            [np.cos(angle), np.sin(angle)], axis=1
        )


@dataclass(frozen=True, kw_only=True)
class Horseshoe:
    """Straight walls under half a circle, whose chords leave the area of the half circle."""

    center: Any
    """Middle of the floor, m, shape (2,)."""
    width: float
    """Width of the floor, m."""
    wall_height: float
    """Height of the walls, m."""
    chords: int = 16
    """Straight edges of the roof."""

    def corners(self, where: str) -> Floats:
        """Return its corners, m, shape (chords + 3, 2)."""
        count = _chords(self.chords, f"{where}, chords", 2)
        half = 0.5 * _positive(self.width, f"{where}, width")
        wall = _positive(self.wall_height, f"{where}, wall_height")
        angle = math.pi * np.arange(1, count) / count
        # Springings stay on the walls; the other corners move out until the areas are equal:
        # the two outer triangles are r R/2 sin a each, the others R^2/2 sin a.
        turn = math.sin(math.pi / count)
        a, b, c = 0.5 * (count - 2) * turn, half * turn, -0.5 * math.pi * half**2
        radius = -c / b if a == 0.0 else (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
        roof = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1) + [0.0, wall]
        sides = np.array([[-half, 0.0], [half, 0.0], [half, wall]])
        return _pair(self.center, f"{where}, center") + np.concatenate(
            [sides, roof, [[-half, wall]]]
        )


@dataclass(frozen=True, kw_only=True)
class Box:
    """A rectangle."""

    corner: Any
    """Lower left corner, m, shape (2,)."""
    size: Any
    """Width and height, m, shape (2,)."""

    def corners(self, where: str) -> Floats:
        """Return its corners, m, shape (4, 2)."""
        size = _pair(self.size, f"{where}, size")
        width, height = (_positive(value, f"{where}, size") for value in size)
        low = _pair(self.corner, f"{where}, corner")
        return low + np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])


@dataclass(frozen=True, kw_only=True)
class Polygon:
    """Any simple outline."""

    points: Any
    """Corners, m, shape (k, 2)."""

    def corners(self, where: str) -> Floats:
        """Return its corners, m, shape (k, 2)."""
        return points_of(self.points, f"{where}, points", 3)


@dataclass(frozen=True, kw_only=True)
class Opening:
    """A void from the start, or rock until a stage excavates it."""

    name: str
    """Name."""
    shape: Circle | Horseshoe | Box | Polygon
    excavated: bool = False
    """True: void from the start; its outline is cut."""
    construction_joint: bool = True
    """True: the outline is cut, and welded until it is excavated.  False: it is not cut, and the
    opening has the blocks that lie in it for the most part."""

    @property
    def where(self) -> str:
        """How messages call it."""
        return f"opening '{self.name}'"

    @property
    def cut(self) -> bool:
        """Whether its outline is cut."""
        return self.excavated or self.construction_joint

    def outline(self) -> Outline:
        """Return its outline, counter-clockwise; ModelError where it crosses itself."""
        return outline(self.shape.corners(self.where), self.where)


STRAIGHT = 1e-13
"""Corners that lie this near to a straight line, over the outline's size, are none."""


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
        what = f"{shortened(repr(points))} is not a list of at least {least} points (x, y)"
        raise ModelError(what, where=where, remedy="give them as [[x, y], [x, y], ...], in m")
    for k in np.flatnonzero(~np.isfinite(array).all(axis=1))[:1]:
        what = f"point {k + 1}, ({array[k, 0]}, {array[k, 1]}), is not finite"
        raise ModelError(what, where=where, remedy="give finite coordinates, in m")
    ranges.check_size(float(np.abs(array).max()), ranges.COORDINATE, where, "give coordinates in m")
    return array


def profile_outline(points: Any, depth: float, sides: tuple[float, float] = (0.0, 0.0)) -> Floats:
    """Return the outline (k, 2), m, counter-clockwise, of the ground below a profile (n, 2), m.

    The profile is an open line from side to side, in either direction; overhangs are allowed.  The
    bottom is level, ``depth`` below its lowest point, m; the ground goes on, level, by ``sides``
    left and right of its ends, m.  ModelError where no ground lies between the sides.
    """
    where, surface = "domain, profile", points_of(points, "domain, profile", 2)
    if surface[0, 0] > surface[-1, 0]:
        surface = surface[::-1]
    left, right = float(surface[0, 0] - sides[0]), float(surface[-1, 0] + sides[1])
    for k in np.flatnonzero((surface[:, 0] < left) | (surface[:, 0] > right))[:1]:
        x, y = surface[k]
        what = f"({x:.9g}, {y:.9g}) lies beyond the sides of the model, x = {left:g} and {right:g}"
        remedy = "begin and end it at the sides, where the ground goes on, or give larger sides"
        raise ModelError(what, where=where, remedy=remedy)
    if not depth > 0.0:
        raise ModelError(f"{depth} is not a depth", where="domain, depth", remedy="give m, above 0")
    bottom = float(surface[:, 1].min()) - depth
    ends = [(right, bottom), (right, surface[-1, 1])], [(left, surface[0, 1])]
    corners = np.array([(left, bottom), *ends[0], *surface[::-1].tolist(), *ends[1]])
    return outline(corners, where).corners


def outline(points: Any, where: str) -> Outline:
    """Return a closed outline, counter-clockwise; the last point may repeat the first.

    ModelError where it has no area, or crosses or touches itself.
    """
    corners = points_of(points, where, 3)
    size = float(np.hypot(*np.ptp(corners, axis=0)))
    apart = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T) > STRAIGHT * size
    corners = corners[apart]
    if len(corners) >= 3:
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        one, other = corners - before, after - corners
        cross = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
        chord = np.maximum(np.hypot(*(after - before).T), STRAIGHT * size)
        straight = (cross <= STRAIGHT * size * chord) & ((one * other).sum(axis=1) > 0.0)
        corners = corners[~straight]
    middle = corners.mean(axis=0) if len(corners) else np.zeros(2)
    polygon = shapely.Polygon(corners - middle) if len(corners) >= 3 else shapely.Polygon()
    if not shapely.is_valid(polygon):
        place = re.search(r"\[(\S+) (\S+)\]", str(shapely.is_valid_reason(polygon)))
        x, y = np.array(place.groups() if place else (0, 0), float) + middle
        what = "crosses or touches itself" + (f" at ({x:.9g}, {y:.9g})" if place else "")
        raise ModelError(what, where=where, remedy="order the points along the outline, each once")
    if polygon.area <= 1e-12 * size**2:
        remedy = "give at least 3 points that span an area"
        raise ModelError(f"has no area ({polygon.area:.3g} m2)", where=where, remedy=remedy)
    turned = not shapely.is_ccw(polygon.exterior)
    return Outline(corners=corners[::-1].copy() if turned else corners, turned=turned)
