"""The lines that linings follow, and their segments.

A lining lies to the left of its line.  Lines run so that it does: counter-clockwise round an
opening.  A corner of the line that turns by more
than 20 degrees is an end of segments, on a mitre; between such corners the line is cut into equal
pieces.  Smaller corners, and those where joints of the rock come out, stay in the outer faces.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError
from clast.inputs.declaring.values import number_of
from clast.model.bodies import loops_round
from clast.model.checks import point_text
from clast.model.model import Floats, Ints

DECIMALS_COMPARED = 6
"""Decimals of turns, and of shares of an outline, that are compared."""


class LinesOfRock:
    """The outlines of the blocks that linings may follow; made when they are asked for."""

    def __init__(
        self,
        polygons: Any,
        names: Sequence[str],
        openings: Mapping[str, Floats],
        blocks_of_openings: Mapping[str, Sequence[str]],
    ) -> None:
        self._polygons = polygons
        self._number = {name: k for k, name in enumerate(names)}
        self._openings = openings
        self._blocks = blocks_of_openings
        bounds = shapely.total_bounds(polygons) if len(polygons) else np.array([0.0, 0, 1, 1])
        # Grid on which outlines are joined, in units of the size of the case
        self._grid = 1e-8 * float(np.hypot(*(bounds[2:] - bounds[:2])))
        self._tree = shapely.STRtree(polygons)

    def line(self, one: Any, where: str) -> tuple[Floats, bool]:
        """Return the points of the line of a lining (a Lining), (c, 2), and whether it was turned.

        A line that comes back does not repeat its first point.
        """
        if one.opening is not None:
            ring = self._opening(one.opening, where)
            return (ring if one.part is None else _part(ring, one.part, f"{where}, part")), False
        points = np.array(one.polyline, float)
        points = points[:-1] if one.is_ring else points
        side = one.side or self._free_side(points, one.thickness)
        if side == "right":
            return np.ascontiguousarray(points[::-1]), True
        return points, False

    def _opening(self, name: str, where: str) -> Floats:
        """Return the outline of an opening as its blocks have it, counter-clockwise, (c, 2)."""
        known = dict.fromkeys(sorted({*self._openings, *self._blocks}), 0)
        number_of(name, known, "opening", f"{where}, opening")
        if name in self._blocks:
            inside = self._polygons[[self._number[block] for block in self._blocks[name]]]
            return self._exterior(inside, f"{where}, opening")
        given = shapely.Polygon(self._openings[name])
        near = self._tree.query(given.buffer(1e-3 * np.sqrt(given.area)))
        # of holes the blocks are to the left, too
        for loop in (loop[::-1] for loop in _loops(self._polygons[near])):
            around = shapely.make_valid(shapely.Polygon(loop))
            if _is_counterclockwise(loop) and around.intersection(given).area > 0.5 * given.area:
                return _from_a_start(loop)
        return _from_a_start(_ring(given))

    def _exterior(self, polygons: Any, where: str) -> Floats:
        """Return the outline of blocks that are in one piece, counter-clockwise, (c, 2)."""
        outside = [loop for loop in _loops(polygons) if _is_counterclockwise(loop)]
        if len(outside) != 1:
            remedy = "give a lining to each piece, along a polyline"
            raise ModelError("its blocks are in several pieces", where=where, remedy=remedy)
        return _from_a_start(outside[0])

    def _free_side(self, points: Floats, thickness: float) -> str:
        """Return the side of a polyline where there is no rock; left where that is undecided."""
        middle, line = 0.5 * (points[1:] + points[:-1]), np.diff(points, axis=0)
        left = np.stack([-line[:, 1], line[:, 0]], axis=1) / np.hypot(*line.T)[:, None]
        rock = [
            self._tree.query(
                shapely.points(middle + sign * 0.1 * thickness * left), predicate="intersects"
            ).shape[1]
            for sign in (1.0, -1.0)
        ]
        return "right" if rock[0] and not rock[1] else "left"


def _loops(polygons: Any) -> list[Floats]:
    """Return the outlines of polygons that lie flush, (c, 2) each, with these to their left."""
    rings = [_ring(one) for one in polygons if isinstance(one, shapely.Polygon)]
    start = np.cumsum([0, *map(len, rings)])
    area = np.array([shapely.Polygon(ring).area for ring in rings])
    return loops_round(np.concatenate(rings), start, area) if rings else []


def _is_counterclockwise(loop: Floats) -> bool:
    """Return whether a loop (c, 2) encloses the area to its left."""
    return bool(shapely.is_ccw(shapely.LinearRing(loop)))


def _from_a_start(ring: Floats) -> Floats:
    """Return a ring (c, 2) that begins at a corner which follows from its shape alone.

    The one with the sharpest turn; of equal ones that from which turns and lengths of the edges to
    either side are larger.  Turned, moved, mirrored or with its blocks in another order an opening
    has the same segments.
    """
    after = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(*after.T)
    before = np.roll(after / length[:, None], 1, axis=0)
    turn = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) / length
    turn, length = (
        np.round(turn, DECIMALS_COMPARED),
        np.round(length / length.sum(), DECIMALS_COMPARED),
    )
    count = len(ring)
    # Corners to either side of one by which it is told from others
    reach = np.arange(min(count, 100))

    def shape_from(corner: int) -> tuple[list[float], list[float]]:
        """Return turns and lengths to both sides of a corner, the larger ones first."""
        ahead, back = (corner + reach) % count, (corner - reach) % count
        sides = ((ahead, ahead), (back, (back - 1) % count))
        one, other = (np.stack([turn[k], length[e]], axis=1).ravel().tolist() for k, e in sides)
        return max(one, other), min(one, other)

    start = max(np.flatnonzero(turn == turn.max()).tolist(), key=shape_from)
    return np.ascontiguousarray(np.roll(ring, -start, axis=0))


def _ring(polygon: Any) -> Floats:
    """Return the corners of the outside of a polygon, counter-clockwise, (c, 2)."""
    ring = np.array(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1]
    return np.ascontiguousarray(ring)


def _part(ring: Floats, ends: Any, where: str) -> Floats:
    """Return a ring from one point on it to another, onwards, (c, 2)."""
    closed = np.concatenate([ring, ring[:1]])
    line = shapely.LineString(closed)
    marks = [0.0, *np.cumsum(np.hypot(*np.diff(closed, axis=0).T)).tolist()]
    close = 1e-9 * line.length
    for point in ends:
        away = line.distance(shapely.Point(point))
        # How far from an outline a point on it may be given, in units of its length
        if away > 0.01 * line.length:
            what = f"{point_text(np.array(point))} is {away:.3g} m from the outline"
            raise ModelError(what, where=where, remedy="give points on it")

    def place(point: Any) -> float:
        """Return the distance of a point along the ring, m: at a corner of it that is close."""
        along = line.project(shapely.Point(point))
        nearest = min(marks, key=lambda mark: abs(mark - along))
        # Distance of a point from a corner of an outline that is none, in units of its length
        return nearest if abs(nearest - along) <= 1e-3 * line.length else along

    first, last = map(place, ends)
    span = (last - first) % line.length
    between = sorted(((mark - first) % line.length, k) for k, mark in enumerate(marks[:-1]))
    inner = [ring[k] for distance, k in between if close < distance < span - close]
    ends_on = [np.array(line.interpolate(at).coords[0]) for at in (first, last)]
    return np.array([ends_on[0], *inner, ends_on[1]])


MITRE_TURN_RAD = np.radians(20.0)
"""Turn of a line, rad, that is an end of segments."""
POINTS_APART_MIN = 0.1
"""Distance between points of the line, in units of a segment, below which they are one."""
ROUNDING = 1e-9
"""Difference that is rounding, rad and in units of a length: ties must not hang on it."""


@dataclass(frozen=True, kw_only=True)
class CutLine:
    """A line cut into s segments: p points of its outer face, and the faces between segments."""

    at: Floats
    """Points of the outer line, m, shape (p, 2)."""
    first: Ints
    """First point of each segment, shape (s,)."""
    count: Ints
    """Number of points of each, shape (s,)."""
    inner: Floats
    """Inner ends of the two faces of each segment, m, shape (s, 2, 2)."""
    closed: bool
    """Whether the last segment ends where the first begins."""

    def polygon(self, segment: int) -> Floats:
        """Return the corners of a segment, counter-clockwise, m, (c, 2)."""
        rows = (self.first[segment] + np.arange(self.count[segment])) % len(self.at)
        return np.concatenate([self.at[rows], self.inner[segment, ::-1]])

    @property
    def middles(self) -> Floats:
        """Middles of the two faces of each segment, m, shape (s, 2, 2)."""
        last = (self.first + self.count - 1) % len(self.at)
        return np.asarray(0.5 * (np.stack([self.at[self.first], self.at[last]], 1) + self.inner))


NOTHING_BEYOND: tuple[Floats | None, Floats | None] = (None, None)


def cut_line(
    line: Floats,
    *,
    comes_back: bool,
    length: float,
    thickness: float,
    is_middle: bool,
    where: str,
    beyond: tuple[Floats | None, Floats | None] = NOTHING_BEYOND,
) -> CutLine:
    """Return the segments of a lining to the left of a line (c, 2), m, or about it.

    ``comes_back``: its last point is followed by the first.  ``beyond`` are the edges (2,), m, of
    other linings that end at its start and begin at its end: it ends on mitres there.  Raises
    ModelError where the thickness does not fit.
    """
    if comes_back:
        sharp = np.flatnonzero(np.abs(_turns(line)) > MITRE_TURN_RAD + ROUNDING)
        line = np.roll(line, -int(sharp[0]), axis=0) if len(sharp) else line
    given = _whole(line, comes_back)
    if is_middle:
        line = line - 0.5 * thickness * _normals(line, comes_back, beyond)
    points = _whole(line, comes_back)
    marks = _marks(points)
    # the length is that along the line as it is given
    length *= marks[-1] / _marks(given)[-1]
    # Segments of a lining: more are a wrong unit or corner
    if marks[-1] > 10_000 * length:
        what = f"{marks[-1]:.3g} m would be {marks[-1] / length:.0f} segments of {length:.3g} m"
        remedy = "give longer segments, m, or check the corners of the line"
        raise ModelError(what, where=f"{where}, segment", remedy=remedy)
    ends = _ends(points, marks, comes_back, length)
    if comes_back and len(ends) < 4:
        what = f"a ring of {marks[-1]:.3g} m cannot be divided into three segments of {length:g} m"
        raise ModelError(what, where=f"{where}, segment", remedy="give shorter segments")
    at, first = _points(points, marks, ends, comes_back)
    count = np.diff(np.concatenate([first, [len(at) if comes_back else len(at) - 1]])) + 1
    inner = _place(points, marks, ends) + thickness * _normals_at(
        points, marks, ends, comes_back, beyond
    )
    inner = np.stack([inner[:-1], inner[1:]], axis=1)
    cut = CutLine(at=at, first=first, count=count, inner=inner, closed=comes_back)
    _check(cut, thickness, where)
    return cut


def _whole(line: Floats, comes_back: bool) -> Floats:
    """Return a line with its first point at its end as well, if it comes back."""
    return np.concatenate([line, line[:1]]) if comes_back else line


def _marks(points: Floats) -> Floats:
    """Return how far along a line its points are, m, (c,)."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _turns(ring: Floats) -> Floats:
    """Return by how much a ring turns left at each of its points, rad, (c,)."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(np.arctan2(cross, (before * after).sum(axis=1)))


def _normals(line: Floats, comes_back: bool, beyond: tuple[Floats | None, Floats | None]) -> Floats:
    """Return the mitre at each point of a line: to the left, 1 away from both edges, (c, 2)."""
    if comes_back:
        before, after = line - np.roll(line, 1, axis=0), np.roll(line, -1, axis=0) - line
    else:
        edges = np.diff(line, axis=0)
        first, last = (
            own if other is None else other
            for own, other in zip((edges[0], edges[-1]), beyond, strict=True)
        )
        before, after = np.vstack([first, edges]), np.vstack([edges, last])
    one, other = (
        np.stack([-e[:, 1], e[:, 0]], 1) / np.hypot(*e.T)[:, None] for e in (before, after)
    )
    both = one + other
    return np.asarray(2.0 * both / np.maximum((both**2).sum(axis=1), 1e-12)[:, None])


def _ends(points: Floats, marks: Floats, comes_back: bool, length: float) -> Floats:
    """Return where segments end along a line, m from its start, ascending, (s + 1,)."""
    turns = np.zeros(len(points))
    ring = points[:-1] if comes_back else points
    turns[: len(ring)] = _turns(ring)
    sharp = np.abs(turns) > MITRE_TURN_RAD + ROUNDING
    sharp[[0, -1]] = True
    corners = marks[sharp]
    ends = [corners[:1]]
    for low, high in itertools.pairwise(corners):
        pieces = max(1, math.ceil((high - low) / length * (1.0 - ROUNDING) - 0.5))
        ends.append(np.linspace(low, high, pieces + 1)[1:])
    marked = np.concatenate(ends)
    # a corner close by is where the segment ends; of two as close on either side, neither
    spacing = np.diff(marked)
    room = POINTS_APART_MIN * np.minimum(spacing[:-1], spacing[1:]) * (1.0 - ROUNDING)
    away = np.abs(marks[:, None] - marked[1:-1])
    least = away.min(axis=0)
    one = (away <= least + ROUNDING * length).sum(axis=0) == 1
    marked[1:-1] = np.where(one & (least < room), marks[away.argmin(axis=0)], marked[1:-1])
    return marked


def _points(points: Floats, marks: Floats, ends: Floats, comes_back: bool) -> tuple[Floats, Ints]:
    """Return the points of the outer line (p, 2), and the first of each segment (s,).

    Of corners that are close together the sharper one stays, then that nearer to the middle of the
    segment: the same in both directions along the line.
    """
    at: list[Floats] = []
    first = []
    sharpness = np.round(np.abs(_turns(points)), 6)
    for low, high in itertools.pairwise(ends):
        first.append(len(at))
        at.append(_place(points, marks, np.array([low]))[0])
        room, middle = POINTS_APART_MIN * (high - low) * (1.0 - ROUNDING), 0.5 * (low + high)
        inside = np.flatnonzero((marks > low + room) & (marks < high - room))
        order = np.lexsort((np.abs(marks[inside] - middle), -sharpness[inside]))
        kept: list[int] = []
        for k in inside[order].tolist():
            if all(abs(marks[k] - marks[other]) >= room for other in kept):
                kept.append(k)
        at += list(points[sorted(kept)])
    if not comes_back:
        at.append(points[-1])
    return np.array(at), np.array(first, np.int64)


def _place(points: Floats, marks: Floats, where: Floats) -> Floats:
    """Return the points of a line so far along it, m, (k, 2)."""
    return np.stack([np.interp(where, marks, points[:, axis]) for axis in (0, 1)], axis=1)


def _normals_at(
    points: Floats,
    marks: Floats,
    ends: Floats,
    comes_back: bool,
    beyond: tuple[Floats | None, Floats | None],
) -> Floats:
    """Return the mitre at each end of a segment, (s + 1, 2)."""
    ring = points[:-1] if comes_back else points
    at_points = _normals(ring, comes_back, beyond)
    at_points = np.concatenate([at_points, at_points[:1]]) if comes_back else at_points
    edges = np.diff(points, axis=0)
    of_edges = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
    nearest = np.argmin(np.abs(marks[:, None] - ends), axis=0)
    on_point = np.abs(marks[nearest] - ends) <= 1e-9 * marks[-1]
    edge = np.clip(np.searchsorted(marks, ends, side="right") - 1, 0, len(edges) - 1)
    return np.where(on_point[:, None], at_points[nearest], of_edges[edge])


def _check(cut: CutLine, thickness: float, where: str) -> None:
    """Refuse segments that the thickness turns inside out, and linings that meet themselves."""
    last = (cut.first + cut.count - 1) % len(cut.at)
    outer = cut.at[last] - cut.at[cut.first]
    inner = cut.inner[:, 1] - cut.inner[:, 0]
    length = np.hypot(*outer.T)
    for k in np.flatnonzero((outer * inner).sum(axis=1) <= 0.05 * length**2)[:1]:
        raise ModelError(
            f"{thickness:g} m is beyond the radius of curvature at "
            f"{point_text(cut.at[cut.first[k]])}: the inner face would turn inside out",
            where=f"{where}, thickness",
            remedy="give a thinner lining, or smooth the line there",
        )
    for k in np.flatnonzero(thickness > 1.5 * length)[:1]:
        what = (
            f"{thickness:g} m is more than the segment of {length[k]:.3g} m at "
            f"{point_text(cut.at[cut.first[k]])}"
        )
        remedy = "leave out corners of the line that are close together, or give a thinner lining"
        raise ModelError(what, where=f"{where}, thickness", remedy=remedy)
    polygons = shapely.polygons([shapely.linearrings(cut.polygon(k)) for k in range(len(inner))])
    one, other = shapely.STRtree(polygons).query(polygons)
    count = len(polygons)
    apart = (other - one) % count if cut.closed else other - one
    far = (one < other) & (apart > 1) & ~(cut.closed & (apart == count - 1))
    common = shapely.area(shapely.intersection(polygons[one[far]], polygons[other[far]]))
    bad = ~shapely.is_valid(polygons)
    bad[one[far][common > 1e-6 * thickness**2]] = True
    for k in np.flatnonzero(bad)[:1]:
        what = f"crosses itself near {point_text(cut.at[cut.first[k]])}"
        remedy = "give a line that does not come so close to itself, or a thinner lining"
        raise ModelError(what, where=where, remedy=remedy)
