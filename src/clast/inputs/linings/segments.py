"""Segments of a lining: a line cut into pieces, and the faces between them.

A corner of the line that turns by more than 20 degrees is an end of segments, on a mitre; between
such corners the line is cut into equal pieces.  Smaller corners, and those where joints of the rock
come out, stay in the outer faces of segments.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import shapely

from clast.errors import ModelError
from clast.model.checks import point_text
from clast.model.model import Floats, Ints

SHARP = np.radians(20.0)
"""Turn of a line, rad, that is an end of segments."""
APART = 0.1
"""Distance between points of the line, in units of a segment, below which they are one."""
ROUNDED = 1e-9
"""Difference that is rounding, rad and in units of a length: ties must not hang on it."""
MOST = 10_000
"""Segments of a lining: more are a wrong unit or corner."""


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


def cut_line(
    line: Floats,
    *,
    comes_back: bool,
    length: float,
    thickness: float,
    is_middle: bool,
    where: str,
) -> CutLine:
    """Return the segments of a lining to the left of a line (c, 2), m, or about it.

    ``comes_back``: its last point is followed by the first.  Raises ModelError where the thickness
    does not fit.
    """
    if comes_back:
        line = _from_a_corner(line)
    given = _whole(line, comes_back)
    if is_middle:
        line = line - 0.5 * thickness * _normals(line, comes_back)
    points = _whole(line, comes_back)
    marks = _marks(points)
    # the length is that along the line as it is given
    length *= marks[-1] / _marks(given)[-1]
    if marks[-1] > MOST * length:
        raise ModelError(
            f"{marks[-1]:.3g} m would be {marks[-1] / length:.0f} segments of {length:.3g} m",
            where=f"{where}, segment",
            remedy="give longer segments, m, or check the corners of the line",
        )
    ends = _ends(points, marks, comes_back, length)
    if comes_back and len(ends) < 4:
        raise ModelError(
            f"a ring of {marks[-1]:.3g} m cannot be divided into three segments of {length:g} m",
            where=f"{where}, segment",
            remedy="give shorter segments",
        )
    at, first = _points(points, marks, ends, comes_back)
    count = np.diff(np.concatenate([first, [len(at) if comes_back else len(at) - 1]])) + 1
    inner = _place(points, marks, ends) + thickness * _normals_at(points, marks, ends, comes_back)
    inner = np.stack([inner[:-1], inner[1:]], axis=1)
    found = CutLine(at=at, first=first, count=count, inner=inner, closed=comes_back)
    _check(found, thickness, where)
    return found


def _whole(line: Floats, comes_back: bool) -> Floats:
    """Return a line with its first point at its end as well, if it comes back."""
    return np.concatenate([line, line[:1]]) if comes_back else line


def _marks(points: Floats) -> Floats:
    """Return how far along a line its points are, m, (c,)."""
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _from_a_corner(ring: Floats) -> Floats:
    """Return a ring that begins at its first sharp corner, if it has one."""
    sharp = np.flatnonzero(np.abs(_turns(ring)) > SHARP + ROUNDED)
    return np.roll(ring, -int(sharp[0]), axis=0) if len(sharp) else ring


def _turns(ring: Floats) -> Floats:
    """Return by how much a ring turns left at each of its points, rad, (c,)."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(np.arctan2(cross, (before * after).sum(axis=1)))


def _normals(line: Floats, comes_back: bool) -> Floats:
    """Return the mitre at each point of a line: to the left, 1 away from both edges, (c, 2)."""
    if comes_back:
        before, after = line - np.roll(line, 1, axis=0), np.roll(line, -1, axis=0) - line
    else:
        edges = np.diff(line, axis=0)
        before, after = np.concatenate([edges[:1], edges]), np.concatenate([edges, edges[-1:]])
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
    sharp = np.abs(turns) > SHARP + ROUNDED
    sharp[[0, -1]] = True
    corners = marks[sharp]
    ends = [corners[:1]]
    for low, high in itertools.pairwise(corners):
        pieces = max(1, math.ceil((high - low) / length * (1.0 - ROUNDED) - 0.5))
        ends.append(np.linspace(low, high, pieces + 1)[1:])
    found = np.concatenate(ends)
    # a corner close by is where the segment ends; of two as close on either side, neither
    spacing = np.diff(found)
    room = APART * np.minimum(spacing[:-1], spacing[1:]) * (1.0 - ROUNDED)
    away = np.abs(marks[:, None] - found[1:-1])
    least = away.min(axis=0)
    one = (away <= least + ROUNDED * length).sum(axis=0) == 1
    found[1:-1] = np.where(one & (least < room), marks[away.argmin(axis=0)], found[1:-1])
    return found


def _points(points: Floats, marks: Floats, ends: Floats, comes_back: bool) -> tuple[Floats, Ints]:
    """Return the points of the outer line (p, 2), and the first of each segment (s,).

    Of corners that are close together the sharper one stays, then that nearer to the middle of the
    segment: either way along the line the same.
    """
    at: list[Floats] = []
    first = []
    sharpness = np.round(np.abs(_turns(points)), 6)
    for low, high in itertools.pairwise(ends):
        first.append(len(at))
        at.append(_place(points, marks, np.array([low]))[0])
        room, middle = APART * (high - low) * (1.0 - ROUNDED), 0.5 * (low + high)
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


def _normals_at(points: Floats, marks: Floats, ends: Floats, comes_back: bool) -> Floats:
    """Return the mitre at each end of a segment, (s + 1, 2)."""
    ring = points[:-1] if comes_back else points
    at_points = _normals(ring, comes_back)
    at_points = np.concatenate([at_points, at_points[:1]]) if comes_back else at_points
    edges = np.diff(points, axis=0)
    of_edges = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
    nearest = np.argmin(np.abs(marks[:, None] - ends), axis=0)
    on_point = np.abs(marks[nearest] - ends) <= 1e-9 * marks[-1]
    edge = np.clip(np.searchsorted(marks, ends, side="right") - 1, 0, len(edges) - 1)
    return np.where(on_point[:, None], at_points[nearest], of_edges[edge])


def _check(found: CutLine, thickness: float, where: str) -> None:
    """Refuse segments that the thickness turns inside out, and linings that meet themselves."""
    last = (found.first + found.count - 1) % len(found.at)
    outer = found.at[last] - found.at[found.first]
    inner = found.inner[:, 1] - found.inner[:, 0]
    length = np.hypot(*outer.T)
    for k in np.flatnonzero((outer * inner).sum(axis=1) <= 0.05 * length**2)[:1]:
        raise ModelError(
            f"{thickness:g} m is beyond the radius of curvature at "
            f"{point_text(found.at[found.first[k]])}: the inner face would turn inside out",
            where=f"{where}, thickness",
            remedy="give a thinner lining, or smooth the line there",
        )
    for k in np.flatnonzero(thickness > 1.5 * length)[:1]:
        raise ModelError(
            f"{thickness:g} m is more than the segment of {length[k]:.3g} m at "
            f"{point_text(found.at[found.first[k]])}",
            where=f"{where}, thickness",
            remedy="leave out corners of the line that are close together, or give a thinner "
            "lining",
        )
    polygons = shapely.polygons([shapely.linearrings(found.polygon(k)) for k in range(len(inner))])
    one, other = shapely.STRtree(polygons).query(polygons)
    count = len(polygons)
    apart = (other - one) % count if found.closed else other - one
    far = (one < other) & (apart > 1) & ~(found.closed & (apart == count - 1))
    common = shapely.area(shapely.intersection(polygons[one[far]], polygons[other[far]]))
    bad = ~shapely.is_valid(polygons)
    bad[one[far][common > 1e-6 * thickness**2]] = True
    for k in np.flatnonzero(bad)[:1]:
        raise ModelError(
            f"crosses itself near {point_text(found.at[found.first[k]])}",
            where=where,
            remedy="give a line that does not come so close to itself, or a thinner lining",
        )
