"""Cut blocks as plain arrays: the input of every writer, and the output of readers of blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from clast.errors import CaseError
from clast.model.arrays import Floats, Ints, areas, owners, polygons_of
from clast.rockmass.drawings.drawing import LeftOut


@dataclass(frozen=True, kw_only=True, eq=False)
class Blocks:
    """Polygons with their rocks, and the joints along their edges."""

    vertices: Floats
    """Vertices of all blocks, m, counter-clockwise, shape (nv, 2)."""
    block_start: Ints
    """First vertex of each block, and the number of vertices, shape (nb + 1,)."""
    rock: tuple[str, ...]
    """Rock of each block."""
    edge_joint: tuple[str, ...]
    """Joint of the edge that starts at each vertex; empty where there is none."""
    name: tuple[str, ...] = ()
    """Name of each block; their numbers from 1 if empty."""
    layer: tuple[str, ...] = ()
    """Layer of a drawing that each block is on; empty for other files."""
    notes: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()

    @property
    def count(self) -> int:
        """Return the number of blocks."""
        return len(self.block_start) - 1

    def polygon(self, block: int) -> Floats:
        """Return the vertices of a block, m, shape (n, 2)."""
        return self.vertices[self.block_start[block] : self.block_start[block + 1]]


def blocks_of(
    vertices: Any,
    block_start: Any,
    rock: Sequence[str],
    edge_joint: Sequence[str] | None = None,
    where: str = "blocks",
    name: Sequence[str] = (),
) -> Blocks:
    """Return blocks of plain arrays: (nv, 2), m, (nb + 1,), (nb,), (nv,) and (nb,) names.

    Raises CaseError where the arrays do not belong together, or where a coordinate is not finite.
    """
    try:
        points = np.array(vertices, dtype=np.float64)
        given = np.asarray(block_start)
        start = given.astype(np.int64)
        whole = np.array_equal(given, start)
    except (TypeError, ValueError, OverflowError) as error:
        raise CaseError(f"the arrays are not numbers: {error}", where=where) from None
    joints = tuple(str(name) for name in ([""] * len(points) if edge_joint is None else edge_joint))
    rocks = tuple(str(name) for name in rock)
    faults = {
        f"vertices have shape {points.shape}, not (nv, 2)": points.ndim != 2
        or points.shape[-1] != 2,
        "a vertex is not finite": not np.isfinite(points).all(),
        f"block_start has shape {start.shape}, not (nb + 1,)": start.ndim != 1 or len(start) == 0,
        "block_start has no whole numbers": not whole,
    }
    fault = next((what for what, there in faults.items() if there), "")
    fault = fault or _uneven(points, start, rocks, joints)
    if not fault and len(name) not in (0, len(start) - 1):
        fault = f"there are {len(name)} names for {len(start) - 1} blocks"
    if fault:
        remedy = "give vertices, block_start, rock and edge_joint of one system"
        raise CaseError(fault, where=where, remedy=remedy)
    names = tuple(map(str, name))
    return Blocks(vertices=points, block_start=start, rock=rocks, edge_joint=joints, name=names)


def counter_clockwise(blocks: Blocks) -> Blocks:
    """Return blocks all of which run counter-clockwise, with a note on those that did not.

    Turned blocks keep their first vertex, and every edge its joint.
    """
    start = blocks.block_start
    count = np.diff(start)
    owner = owners(start)
    clockwise = areas(blocks.vertices, start) < 0.0
    if not clockwise.any():
        return blocks
    entry = np.arange(len(owner))
    within, last = entry - start[owner], start[owner] + start[owner + 1] - 1
    vertex = np.where(
        clockwise[owner], start[owner] + (count[owner] - within) % count[owner], entry
    )
    edge = np.where(clockwise[owner], last - entry, entry)
    numbers = np.flatnonzero(clockwise) + 1
    listed = ", ".join(map(str, numbers[:10])) + (", ..." if len(numbers) > 10 else "")
    note = f"{len(numbers)} blocks ran clockwise and were reversed: {listed}"
    return replace(
        blocks,
        vertices=np.ascontiguousarray(blocks.vertices[vertex]),
        edge_joint=tuple(blocks.edge_joint[k] for k in edge.tolist()),
        notes=(*blocks.notes, note),
    )


def _uneven(points: Floats, start: Ints, rocks: Sequence[str], joints: Sequence[str]) -> str:
    """Return the disagreement in the lengths of the arrays, or nothing."""
    if start[0] != 0 or start[-1] != len(points):
        return f"block_start goes from {start[0]} to {start[-1]}, not from 0 to {len(points)}"
    few = np.flatnonzero(np.diff(start) < 3)
    if len(few):
        return f"block {few[0]} has {np.diff(start)[few[0]]} vertices, and a block at least 3"
    if len(rocks) != len(start) - 1:
        return f"there are {len(rocks)} rocks for {len(start) - 1} blocks"
    if len(joints) != len(points):
        return f"there are {len(joints)} joints of edges for {len(points)} vertices"
    return ""


def crossed_blocks(ends: Any, vertices: Any, block_start: Any) -> tuple[Ints, Floats]:
    """Return the blocks that a line crosses (k,), rising, and a point of it in each (k, 2), m.

    ``ends`` are (2, 2), m, vertices (nv, 2), m, block_start (nb + 1,).
    The point is the middle of the longest part of the line in the block; a part along an edge
    counts, a corner does not.
    """
    line = shapely.LineString(np.asarray(ends, float))
    polygons = polygons_of(np.asarray(vertices, float), np.asarray(block_start, np.int64))
    near = np.sort(shapely.STRtree(polygons).query(line, predicate="intersects"))
    blocks, points = [], []
    for block in near:
        within = shapely.intersection(line, polygons[block])
        part = max(shapely.get_parts(within), key=lambda one: one.length)
        if part.length > 1e-6 * line.length:  # shorter ones only touch the block
            blocks.append(int(block))
            points.append(part.interpolate(0.5, normalized=True).coords[0])
    return np.array(blocks, np.int64), np.array(points, float).reshape(-1, 2)


def blocks_with(points: Any, vertices: Any, block_start: Any) -> Ints:
    """Return the block that each point lies in, -1 for none, shape (k,).

    Points are (k, 2), vertices (nv, 2), m, block_start (nb + 1,).  A point on an edge lies in
    the block of the lower number.
    """
    places = shapely.points(np.asarray(points, float).reshape(-1, 2))
    polygons = polygons_of(np.asarray(vertices, float), np.asarray(block_start, np.int64))
    point, block = shapely.STRtree(polygons).query(places, predicate="intersects")
    lowest = np.full(len(places), len(polygons), np.int64)
    np.minimum.at(lowest, point, block)
    return np.where(lowest < len(polygons), lowest, -1)
