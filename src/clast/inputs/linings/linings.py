"""[[lining]]: shotcrete, rings, arches of steel; segments as blocks, and springs between."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import shapely
from pydantic import Field, StrictBool, StrictStr, model_validator

from clast.actions.linings import (
    ACROSS,
    ALONG,
    TURNING,
    Linings,
    LiningShape,
    OneLining,
    interaction_curve,
)
from clast.actions.links import LinkRows, Links
from clast.errors import ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, RefersTo
from clast.inputs.declaring.table import Ends, Length, Line, Positive, Strength, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.inputs.declaring.values import number_of
from clast.inputs.linings.joined_ends import ENDS_APART_MAX, JoinedEnd, beyond, joined_ends
from clast.inputs.linings.lines import ROUNDING, CutLine, LinesOfRock, cut_line
from clast.inputs.materials import Joint, Rock
from clast.inputs.placing.bolt_lines import Ground
from clast.inputs.placing.place_blocks import BlockArrays
from clast.model import model, ranges
from clast.model.model import Floats, Ints, Plane, PlaneStrain
from clast.model.ranges import check_names
from clast.model.supports import GROUND

End = Literal["free", "hinged", "clamped"]
STRENGTH_BY_MODULUS_MIN = 1e-6
"""Strength, in units of the modulus, below which it looks like another unit."""


class Lining(Table):
    """A lining of stiff segments along an opening or a polyline.

    Between segments, at the middle of the thickness, are the springs of a beam.
    """

    name: StrictStr
    """Name; its segments are blocks called NAME/1, NAME/2, ..."""
    opening: StrictStr | None = None
    """Opening that it lines on the inside."""
    polyline: Line | None = None
    """Points [x, y] that it follows, m; it is closed if the last equals the first."""
    part: Ends | None = None
    """With opening: it begins at the first point and ends at the second, counter-clockwise, m."""
    side: Literal["left", "right", "middle"] | None = None
    """With polyline: its side, looking along it; if absent, that of the rock, else left."""
    closed: StrictBool | None = None
    """False: the last segment is not joined to the first; as the line if absent."""
    thickness: Length
    """Thickness, m."""
    segment: Length
    """Length of a segment, m; between corners it is rounded to a whole number of segments."""
    young: Annotated[Positive, within(ranges.STRESS)]
    """Young's modulus, Pa."""
    poisson: Annotated[Number, Field(ge=0.0, lt=0.5)] = 0.2
    """Poisson's ratio."""
    density: Annotated[Positive, within(ranges.DENSITY)] = 2400.0
    """Density, kg/m3."""
    tension: Strength | None = None
    """Tensile strength, Pa; with compression; it is elastic if both are absent."""
    compression: Annotated[Positive, within(ranges.STRESS)] | None = None
    """Compressive strength, Pa."""
    joint: StrictStr | None = None
    """Joint to the rock, [joint.NAME]: strength and stiffness of the bond."""
    start: End = "free"
    """Support of its first end by the ground, which is no block."""
    end: End = "free"
    """Support of its last end by the ground."""
    joins: Annotated[StrictStr, RefersTo("lining")] | None = None
    """Lining to whose ends those of its own are joined that lie at one place with them, free of
    stress when both are there."""
    connection: Literal["clamped", "hinged"] | None = None
    """With joins: whether the joint bears a moment; "clamped" if absent."""
    stage: StrictStr | None = None
    """Stage that installs it, free of stress, on the outline at that time; it exists from the start
    if absent.
    """

    ONE_OF: ClassVar = {
        'give one of opening = "NAME" and polyline = [[x, y], ...]': ("opening", "polyline")
    }
    WHEN: ClassVar = {
        "opening": {ANY: ("part",)},
        "polyline": {ANY: ("side",)},
        "joins": {ANY: ("connection",)},
    }

    @model_validator(mode="after")
    def _follows_one_line(self) -> Self:
        of_lines = (("part", "opening", "an opening"), ("side", "polyline", "a polyline"))
        for key, line, kind in of_lines:
            if getattr(self, key) is not None and getattr(self, line) is None:
                raise refusal(f"{key} is that of a lining along {kind}", "leave it out", key)
        if self.part is not None and self.part[0] == self.part[1]:
            raise refusal("begins and ends at the same point", "give two distinct points", "part")
        return self

    @model_validator(mode="after")
    def _is_open_or_closed(self) -> Self:
        points = self.polyline
        if points is not None:
            apart = np.hypot(*np.diff(np.array(points, float).reshape(-1, 2), axis=0).T)
            if len(points) < 2 or not apart.all():
                what = "has fewer than two points" if len(points) < 2 else "has a point twice"
                raise refusal(what, "give distinct points [x, y], m", "polyline")
        if self.closed and not self.is_ring:
            remedy = "repeat the first point at the end of polyline, or leave closed out"
            raise refusal("is closed, but its line is open", remedy, "closed")
        ring = self.is_ring and self.closed is not False
        for key in ("start", "end"):
            if ring and getattr(self, key) != "free":
                what = "a closed lining has no ends"
                raise refusal(what, f"leave {key} out, or closed = false", key)
        return self

    @model_validator(mode="after")
    def _joins_another(self) -> Self:
        if self.joins is None and self.connection is not None:
            remedy = "name the lining that it joins: joins, or leave connection out"
            raise refusal("connection is that of a lining that joins another", remedy, "connection")
        if self.joins is not None and (self.joins == self.name or self.is_ring):
            what = (
                "joins itself" if self.joins == self.name else "its line is closed: it has no ends"
            )
            raise refusal(what, "name another lining at an end of this one", "joins")
        return self

    @model_validator(mode="after")
    def _has_sensible_numbers(self) -> Self:
        if (self.tension is None) != (self.compression is None):
            key = "tension" if self.tension is None else "compression"
            remedy = "give it in Pa (tension = 0 for plain concrete), or neither: it is elastic"
            raise refusal(f"{key} is missing: a section needs both strengths", remedy, key)
        if self.thickness > self.segment:
            what = f"{self.thickness:g} m is more than the length of a segment, {self.segment:g} m"
            remedy = "give longer segments: a beam segment is longer than it is thick"
            raise refusal(what, remedy, "thickness")
        strength = self.compression
        if strength is not None and strength < STRENGTH_BY_MODULUS_MIN * self.young:
            what = f"{strength:g} looks like another unit than that of young, {self.young:g}"
            raise refusal(what, f"if these are MPa and Pa, write {strength * 1e6:g}", "compression")
        if self.tension and self.compression and self.tension > self.compression:
            remedy = "give a tension of about a tenth of compression, both in Pa"
            raise refusal("is more than the compressive strength", remedy, "tension")
        return self

    @property
    def is_ring(self) -> bool:
        """Whether its line comes back to where it begins."""
        if self.polyline is not None:
            return len(self.polyline) > 3 and self.polyline[0] == self.polyline[-1]
        return self.opening is not None and self.part is None

    @property
    def joins_ends(self) -> bool:
        """Whether the last segment is joined to the first."""
        return self.is_ring and self.closed is not False


JOINT_STRAIN_SHARE = 0.5
"""Share of the strain along a lining that is left to its joints, whose springs are not too stiff
then: steps turn blocks by chords, which stretch springs by r^2 l/4."""
TOUCH_DISTANCE = 1e-3
"""How far from a face of a segment its rock may be, in units of the thickness."""
MODULUS_BY_ROCK_MIN = 1e-5
"""Modulus, in units of that of the softest rock, below which it looks like another unit."""
IN_ROCK_SHARE_MAX = 1e-3
"""Share of a segment that may lie in rock."""


class LiningMaterial(Rock):
    """Material of the segments of a lining."""

    def rock(self, name: str) -> model.Rock:
        """Return it as a rock of the model that is not ground."""
        return replace(super().rock(name), is_ground=False)


@dataclass(frozen=True, kw_only=True, repr=False)
class PlacedLining:
    """A lining that is cut into segments."""

    table: Lining
    """Its table."""
    turned: bool
    """Whether its line was turned round, so that it lies to the left of it."""
    cut: CutLine
    """Its segments."""
    polygons: Any
    """Their outlines, shape (s,)."""
    inside: tuple[str, ...]
    """Names of the blocks in its place."""
    beside: tuple[tuple[str, str], ...]
    """Pairs of a segment and a block that touch."""
    joined: tuple[JoinedEnd, ...]
    """Its ends that are joined to those of others, by its own word."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its segments."""
        return tuple(f"{self.table.name}/{k}" for k in range(1, len(self.cut.first) + 1))

    @property
    def loose(self) -> tuple[str, ...]:
        """Names of its segments that are to be bonded and touch no block."""
        touching = {segment for segment, _ in self.beside}
        return tuple(name for name in self.names if self.table.joint and name not in touching)

    @property
    def rock(self) -> str:
        """Name of its material among the rocks."""
        return f"lining {self.table.name}"


def placed_linings(
    tables: Sequence[Lining],
    polygons: Any,
    names: Sequence[str],
    openings: Mapping[str, Floats],
    blocks_of_openings: Mapping[str, Sequence[str]],
) -> tuple[PlacedLining, ...]:
    """Return the linings cut into segments, blocks (n,) being there.  Raises ModelError."""
    check_names("lining", [one.name for one in tables])
    lines = LinesOfRock(polygons, names, openings, blocks_of_openings)
    tree = shapely.STRtree(polygons)
    placed: list[PlacedLining] = []
    drawn = [lines.line(one, f"lining '{shortened(one.name)}'") for one in tables]
    joined = joined_ends(tables, drawn)
    for number, table in enumerate(tables):
        where = f"lining '{shortened(table.name)}'"
        cut = cut_line(
            drawn[number][0],
            comes_back=table.is_ring,
            length=table.segment,
            thickness=table.thickness,
            is_middle=table.side == "middle",
            where=where,
            beyond=beyond(number, joined, drawn),
        )
        own = tuple(end for end in joined if end.lining == number)
        one = replace(_placed(table, where, cut, tree, names), turned=drawn[number][1], joined=own)
        for other in placed:
            k, j = shapely.STRtree(other.polygons).query(one.polygons, predicate="intersects")
            common = shapely.area(shapely.intersection(one.polygons[k], other.polygons[j]))
            thin = min(table.thickness, other.table.thickness)
            if common.max(initial=0.0) > IN_ROCK_SHARE_MAX * thin**2:
                what = f"crosses lining '{shortened(other.table.name)}'"
                remedy = "end one at the other, or place it on the inner face of the first"
                raise ModelError(what, where=where, remedy=remedy)
        placed.append(one)
    return tuple(placed)


def _placed(one: Lining, where: str, cut: CutLine, tree: Any, names: Sequence[str]) -> PlacedLining:
    """Return a lining cut into segments, whose ends are joined to no others."""
    count = len(cut.first)
    if count < 2 and one.start == one.end == "free" and one.joins is None:
        what = "is a single segment without supports: it cannot bend"
        raise ModelError(what, where=f"{where}, segment", remedy="give shorter segments")
    polygons = np.array([shapely.Polygon(cut.polygon(k)) for k in range(count)])
    segment, block = tree.query(polygons, predicate="intersects")
    # on a grid: where faces lie on each other but for rounding, GEOS may find all of a segment
    common = shapely.area(
        shapely.intersection(
            polygons[segment], tree.geometries[block], grid_size=1e-6 * one.thickness
        )
    )
    deep = common > IN_ROCK_SHARE_MAX * shapely.area(polygons[segment])
    inside = tuple(names[k] for k in np.unique(block[deep]).tolist())
    if inside and one.stage is None:
        what = f"lies in rock: block '{shortened(inside[0])}'" + (
            f" and {len(inside) - 1} more" if len(inside) > 1 else ""
        )
        remedy = "give it a stage that comes after their excavation, or another side"
        raise ModelError(what, where=where, remedy=remedy)
    near = TOUCH_DISTANCE * one.thickness
    segment, block = tree.query(polygons, predicate="dwithin", distance=near)
    own = [f"{one.name}/{k + 1}" for k in range(count)]
    within = {names.index(name) for name in inside}
    beside = tuple(
        (own[k], names[b])
        for k, b in zip(segment.tolist(), block.tolist(), strict=True)
        if b not in within
    )
    return PlacedLining(
        table=one,
        turned=False,
        cut=cut,
        polygons=polygons,
        inside=inside,
        beside=beside,
        joined=(),
    )


def material(one: Lining, plane: Plane, rocks: Sequence[Rock]) -> LiningMaterial:
    """Return the material of the segments of a lining, which strain along it by a share.

    Without Poisson's ratio: pressure across the thickness does not lengthen a beam.  Raises
    ModelError where its modulus is in another unit than those of the ``rocks``.
    """
    softest = min((rock.young for rock in rocks), default=one.young)
    if one.young < MODULUS_BY_ROCK_MIN * softest:
        what = f"{one.young:g} looks like another unit than that of the rock, {softest:g}"
        remedy = f"if these are GPa and Pa, write {one.young * 1e9:g}"
        raise ModelError(what, where=f"lining '{shortened(one.name)}', young", remedy=remedy)
    young = _modulus(one, plane) / (1.0 - JOINT_STRAIN_SHARE)
    return LiningMaterial(young=young, poisson=0.0, density=one.density)


def _modulus(one: Lining, plane: Plane) -> float:
    """Return the modulus of a beam: E, or E/(1 - nu^2) of a shell in plane strain, Pa."""
    strain = isinstance(plane, PlaneStrain)
    return one.young / (1.0 - one.poisson**2) if strain else one.young


def entry(one: PlacedLining, first: int) -> BlockArrays:
    """Return the segments as blocks, the ``first`` of which has this number from 0."""
    outlines = [one.cut.polygon(k) for k in range(len(one.cut.first))]
    start = np.cumsum([0, *map(len, outlines)])
    name = one.table.joint or ""
    joints = [["" if k >= len(ring) - 3 else name for k in range(len(ring))] for ring in outlines]
    return BlockArrays(
        first,
        one.names,
        one.rock,
        np.concatenate(outlines),
        start,
        False,
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        [joint for ring in joints for joint in ring],
    )


def with_bonds(joints: Mapping[str, Joint], placed: Sequence[PlacedLining]) -> dict[str, Joint]:
    """Return the joints with the pairs of segments and rock that they bond."""
    bonded = dict(joints)
    for one in placed:
        name = one.table.joint
        if name is not None:
            where = f"lining '{shortened(one.table.name)}', joint"
            number_of(name, dict.fromkeys(bonded, 0), "joint", where)
            pairs = [*bonded[name].between, *one.beside]
            bonded[name] = bonded[name].model_copy(update={"between": pairs})
    return bonded


def linings_of_ground(
    placed: Sequence[PlacedLining], ground: Ground, plane: Plane
) -> tuple[Linings, ...]:
    """Return the action of all linings on the blocks of the ground; none where there are none."""
    if not placed:
        return ()
    each, rows, apart, joints = [], [], [], 0
    segments = [ground.blocks(one.names, one.rock) for one in placed]
    for one, blocks in zip(placed, segments, strict=True):
        table = one.table
        springs = _springs(one, blocks, ground, plane, (placed, segments))
        count = len(springs.along)
        curve = None
        if table.compression is not None:
            curve = interaction_curve(table.thickness, table.tension or 0.0, table.compression)
        each.append(
            OneLining(
                name=table.name,
                stage=table.stage or "",
                closed=table.joins_ends,
                thickness=table.thickness,
                tension=np.inf if table.tension is None else table.tension,
                compression=np.inf if table.compression is None else table.compression,
                curve=curve,
                segments=blocks,
                joints=np.arange(joints, joints + count),
                along=springs.along,
                at=springs.at,
                face=springs.face,
                meets=np.zeros((0, 4), np.int64),
                shape=_shape(one, ground),
                inside=ground.blocks(one.inside, one.rock),
                loose=ground.blocks(one.loose, one.rock),
            )
        )
        rows.append(springs)
        apart.append(_without_contacts(one, springs, ground))
        joints += count
    meets = _meets(placed, each, rows)
    each = [replace(one, meets=meets[k]) for k, one in enumerate(each)]
    return (
        Linings(
            each=tuple(each),
            springs=Links(rows=_rows(each, rows), apart=np.zeros((0, 2), np.int64)),
            apart=np.unique(np.sort(np.concatenate(apart), axis=1), axis=0),
        ),
    )


def _without_contacts(one: PlacedLining, springs: _JointSprings, ground: Ground) -> Ints:
    """Return the pairs of segments that follow each other, and of held ends with fixed blocks."""
    blocks = ground.blocks(one.names, one.rock).tolist()
    pairs = list(itertools.pairwise(blocks))
    pairs += [(blocks[-1], blocks[0])] if one.table.is_ring else []
    pairs += [tuple(pair) for pair in springs.pair[springs.other >= 0].tolist()]
    for pair, at in zip(springs.pair.tolist(), springs.at, strict=True):
        if GROUND in pair:
            near = TOUCH_DISTANCE * one.table.thickness
            close = ground.tree.query(shapely.points(at), predicate="dwithin", distance=near)
            pairs += [(max(pair), int(block)) for block in close if ground.fixed[block]]
    return np.array(pairs, np.int64).reshape(-1, 2)


@dataclass(frozen=True, kw_only=True)
class _JointSprings:
    """The springs of the k joints of a lining."""

    pair: Ints
    """Blocks before and after each joint, shape (k, 2)."""
    at: Floats
    """Where it is, m, about the origin, shape (k, 2)."""
    direction: Floats
    """Direction of the lining there, shape (k, 2)."""
    along: Floats
    """How far along the lining, m, shape (k,)."""
    stiffness: Floats
    """Stiffness along, across, N/m per m, and against rotation, N per rad; 0: free, (k, 3)."""
    face: Ints
    """Segment, and 0 for its start or 1 for its end, shape (k, 2)."""
    other: Ints
    """Lining whose end is joined there, -1 for none, shape (k,)."""


def _section(table: Lining, plane: Plane) -> Floats:
    """Return stiffness times length of a joint: along, across, against rotation, shape (3,)."""
    young = _modulus(table, plane)
    # 5/6 of a rectangular section resists shear
    shear = 5.0 / 6.0 * table.young / (2.0 * (1.0 + table.poisson))
    # what the segments strain by themselves is not left to the joints
    of_segments = 2.0 * (1.0 - JOINT_STRAIN_SHARE) / young
    return table.thickness * np.array(
        [
            young / JOINT_STRAIN_SHARE,
            1.0 / (1.0 / shear - of_segments),
            young * table.thickness**2 / 12.0,
        ]
    )


BENDS = {"clamped": np.ones(3), "hinged": np.array([1.0, 1.0, 0.0])}
"""Components that joints have, by their kind."""


def _springs(
    one: PlacedLining,
    blocks: Ints,
    ground: Ground,
    plane: Plane,
    every: tuple[Sequence[PlacedLining], Sequence[Ints]],
) -> _JointSprings:
    """Return the springs between segments, and those at ends that are held or joined.

    ``every`` are all linings and the blocks of their segments.
    """
    table, middles = one.table, one.cut.middles - ground.outlines.origin
    chord = middles[:, 1] - middles[:, 0]
    length = np.hypot(*chord.T)
    unit, mark = chord / length[:, None], np.concatenate([[0.0], np.cumsum(length)])
    section, count = _section(table, plane), len(blocks)
    held = (table.end, table.start) if one.turned else (table.start, table.end)
    joined = {joint.end: joint for joint in one.joined}
    # blocks, place, direction, distance along the lining, stiffness, face, other lining
    rows: list[tuple[Any, ...]] = []

    def at_end(end: int) -> None:
        last, place = (count - 1) * end, mark[-end]
        if end in joined:
            pair, at, both, stiffness = _across(joined[end], every, ground, plane)
            rows.append((pair, at, both, place, stiffness, (last, end), joined[end].other))
        elif held[end] != "free":
            pair = (blocks[-1], GROUND) if end else (GROUND, blocks[0])
            stiffness = BENDS[held[end]] * section / (0.5 * length[last])
            rows.append((pair, middles[last, end], unit[last], place, stiffness, (last, end), -1))

    at_end(0)
    for k in range(count if table.joins_ends else count - 1):
        after, both = (k + 1) % count, unit[k] + unit[(k + 1) % count]
        pair, apart = (blocks[k], blocks[after]), 0.5 * (length[k] + length[after])
        both = both / np.hypot(*both)
        rows.append((pair, middles[k, 1], both, mark[k + 1], section / apart, (k, 1), -1))
    at_end(1)
    pairs, at, direction, along, stiffness, face, other = map(np.array, zip(*rows, strict=True))
    return _JointSprings(
        pair=pairs.astype(np.int64),
        at=at,
        direction=direction,
        along=along,
        stiffness=stiffness,
        face=face.astype(np.int64),
        other=other.astype(np.int64),
    )


def _across(
    joint: JoinedEnd,
    every: tuple[Sequence[PlacedLining], Sequence[Ints]],
    ground: Ground,
    plane: Plane,
) -> tuple[tuple[int, int], Floats, Floats, Floats]:
    """Return blocks, place, direction and stiffness (3,) of the joint between two linings."""
    placed, segments = every
    blocks, places, units, soft = [], [], [], np.zeros(3)
    for number, end in ((joint.lining, joint.end), (joint.other, joint.other_end)):
        one, last = placed[number], end * (len(segments[number]) - 1)
        chord = one.cut.middles[last, 1] - one.cut.middles[last, 0]
        length = float(np.hypot(*chord))
        blocks.append(int(segments[number][last]))
        places.append(one.cut.middles[last, end] - ground.outlines.origin)
        units.append(chord / length)
        soft += 0.5 * length / _section(one.table, plane)
    mine, other = placed[joint.lining].table, placed[joint.other].table
    apart = float(np.hypot(*(places[1] - places[0])))
    if apart > ENDS_APART_MAX * min(mine.thickness, other.thickness):
        what = f"its middle and that of lining '{shortened(other.name)}' are {apart:.3g} m apart"
        remedy = "line the same side with both"
        raise ModelError(what, where=f"lining '{shortened(mine.name)}', joins", remedy=remedy)
    both = units[0] + (units[1] if joint.end != joint.other_end else -units[1])
    pair = (blocks[0], blocks[1]) if joint.end else (blocks[1], blocks[0])
    stiffness = BENDS[mine.connection or "clamped"] / soft
    return pair, 0.5 * (places[0] + places[1]), both / np.hypot(*both), stiffness


def _meets(
    placed: Sequence[PlacedLining], each: Sequence[OneLining], springs: Sequence[_JointSprings]
) -> list[Ints]:
    """Return the joints at joined ends of each lining, as OneLining has them, (q, 4) each."""
    rows: list[list[tuple[int, ...]]] = [[] for _ in placed]
    for one, lining, own in zip(placed, each, springs, strict=True):
        for joint in one.joined:
            ends = np.flatnonzero((own.other >= 0) & (own.face[:, 1] == joint.end))
            at, side = int(lining.joints[ends[0]]), 1 - joint.end
            sides = ((joint.lining, joint.end, side), (joint.other, joint.other_end, 1 - side))
            for number, end, mine in sides:
                last = end * (len(each[number].segments) - 1)
                rows[number].append((at, mine, last, end))
    return [np.array(of, np.int64).reshape(-1, 4) for of in rows]


def _rows(each: Sequence[OneLining], springs: Sequence[_JointSprings]) -> LinkRows:
    """Return the rows of springs of all joints."""
    names = [f"{one.name}/{k}" for one in each for k in range(1, len(one.joints) + 1)]
    stiffness = np.concatenate([one.stiffness for one in springs])
    link, component = np.nonzero(stiffness)
    count = len(link)
    return LinkRows(
        name=tuple(names),
        block=np.concatenate([one.pair for one in springs]),
        at=np.concatenate([one.at for one in springs]),
        along=np.concatenate([one.direction for one in springs]),
        # which of two neighbours is first must not matter
        turning=np.full((len(names), 2), 0.5),
        stage=tuple(one.stage for one in each for _ in one.joints),
        also=tuple("" if k < 0 else each[k].stage for one in springs for k in one.other.tolist()),
        link=link,
        component=np.array([ALONG, ACROSS, TURNING])[component],
        stiffness=stiffness[link, component],
        strength=np.full(count, np.inf),
        rupture=np.full(count, np.inf),
        gap=np.zeros(count),
        damping=np.zeros(count),
    )


def _shape(one: PlacedLining, ground: Ground) -> LiningShape:
    """Return the geometry of a lining, and the edges of rock to its right that its points lie on.

    Such edges run against the line: the rock is to their left.
    """
    outlines, cut = ground.outlines, one.cut
    at = cut.at - outlines.origin
    following = np.asarray(outlines.following)
    others = {*one.inside, *one.names}
    solid = np.array([name not in others for name in outlines.names], np.bool_)
    edges = np.flatnonzero(solid[outlines.owner])
    begin = outlines.vertices[edges]
    line = outlines.vertices[following[edges]] - begin
    length = np.hypot(*line.T) if len(edges) else np.zeros(0)
    tangent = np.roll(at, -1, axis=0) - np.roll(at, 1, axis=0)
    tangent = tangent if cut.closed else np.gradient(at, axis=0)
    tangent = tangent / np.hypot(*tangent.T)[:, None]
    near = TOUCH_DISTANCE * one.table.thickness + ground.moved
    point, edge, share = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for k, place in enumerate(at if len(edges) else ()):
        along = ((place - begin) * line).sum(axis=1) / length**2
        foot = begin + np.clip(along, 0.0, 1.0)[:, None] * line
        against = (line @ tangent[k]) / length < -0.5 + ROUNDING
        on = np.flatnonzero((np.hypot(*(place - foot).T) <= near) & against)
        point.append(np.full(len(on), k))
        edge.append(edges[on])
        share.append(np.clip(along[on], 0.0, 1.0))
    edge_of_point = np.concatenate(edge)
    return LiningShape(
        at=at,
        point=np.concatenate(point),
        vertex=np.stack([edge_of_point, following[edge_of_point]], axis=1),
        share=np.concatenate(share),
        first=cut.first,
        count=cut.count,
        inner=cut.inner - outlines.origin,
    )
