"""The edges of a model that pressures along straight lines press on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
import shapely

from clast.errors import ModelError
from clast.inputs.declaring.values import number_of
from clast.inputs.loads import Pressure
from clast.inputs.placing.points import named_loads
from clast.model.checks import TOUCHING, BlockOutlines, point_text
from clast.model.factors import NO_FACTOR
from clast.model.model import EdgePressures, Floats, Ints


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
    pressures: Sequence[Pressure],
    block_number: dict[str, int],
    factor_number: dict[str, int],
    outlines: BlockOutlines,
) -> tuple[EdgePressures, tuple[str, ...]]:
    """Return the parts of edges on which pressures act, and notes of lines that leave edges.

    Raises ModelError where no edge lies along a line, or edges of two blocks do.
    """
    found = [EdgePressures()]
    notes: list[str] = []
    for label, name, one in named_loads(pressures, "pressure"):
        line = _line(one, outlines)
        ends = one.value if isinstance(one.value, tuple) else (one.value, one.value)
        edges = np.arange(len(outlines.vertices))
        if one.block is not None:
            own = number_of(one.block, block_number, "block", f"{label}, block")
            edges = edges[outlines.owner == own]
        factor = NO_FACTOR
        if one.amplitude is not None:
            factor = number_of(one.amplitude, factor_number, "amplitude", f"{label}, amplitude")
        edge, share, place = _parts(line, edges, outlines)
        if len(edge) == 0:
            _refuse_no_edge(label, line, edges, outlines)
        _refuse_two_blocks(label, line, edge, np.sort(place, axis=1), outlines)
        notes += _uncovered(label, line, place)
        found.append(
            EdgePressures(
                block=outlines.owner[edge],
                edge=edge,
                share=share,
                pressure=ends[0] + (ends[1] - ends[0]) * place / line.length,
                factor=np.full(len(edge), factor),
                name=(name,) * len(edge),
            )
        )
    keys = ("block", "edge", "share", "pressure", "factor")
    joined = {key: np.concatenate([getattr(part, key) for part in found]) for key in keys}
    names = tuple(name for part in found for name in part.name)
    return EdgePressures(**joined, name=names), tuple(notes)


def _line(pressure: Pressure, outlines: BlockOutlines) -> _Line:
    """Return the line of a pressure about the origin."""
    start, end = (np.array(one) - outlines.origin for one in (pressure.start, pressure.end))
    length = float(np.hypot(*(end - start)))
    return _Line(start, (end - start) / length, length)


def _reach(outlines: BlockOutlines, edges: Ints) -> Floats:
    """Return how far edges may lie beside a line, m: as far as loads may beside their blocks."""
    return np.asarray(TOUCHING * np.sqrt(np.abs(outlines.area)))[outlines.owner[edges]]


def _parts(line: _Line, edges: Ints, outlines: BlockOutlines) -> tuple[Ints, Floats, Floats]:
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


def _refuse_no_edge(label: str, line: _Line, edges: Ints, outlines: BlockOutlines) -> NoReturn:
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
        where=label,
        remedy="give start and end on the outline of a block (a line within a block is loaded by a "
        "line load)",
    )


def _refuse_two_blocks(
    label: str, line: _Line, edge: Ints, place: Floats, outlines: BlockOutlines
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
            where=label,
            remedy=f'name the one that is loaded, e.g. block = "{outlines.names[one]}"',
        )


def _uncovered(label: str, line: _Line, place: Floats) -> Iterator[str]:
    """Say where a line has parts along no edge: nothing is pressed there."""
    pressed = float(np.abs(np.diff(place, axis=1)).sum())
    if pressed < (1.0 - TOUCHING) * line.length:
        yield (
            f"{label} is {line.length:.6g} m long, but edges lie along only {pressed:.6g} m "
            "of it: the pressure acts on these only"
        )
