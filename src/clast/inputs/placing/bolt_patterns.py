"""Bolts round an opening: radial, at equal distances along its outline."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.placing.bolt_lines import Ground
from clast.inputs.placing.bolts import BoltEntry
from clast.model import ranges
from clast.model.model import Floats
from clast.model.value_checks import check_name, check_number, check_numbers, check_text

BESIDE = 1e-3
"""Share of a bolt's length by which its head may lie beside the wall, as outlines are rounded."""
MOST = 100_000
"""Most bolts of a pattern."""


@dataclass(frozen=True, kw_only=True)
class PatternEntry:
    """Bolts round an opening, by the name of its outline or by the outline itself, m."""

    label: str
    name: str | None
    kind: str
    opening: Any
    length: Any
    spacing: Any
    angles: Any
    choices: Mapping[str, Any]

    @property
    def group(self) -> str:
        """Name of the pattern: its own, that of its opening, or its number."""
        if self.name is not None:
            return self.name
        return self.opening if isinstance(self.opening, str) else self.label


def bolts_round(
    entry: PatternEntry, outlines: Mapping[str, Floats], ground: Ground, excavated: Collection[str]
) -> list[BoltEntry]:
    """Return the bolts of a pattern; ModelError where one of them would lie in a void.

    ``outlines`` are those of openings with a shape; ``excavated`` has the names of openings of
    blocks, too.
    """
    if entry.name is not None:
        check_text(check_name(entry.name, "bolt pattern", entry.label), entry.label)
    corners = _outline(entry, outlines, excavated)
    length = _size(entry, "length")
    heads, way = _heads(entry, corners, _size(entry, "spacing"))
    found = []
    for k, (head, direction) in enumerate(zip(heads, way, strict=True), 1):
        angle = np.degrees(np.arctan2(direction[1], direction[0]))
        label = f"{entry.label}, bolt {k} at {angle % 360.0:.4g} degrees"
        line = np.array([head, head + length * direction])
        start, blocks = _in_rock(line, ground, label)
        grouted = entry.choices.get("anchorage") == "grouted"
        found.append(
            BoltEntry(
                label=label,
                name=f"{entry.group}-{k}",
                kind=entry.kind,
                start=tuple(start.tolist()),
                end=tuple(line[1].tolist()),
                blocks=None if grouted else blocks,
                choices=entry.choices,
                group=entry.group,
            )
        )
    return found


def _outline(
    entry: PatternEntry, outlines: Mapping[str, Floats], excavated: Collection[str]
) -> Floats:
    """Return the corners of the opening, counter-clockwise, m, (c, 2)."""
    given = entry.opening
    if isinstance(given, str):
        if given not in outlines and given in excavated:
            raise ModelError(
                f"'{shortened(given)}' is an opening of blocks, whose outline is not known",
                where=f"{entry.label}, opening",
                remedy="give an opening with a shape in a [domain], or each bolt as a [[bolt]]",
            )
        if given not in outlines:
            raise ModelError(
                f"there is no opening '{shortened(given)}'",
                where=f"{entry.label}, opening",
                remedy=spelling.advice(given, outlines, kind="opening"),
            )
        given = outlines[given]
    try:
        corners = np.array(given, float)
    except (TypeError, ValueError):
        corners = np.zeros(0)
    if corners.ndim != 2 or corners.shape[1:] != (2,) or len(corners) < 3:
        raise ModelError(
            f"{shortened(repr(entry.opening))} is no outline",
            where=f"{entry.label}, opening",
            remedy="give the name of an opening, or its corners [[x, y], ...], m",
        )
    shape = shapely.Polygon(corners)
    if not shape.is_valid:
        raise ModelError(
            "its outline crosses itself",
            where=f"{entry.label}, opening",
            remedy="order its corners",
        )
    return corners if shapely.is_ccw(shape.exterior) else corners[::-1].copy()


def _size(entry: PatternEntry, key: str) -> float:
    """Return the length or the spacing, m."""
    where = f"{entry.label}, {key}"
    value = check_number(getattr(entry, key), where)
    if not value > 0.0:
        raise ModelError(f"must be above 0, not {value:g}", where=where, remedy="give m")
    ranges.check_size(value, ranges.LENGTH, where, "give m")
    return value


def _heads(entry: PatternEntry, corners: Floats, spacing: float) -> tuple[Floats, Floats]:
    """Return where bolts begin, m, and their directions away from the centroid, (b, 2) each.

    What the spacing leaves of the outline between the angles is left free at both ends alike.
    """
    first, last = check_numbers(entry.angles, 2, f"{entry.label}, from and to").tolist()
    if not 0.0 < last - first <= 360.0:
        raise ModelError(
            f"from {first:g} to {last:g} degrees is no part of an outline",
            where=entry.label,
            remedy="give from below to, counter-clockwise from +x, at most 360 degrees apart",
        )
    middle = shapely.get_coordinates(shapely.centroid(shapely.Polygon(corners)))[0]
    ring = shapely.LinearRing(corners)
    whole = last - first == 360.0
    begin, end = (_along(ring, middle, angle) for angle in (first, last))
    room = ring.length if whole else (end - begin) % ring.length
    count = int(room / spacing * (1.0 + 1e-9)) + (0 if whole else 1)
    if count > MOST:
        raise ModelError(
            f"would be {count} bolts", where=f"{entry.label}, spacing", remedy="raise the spacing"
        )
    apart = room / max(count, 1) if whole else spacing
    left = 0.0 if whole else 0.5 * (room - (count - 1) * spacing)
    places = (begin + left + apart * np.arange(max(count, 1))) % ring.length
    heads = shapely.get_coordinates(shapely.line_interpolate_point(ring, places))
    away = heads - middle
    return heads, away / np.hypot(*away.T)[:, None]


def _along(ring: Any, middle: Floats, angle: float) -> float:
    """Return where a ray from the middle leaves an outline, m along it."""
    turn = np.radians(angle)
    far = middle + 2.0 * ring.length * np.array([np.cos(turn), np.sin(turn)])
    hits = shapely.get_coordinates(shapely.intersection(ring, shapely.linestrings([middle, far])))
    outermost = hits[np.argmax(np.hypot(*(hits - middle).T))]
    return float(shapely.line_locate_point(ring, shapely.points(outermost)))


def _in_rock(line: Floats, ground: Ground, label: str) -> tuple[Floats, Sequence[str]]:
    """Return where a bolt begins in the rock behind the wall, m, and the blocks of its ends."""
    origin, length = ground.outlines.origin, float(np.hypot(*(line[1] - line[0])))
    pieces = ground.pieces(line - origin)
    slack = BESIDE * length
    long = np.flatnonzero(np.diff(pieces.ends, axis=1)[:, 0] > slack)
    if not len(long) or pieces.ends[long[0], 0] > slack:
        what, where = "its head lies in no block", line[0]
    elif pieces.ends[long[-1], 1] < length * (1.0 - 1e-6):
        what, where = "its end lies in no block", line[1]
    else:
        begin = max(float(pieces.ends[long[0], 0]), 0.0)
        names = [ground.outlines.names[int(pieces.block[k])] for k in (long[0], long[-1])]
        return line[0] + begin * (line[1] - line[0]) / length, names
    raise ModelError(
        what,
        where=f"{label}, {ground.text(where - origin)}",
        remedy="shorten length, or leave this part of the outline out by from and to",
    )
