"""Pressures along straight lines as they are given to a builder, and the edges they press on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np
import shapely

from clast.errors import ModelError
from clast.inputs.placing.blocks import Vector
from clast.model import ranges
from clast.model.checks import TOUCHING, Outlines, point_text
from clast.model.factors import NO_FACTOR
from clast.model.model import EdgePressures, Floats, Ints
from clast.model.value_checks import check_numbers, number_of


@dataclass(frozen=True, kw_only=True)
class LinePressure:
    """A pressure along the line from ``start`` to ``end``, m, of one or two values, Pa."""

    label: str
    start: Vector
    end: Vector
    value: Any
    block: str | None
    factor: str | None
    name: str = ""


@dataclass(frozen=True)
class _Line:
    """A line about the origin: its first end, its unit direction and its length."""

    start: Floats
    along: Floats
    length: float

    def measured(self, points: Floats) -> tuple[Floats, Floats]:
        """Return how far points (k, 2) are along the line and to its left, m, shape (k,) each."""
        away = points - self.start
        return away @ self.along, away @ np.array([-self.along[1], self.along[0]])


def pressed_edges(
    entries: Sequence[LinePressure],
    block_number: dict[str, int],
    factor_number: dict[str, int],
    outlines: Outlines,
) -> tuple[EdgePressures, tuple[str, ...]]:
    """Return the parts of edges on which pressures act, and notes of lines that leave edges.

    Raises ModelError where no edge lies along a line, or edges of two blocks do.
    """
    found = [EdgePressures()]
    notes: list[str] = []
    for entry in entries:
        line = _line(entry, outlines)
        ends = _pair(entry.value, f"{entry.label}, value")
        edges = np.arange(len(outlines.vertices))
        if entry.block is not None:
            own = number_of(entry.block, block_number, "block", f"{entry.label}, block")
            edges = edges[outlines.owner == own]
        factor = NO_FACTOR
        if entry.factor is not None:
            factor = number_of(entry.factor, factor_number, "table", f"{entry.label}, factor")
        edge, share, place = _parts(line, edges, outlines)
        if len(edge) == 0:
            _refuse_no_edge(entry, line, edges, outlines)
        _refuse_two_blocks(entry, line, edge, np.sort(place, axis=1), outlines)
        notes += _uncovered(entry, line, place)
        found.append(
            EdgePressures(
                block=outlines.owner[edge],
                edge=edge,
                share=share,
                pressure=ends[0] + (ends[1] - ends[0]) * place / line.length,
                factor=np.full(len(edge), factor),
                name=(entry.name,) * len(edge),
            )
        )
    names = ("block", "edge", "share", "pressure", "factor")
    joined = {name: np.concatenate([getattr(one, name) for one in found]) for name in names}
    labels = tuple(name for one in found for name in one.name)
    return EdgePressures(**joined, name=labels), tuple(notes)


def _line(entry: LinePressure, outlines: Outlines) -> _Line:
    """Return the line of a pressure about the origin; refuse one without length."""
    start = check_numbers(entry.start, 2, f"{entry.label}, start") - outlines.origin
    end = check_numbers(entry.end, 2, f"{entry.label}, end") - outlines.origin
    length = float(np.hypot(*(end - start)))
    if length == 0.0:
        raise ModelError("has no length", where=entry.label, remedy="give two different ends")
    return _Line(start, (end - start) / length, length)


def _pair(value: Any, where: str) -> Floats:
    """Return the pressures at both ends, Pa, shape (2,), from two numbers or one for both."""
    several = isinstance(value, Sequence | np.ndarray) and not isinstance(value, str)
    return check_numbers(value if several else (value, value), 2, where, ranges.STRESS)


def _reach(outlines: Outlines, edges: Ints) -> Floats:
    """Return how far edges may lie beside a line, m: as far as loads may beside their blocks."""
    return np.asarray(TOUCHING * np.sqrt(np.abs(outlines.area)))[outlines.owner[edges]]


def _parts(line: _Line, edges: Ints, outlines: Outlines) -> tuple[Ints, Floats, Floats]:
    """Return the edges along a line, the shares of them, and where these are on the line.

    Shapes (k,), (k, 2), -, in the direction of the edge, and (k, 2), m.
    """
    reach = _reach(outlines, edges)
    first = line.measured(outlines.vertices[edges])
    last = line.measured(outlines.vertices[outlines.following[edges]])
    low = np.clip(np.minimum(first[0], last[0]), 0.0, line.length)
    high = np.clip(np.maximum(first[0], last[0]), 0.0, line.length)
    long = np.flatnonzero(high - low > reach)  # with a length along the line, so none across it
    way, side = last[0][long] - first[0][long], last[1][long] - first[1][long]
    share = (np.stack([low, high], axis=1)[long] - first[0][long, None]) / way[:, None]
    share = np.sort(share, axis=1)
    beside = np.abs(first[1][long, None] + share * side[:, None]).max(axis=1)
    near = beside <= reach[long]
    chosen, share = long[near], share[near]
    # what ends at a corner ends there to the last digit
    close = reach[chosen, None] / np.abs(way[near, None])
    share = np.where(share < close, 0.0, np.where(share > 1.0 - close, 1.0, share))
    return edges[chosen], share, first[0][chosen, None] + share * way[near, None]


def _refuse_no_edge(entry: LinePressure, line: _Line, edges: Ints, outlines: Outlines) -> NoReturn:
    """Raise ModelError for a line along no edge, with the edge that comes nearest."""
    here, there = outlines.vertices[edges], outlines.vertices[outlines.following[edges]]
    end = line.start + line.length * line.along
    shape, sides = (
        shapely.linestrings([line.start, end]),
        shapely.linestrings(np.stack([here, there], axis=1)),
    )
    # how far the shorter one strays from the longer one
    from_edge = [shapely.distance(shapely.points(points), shape) for points in (here, there)]
    from_line = [shapely.distance(shapely.points(point), sides) for point in (line.start, end)]
    away = np.minimum(np.max(from_edge, axis=0), np.max(from_line, axis=0))
    nearest = int(np.argmin(away))
    corners = " to ".join(point_text(one[nearest] + outlines.origin) for one in (here, there))
    raise ModelError(
        f"no edge lies along it; the nearest, {corners} of "
        f"{outlines.label(int(outlines.owner[edges[nearest]]))}, is up to {away[nearest]:.3g} m "
        "away",
        where=entry.label,
        remedy="give start and end on the outline of a block (a line within a block is loaded by a "
        "line load)",
    )


def _refuse_two_blocks(
    entry: LinePressure, line: _Line, edge: Ints, place: Floats, outlines: Outlines
) -> None:
    """Refuse a line along which edges of two blocks lie in the same place (k, 2), m."""
    order = np.argsort(place[:, 0], kind="stable")
    edge, place = edge[order], place[order]
    reach = _reach(outlines, edge)
    for k in np.flatnonzero(place[1:, 0] < place[:-1, 1] - reach[1:])[:1]:
        one, other = (int(block) for block in np.sort(outlines.owner[edge[k : k + 2]]))
        at = line.start + place[k + 1, 0] * line.along + outlines.origin
        raise ModelError(
            f"edges of {outlines.label(one)} and {outlines.label(other)} both lie along it from "
            f"{point_text(at)} on",
            where=entry.label,
            remedy=f'say which one is pressed, e.g. block = "{outlines.names[one]}"',
        )


def _uncovered(entry: LinePressure, line: _Line, place: Floats) -> Iterator[str]:
    """Say where a line has parts along no edge: nothing is pressed there."""
    pressed = float(np.abs(np.diff(place, axis=1)).sum())
    if pressed < (1.0 - TOUCHING) * line.length:
        yield (
            f"{entry.label} is {line.length:.6g} m long, but edges lie along only {pressed:.6g} m "
            "of it: it presses on these"
        )
