"""Viscous boundaries as they are given to a builder, and the edges that they are found on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from clast.errors import ModelError, shortened
from clast.inputs.placing.blocks import Vector
from clast.model.checks import Geometries, Outlines, point_text
from clast.model.ground_motion import GroundMotion, IncomingWave
from clast.model.in_situ import SIDES
from clast.model.model import Bools, Floats, Ints
from clast.model.outline import outline_edges
from clast.model.value_checks import check_number, check_numbers
from clast.model.viscous_edges import DOWNWARDS, ViscousEdges

STATIC = {"hold": 1.0, "none": 0.0}
"""Share of what supports bear that stays, by name."""
BESIDE = 1e-6
"""An edge lies on a line or beside another block up to this share of its own length."""
OUTSIDE = np.array([0.05, 0.5, 0.95])
"""Places along an edge, as shares of its length, where rock beyond it would be in a block."""


@dataclass(frozen=True, kw_only=True)
class ViscousBoundary:
    """A viscous boundary as it is given; one of ``side``, ``edges`` and ``polygon`` says where."""

    label: str
    side: str | None
    edges: Sequence[tuple[Vector, Vector]] | None
    polygon: Sequence[Vector] | Floats | None
    normal: float
    tangential: float
    static: str
    begins: float
    stage: str | None = None


def viscous_edges(
    entries: Sequence[ViscousBoundary], outlines: Outlines, polygons: Geometries, fixed: Bools
) -> ViscousEdges:
    """Return the edges of viscous boundaries, in their order.

    Raises ModelError for edges within the rock, on fixed blocks or in two boundaries, and for
    places without any edge.
    """
    found = [ViscousEdges()]
    seen: dict[int, str] = {}
    for entry in entries:
        numbers = _numbers(entry)
        edge = _edges(entry, outlines, polygons)
        _refuse_fixed(entry, edge, outlines, fixed)
        for one in edge.tolist():
            if one in seen:
                raise ModelError(
                    f"{_edge_text(one, outlines)} is an edge of {seen[one]}, too",
                    where=entry.label,
                    remedy="let each edge be in one viscous boundary",
                )
        seen |= dict.fromkeys(edge.tolist(), entry.label)
        columns = {name: np.full(len(edge), value) for name, value in numbers.items()}
        stage = (entry.stage or "",) * len(edge)
        found.append(ViscousEdges(edge=edge, block=outlines.owner[edge], stage=stage, **columns))
    names = ("edge", "block", "normal", "tangential", "kept", "begins")
    joined = {name: np.concatenate([getattr(one, name) for one in found]) for name in names}
    return ViscousEdges(**joined, stage=sum((one.stage for one in found), ()))


def check_incoming(motion: GroundMotion, edges: ViscousEdges, outlines: Outlines) -> None:
    """Refuse a wave from below where no viscous edge faces down."""
    if not isinstance(motion, IncomingWave):
        return
    line = outlines.vertices[outlines.following[edges.edge]] - outlines.vertices[edges.edge]
    down = -line[:, 0] <= DOWNWARDS * np.hypot(*line.T)
    if not down.any():
        what = "no viscous edge faces down" if len(edges) else "there are no viscous boundaries"
        raise ModelError(
            f"the wave has to come in, but {what}",
            where="ground_motion",
            remedy='give [[viscous_boundary]] with where = {side = "bottom"}, or let the motion '
            'act as a "body-force" or on the "base"',
        )


def _numbers(entry: ViscousBoundary) -> dict[str, float]:
    """Return multiples, share and time of a boundary, checked."""
    where = entry.label
    if entry.static not in STATIC:
        raise ModelError(
            f"static is {entry.static!r}",
            where=f"{where}, static",
            remedy="it is " + " or ".join(f'"{name}"' for name in STATIC),
        )
    numbers = {
        key: check_number(getattr(entry, key), f"{where}, {key}")
        for key in ("normal", "tangential", "begins")
    }
    for key, value in numbers.items():
        if not 0.0 <= value < np.inf:
            raise ModelError(
                f"{value:g} is below 0 or not finite",
                where=f"{where}, {key}",
                remedy="give 0 or more; 1 is the impedance of the rock"
                if key != "begins"
                else "give a time in s, 0 or more",
            )
    if entry.stage is not None:
        numbers["begins"] = _until_stage(entry)
    if numbers["normal"] == numbers["tangential"] == 0.0:
        raise ModelError(
            "normal and tangential are both 0: that is a free edge",
            where=where,
            remedy="leave the boundary out, or give normal = 1 and tangential = 1",
        )
    return {**numbers, "kept": STATIC[entry.static]}


def _until_stage(entry: ViscousBoundary) -> float:
    """Return the time at which a boundary begins whose stage is still to come."""
    if not isinstance(entry.stage, str) or not entry.stage:
        raise ModelError(
            f"{shortened(repr(entry.stage))} is no name of a stage",
            where=f"{entry.label}, stage",
            remedy='give the name of a [[stage]], e.g. stage = "quake"',
        )
    if entry.begins:
        raise ModelError(
            f"begins both at {entry.begins:g} s and with the stage '{shortened(entry.stage)}'",
            where=entry.label,
            remedy="give begins or stage",
        )
    return np.inf


def _edges(entry: ViscousBoundary, outlines: Outlines, polygons: Geometries) -> Ints:
    """Return the edges of a boundary, in their order."""
    given = [key for key in ("side", "edges", "polygon") if getattr(entry, key) is not None]
    if len(given) != 1:
        raise ModelError(
            "says where it is by " + (" and ".join(given) if given else "nothing"),
            where=f"{entry.label}, where",
            remedy='give one of side = "bottom", edges = [[p, q], ...] and polygon = [...]',
        )
    if entry.side is not None:
        edge = _on_side(entry, outlines)
    elif entry.edges is not None:
        edge = _on_lines(entry, entry.edges, outlines)
        inner = edge[~_is_outer(edge, outlines, polygons)]
        for one in inner[:1].tolist():
            raise ModelError(
                f"{_edge_text(one, outlines)} has another block behind it",
                where=f"{entry.label}, where",
                remedy="give edges with no block beyond them: waves leave the model there",
            )
    else:
        edge = _within(entry, outlines, polygons)
    return np.unique(edge)


def _on_side(entry: ViscousBoundary, outlines: Outlines) -> Ints:
    side = str(entry.side)
    if side not in SIDES:
        raise ModelError(
            f"there is no side '{side}'",
            where=f"{entry.label}, where",
            remedy=f"the sides are {', '.join(SIDES)}",
        )
    edge = outline_edges(outlines.vertices, outlines.start, (side,))[:, 0]
    if len(edge) == 0:
        raise ModelError(
            f"no edge lies on the {side} side of the box around all blocks, only corners",
            where=f"{entry.label}, where",
            remedy="name the edges: edges = [[p, q], ...] with points p and q, or a polygon",
        )
    return edge


def _on_lines(entry: ViscousBoundary, lines: Any, outlines: Outlines) -> Ints:
    """Return the edges that lie along straight lines."""
    here, there = outlines.vertices, outlines.vertices[outlines.following]
    near = BESIDE * np.sqrt(np.abs(outlines.area))[outlines.owner]
    found = []
    for number, line in enumerate(lines, start=1):
        where = f"{entry.label}, where, edges {number}"
        ends = check_numbers(np.ravel(np.asarray(line, object)).tolist(), 4, where).reshape(2, 2)
        first, last = ends - outlines.origin
        length = float(np.hypot(*(last - first)))
        if length == 0.0:
            raise ModelError("has no length", where=where, remedy="give two different ends")
        along = (last - first) / length
        on = np.ones(len(here), np.bool_)
        for end in (here, there):
            away = end - first
            on &= np.abs(away[:, 0] * along[1] - away[:, 1] * along[0]) <= near
            on &= (away @ along >= -near) & (away @ along <= length + near)
        if not on.any():
            ends_text = " to ".join(point_text(end) for end in ends)
            raise ModelError(
                f"no edge lies on the line from {ends_text}",
                where=where,
                remedy="give the corners of edges on the outline of the model",
            )
        found.append(np.flatnonzero(on))
    if not found:
        raise ModelError(
            "is an empty list",
            where=f"{entry.label}, where, edges",
            remedy="name the edges: edges = [[p, q], ...] with points p and q",
        )
    return np.concatenate(found)


def _within(entry: ViscousBoundary, outlines: Outlines, polygons: Geometries) -> Ints:
    """Return the outer edges whose middle lies in a polygon."""
    where = f"{entry.label}, where, polygon"
    corners = [check_numbers(corner, 2, where) for corner in entry.polygon or ()]
    if len(corners) < 3:
        raise ModelError(
            f"{len(corners)} points are no polygon", where=where, remedy="give 3 points or more"
        )
    shape = shapely.Polygon(np.array(corners) - outlines.origin)
    if not shape.is_valid:
        raise ModelError(
            "the polygon crosses itself", where=where, remedy="order its points along its outline"
        )
    middle = 0.5 * (outlines.vertices + outlines.vertices[outlines.following])
    edge = np.flatnonzero(shapely.covers(shape, shapely.points(middle)))
    edge = edge[_is_outer(edge, outlines, polygons)]
    if len(edge) == 0:
        raise ModelError(
            "no edge on the outline of the model has its middle in the polygon",
            where=where,
            remedy="let it enclose the edges through which waves are to leave",
        )
    return edge


def _is_outer(edge: Ints, outlines: Outlines, polygons: Geometries) -> Bools:
    """Return which edges (k,) have no other block right behind them, shape (k,)."""
    first = outlines.vertices[edge]
    line = outlines.vertices[outlines.following[edge]] - first
    out = BESIDE * np.stack([line[:, 1], -line[:, 0]], axis=1)
    at = first[:, None] + OUTSIDE[:, None] * line[:, None] + out[:, None]
    tree = shapely.STRtree(polygons)
    hit, block = tree.query(shapely.points(at.reshape(-1, 2)), predicate="intersects")
    number = hit // len(OUTSIDE)
    outer = np.ones(len(edge), np.bool_)
    outer[number[block != outlines.owner[edge][number]]] = False
    return outer


def _refuse_fixed(entry: ViscousBoundary, edge: Ints, outlines: Outlines, fixed: Bools) -> None:
    """Refuse edges of blocks that do not move."""
    for one in edge[fixed[outlines.owner[edge]]][:1].tolist():
        raise ModelError(
            f"{_edge_text(one, outlines)} is on a fixed block, which takes up no waves",
            where=entry.label,
            remedy="remove fixed = true of the block; in-situ stress, or supports until the "
            "dashpots begin (begins), hold it",
        )


def _edge_text(edge: int, outlines: Outlines) -> str:
    """Return how a message calls an edge."""
    ends = " to ".join(point_text(outlines.at(k)) for k in (edge, int(outlines.following[edge])))
    return f"{ends} of {outlines.label(int(outlines.owner[edge]))}"
