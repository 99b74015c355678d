"""Bolts round an opening: radial, at equal distances along its outline."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import ModelError, shortened
from clast.inputs.bolts import Bolt, BoltPattern
from clast.inputs.placing.bolt_lines import Ground
from clast.model.model import Floats
from clast.model.names import check_text

BESIDE = 1e-3
"""Share of a bolt's length by which its head may lie beside the wall, as outlines are rounded."""
MOST = 100_000
"""Most bolts of a pattern."""


def bolts_round(
    pattern: BoltPattern,
    number: int,
    openings: tuple[Mapping[str, Floats], Collection[str]],
    ground: Ground,
) -> Iterator[tuple[str, Bolt]]:
    """Give label and record of each bolt of a pattern; ModelError where one would lie in a void.

    ``openings`` are the outlines of openings with a shape, and the names of those of blocks.
    """
    whole = pattern.label(number)
    if pattern.name is not None:
        check_text(pattern.name, whole)
    corners = _outline(pattern, whole, *openings)
    heads, way = _heads(pattern, whole, corners)
    shared = pattern.model_dump(
        include={"kind", "anchorage", "free_length", "pretension_is", "stage"}
    )
    for k, (head, direction) in enumerate(zip(heads, way, strict=True), 1):
        angle = np.degrees(np.arctan2(direction[1], direction[0]))
        label = f"{whole}, bolt {k} at {angle % 360.0:.4g} degrees"
        line = np.array([head, head + pattern.length * direction])
        start, blocks = _in_rock(line, ground, label)
        yield (
            label,
            Bolt(
                name=f"{pattern.group(number)}-{k}",
                start=tuple(start.tolist()),
                end=tuple(line[1].tolist()),
                blocks=None if pattern.anchorage == "grouted" else blocks,
                **shared,
            ),
        )


def _outline(
    pattern: BoltPattern, label: str, outlines: Mapping[str, Floats], excavated: Collection[str]
) -> Floats:
    """Return the corners of the opening, counter-clockwise, m, (c, 2)."""
    given = pattern.opening
    if isinstance(given, str):
        if given not in outlines and given in excavated:
            raise ModelError(
                f"'{shortened(given)}' is an opening given by its blocks, so its outline is not "
                "known",
                where=f"{label}, opening",
                remedy="give an opening with a shape in a [domain], or each bolt as a [[bolt]]",
            )
        if given not in outlines:
            raise ModelError(
                f"there is no opening '{shortened(given)}'",
                where=f"{label}, opening",
                remedy=spelling.advice(given, outlines, kind="opening"),
            )
    corners = np.array(outlines[given] if isinstance(given, str) else given, float)
    if len(corners) < 3:
        raise ModelError(
            f"{shortened(repr(given))} is not an outline",
            where=f"{label}, opening",
            remedy="give the name of an opening, or its corners [[x, y], ...], m",
        )
    shape = shapely.Polygon(corners)
    if not shape.is_valid:
        raise ModelError(
            "its outline crosses itself",
            where=f"{label}, opening",
            remedy="order its corners",
        )
    return corners if shapely.is_ccw(shape.exterior) else corners[::-1].copy()


def _heads(pattern: BoltPattern, label: str, corners: Floats) -> tuple[Floats, Floats]:
    """Return where bolts begin, m, and their directions away from the centroid, (b, 2) each.

    The remainder of the spacing along the outline between the angles is left free at both ends
    alike.
    """
    first, last, spacing = pattern.from_, pattern.to, pattern.spacing
    middle = shapely.get_coordinates(shapely.centroid(shapely.Polygon(corners)))[0]
    ring = shapely.LinearRing(corners)
    whole = last - first == 360.0
    begin, end = (_along(ring, middle, angle, label) for angle in (first, last))
    room = ring.length if whole else (end - begin) % ring.length
    count = int(room / spacing * (1.0 + 1e-9)) + (0 if whole else 1)
    if count > MOST:
        raise ModelError(
            f"would be {count} bolts", where=f"{label}, spacing", remedy="raise the spacing"
        )
    apart = room / max(count, 1) if whole else spacing
    left = 0.0 if whole else 0.5 * (room - (count - 1) * spacing)
    places = (begin + left + apart * np.arange(max(count, 1))) % ring.length
    heads = shapely.get_coordinates(shapely.line_interpolate_point(ring, places))
    away = heads - middle
    return heads, away / np.hypot(*away.T)[:, None]


def _along(ring: Any, middle: Floats, angle: float, label: str) -> float:
    """Return where a ray from the middle leaves an outline, m along it."""
    turn = np.radians(angle)
    far = middle + 2.0 * ring.length * np.array([np.cos(turn), np.sin(turn)])
    hits = shapely.get_coordinates(shapely.intersection(ring, shapely.linestrings([middle, far])))
    if not len(hits):  # the centroid of an outline with a bay may lie outside
        raise ModelError(
            f"the ray at {angle:g} degrees from its centroid ({middle[0]:.4g}, "
            f"{middle[1]:.4g}) does not meet its outline",
            where=f"{label}, opening",
            remedy="give other angles from and to, a simpler outline, or single bolts: [[bolt]]",
        )
    outermost = hits[np.argmax(np.hypot(*(hits - middle).T))]
    return float(shapely.line_locate_point(ring, shapely.points(outermost)))


def _in_rock(line: Floats, ground: Ground, label: str) -> tuple[Floats, tuple[str, str]]:
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
        first, last = (ground.outlines.names[int(pieces.block[k])] for k in (long[0], long[-1]))
        return line[0] + begin * (line[1] - line[0]) / length, (first, last)
    raise ModelError(
        what,
        where=f"{label}, {ground.text(where - origin)}",
        remedy="shorten length, or leave this part of the outline out by from and to",
    )
