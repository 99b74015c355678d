"""[[viscous_boundary]]: outer edges through which waves leave the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import shapely
from pydantic import Field, StrictStr, model_validator

from clast.errors import ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.table import Instant, Loop, Point, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.in_situ import Side
from clast.inputs.placing.bolt_lines import Ground
from clast.model import ranges
from clast.model.checks import BlockOutlines, point_text
from clast.model.edges import outline_edges
from clast.model.ground_motion import GroundMotion, IncomingWave
from clast.model.model import Bools, Ints
from clast.model.surroundings import DOWNWARDS, ViscousEdges

Multiple = Annotated[Number, Field(ge=0.0), within(ranges.FACTOR)]


class Where(Table):
    """Where a viscous boundary is: one of these."""

    side: Side | None = None
    """Side of the box around all blocks: all edges on it."""
    edges: list[tuple[Point, Point]] | None = None
    """Straight lines [[p, q], ...] along outer edges, m: all edges on them."""
    polygon: Loop | None = None
    """Polygon, m: all outer edges with their middle in it."""

    ONE_OF: ClassVar = {
        'give one of side = "bottom", edges = [[p, q], ...] and polygon = [...]': (
            "side",
            "edges",
            "polygon",
        )
    }


class ViscousBoundary(Table):
    """Dashpots on outer edges in place of the rock beyond, which absorb waves.

    On an edge act -normal rho c_p v_n and -tangential rho c_s v_t, with rho, c_p and c_s of the
    block behind it.
    """

    where: Where
    """Which edges: {side = "bottom"}, {edges = [[p, q], ...]} or {polygon = [...]}."""
    normal: Multiple = 1.0
    """Multiple of rho c_p; 0: free along the normal."""
    tangential: Multiple = 1.0
    """Multiple of rho c_s; 0: free along the edge."""
    static: Literal["hold", "none"] = "hold"
    """Forces of the springs when the dashpots begin: kept as a traction, "hold", or removed,
    "none"."""
    begins: Annotated[Instant, Field(ge=0.0)] = 0.0
    """Time, s, from which the dashpots act; springs as stiff as those of fixed points hold the
    edges before it, in the directions that have dashpots."""
    stage: StrictStr | None = None
    """Stage with which the dashpots begin, in the place of begins."""

    @model_validator(mode="after")
    def _begins_once(self) -> Self:
        if self.stage == "":
            what = "'' is not the name of a stage"
            raise refusal(what, 'give the name of a [[stage]], e.g. "quake"', "stage")
        if self.stage is not None and self.begins:
            named = shortened(self.stage)
            what = f"begins both at {self.begins:g} s and with the stage '{named}'"
            raise refusal(what, "give begins or stage")
        if self.normal == self.tangential == 0.0:
            what = "normal and tangential are both 0, which is a free edge"
            raise refusal(what, "leave the boundary out, or give normal = 1 and tangential = 1")
        return self


def with_where(keys: dict[str, Any], kind: type[Table] = Where) -> dict[str, Any]:
    """Return the keys of a boundary of a script, which says where by keys of their own."""
    places = kind.model_fields
    where = {key: keys[key] for key in places if keys.get(key) is not None}
    return {"where": where, **{key: keys[key] for key in keys if key not in places}}


STATIC = {"hold": 1.0, "none": 0.0}
"""Share of the support reactions that stays, by name."""
BESIDE_SHARE = 1e-6
"""An edge lies on a line or beside another block up to this share of its own length."""
OUTSIDE = np.array([0.05, 0.5, 0.95])
"""Places along an edge, as shares of its length, where rock beyond it would be in a block."""


def viscous_edges(boundaries: Sequence[ViscousBoundary], ground: Ground) -> ViscousEdges:
    """Return the edges of viscous boundaries, in their order."""
    outlines = ground.outlines
    parts = [ViscousEdges()]
    seen: dict[int, str] = {}
    for number, one in enumerate(boundaries, 1):
        label = f"viscous boundary {number}"
        edge = _edges(label, one.where, ground)
        for k in edge[ground.fixed[outlines.owner[edge]]][:1].tolist():
            what = f"{_edge_text(k, outlines)} is on a fixed block, which cannot absorb waves"
            remedy = (
                "remove fixed = true of the block; in-situ stress, or supports until the dashpots "
                "begin (begins), hold it"
            )
            raise ModelError(what, where=label, remedy=remedy)
        for k in edge.tolist():
            if k in seen:
                what = f"{_edge_text(k, outlines)} is an edge of {seen[k]}, too"
                remedy = "list each edge in one viscous boundary only"
                raise ModelError(what, where=label, remedy=remedy)
        seen |= dict.fromkeys(edge.tolist(), label)
        numbers = {
            "normal": one.normal,
            "tangential": one.tangential,
            "kept": STATIC[one.static],
            "begins": one.begins if one.stage is None else np.inf,
        }
        columns = {name: np.full(len(edge), value) for name, value in numbers.items()}
        stage = (one.stage or "",) * len(edge)
        parts.append(ViscousEdges(edge=edge, block=outlines.owner[edge], stage=stage, **columns))
    names = ("edge", "block", "normal", "tangential", "kept", "begins")
    joined = {name: np.concatenate([getattr(one, name) for one in parts]) for name in names}
    return ViscousEdges(**joined, stage=sum((one.stage for one in parts), ()))


def check_incoming(motion: GroundMotion, edges: ViscousEdges, outlines: BlockOutlines) -> None:
    """Refuse a wave from below where no viscous edge faces down."""
    if not isinstance(motion, IncomingWave):
        return
    line = outlines.vertices[outlines.following[edges.edge]] - outlines.vertices[edges.edge]
    down = -line[:, 0] <= DOWNWARDS * np.hypot(*line.T)
    if not down.any():
        what = "no viscous edge faces down" if len(edges) else "there are no viscous boundaries"
        raise ModelError(
            f"the wave needs a boundary to enter through, but {what}",
            where="ground_motion",
            remedy='give [[viscous_boundary]] with where = {side = "bottom"}, or let the motion '
            'act as a "body-force" or on the "base"',
        )


def _edges(label: str, place: Where, ground: Ground) -> Ints:
    """Return the edges of a boundary, in their order."""
    outlines = ground.outlines
    if place.side is not None:
        edge = outline_edges(outlines.vertices, outlines.start, (place.side,))[:, 0]
        if len(edge) == 0:
            what = (
                f"no edge lies on the {place.side} side of the box around all blocks, only corners"
            )
            remedy = "name the edges: edges = [[p, q], ...] with points p and q, or a polygon"
            raise ModelError(what, where=f"{label}, where", remedy=remedy)
    elif place.edges is not None:
        edge = _on_lines(label, place.edges, outlines)
        for one in edge[~_is_outer(edge, ground)][:1].tolist():
            what = f"{_edge_text(one, outlines)} borders on another block"
            remedy = "give edges with no block beyond them: the waves leave the model there"
            raise ModelError(what, where=f"{label}, where", remedy=remedy)
    else:
        edge = _within(label, place.polygon or [], ground)
    return np.unique(edge)


def _on_lines(label: str, lines: Sequence[tuple[Point, Point]], outlines: BlockOutlines) -> Ints:
    """Return the edges that lie along straight lines."""
    here, there = outlines.vertices, outlines.vertices[outlines.following]
    near = BESIDE_SHARE * np.sqrt(np.abs(outlines.area))[outlines.owner]
    edges = [np.zeros(0, np.int64)]
    for number, line in enumerate(lines, start=1):
        where = f"{label}, where, edges {number}"
        ends = np.array(line)
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
            what = f"no edge lies on the line from {ends_text}"
            remedy = "give the corners of edges on the outline of the model"
            raise ModelError(what, where=where, remedy=remedy)
        edges.append(np.flatnonzero(on))
    if not lines:
        remedy = "name the edges: edges = [[p, q], ...] with points p and q"
        raise ModelError("is an empty list", where=f"{label}, where, edges", remedy=remedy)
    return np.concatenate(edges)


def _within(label: str, polygon: Loop, ground: Ground) -> Ints:
    """Return the outer edges whose middle lies in a polygon."""
    outlines = ground.outlines
    where = f"{label}, where, polygon"
    if len(polygon) < 3:
        what = f"{len(polygon)} points do not make a polygon"
        raise ModelError(what, where=where, remedy="give 3 points or more")
    shape = shapely.Polygon(np.array(polygon) - outlines.origin)
    if not shape.is_valid:
        what = "the polygon crosses itself"
        raise ModelError(what, where=where, remedy="order its points along its outline")
    middle = 0.5 * (outlines.vertices + outlines.vertices[outlines.following])
    edge = np.flatnonzero(shapely.covers(shape, shapely.points(middle)))
    edge = edge[_is_outer(edge, ground)]
    if len(edge) == 0:
        what = "no edge on the outline of the model has its middle in the polygon"
        remedy = "enclose the edges through which waves should leave"
        raise ModelError(what, where=where, remedy=remedy)
    return edge


def _is_outer(edge: Ints, ground: Ground) -> Bools:
    """Return which edges (k,) have no other block right behind them, shape (k,)."""
    outlines = ground.outlines
    first = outlines.vertices[edge]
    line = outlines.vertices[outlines.following[edge]] - first
    out = BESIDE_SHARE * np.stack([line[:, 1], -line[:, 0]], axis=1)
    at = first[:, None] + OUTSIDE[:, None] * line[:, None] + out[:, None]
    hit, block = ground.tree.query(shapely.points(at.reshape(-1, 2)), predicate="intersects")
    number = hit // len(OUTSIDE)
    outer = np.ones(len(edge), np.bool_)
    outer[number[block != outlines.owner[edge][number]]] = False
    return outer


def _edge_text(edge: int, outlines: BlockOutlines) -> str:
    """Return how a message calls an edge."""
    ends = " to ".join(point_text(outlines.at(k)) for k in (edge, int(outlines.following[edge])))
    return f"{ends} of {outlines.label(int(outlines.owner[edge]))}"
