"""[[fixed_point]], [[point_load]], [[line_load]], [[pressure]]: supports and loads of blocks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, ClassVar, NoReturn, Self, TypeVar

import numpy as np
import shapely
from pydantic import StrictStr, model_validator

from clast.errors import ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import Extends
from clast.inputs.declaring.table import OR_PAIR, Force, Instant, Point, Stress, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.measurements import MeasuredPoint
from clast.inputs.placing.bolt_lines import Ground
from clast.model import ranges
from clast.model.checks import OVERLAP_TOLERANCE, BlockOutlines, beside_reach, locate, point_text
from clast.model.factors import Factor
from clast.model.model import (
    EdgePressures,
    Floats,
    Ints,
    LineLoads,
    MaterialPoints,
    MeasuredPoints,
    PointLoads,
)
from clast.model.ranges import check_text


class FixedPoint(Table):
    """A point of a block that is held in place by a stiff spring."""

    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class Amplitude(Table):
    """A factor of loads over time, linear between its instants and constant outside them.

    Loads name it in ``amplitude``; each step has the load times the value at its end.
    """

    NAMED: ClassVar[bool] = True

    time: list[Instant]
    """Times, s, increasing."""
    value: list[Annotated[Number, within(ranges.FACTOR)]]
    """Values at the instants, -."""

    @model_validator(mode="after")
    def _is_a_function_of_time(self) -> Self:
        count = len(self.time)
        if len(self.value) != count:
            what = f"has {len(self.value)} values for {count} instants"
            raise refusal(what, "give one value for each instant", "value")
        if count < 2:
            remedy = "give at least 2; a load that is constant needs no amplitude"
            raise refusal(f"has {count} instants", remedy, "time")
        for k, (before, after) in enumerate(pairwise(self.time), 1):
            if after <= before:
                what = f"instant {k + 1}, {after:g} s, is not after instant {k}, {before:g} s"
                remedy = "order the instants by time, each once (for a jump, 1e-9 s apart)"
                raise refusal(what, remedy, "time")
        return self

    def factor(self, name: str) -> Factor:
        """Return it as a factor of the model."""
        time, value = (np.array(one, np.float64) for one in (self.time, self.value))
        return Factor(name=name, time=time, value=value)


class Load(Table):
    """A load on a block that may change over time."""

    block: StrictStr | None = None
    """Block; needed only where blocks touch."""
    amplitude: StrictStr | None = None
    """Amplitude over time by which the load is multiplied; constant if absent."""
    name: StrictStr | None = None
    """Name by which stages refer to it; several loads may share one."""


class PointLoad(Load):
    """A force at a point that moves with its block."""

    at: Point
    """Coordinates [x, y], m."""
    force: Annotated[tuple[Force, Force], Extends("vector", "at")]
    """Force [x, y], N per metre of thickness."""


class AlongLine(Load):
    """A load along a straight line."""

    start: Point
    """First end of the line [x, y], m."""
    end: Point
    """Second end of the line [x, y], m."""

    @model_validator(mode="after")
    def _has_a_length(self) -> Self:
        check_length(self.start, self.end)
        return self


class LineLoad(AlongLine):
    """A traction along a line that moves with its block, usually along an edge."""

    traction: Annotated[tuple[Force, Force], Extends("vector", "start")]
    """Force per length [x, y], N/m per metre of thickness."""


class Pressure(AlongLine):
    """A pressure on the edges along a straight line; it stays normal to them as they turn.

    It acts on the parts of edges that lie on the line at the start of the run, from outside the
    blocks, and goes with them.
    """

    value: Annotated[
        Annotated[Stress | tuple[Stress, Stress], OR_PAIR], Extends("pressure", "start")
    ]
    """Pressure, Pa, positive into the blocks: one number, or [at start, at end], linear between."""
    block: StrictStr | None = None
    """Block; needed only where edges of two blocks lie on the line."""


def check_length(start: Point, end: Point) -> None:
    """Refuse a line whose ends are one point."""
    if start == end:
        raise refusal("has no length", "give two different ends")


L = TypeVar("L", bound=Load)


def named_loads(loads: Sequence[L], kind: str) -> Iterator[tuple[str, L]]:
    """Give each load with how messages call it."""
    for number, one in enumerate(loads, 1):
        label = f"{kind} {number}"
        if one.name is not None:
            check_text(one.name, label)
        yield label, one


def _placed(records: Iterable[tuple[str, Any]], ground: Ground) -> tuple[Ints, Floats]:
    """Return the blocks (k,) of labelled records, and their points about the origin, m, (k, e, 2).

    Points of a line are its ends, e = 2.
    """
    labels, given = zip(*records, strict=True) if records else ((), ())
    ends = [(one.start, one.end) if isinstance(one, AlongLine) else (one.at,) for one in given]
    if not ends:
        return np.zeros(0, np.int64), np.zeros((0, 2, 2))
    origin = ground.outlines.origin
    at = np.array(ends) - origin
    shapes = shapely.points(at[:, 0]) if at.shape[1] == 1 else shapely.linestrings(at)
    named = [
        -1 if one.block is None else ground.block(one.block, label)
        for label, one in zip(labels, given, strict=True)
    ]

    def where(k: int) -> str:
        return f"{labels[k]} at {point_text(at[k, 0] + origin)}"

    outlines, tree = ground.outlines, ground.tree
    block = locate(np.array(shapes), np.array(named), where, outlines, tree, ground.tolerance)
    return block, at


def fixed_points_in(records: Sequence[FixedPoint], ground: Ground) -> MaterialPoints:
    """Return the fixed points of the model."""
    block, at = _placed([(f"fixed point {k}", one) for k, one in enumerate(records, 1)], ground)
    return MaterialPoints(block=block, at=at[:, 0])


def measured_points_in(records: Sequence[MeasuredPoint], ground: Ground) -> MeasuredPoints:
    """Return the measured points of the model."""
    block, at = _placed(
        [(f"measured point '{shortened(one.name)}'", one) for one in records], ground
    )
    return MeasuredPoints(block=block, at=at[:, 0], name=tuple(one.name for one in records))


def point_loads_in(records: Sequence[PointLoad], ground: Ground) -> PointLoads:
    """Return the point loads of the model."""
    named = list(named_loads(records, "point load"))
    block, at = _placed(named, ground)
    return PointLoads(
        block=block,
        at=at[:, 0],
        force=np.array([one.force for one in records], float).reshape(-1, 2),
        factor=_factors(named, ground),
        name=tuple(one.name or "" for one in records),
    )


def line_loads_in(records: Sequence[LineLoad], ground: Ground) -> LineLoads:
    """Return the line loads of the model."""
    named = list(named_loads(records, "line load"))
    block, at = _placed(named, ground)
    return LineLoads(
        block=block,
        start=at[:, 0],
        end=at[:, 1],
        traction=np.array([one.traction for one in records], float).reshape(-1, 2),
        factor=_factors(named, ground),
        name=tuple(one.name or "" for one in records),
    )


def points_placed(kinds: Iterable[MaterialPoints | LineLoads]) -> Iterator[tuple[str, int, Floats]]:
    """Give the label, the block and the points (e, 2), m, of each place of several kinds."""
    called = {MeasuredPoints: "measured point", PointLoads: "point load", LineLoads: "line load"}
    for one in kinds:
        kind = called.get(type(one), "fixed point")
        ends = (one.start, one.end) if isinstance(one, LineLoads) else (one.at,)
        named = one.name if isinstance(one, MeasuredPoints) else ()
        for k, at in enumerate(np.stack(ends, axis=1)):
            label = f"'{shortened(named[k])}'" if named else str(k + 1)
            yield f"{kind} {label}", int(one.block[k]), at


def _factors(named: Iterable[tuple[str, Load]], ground: Ground) -> Ints:
    """Return the number of the amplitude of each load, NO_FACTOR where it has none, (k,)."""
    return np.array(
        [ground.amplitude(one.amplitude, f"{label}, amplitude") for label, one in named], np.int64
    )


@dataclass(frozen=True)
class LoadedLine:
    """A line about the origin: its first end, its unit direction and its length."""

    start: Floats
    along: Floats
    length: float

    def measured(self, points: Floats) -> tuple[Floats, Floats]:
        """Return how far points (k, 2) are along the line and to its left, m, shape (k,) each."""
        away = points - self.start
        return away @ self.along, away @ np.array([-self.along[1], self.along[0]])


def pressed_edges(
    pressures: Sequence[Pressure], ground: Ground
) -> tuple[EdgePressures, tuple[str, ...]]:
    """Return the parts of edges on which pressures act, and notes of lines that leave edges."""
    parts = [EdgePressures()]
    notes: list[str] = []
    outlines = ground.outlines
    for label, one in named_loads(pressures, "pressure"):
        start, end = (np.array(point) - outlines.origin for point in (one.start, one.end))
        length = float(np.hypot(*(end - start)))
        line = LoadedLine(start, (end - start) / length, length)
        ends = one.value if isinstance(one.value, tuple) else (one.value, one.value)
        edges = np.arange(len(outlines.vertices))
        if one.block is not None:
            edges = edges[outlines.owner == ground.block(one.block, f"{label}, block")]
        factor = ground.amplitude(one.amplitude, f"{label}, amplitude")
        edge, share, place = _parts(line, edges, outlines, ground.tolerance)
        if len(edge) == 0:
            _refuse_no_edge(label, line, edges, outlines)
        _refuse_two_blocks(label, line, edge, np.sort(place, axis=1), outlines)
        away = np.abs(line.measured(outlines.vertices[edge])[1])
        if (away > _reach(outlines, edge)).any():
            notes.append(f"{label} lies {away.max():.2g} m beside edges, and acts on them")
        pressed = float(np.abs(np.diff(place, axis=1)).sum())
        if pressed < (1.0 - OVERLAP_TOLERANCE) * line.length:
            notes.append(
                f"{label} is {line.length:.6g} m long, but edges lie along only {pressed:.6g} m "
                "of it: the pressure acts on these only"
            )
        parts.append(
            EdgePressures(
                block=outlines.owner[edge],
                edge=edge,
                share=share,
                pressure=ends[0] + (ends[1] - ends[0]) * place / line.length,
                factor=np.full(len(edge), factor),
                name=(one.name or "",) * len(edge),
            )
        )
    keys = ("block", "edge", "share", "pressure", "factor")
    joined = {key: np.concatenate([getattr(part, key) for part in parts]) for key in keys}
    names = tuple(name for part in parts for name in part.name)
    return EdgePressures(**joined, name=names), tuple(notes)


def _reach(outlines: BlockOutlines, edges: Ints) -> Floats:
    """Return how far edges may lie beside a line, m: as far as loads may beside their blocks."""
    return np.asarray(OVERLAP_TOLERANCE * np.sqrt(np.abs(outlines.area)))[outlines.owner[edges]]


def _parts(
    line: LoadedLine, edges: Ints, outlines: BlockOutlines, tolerance: float
) -> tuple[Ints, Floats, Floats]:
    """Return the edges along a line, the shares of them, and where these are on the line.

    Shapes (k,), (k, 2), -, in the direction of the edge, and (k, 2), m.  Where no edge lies along
    the line, those within the ``tolerance`` beside it do, m.
    """
    reach = _reach(outlines, edges)
    first = line.measured(outlines.vertices[edges])
    last = line.measured(outlines.vertices[outlines.following[edges]])
    low = np.clip(np.minimum(first[0], last[0]), 0.0, line.length)
    high = np.clip(np.maximum(first[0], last[0]), 0.0, line.length)
    long = np.flatnonzero(high - low > reach)  # with a length along the line, so none across it
    run, side = last[0][long] - first[0][long], last[1][long] - first[1][long]
    share = (np.stack([low, high], axis=1)[long] - first[0][long, None]) / run[:, None]
    share = np.sort(share, axis=1)
    beside = np.abs(first[1][long, None] + share * side[:, None]).max(axis=1)
    near = beside <= reach[long]
    if not near.any():
        near = beside <= beside_reach(outlines, tolerance)[outlines.owner[edges[long]]]
    chosen, share = long[near], share[near]
    # what ends at a corner ends there to the last digit
    close = reach[chosen, None] / np.abs(run[near, None])
    share = np.where(share < close, 0.0, np.where(share > 1.0 - close, 1.0, share))
    return edges[chosen], share, first[0][chosen, None] + share * run[near, None]


def _refuse_no_edge(label: str, line: LoadedLine, edges: Ints, outlines: BlockOutlines) -> NoReturn:
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
    label: str, line: LoadedLine, edge: Ints, place: Floats, outlines: BlockOutlines
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
