"""Points and lines on blocks as they are given to a builder, and the blocks they are found on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import shapely

from clast.errors import shortened
from clast.inputs.declaring.table import Inputs, Point, Table
from clast.inputs.declaring.values import number_of
from clast.inputs.loads import FixedPoint, LineLoad, PointLoad, Pressure
from clast.inputs.measurements import MeasuredPoint
from clast.model.checks import BlockOutlines, Geometries, locate, point_text
from clast.model.factors import NO_FACTOR
from clast.model.model import Floats, Ints, LineLoads, PointLoads
from clast.model.names import check_text


@dataclass(frozen=True)
class LoadPlace:
    """A point, or a line from ``at`` to ``end``, on a block; ``load`` is its force or traction."""

    label: str
    at: Point
    block: str | None
    end: Point | None = None
    load: Point = (0.0, 0.0)
    factor: str | None = None
    name: str = ""


@dataclass(frozen=True)
class LoadPlaces:
    """Where points or lines ended up: blocks (k,), ends (k, 2), loads (k, 2), factors, names."""

    block: Ints
    at: Floats
    end: Floats
    load: Floats
    factor: Ints
    name: tuple[str, ...]


def places_of(given: Inputs) -> dict[type[Table], list[LoadPlace]]:
    """Return where everything is that is at points or along lines, by its kind."""
    return {
        FixedPoint: [
            LoadPlace(f"fixed point {k}", one.at, one.block)
            for k, one in enumerate(given.all(FixedPoint), 1)
        ],
        MeasuredPoint: [
            LoadPlace(f"measured point '{shortened(one.name)}'", one.at, one.block)
            for one in given.all(MeasuredPoint)
        ],
        PointLoad: [
            LoadPlace(label, one.at, one.block, load=one.force, factor=one.amplitude, name=name)
            for label, name, one in named_loads(given.all(PointLoad), "point load")
        ],
        LineLoad: [
            LoadPlace(label, one.start, one.block, one.end, one.traction, one.amplitude, name)
            for label, name, one in named_loads(given.all(LineLoad), "line load")
        ],
    }


L = TypeVar("L", PointLoad, LineLoad, Pressure)


def named_loads(loads: Sequence[L], kind: str) -> Iterator[tuple[str, str, L]]:
    """Give each load with how messages call it, and its name, "" where it has none."""
    for number, one in enumerate(loads, 1):
        label = f"{kind} {number}"
        if one.name is not None:
            check_text(one.name, label)
        yield label, one.name or "", one


def located(
    entries: list[LoadPlace],
    block_number: dict[str, int],
    factor_number: dict[str, int],
    outlines: BlockOutlines,
    polygons: Geometries,
    moved: float,
) -> LoadPlaces:
    """Return blocks and coordinates about the origin of points or lines.

    ``moved``, m, is how far vertices may have moved since they were drawn.
    """
    count = len(entries)
    at, end, load = np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2))
    named, factor = np.full(count, -1, np.int64), np.full(count, NO_FACTOR, np.int64)
    for k, entry in enumerate(entries):
        at[k] = np.array(entry.at) - outlines.origin
        if entry.end is not None:
            end[k] = np.array(entry.end) - outlines.origin
        load[k] = entry.load
        if entry.block is not None:
            named[k] = number_of(entry.block, block_number, "block", entry.label)
        if entry.factor is not None:
            factor[k] = number_of(
                entry.factor, factor_number, "amplitude", f"{entry.label}, amplitude"
            )
    lines = np.array([entry.end is not None for entry in entries], dtype=np.bool_)
    shapes = np.array(shapely.points(at))
    if lines.any():
        shapes = np.array(shapely.linestrings(np.stack([at, end], axis=1)))
    if count == 0:
        return LoadPlaces(np.zeros(0, np.int64), at, end, load, factor, ())

    def where(k: int) -> str:
        return f"{entries[k].label} at {point_text(at[k] + outlines.origin)}"

    block = locate(shapes, named, where, outlines, shapely.STRtree(polygons), moved)
    return LoadPlaces(block, at, end, load, factor, tuple(entry.name for entry in entries))


def point_loads_of(places: LoadPlaces) -> PointLoads:
    """Return the point loads of a model, by where they are."""
    return PointLoads(
        block=places.block,
        at=places.at,
        force=places.load,
        factor=places.factor,
        name=places.name,
    )


def line_loads_of(places: LoadPlaces) -> LineLoads:
    """Return the line loads of a model, by where they are."""
    return LineLoads(
        block=places.block,
        start=places.at,
        end=places.end,
        traction=places.load,
        factor=places.factor,
        name=places.name,
    )
