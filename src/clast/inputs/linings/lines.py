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
from clast.model.checks import point_text
from clast.model.model import Floats

GRID = 1e-8
"""Grid on which outlines are joined, in units of the size of the case."""
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
        near = self._polygons[self._tree.query(given.buffer(1e-3 * np.sqrt(given.area)))]
        joined = shapely.union_all(self._polygons, grid_size=self._grid) if len(near) else given
        holes = [
            shapely.Polygon(ring)
            for part in shapely.get_parts(joined)
            for ring in getattr(part, "interiors", ())
        ]
        holes = [hole for hole in holes if hole.intersection(given).area > 0.5 * given.area]
        return _ring(holes[0] if holes else given)

    def _exterior(self, polygons: Any, where: str) -> Floats:
        """Return the outline of blocks that are in one piece, counter-clockwise, (c, 2)."""
        joined = shapely.union_all(polygons, grid_size=self._grid)
        if not isinstance(joined, shapely.Polygon):
            raise ModelError(
                "its blocks are in several pieces",
                where=where,
                remedy="give a lining to each piece, along a polyline",
            )
        return _ring(joined)

    def _outer_edge(self, ends: Any, where: str) -> Floats:
        """Return the outside of the blocks between two points, rock to its right, (c, 2)."""
        joined = shapely.union_all(self._polygons, grid_size=self._grid)
        parts = list(shapely.get_parts(joined))
        part = min(parts, key=lambda one: one.exterior.distance(shapely.Point(ends[0])))
        # rock is to the left of a ring that runs counter-clockwise
        ring = np.ascontiguousarray(_ring(part)[::-1])
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
