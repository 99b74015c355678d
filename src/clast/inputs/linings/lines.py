"""The lines that linings follow: outlines of openings, outer edges of blocks, polylines.

A lining lies to the left of its line.  Lines run so that it does: counter-clockwise round an
opening, with the rock to their right along an outer edge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.linings.lining_table import Lining
from clast.model.bodies import loops_round
from clast.model.checks import point_text
from clast.model.model import Floats

GRID = 1e-8
"""Grid on which outlines are joined, in units of the size of the case."""
ALIKE = 6
"""Decimals of turns, and of shares of an outline, that are compared."""
NEIGHBOURS = 100
"""Corners to either side of one by which it is told from others."""
CORNER = 1e-3
"""Distance of a point from a corner of an outline that is none, in units of its length."""
NEAR = 0.01
"""How far from an outline a point on it may be given, in units of its length."""


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
        self._grid = GRID * float(np.hypot(*(bounds[2:] - bounds[:2])))
        self._tree = shapely.STRtree(polygons)

    def line(self, one: Lining, where: str) -> tuple[Floats, bool]:
        """Return the points of the line of a lining, (c, 2), and whether it was turned round.

        A line that comes back does not repeat its first point.
        """
        if one.opening is not None:
            ring = self._opening(one.opening, where)
            return (ring if one.part is None else _part(ring, one.part, f"{where}, part")), False
        if one.outer_edge is not None:
            return self._outer_edge(one.outer_edge, f"{where}, outer_edge"), False
        points = np.array(one.polyline, float)
        points = points[:-1] if one.is_ring else points
        side = one.side or self._free_side(points, one.thickness)
        if side == "right":
            return np.ascontiguousarray(points[::-1]), True
        return points, False

    def _opening(self, name: str, where: str) -> Floats:
        """Return the outline of an opening as its blocks have it, counter-clockwise, (c, 2)."""
        known = {*self._openings, *self._blocks}
        if name not in known:
            raise ModelError(
                f"there is no opening '{shortened(name)}'",
                where=f"{where}, opening",
                remedy=spelling.advice(name, sorted(known), kind="opening"),
            )
        if name in self._blocks:
            inside = self._polygons[[self._number[block] for block in self._blocks[name]]]
            return self._exterior(inside, f"{where}, opening")
        given = shapely.Polygon(self._openings[name])
        near = self._tree.query(given.buffer(1e-3 * np.sqrt(given.area)))
        # of holes the blocks are to the left, too
        holes = [loop[::-1] for loop in _loops(self._polygons[near])]
        holes = [loop for loop in holes if _is_most_of(given, loop)]
        return _from_a_start(holes[0] if holes else _ring(given))

    def _exterior(self, polygons: Any, where: str) -> Floats:
        """Return the outline of blocks that are in one piece, counter-clockwise, (c, 2)."""
        outside = [loop for loop in _loops(polygons) if _is_counterclockwise(loop)]
        if len(outside) != 1:
            raise ModelError(
                "its blocks are in several pieces",
                where=where,
                remedy="give a lining to each piece, along a polyline",
            )
        return _from_a_start(outside[0])

    def _outer_edge(self, ends: Any, where: str) -> Floats:
        """Return the outside of the blocks between two points, rock to its right, (c, 2)."""
        joined = shapely.union_all(self._polygons, grid_size=self._grid)
        at = shapely.Point(ends[0])
        rims = [part.exterior for part in shapely.get_parts(joined)]
        rim = min(rims, key=at.distance)
        near = self._tree.query(rim, predicate="dwithin", distance=2.0 * self._grid)
        outside = [loop for loop in _loops(self._polygons[near]) if _is_counterclockwise(loop)]
        loop = min(outside, key=lambda one: at.distance(shapely.LinearRing(one)))
        # rock is to the left of a loop that runs counter-clockwise
        ring = np.ascontiguousarray(loop[::-1])
        one = _part(ring, ends, where)
        other = _part(ring, (ends[1], ends[0]), where)
        return one if _length(one) <= _length(other) else other

    def _free_side(self, points: Floats, thickness: float) -> str:
        """Return the side of a polyline where there is no rock; left where that is undecided."""
        middle, way = 0.5 * (points[1:] + points[:-1]), np.diff(points, axis=0)
        left = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
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
    """Return whether a loop (c, 2) encloses what is to its left."""
    return bool(shapely.is_ccw(shapely.LinearRing(loop)))


def _is_most_of(given: Any, loop: Floats) -> bool:
    """Return whether a loop (c, 2) is counter-clockwise round more than half of a polygon."""
    if not _is_counterclockwise(loop):
        return False
    around = shapely.make_valid(shapely.Polygon(loop))
    return bool(around.intersection(given).area > 0.5 * given.area)


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
    turn, length = np.round(turn, ALIKE), np.round(length / length.sum(), ALIKE)
    count = len(ring)
    reach = np.arange(min(count, NEIGHBOURS))

    def shape_from(corner: int) -> tuple[list[float], list[float]]:
        """Return turns and lengths to both sides of a corner, the larger ones first."""
        ahead, back = (corner + reach) % count, (corner - reach) % count
        ways = ((ahead, ahead), (back, (back - 1) % count))
        one, other = (np.stack([turn[k], length[e]], axis=1).ravel().tolist() for k, e in ways)
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
        if away > NEAR * line.length:
            raise ModelError(
                f"{point_text(np.array(point))} is {away:.3g} m from the outline",
                where=where,
                remedy="give points on it",
            )
    first, last = (_on_line(line, marks, point) for point in ends)
    span = (last - first) % line.length
    between = sorted(((mark - first) % line.length, k) for k, mark in enumerate(marks[:-1]))
    inner = [ring[k] for way, k in between if close < way < span - close]
    ends_on = [np.array(line.interpolate(at).coords[0]) for at in (first, last)]
    return np.array([ends_on[0], *inner, ends_on[1]])


def _on_line(line: Any, marks: list[float], point: Any) -> float:
    """Return how far along a ring a point is, m: at a corner of it that is close."""
    along = line.project(shapely.Point(point))
    nearest = min(marks, key=lambda mark: abs(mark - along))
    return nearest if abs(nearest - along) <= CORNER * line.length else along


def _length(points: Floats) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())
