"""Points and lines on blocks as they are given to a builder, and the blocks they are found on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from clast.errors import ModelError
from clast.inputs.placing.blocks import Vector
from clast.model import ranges
from clast.model.checks import Geometries, Outlines, locate, point_text
from clast.model.factors import NO_FACTOR
from clast.model.model import Floats, Ints
from clast.model.value_checks import check_numbers, number_of

NO_LOAD: Vector = ()
"""Load of a place that has none."""


@dataclass(frozen=True)
class Place:
    """A point, or a line from ``at`` to ``end``, on a block; ``load`` is its force or traction."""

    label: str
    at: Vector
    block: str | None
    end: Vector | None = None
    load: Vector = NO_LOAD
    factor: str | None = None
    name: str = ""


@dataclass(frozen=True)
class Places:
    """Where points or lines ended up: blocks (k,), ends (k, 2), loads (k, 2), factors, names."""

    block: Ints
    at: Floats
    end: Floats
    load: Floats
    factor: Ints
    name: tuple[str, ...]


def located(
    entries: list[Place],
    block_number: dict[str, int],
    factor_number: dict[str, int],
    outlines: Outlines,
    polygons: Geometries,
    moved: float,
) -> Places:
    """Return blocks and coordinates about the origin of points or lines.

    ``moved``, m, is how far vertices may have moved since they were drawn.
    """
    count = len(entries)
    at, end, load = np.zeros((count, 2)), np.zeros((count, 2)), np.zeros((count, 2))
    named, factor = np.full(count, -1, np.int64), np.full(count, NO_FACTOR, np.int64)
    for k, entry in enumerate(entries):
        at[k] = check_numbers(entry.at, 2, entry.label) - outlines.origin
        if entry.end is not None:
            end[k] = check_numbers(entry.end, 2, f"{entry.label}, end") - outlines.origin
        if entry.load is not NO_LOAD:
            load[k] = check_numbers(
                entry.load, 2, f"{entry.label}, force or traction", ranges.FORCE
            )
        if entry.block is not None:
            named[k] = number_of(entry.block, block_number, "block", entry.label)
        if entry.factor is not None:
            factor[k] = number_of(entry.factor, factor_number, "table", f"{entry.label}, factor")
    lines = np.array([entry.end is not None for entry in entries], dtype=np.bool_)
    for k in np.flatnonzero(lines & (at == end).all(axis=1))[:1]:
        raise ModelError("has no length", where=entries[k].label, remedy="give two different ends")
    shapes = np.array(shapely.points(at))
    if lines.any():
        shapes = np.array(shapely.linestrings(np.stack([at, end], axis=1)))
    if count == 0:
        return Places(np.zeros(0, np.int64), at, end, load, factor, ())

    def where(k: int) -> str:
        return f"{entries[k].label} at {point_text(at[k] + outlines.origin)}"

    block = locate(shapes, named, where, outlines, shapely.STRtree(polygons), moved)
    return Places(block, at, end, load, factor, tuple(entry.name for entry in entries))
