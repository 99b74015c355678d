"""Closed outlines from drawn lines: lines joined into loops, and loops checked and turned."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.spatial import cKDTree

from clast.errors import CaseError
from clast.model.arrays import Floats, Ints, connected
from clast.rockmass.drawings.drawing import Polyline

CLOSURE = 1e-5
"""Gap between ends of lines that still meet, over the drawing's diagonal."""


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnLine:
    """A line that is part of an outline, or all of it."""

    points: Floats
    """Its points, m, shape (n, 2)."""
    closed: bool
    """True where its last point is joined to the first by another edge."""
    place: str
    """Where it stands in the file."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Loop:
    """A closed line."""

    points: Floats
    """Corners, m, the first not repeated, shape (n, 2)."""
    place: str
    """Where its lines stand in the file."""
    notes: tuple[str, ...] = ()


def loops_of(lines: Sequence[DrawnLine], tolerance: float, file: str) -> list[Loop]:
    """Return the loops that lines make: closed ones by themselves, open ones end to end.

    Ends nearer than ``tolerance``, m, meet; lines drawn twice are taken once; both are noted.
    Raises CaseError with the size and the place of a gap, and where more than two ends meet.
    """
    loops, opened, merged = [], [], 0
    for line in lines:
        points = without_repeats(line.points, tolerance)
        if len(points) < len(line.points):
            merged += len(line.points) - len(points)
        meets = len(points) > 2 and np.hypot(*(points[-1] - points[0])) <= tolerance
        if line.closed or meets:
            gap = 0.0 if line.closed else float(np.hypot(*(points[-1] - points[0])))
            loops.append(_loop(points[:-1] if meets else points, line.place, gap, tolerance))
        elif len(points) > 1:
            opened.append(DrawnLine(points=points, closed=False, place=line.place))
    once = _drawn_once(opened, tolerance)
    if once:
        loops += _joined(once, tolerance, file)
    twice = len(opened) - len(once)
    notes = [f"{twice} lines drawn twice were taken once"] if twice else []
    if merged:
        notes.append(f"{merged} points within {tolerance:.3g} m of the one before were merged")
    return [replace(loops[0], notes=(*notes, *loops[0].notes)), *loops[1:]] if loops else []


def without_repeats(points: Floats, tolerance: float) -> Floats:
    """Return points without those that lie within ``tolerance`` of the one before them."""
    if len(points) < 2:
        return points
    kept = [0]
    for k in range(1, len(points)):
        if np.hypot(*(points[k] - points[kept[-1]])) > tolerance:
            kept.append(k)
    return points[kept]


def _loop(points: Floats, place: str, gap: float, tolerance: float) -> Loop:
    note = f"{place}: a gap of {gap:.3g} m was closed (gaps up to {tolerance:.3g} m are)"
    return Loop(points=points, place=place, notes=(note,) if gap > 0.0 else ())


def _drawn_once(lines: Sequence[DrawnLine], tolerance: float) -> list[DrawnLine]:
    """Return the lines without those of two points that lie on an earlier one."""
    kept: dict[object, DrawnLine] = {}
    largest = max((float(np.abs(line.points).max()) for line in lines), default=0.0)
    grid = max(tolerance, 1e-12 * largest)
    for number, line in enumerate(lines):
        cells = sorted((int(x), int(y)) for x, y in np.round(line.points[[0, -1]] / grid))
        kept.setdefault(tuple(cells) if len(line.points) == 2 else number, line)
    return list(kept.values())


def _joined(lines: Sequence[DrawnLine], tolerance: float, file: str) -> list[Loop]:
    """Return the loops of open lines; end 2 k is the beginning of line k, 2 k + 1 its end."""
    ends = np.array([line.points[side] for line in lines for side in (0, -1)])
    meeting = _partners(ends, lines, tolerance, file)
    loops, used = [], np.zeros(len(lines), bool)
    for first in range(len(lines)):
        if used[first]:
            continue
        parts, places, gap, end = [], [], 0.0, 2 * first
        while not used[end // 2]:
            line = lines[end // 2]
            used[end // 2] = True
            parts.append(line.points[:-1] if end % 2 == 0 else line.points[:0:-1])
            places.append(line.place)
            leaving = end ^ 1
            end = int(meeting[leaving])
            gap = max(gap, float(np.hypot(*(ends[leaving] - ends[end]))))
        loops.append(_loop(np.vstack(parts), _listed(places), gap, tolerance))
    return loops


def _partners(ends: Floats, lines: Sequence[DrawnLine], tolerance: float, file: str) -> Ints:
    """Return the end that each end meets, shape (n,); CaseError where one meets none or several."""
    pairs = cKDTree(ends).query_pairs(tolerance, output_type="ndarray")
    label = connected(pairs[:, 0], pairs[:, 1], len(ends))
    size = np.bincount(label)[label]
    alone = np.flatnonzero(size == 1)
    if len(alone):
        # The narrowest gap is named.
        end, gap, to = int(alone[0]), np.inf, ""
        if len(alone) > 1:
            distance, nearest = cKDTree(ends[alone]).query(ends[alone], k=2)
            narrow = int(np.argmin(distance[:, 1]))
            end, other = int(alone[narrow]), int(alone[nearest[narrow, 1]])
            gap = distance[narrow, 1]
            to = f" to {point(ends[other])}, {lines[other // 2].place}"
        what = f"the outline is not closed: a gap of {gap:.4g} m from {point(ends[end])}{to}"
        remedy = f"close it, or join ends farther apart than {tolerance:.3g} m by tolerance="
        raise CaseError(what, where=f"{file}: {lines[end // 2].place}", remedy=remedy)
    for many in np.flatnonzero(size > 2)[:1]:
        here = np.flatnonzero(label == label[many]).tolist()
        raise CaseError(
            f"{len(here)} ends of lines meet at {point(ends[many])}",
            where=f"{file}: {_listed([lines[k // 2].place for k in here])}",
            remedy="an outline has two at each corner: move other lines to another layer",
        )
    order = np.argsort(label, kind="stable").reshape(-1, 2)
    partner = np.empty(len(ends), np.int64)
    partner[order[:, 0]], partner[order[:, 1]] = order[:, 1], order[:, 0]
    return partner


def ring(loop: Loop, what: str, file: str) -> tuple[Floats, list[str]]:
    """Return the corners of a loop counter-clockwise, shape (n, 2), and the changes to it.

    Raises CaseError where it has no area or crosses itself, with the place.
    """
    points, notes = loop.points, list(loop.notes)
    where = f"{file}: {loop.place}"
    if len(points) < 3:
        raise CaseError(
            f"{what} has {len(points)} different points, and an outline at least 3", where=where
        )
    shape = shapely.Polygon(points)
    if not shape.is_valid:
        place = re.search(r"\[(\S+) (\S+)\]", shapely.is_valid_reason(shape))
        at = f" at {point([float(place[1]), float(place[2])])}" if place else ""
        remedy = "draw it as one simple loop"
        raise CaseError(f"{what} crosses or touches itself{at}", where=where, remedy=remedy)
    if shapely.LinearRing(points).is_ccw:
        return np.ascontiguousarray(points), notes
    notes.append(f"{loop.place}: {what} ran clockwise and was turned round")
    return np.ascontiguousarray(points[::-1]), notes


def outline_of_lines(
    lines: Sequence[Floats], reach: float = 0.0
) -> tuple[Floats, list[Floats]] | None:
    """Return the outline of all faces that lines enclose, and those inside; None if it is not one.

    All are counter-clockwise, (n, 2), m; ends that dangle have no part in them, as in Shi's block
    cutting.  Faces inside are those without a hole, where there is more than one face.  All lines
    are lengthened by ``reach``, m, so that ends which just miss another line meet it.
    """
    drawn = [line for line in lines if len(line) > 1]
    longer = [line.copy() for line in drawn]
    for line, before in zip(longer, drawn, strict=True) if reach else ():
        for end, beside in ((0, 1), (-1, -2)):
            away = before[end] - before[beside]
            size = float(np.hypot(*away))
            line[end] += reach * away / size if size > 0.0 else 0.0
    merged = shapely.unary_union([shapely.LineString(line) for line in longer])
    faces = [face for face in shapely.polygonize([merged]).geoms if face.area > 0.0]
    if not faces:
        return None
    whole = shapely.unary_union(faces)
    if whole.geom_type != "Polygon":
        return None
    plain = [face for face in faces if len(faces) > 1 and not face.interiors]
    outer = shapely.Polygon(whole.exterior).simplify(0.0)
    return _counter_clockwise(outer), [_counter_clockwise(face) for face in plain]


def cutting(
    traces: Sequence[Polyline], boundary: Floats, voids: Sequence[Floats]
) -> tuple[list[Polyline], list[Polyline]]:
    """Return the traces with a part inside of the boundary and outside of voids, and the others.

    A part counts from 1e-7 of the length of the boundary on: a line along it is not inside.
    """
    domain = shapely.Polygon(boundary)
    reach = 1e-7 * domain.length
    holes = shapely.unary_union([shapely.Polygon(void).buffer(reach) for void in voids])
    inner = shapely.difference(domain.buffer(-reach), holes)
    shapely.prepare(inner)
    lines = [shapely.LineString(trace.points) for trace in traces]
    within = shapely.length(shapely.intersection(lines, inner)) > reach
    return (
        [trace for trace, cuts in zip(traces, within, strict=True) if cuts],
        [trace for trace, cuts in zip(traces, within, strict=True) if not cuts],
    )


def lengthened(reach: float) -> str:
    """Return the note that lines were lengthened to meet."""
    return f"lines were extended by {reach:.3g} m at both ends, to close the domain"


def _counter_clockwise(face: shapely.Polygon) -> Floats:
    """Return the corners of a face counter-clockwise, the first not repeated, shape (n, 2)."""
    corners = np.array(face.exterior.coords)[:-1]
    return corners if face.exterior.is_ccw else np.ascontiguousarray(corners[::-1])


def point(at: Floats | Sequence[float]) -> str:
    """Return a place as messages write it."""
    return f"({at[0]:.6g}, {at[1]:.6g}) m"


def _listed(places: Sequence[str]) -> str:
    """Return the first places of many."""
    more = f" and {len(places) - 4} more" if len(places) > 4 else ""
    return ", ".join(places[:4]) + more
