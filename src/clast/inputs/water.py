"""[[water]]: water that presses on outer faces and in joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import shapely
from pydantic import Field, StrictStr, model_validator

from clast.errors import CaseError, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import Extends, RefersTo
from clast.inputs.declaring.table import (
    OR_LINE,
    OR_TABLE,
    OR_TEXT,
    Coordinate,
    Inputs,
    Line,
    Point,
    Table,
)
from clast.inputs.declaring.text import asked_by
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.declaring.values import number_of
from clast.inputs.placing.bolt_lines import Ground
from clast.model import ranges
from clast.model.checks import BlockOutlines, point_text
from clast.model.drainage import distances, drained, parts_between, places_on
from clast.model.edges import Edges, Facing, edges_of, facing_edges, outer_parts
from clast.model.factors import Factor
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints
from clast.model.ranges import check_names
from clast.model.water import Water as WetWater
from clast.model.water import (
    WetFaces,
    WetJoints,
    ends_of_faces,
    faces_of_joints,
    surface_at,
    wetted,
)

UNITS = ((0.1, 3.0, "t/m3 or g/cm3", 1000.0), (3.0, 30.0, "kN/m3", 1000.0 / 9.81))
"""Ranges of density in other units, and the factors that convert them."""
SHARE = "give a share of the full head from 0 to 1, or the name of an amplitude of such shares"

OpeningName = Annotated[StrictStr, RefersTo("opening")]
Drain = Annotated[Annotated[Point | Line, OR_LINE] | OpeningName, OR_TEXT]


def check_density(density: float) -> None:
    """Refuse a density, kg/m3, that is not one of a liquid, or looks like another unit."""
    remedy = "give it in kg/m3: 1000 for water, 1025 for the sea"
    for low, high, unit, factor in UNITS:
        if low <= density < high:
            what = f"{density:g} looks like {unit}, but densities are in kg/m3"
            remedy = f"write {density * factor:.4g}; the weight follows from gravity"
            raise refusal(what, remedy, "density")
    if not density > 0.0:
        raise refusal(f"{density:g} is not a valid density", remedy, "density")
    # Densities below are not kg/m3
    if density < 100.0:
        what = f"{density:g} kg/m3 is not the density of a liquid"
        raise refusal(what, remedy, "density")


class LineFile(Table):
    """A phreatic line in a file beside the case file."""

    file: StrictStr
    """Table with the columns x, y and a row for each point (.csv), beside the case file."""


class Water(Table):
    """Water that presses on all edges below its surface, and follows the blocks."""

    name: StrictStr | None = None
    """Name by which stages refer to it."""
    level: Annotated[Coordinate, Extends("level")] | None = None
    """Height y of a horizontal surface, m; or give a line."""
    line: Annotated[Line | LineFile, OR_TABLE] | None = None
    """Points [x, y] of a phreatic line, m, or {file = "line.csv"}; it is horizontal beyond its
    ends.
    """
    acts_on: Literal["faces", "joints", "both"] = "both"
    """Surfaces it presses on: "faces": edges that no other block covers; "joints": both faces where
    blocks lie along each other; "both"."""
    density: Annotated[Number, within(ranges.DENSITY)] = 1000.0
    """Density, kg/m3."""
    joints: list[StrictStr] | None = None
    """Joints that it enters, by name; all if absent."""
    amplitude: Annotated[Number | StrictStr, OR_TEXT] = 1.0
    """Share of the full head, 0 to 1; or the [amplitude.NAME] of such shares: water that rises."""
    drained_at: Annotated[list[Drain] | OpeningName, OR_TEXT] = Field([])
    """Where there is no pressure: points [x, y] of joints, m, lines [[x, y], [x, y]], openings by
    name, those that stages excavate from then on; along the joints it falls towards them."""
    wetted: Literal["open-and-closed", "closed"] = "open-and-closed"
    """Whether a joint that opens keeps its pressure, or loses it ("closed")."""

    ONE_OF: ClassVar = {
        "give the level y of a horizontal surface, or the points of a phreatic line": (
            "level",
            "line",
        )
    }

    @model_validator(mode="after")
    def _has_a_density(self) -> Self:
        check_density(self.density)
        return self

    @model_validator(mode="after")
    def _suits_what_it_acts_on(self) -> Self:
        if not isinstance(self.amplitude, str) and not 0.0 <= self.amplitude <= 1.0:
            raise refusal(f"{self.amplitude:g} is not a valid share", SHARE, "amplitude")
        if self.acts_on == "faces" and (self.joints is not None or self.drained_at):
            remedy = 'give acts_on = "joints" or "both", or remove joints and drained_at'
            raise refusal("names joints or drains, but the water acts on outer faces only", remedy)
        return self

    @property
    def drains(self) -> list[Any]:
        """Its drains: points, lines, names."""
        return [self.drained_at] if isinstance(self.drained_at, str) else self.drained_at

    def add_to(self, builder: Inputs, key: str, folder: Path) -> None:
        """Add the water, with the line of a file."""
        whole = self
        if isinstance(self.line, LineFile):
            whole = self.model_copy(update={"line": _points(folder / self.line.file)})
        builder.add(whole, key)


def _points(path: Path) -> list[tuple[float, float]]:
    """Return the points of a phreatic line in a file, m."""
    from clast.rockmass.drawings.csv_lines import table_of

    with asked_by("[[water]], line"):
        table = table_of(path)
        for column in ("x", "y"):
            if column not in table.columns:
                what, where = f"has no column {column}", f"{table.file}: its heading"
                remedy = "a phreatic line has the heading x,y and a row for each point"
                raise CaseError(what, where=where, remedy=remedy)
        return [(row.number("x"), row.number("y")) for row in table.rows]


ACTS_ON = {"faces": (True, False), "joints": (False, True), "both": (True, True)}
"""Whether outer edges and whether joints are wetted, by the name in ``acts_on``."""
OPENED = {"open-and-closed": 1.0, "closed": 0.0}
"""Opening of a joint at which its water runs out, in lengths of the joint."""


@dataclass(frozen=True)
class Bed:
    """The ground in which water stands: blocks, their joints, and gravity."""

    ground: Ground
    table: JointTable
    edge_joint: Ints
    """Joint of each edge, -1: none of its own, shape (nv,)."""
    block_rock: Ints
    """Rock of each block, shape (n,)."""
    gravity: Floats
    """Gravity, m/s2, shape (2,)."""
    openings: Mapping[str, Floats]
    """Outlines of openings about the origin, m, (c, 2) each."""
    blocks_of_openings: Mapping[str, Ints]
    """Blocks of openings that stages excavate."""
    waits: Bools
    """Segments of linings that wait for their stage, shape (n,)."""


def waters_in(waters: Sequence[Water], bed: Bed) -> tuple[tuple[WetWater, ...], tuple[str, ...]]:
    """Return the edges that water wets, and the remarks on it."""
    if not waters:
        return (), ()
    outlines = bed.ground.outlines
    edges = edges_of(outlines.vertices, outlines.following, outlines.owner, outlines.area)
    facing = facing_edges(edges)
    check_names("water", [one.name for one in waters if one.name is not None])
    wet, notes = [], []
    for number, one in enumerate(waters, 1):
        water, said = _water(f"water {number}", one, bed, edges, facing)
        wet.append(water)
        notes += said
    return tuple(wet), tuple(notes)


def _water(
    label: str, given: Water, bed: Bed, edges: Edges, facing: Facing
) -> tuple[WetWater, list[str]]:
    """Return one water, and the remarks on it."""
    outlines = bed.ground.outlines
    surface = _surface(label, given, outlines)
    share, factor = _share(label, given, bed.ground)
    across, up = bed.gravity.tolist()
    if across != 0.0 or up >= 0.0:
        raise ModelError(
            f"gravity is [{across:g}, {up:g}]: a water level needs gravity straight down",
            where=label,
            remedy="give gravity = [0.0, -9.81]; a constant horizontal load is "
            "seismic_coefficient = [0.1, 0.0], an earthquake is [ground_motion]",
        )
    on_faces, on_joints = ACTS_ON[given.acts_on]
    faces, joints = WetFaces(), WetJoints()
    drains = np.zeros((0, 2))
    if on_faces:
        faces = _pressed(given, bed, edges, facing)
    if on_joints:
        joints, drains = _joints(label, given, bed, edges, facing)
    water = WetWater(
        name=given.name or "",
        surface=surface,
        weight=given.density * float(-up),
        share=share,
        factor=factor,
        faces=faces,
        joints=joints,
        drain_at=drains,
    )
    if len(drains):
        water = drained(water, np.zeros(len(outlines.names), np.bool_))
    notes = []
    for point in (np.array(one) for one in given.drains if np.shape(one) == (2,)):
        if surface_at(surface, point[:1] - outlines.origin[0])[0] <= point[1] - outlines.origin[1]:
            notes.append(f"{label}: the drain at {point_text(point)} lies above the water")
    return water, [*notes, _said(label, water, edges)]


def _surface(label: str, given: Water, outlines: BlockOutlines) -> Floats:
    """Return the points of the phreatic line about the origin, x rising, shape (m, 2), m."""
    surface = _line(label, given, outlines)
    x, y = outlines.vertices.T
    depth = surface_at(surface, x) - y
    if depth.max() <= 0.0:
        nearest = int(np.argmax(depth))
        what = (
            f"its surface lies below all blocks, by {abs(depth[nearest]):.6g} m at the nearest, "
            f"{outlines.vertex_label(nearest)}"
        )
        remedy = "give its height y in the coordinates of the case, not a depth"
        raise ModelError(what, where=label, remedy=remedy)
    return surface


def _line(label: str, given: Water, outlines: BlockOutlines) -> Floats:
    """Return the points of a level or a line about the origin, x rising, shape (m, 2)."""
    if given.level is not None:
        return np.array([[0.0, given.level - outlines.origin[1]]])
    where = f"{label}, line"
    points = np.array(given.line).reshape(-1, 2)
    if len(points) < 2:
        what = f"has {len(points)} points"
        raise ModelError(what, where=where, remedy="give at least 2, or a level")
    across = np.diff(points[:, 0])
    if (across < 0.0).all():
        points, across = points[::-1], -across[::-1]
    for k in np.flatnonzero(across <= 0.0)[:1]:
        raise ModelError(
            f"x decreases at {point_text(points[k + 1])}: the water surface would have two "
            "heights there",
            where=where,
            remedy="order the points by x, each x once; where the water falls steeply, give two x "
            "a little apart",
        )
    return np.ascontiguousarray(points - outlines.origin)


def _share(label: str, given: Water, ground: Ground) -> tuple[float, Factor | None]:
    """Return the share of the full head, and the amplitude that it follows."""
    name, where = given.amplitude, f"{label}, amplitude"
    if not isinstance(name, str):
        return name, None
    factor = ground.factors[ground.amplitude(name, where)]
    low, high = factor.value.min(), factor.value.max()
    if low < 0.0 or high > 1.0:
        what = f"amplitude '{shortened(name)}' goes from {low:g} to {high:g}"
        raise ModelError(what, where=where, remedy=SHARE)
    return 1.0, factor


def _joints(
    label: str, given: Water, bed: Bed, edges: Edges, facing: Facing
) -> tuple[WetJoints, Floats]:
    """Return the joints that water enters, and the places of drains about the origin, m, (d, 2)."""
    if given.joints is not None:
        chosen = _chosen(label, given.joints, bed, facing)
        facing = Facing(facing.edge[chosen], facing.share[chosen])
    if not len(facing.edge):
        what = "no two blocks share a face: there is no joint for the water to enter"
        remedy = 'give acts_on = "faces", or use blocks that touch'
        raise ModelError(what, where=label, remedy=remedy)
    near = edges.near[facing.edge].min(axis=1)
    apart = np.zeros((len(facing.edge), 2))
    joints = WetJoints(edge=facing.edge, share=facing.share, lowered=apart)
    drains, dug = _drains(label, given, bed, _middle(joints, edges), near)
    if len(drains):
        part, share = parts_between(_middle(joints, edges), near, drains)
        width = joints.share[part, :, 1:] - joints.share[part, :, :1]
        divided = joints.share[part, :, :1] + width * share[:, None]
        joints = WetJoints(edge=joints.edge[part], share=divided, lowered=apart[part])
        near = near[part]
    one, other = faces_of_joints(joints, edges.vertices, edges.after)
    length = np.hypot(*(one[:, 1] - one[:, 0]).T)
    gap = np.hypot(*np.moveaxis(other - one, -1, 0)).max(axis=1)
    opened, ends = OPENED[given.wetted], _middle(joints, edges)
    # Opening that counts as closed, in units of the distance that faces may lie apart
    joints = WetJoints(
        edge=joints.edge,
        share=joints.share,
        lowered=joints.lowered,
        widest=gap + np.maximum(opened * length, 1e-3 * near),
        ends=ends,
        near=near,
        conducts=np.asarray(~bed.waits[bed.ground.outlines.owner[joints.edge]].any(axis=1)),
        drain=_covering(bed, dug, joints, ends, near),
    )
    return joints, drains


def _middle(joints: WetJoints, edges: Edges) -> Floats:
    """Return the ends of joints halfway between their faces, m, shape (k, 2, 2)."""
    one, other = faces_of_joints(joints, edges.vertices, edges.after)
    return np.asarray(0.5 * (one + other))


def _chosen(label: str, names: Sequence[str], bed: Bed, facing: Facing) -> Any:
    """Return which parts of edges that lie along each other belong to named joints, (k,)."""
    where = f"{label}, joints"
    number = {joint.name: index for index, joint in enumerate(bed.table.joints)}
    wanted = [number_of(name, number, "joint", where) for name in names]
    pairs = bed.ground.outlines.owner[facing.edge]
    joint, named = bed.table.of_pairs(bed.block_rock, pairs)
    own = bed.edge_joint[facing.edge]
    own = np.where((own >= 0) & ~named[:, None], own, joint[:, None])
    # an edge that has none of its own takes that of the other, as contacts do
    other = own[:, ::-1]
    bare = (bed.edge_joint[facing.edge] < 0) & ~named[:, None]
    chosen = np.isin(np.where(bare, other, own), wanted).any(axis=1)
    if not chosen.any():
        raise ModelError(
            f"no two blocks share a face along {', '.join(map(repr, names)) or 'none'}",
            where=where,
            remedy="name joints that edges, pairs of blocks or pairs of rocks have, or leave it "
            "out: all joints",
        )
    return chosen


def _drains(label: str, given: Water, bed: Bed, ends: Floats, near: Floats) -> tuple[Floats, Ints]:
    """Return the places of drains about the origin, m, (d, 2), and blocks that drain (b,).

    ``ends`` (k, 2, 2) are those of the joints, which count when nearer than ``near`` (k,), m.
    """
    places, dug = [np.zeros((0, 2))], [np.zeros(0, np.int64)]
    blocks = {name: np.array([k]) for k, name in enumerate(bed.ground.outlines.names)}
    blocks |= bed.blocks_of_openings
    known = dict.fromkeys([*bed.openings, *blocks], 0)
    for number, one in enumerate(given.drains, 1):
        where = f"{label}, drained_at, {number}"
        if isinstance(one, str):
            number_of(one, known, "opening or block", where)
            if one in blocks:
                dug.append(blocks[one])
                continue
            line = np.concatenate([bed.openings[one], bed.openings[one][:1]])
        else:
            line = np.array(one).reshape(-1, 2) - bed.ground.outlines.origin
        if len(line) == 1:
            away = float(distances(ends, line)[0])
            if away > near.max():
                what = (
                    f"{point_text(line[0] + bed.ground.outlines.origin)} is not on a joint that "
                    f"this water enters; the nearest is {away:.3g} m away"
                )
                remedy = "give a point on the joint itself, e.g. where it comes out of the slope"
                raise ModelError(what, where=where, remedy=remedy)
            places.append(line)
            continue
        places.append(places_on(line, ends, near))
        if not len(places[-1]):
            remedy = "let it cross joints below the water level, or remove it"
            raise ModelError("no joint that this water enters meets it", where=where, remedy=remedy)
    return np.concatenate(places), np.unique(np.concatenate(dug))


def _covering(bed: Bed, dug: Ints, joints: WetJoints, ends: Floats, near: Floats) -> Ints:
    """Return the blocks of ``dug`` (b,) that joints are edges of or lie in; -1: none, (k, 2).

    Those of the joint's two faces, or those in which its two ``ends`` (k, 2, 2) lie, of a lining.
    """
    owner = bed.ground.outlines.owner[joints.edge]
    drain = np.where(np.isin(owner, dug), owner, -1)
    tree = shapely.STRtree(bed.ground.outlines.polygons()[dug])
    within = np.full((len(ends), 2), -1)
    for end in (0, 1):
        joint, number = tree.query(shapely.points(ends[:, end]), "dwithin", distance=near)
        within[joint, end] = dug[number]
    lies = (within >= 0).all(axis=1) & (drain < 0).all(axis=1)
    drain[lies] = within[lies]
    return drain


def _pressed(given: Water, bed: Bed, edges: Edges, facing: Facing) -> WetFaces:
    """Return the outer faces that water wets: none inside drained voids, and no waiting lining."""
    edge, part = outer_parts(edges, facing)
    faces = WetFaces(edge=edge, share=part)
    ends = ends_of_faces(faces, edges.vertices, edges.after)
    dry = bed.waits[edges.owner[edge]]
    for name in (one for one in given.drains if isinstance(one, str) and one in bed.openings):
        void = shapely.Polygon(bed.openings[name])
        away = shapely.distance(shapely.points(ends), void)
        dry = dry | (away <= edges.near[edge, None]).all(axis=1)
    return WetFaces(edge=edge[~dry], share=part[~dry])


def _said(label: str, water: WetWater, edges: Edges) -> str:
    """Return the note on wetted edges and pressure at the start; refuse water that wets none."""
    faces = wetted(water.surface, ends_of_faces(water.faces, edges.vertices, edges.after))
    one, other = faces_of_joints(water.joints, edges.vertices, edges.after)
    joints = wetted(water.surface, 0.5 * (one + other), water.joints.lowered)
    if not len(faces.line) and not len(joints.line):
        what = "wets no edge: no joint or outer face lies below its surface"
        remedy = "raise the level, drain less, or set acts_on to both faces and joints"
        raise ModelError(what, where=label, remedy=remedy)
    parts, most = [], 0.0
    weight = water.weight * (water.share if water.factor is None else 1.0)
    if len(faces.line):
        line = faces.ends[:, 1] - faces.ends[:, 0]
        pressed = 0.5 * faces.head.sum(axis=1)[:, None] * line
        x, y = weight * np.array([-pressed[:, 1].sum(), pressed[:, 0].sum()]) + 0.0
        parts.append(
            f"{np.hypot(*line.T).sum():.6g} m of outer faces, on which it presses with "
            f"({x:.6g}, {y:.6g}) N/m"
        )
        most = float(faces.head.max())
    if len(joints.line):
        length = np.hypot(*(joints.ends[:, 1] - joints.ends[:, 0]).T)
        force = weight * float(np.sum(0.5 * joints.head.sum(axis=1) * length))
        parts.append(
            f"{length.sum():.6g} m of joints, which it presses apart with {force:.6g} N/m in all"
        )
        most = max(most, float(joints.head.max()))
    rises = f", times amplitude '{water.factor.name}'" if water.factor else ""
    over = float(water.surface[:, 1].min() - edges.vertices[:, 1].max())
    deep = f"; its level is {over:.3g} m above the highest block" if over > 0.0 else ""
    return f"{label} wets {' and '.join(parts)}; up to {weight * most:.4g} Pa{rises}{deep}"
