"""[[measured_point]], [[measured_contact]], [[measured_reaction]] and others, [[reference]]."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import StrictStr

from clast import spelling
from clast.actions.motions import Motions, OneMotion
from clast.block import polygon
from clast.errors import Fault, ModelError, shortened
from clast.inputs.declaring.annotations import RefersTo
from clast.inputs.declaring.table import Point, Positive, Shift, Table
from clast.inputs.declaring.values import number_of
from clast.inputs.in_situ import Side
from clast.inputs.placing.bolt_lines import Ground
from clast.model.edges import outline_edges
from clast.model.joints import JointTable
from clast.model.model import Convergences, Floats, Ints, MeasuredContacts, MeasuredPoints
from clast.model.ranges import check_names
from clast.model.supports import Reactions

PointName = Annotated[StrictStr, RefersTo("measured_point")]


class MeasuredPoint(Table):
    """A point whose displacement, velocity and rotation are recorded every step."""

    name: StrictStr
    """Name."""
    at: Point
    """Coordinates [x, y], m."""
    block: StrictStr | None = None
    """Block; needed only where blocks touch."""


class MeasuredConvergence(Table):
    """The approach of two measured points, recorded every step: positive where they close in.

    It is their relative displacement along the line between them at the start, since then or since
    a stage has reset it.
    """

    name: StrictStr
    """Name."""
    of: tuple[PointName, PointName]
    """Two [[measured_point]]s, e.g. ["left wall", "right wall"]."""


class MeasuredContact(Table):
    """Forces, opening and slip of contacts, recorded every step: at a place, or of a joint."""

    name: StrictStr
    """Name."""
    at: Point | None = None
    """Place [x, y], m: the contact nearest to it at each step."""
    joint: StrictStr | None = None
    """Joint: the mean of its contacts, each by its length, with extremes."""

    ONE_OF: ClassVar = {"give a place [x, y] in m, or the name of a joint": ("at", "joint")}


class MeasuredReaction(Table):
    """The total reaction of some supports, recorded every step."""

    name: StrictStr
    """Name."""
    side: Side | None = None
    """Side of the box around all blocks: its fixed blocks and points, viscous edges, and edges
    under in-situ stress."""
    block: StrictStr | None = None
    """Block, fixed or moved."""
    blocks: list[StrictStr] | None = None
    """Blocks, fixed or moved."""
    fixed_point: Point | None = None
    """Coordinates [x, y] of a [[fixed_point]], m."""
    about: Point | None = None
    """Reference point [x, y] of its moment, m; the centre of the supports if absent."""

    ONE_OF: ClassVar = {
        'give one of block = "1", blocks = ["1", "2"], fixed_point = [x, y], side = "left"': (
            "block",
            "blocks",
            "fixed_point",
            "side",
        )
    }


class Reference(Table):
    """A known displacement, to compare a run with."""

    point: PointName
    """Measured point."""
    displacement: Shift
    """Displacement [u, v] since the start, or since a stage has reset it, m."""
    time: Positive | None = None
    """When, s; the end of the run if absent."""
    source: Annotated[StrictStr, RefersTo()] = ""
    """Where it comes from, e.g. "closed form: g t2/2"."""


def point_faults(
    points: Sequence[MeasuredPoint],
    references: Sequence[Reference],
    convergences: Sequence[MeasuredConvergence],
) -> Iterator[Fault]:
    """Yield faults of points in a case file: names with a slash, references to none."""
    for number, point in enumerate(points):
        if "/" in point.name:  # scripts may: only a file's names are typed in again
            yield Fault(
                f"'{shortened(point.name)}' has a /, but names places in the result file",
                "give it a name without /",
                ("measured_point", number, "name"),
            )
    names = [point.name for point in points]
    named = [(one.point, ("reference", k, "point")) for k, one in enumerate(references)]
    for k, pair in enumerate(convergences):
        named += [(end, ("measured_convergence", k, "of")) for end in dict.fromkeys(pair.of)]
    for name, place in named:
        if name not in names:
            yield Fault(
                f"there is no measured point '{shortened(name)}'",
                spelling.advice(name, names, kind="measured point"),
                place,
            )


def convergences_in(given: Sequence[MeasuredConvergence], points: MeasuredPoints) -> Convergences:
    """Return the convergences to be recorded; raises ModelError for pairs without a distance."""
    check_names("measured convergence", [one.name for one in given])
    number = {name: k for k, name in enumerate(points.name)}
    pairs = np.zeros((len(given), 2), np.int64)
    for k, one in enumerate(given):
        where = f"measured convergence '{shortened(one.name)}', of"
        pairs[k] = [number_of(end, number, "measured point", where) for end in one.of]
        if not np.ptp(points.at[pairs[k]], axis=0).any():
            first, second = map(shortened, one.of)
            what = f"'{first}' and '{second}' are at one place: no line joins them"
            raise ModelError(what, where=where, remedy="name two points that lie apart")
    return Convergences(name=tuple(one.name for one in given), point=pairs)


def contacts_measured(
    given: Sequence[MeasuredContact], table: JointTable, origin: Floats
) -> MeasuredContacts:
    """Return the contacts to be recorded; raises ModelError for names that cannot be."""
    check_names("measured contact", [one.name for one in given])
    joints = {joint.name: k for k, joint in enumerate(table.joints)}
    number = [
        -1
        if one.joint is None
        else number_of(one.joint, joints, "joint", f"measured contact {k}, joint")
        for k, one in enumerate(given, 1)
    ]
    nowhere = np.full(2, np.nan)
    places = [nowhere if one.at is None else np.asarray(one.at) - origin for one in given]
    return MeasuredContacts(
        name=tuple(one.name for one in given),
        at=np.array(places, np.float64).reshape(-1, 2),
        joint=np.array(number, np.int64),
    )


@dataclass(frozen=True)
class Supported:
    """Supports and motions of the blocks."""

    ground: Ground
    """The blocks."""
    viscous_edges: Ints
    """First vertices of the viscous edges, shape (v,)."""
    outline: Ints
    """First vertices of the edges under in-situ stress, shape (o,)."""
    actions: tuple[Any, ...]
    """Actions on the blocks."""

    @property
    def motions(self) -> dict[str, OneMotion]:
        """The motions by their names."""
        groups = [action.each for action in self.actions if isinstance(action, Motions)]
        return {one.name: one for each in groups for one in each}

    @property
    def moved(self) -> Ints:
        """Blocks that motions move, shape (k,)."""
        blocks = [one.block for one in self.motions.values()]
        return np.concatenate([np.zeros(0, np.int64), *blocks])


NONE = np.zeros(0, np.int64)
SIDES = {"left": (0, 0), "right": (0, 1), "bottom": (1, 0), "top": (1, 1)}
"""Axis of each side, and whether it is the low or the high end."""


@dataclass(frozen=True, eq=False)
class _Part:
    """A reaction: its name, its supports, and the point of its moment."""

    name: str
    about: Floats
    blocks: Ints = field(default_factory=NONE.copy)
    fixed_points: Ints = field(default_factory=NONE.copy)
    viscous_edges: Ints = field(default_factory=NONE.copy)
    outline: Ints = field(default_factory=NONE.copy)
    ground: Ints = field(default_factory=NONE.copy)


def reactions_in(records: Sequence[MeasuredReaction], supports: Supported) -> Reactions:
    """Return the reactions that are recorded of supports: totals, motions, ``records``."""
    parts = [*_totals(supports), *(_measured(one, supports) for one in records)]
    if not parts:
        return Reactions()
    check_names("reaction", [one.name for one in parts])

    def pairs(kind: str) -> Ints:
        rows = [(k, int(one)) for k, part in enumerate(parts) for one in getattr(part, kind)]
        return np.array(rows, np.int64).reshape(-1, 2)

    return Reactions(
        name=tuple(one.name for one in parts),
        about=np.array([one.about for one in parts]),
        of_block=pairs("blocks"),
        of_fixed_point=pairs("fixed_points"),
        of_viscous_edge=pairs("viscous_edges"),
        of_outline=pairs("outline"),
        of_ground=pairs("ground"),
    )


def _totals(supports: Supported) -> Iterable[_Part]:
    """Give the totals of each kind of support, and the reactions of motions."""
    ground = supports.ground
    still = np.setdiff1d(np.flatnonzero(ground.fixed), supports.moved)
    places = [one.on_ground for one in supports.actions if hasattr(one, "on_ground")]
    at = np.concatenate([np.zeros((0, 2)), *places])
    if len(still) or len(at):
        # what the ground holds by links and linings is held as by a fixed block
        about = _middle(supports, still, NONE) if len(still) else at.mean(axis=0)
        held = np.zeros(min(1, len(at)), np.int64)
        yield _Part("fixed blocks", about, blocks=still, ground=held)
    points = np.arange(len(supports.ground.points.block))
    if len(points):
        yield _Part("fixed points", _middle(supports, NONE, points), fixed_points=points)
    about = _middle(supports, np.arange(len(ground.fixed)), NONE)
    if len(supports.viscous_edges):
        yield _Part("viscous edges", about, viscous_edges=np.arange(len(supports.viscous_edges)))
    if len(supports.outline):
        yield _Part("outline", about, outline=supports.outline)
    for name, one in supports.motions.items():
        point = NONE if one.point is None else np.array([one.point])
        yield _Part(name, _middle(supports, one.block, point), one.block, point)


def _measured(one: MeasuredReaction, supports: Supported) -> _Part:
    """Return a reaction that is asked for; raises ModelError where nothing is held or moved."""
    ground = supports.ground
    where = f"measured reaction '{shortened(one.name)}'"
    blocks, points, edges, outline = NONE, NONE, NONE, NONE
    if one.side is not None:
        blocks, points, edges, outline = _on_side(one.side, supports, where)
    elif one.fixed_point is not None:
        points = ground.fixed_point(one.fixed_point, where)
    else:
        key, names = ("blocks", one.blocks) if one.block is None else ("block", [one.block])
        blocks = ground.blocks(names or (), f"{where}, {key}")
        loose = [b for b in blocks.tolist() if not ground.fixed[b] and b not in supports.moved]
        if loose or not len(blocks):
            said = shortened(ground.outlines.names[loose[0]]) if loose else ""
            what = f"block '{said}' is neither fixed nor moved" if loose else "names no block"
            remedy = "name blocks with fixed = true or a [[motion]], or give a fixed_point"
            raise ModelError(what, where=f"{where}, {key}", remedy=remedy)
    about = _middle(supports, blocks, points, np.union1d(supports.viscous_edges[edges], outline))
    if one.about is not None:
        about = np.array(one.about) - ground.outlines.origin
    return _Part(one.name, about, blocks, points, edges, outline)


def _on_side(side: Side, supports: Supported, where: str) -> tuple[Ints, Ints, Ints, Ints]:
    """Return the fixed blocks and points, viscous and stressed edges on a side of the model."""
    ground = supports.ground
    outlines, at = ground.outlines, ground.points.at
    edges = outline_edges(outlines.vertices, outlines.start, (side,))[:, 0]
    owner = np.unique(outlines.owner[edges])
    blocks = owner[ground.fixed[owner] & ~np.isin(owner, supports.moved)]
    low, high = outlines.vertices.min(axis=0), outlines.vertices.max(axis=0)
    axis, end = SIDES[side]
    # Distance from a side at which a fixed point is on it, as a share of the model
    beside = np.abs(at[:, axis] - (low, high)[end][axis]) <= 1e-6 * float(np.hypot(*high - low))
    points, viscous = np.flatnonzero(beside), np.isin(supports.viscous_edges, edges).nonzero()[0]
    outline = np.intersect1d(supports.outline, edges)
    if not len(blocks) + len(points) + len(viscous) + len(outline):
        what = f"no fixed block, fixed point, viscous edge or [in_situ] edge is on the {side} side"
        remedy = "name another side, a block or a fixed_point; links have histories of their own"
        raise ModelError(what, where=f"{where}, side", remedy=remedy)
    return blocks, points, viscous, outline


def _middle(supports: Supported, blocks: Ints, points: Ints, first: Ints = NONE) -> Floats:
    """Return the mean of centroids of blocks, fixed points, and edges by first vertices, (2,)."""
    outlines = supports.ground.outlines
    _, centroid, _ = polygon.moments(outlines.vertices, outlines.start)
    ends = outlines.vertices[first], outlines.vertices[outlines.following[first]]
    at = [centroid[blocks], supports.ground.points.at[points], 0.5 * (ends[0] + ends[1])]
    return np.asarray(np.concatenate(at).mean(axis=0))
