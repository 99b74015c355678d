"""[domain], [[trace]], [[opening]], [[region]], [[block_pattern]]: domain and cuts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, StrictBool, StrictInt, StrictStr, model_validator

from clast import spelling
from clast.errors import Fault, ModelError, shortened
from clast.inputs.declaring.alternatives import Number, within
from clast.inputs.declaring.annotations import ANY, Extends, RefersTo
from clast.inputs.declaring.table import (
    OR_TABLE,
    Inputs,
    Length,
    Line,
    Loop,
    Point,
    Positive,
    Table,
)
from clast.inputs.declaring.validation_messages import check_one, refusal, refusals
from clast.inputs.declaring.values import number_of
from clast.model import ranges
from clast.model.ranges import check_text
from clast.model.surroundings import OpeningBlocks

Side = Literal["bottom", "left", "right", "top"]
Least = Annotated[Number, Field(ge=0.0), within(ranges.COORDINATE)]
Size = Annotated[tuple[Length, Length], Extends("size", "corner")]
Seed = Annotated[StrictInt, Field(ge=0)]
OutlineLayer = Annotated[
    StrictStr | None,
    Field(description="Layer of a DXF drawing with this outline only; required for DXF."),
]
DrawingUnit = Annotated[
    StrictStr | None,
    Field(
        description="Unit of a DXF drawing: m, cm, mm, km, in or ft; that of its header if absent."
    ),
]
Selection = Annotated[
    dict[str, StrictStr] | None,
    Field(description="Attributes of the features that are taken, e.g. {kind = 'fault'}."),
]


class FileTable(Table):
    """A closed outline in a file beside the case file."""

    file: StrictStr
    """Drawing (.dxf), table with the columns x, y (.csv), or .geojson, .wkt, .gpkg, .shp, beside
    the case file."""
    layer: OutlineLayer = None
    unit: DrawingUnit = None
    select: Selection = None


Boundary = Annotated[Loop | FileTable, OR_TABLE]
Profile = Annotated[Line | FileTable, OR_TABLE]


class DomainTable(Table):
    """The rock mass that [[joint_set]], [[trace]], [[opening]] and [[block_pattern]] cut."""

    boundary: Boundary | None = None
    """Corners [x, y] of its outline, m; or {file = "site.dxf", layer = "BOUNDARY"}."""
    profile: Profile | None = None
    """Points [x, y] of the ground surface from side to side, an open line, m; or
    {file = "site.csv"}; instead of boundary."""
    depth: Length | None = None
    """Depth of the bottom below the lowest point of the profile, m."""
    sides: tuple[Least, Least] = (0.0, 0.0)
    """How far the ground goes on, level, left and right of the profile, m."""
    rock: StrictStr | None = None
    """Rock of all blocks that lie in no region; may be left out where there is only one."""
    section_azimuth: Number | None = None
    """Direction of +x clockwise from north, degrees; needed only for dip and dip_direction."""
    tolerance: Positive | None = None
    """Grid to which all lines are rounded, m; the power of ten below 1e-6 of the diagonal if
    absent."""
    smallest_edge: Least | None = None
    """Shorter edges are collapsed, m; 0.01 of the median spacing of the sets if absent."""
    smallest_block: Least | None = None
    """Smaller blocks join the neighbour with the longest shared edge, m2; (2 smallest_edge)^2 if
    absent."""
    most_blocks: Annotated[StrictInt, Field(ge=1)] = 200_000
    """Largest number of blocks; a domain with more is rejected before it is cut."""
    seed: Seed = 0
    """Seed of the random numbers of all sets without their own."""
    fixed_sides: list[Side] = Field([])
    """Sides of the smallest rectangle about the boundary: blocks with a vertex on one of them
    cannot move at all."""

    ONE_OF: ClassVar = {
        "give the closed outline as boundary, or the ground surface as profile with depth": (
            "boundary",
            "profile",
        )
    }
    WHEN: ClassVar = {"profile": {ANY: ("depth", "sides")}}
    BASIC: ClassVar = ("depth", "rock", "fixed_sides")
    RARE: ClassVar = ("tolerance", "smallest_edge", "smallest_block", "most_blocks")

    @model_validator(mode="after")
    def _has_one_outline(self) -> Self:
        if self.profile is not None and self.depth is None:
            remedy = "give how far the model goes below the lowest point of the profile, m"
            raise refusal("is missing beside profile", remedy, "depth")
        for key in ("depth", "sides") if self.boundary is not None else ():
            if key in self.model_fields_set:
                raise refusal("goes with a profile, not a boundary", "leave it out", key)
        return self


class TraceTable(Table):
    """Mapped joints: one polyline, or those of a file."""

    points: Line | None = None
    """Points [x, y] of a polyline in order, m."""
    file: StrictStr | None = None
    """Traces in a file beside the case file: .csv (x1, y1, x2, y2 or id, x, y, with part, joint
    and set)
    .dxf, .geojson, .wkt, .gpkg or .shp; instead of points."""
    layer: StrictStr | None = None
    """Layer of a DXF drawing, required, or of a GeoPackage."""
    unit: DrawingUnit = None
    select: Selection = None
    joint: StrictStr | None = None
    """Joint along them: [joint.NAME]; that of the pair of rocks, or the default, if absent."""
    set: StrictStr = "traces"
    """Set that they are counted with, and at which cross-jointed sets may end."""

    INSTEAD: ClassVar = (("points", "file"),)
    WHEN: ClassVar = {"file": {ANY: ("layer", "unit", "select")}}

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        check_source(self, "points", 'give points = [[x, y], ...] or file = "traces.csv"')
        if self.file is None and self.select is not None:
            raise refusal("there is no file", "name the file of the features", "select")
        return self


def check_source(table: TraceTable | OpeningTable, key: str, remedy: str) -> None:
    """Refuse tables with both or none of a file and ``key``, and layers without a file."""
    check_one(table, (key, "file"), remedy)
    for name in ("layer", "unit"):
        if table.file is None and getattr(table, name) is not None:
            raise refusal("there is no file", "name the drawing", name)


SHAPES: dict[str, tuple[str, tuple[str, ...], tuple[str, ...]]] = {
    "circle": ("Circle", ("center", "radius"), ("chords",)),
    "horseshoe": ("Horseshoe", ("center", "width", "wall_height"), ("chords",)),
    "box": ("Box", ("corner", "size"), ()),
    "polygon": ("Polygon", ("points",), ()),
}
"""Shape -> its class, the keys that it needs, those that it may have."""
SHAPE_KEYS = ("center", "radius", "width", "wall_height", "chords", "corner", "size", "points")


class OpeningTable(Table):
    """An opening: void from the start, or rock with a welded outline that can be excavated."""

    name: StrictStr
    """Name."""
    shape: Literal["circle", "horseshoe", "box", "polygon"] | None = None
    """circle (center, radius, chords), horseshoe (center, width, wall_height, chords), box (corner,
    size) or polygon (points)."""
    center: Point | None = None
    """Centre of a circle, middle of the floor of a horseshoe [x, y], m."""
    radius: Annotated[Length, Extends("radius", "center")] | None = None
    """Radius of the circle that has the area of the opening, m."""
    width: Annotated[Length, Extends("width", "center")] | None = None
    """Width of a horseshoe, m."""
    wall_height: Annotated[Length, Extends("height", "center")] | None = None
    """Height of the walls below the half circle of a horseshoe, m."""
    chords: StrictInt | None = None
    """Straight edges of a circle, 32 if absent, or of the roof of a horseshoe, 16 if absent."""
    corner: Point | None = None
    """Lower left corner of a box [x, y], m."""
    size: Size | None = None
    """Width and height of a box, m."""
    points: Loop | None = None
    """Corners [x, y] of a polygon, m."""
    file: StrictStr | None = None
    """Outline in a file beside the case file, .dxf or .csv; instead of a shape."""
    layer: OutlineLayer = None
    unit: DrawingUnit = None
    blocks: list[StrictStr] = Field([])
    """Names of blocks, without a domain, that are excavated together; instead of a shape."""
    weld: Annotated[StrictStr, RefersTo("joint")] | None = None
    """With blocks: the joint [joint.NAME] whose edges are welded until it is excavated, and have no
    joint afterwards.
    """
    excavated: StrictBool = False
    """True for a void from the start; else it is rock."""
    construction_joint: StrictBool = True
    """True: while it is rock its outline is cut and welded; false: it is not cut."""

    INSTEAD: ClassVar = (("shape", "file", "blocks"),)
    WHEN: ClassVar = {
        "shape": {name: (*needed, *allowed) for name, (_, needed, allowed) in SHAPES.items()},
        "file": {ANY: ("layer", "unit")},
        "blocks": {ANY: ("weld",)},
    }
    BASIC: ClassVar = tuple(key for _, needed, _ in SHAPES.values() for key in needed)
    RARE: ClassVar = ("chords", "construction_joint")

    @model_validator(mode="after")
    def _is_one_shape(self) -> Self:
        if self.blocks:
            keys = ("shape", "file", "layer", "unit", *SHAPE_KEYS)
            given = [key for key in keys if getattr(self, key) is not None]
            check_keys(given, (), (), "opening of blocks")
            if self.excavated:
                what = "blocks cannot be void from the start"
                raise refusal(what, "remove the blocks, or excavated = true", "excavated")
            return self
        if self.weld is not None:
            what = "there are no blocks"
            raise refusal(what, "remove it: the outline of a shape is welded automatically", "weld")
        if "blocks" in self.model_fields_set:
            remedy = "name the blocks inside, or give a shape in place of blocks"
            raise refusal("is an empty list", remedy, "blocks")
        check_source(self, "shape", 'give shape = "circle" (or another), or a file')
        given = [key for key in SHAPE_KEYS if getattr(self, key) is not None]
        if self.shape is None:
            check_keys(given, (), (), "opening of a file")
        else:
            _, needed, allowed = SHAPES[self.shape]
            check_keys(given, needed, allowed, self.shape)
        return self

    def add_to(self, builder: Inputs, key: str, folder: Path) -> None:
        """Add an opening of blocks; that of a shape comes with the domain that is cut."""
        if self.blocks:
            builder.add(self, key)


def of_blocks(keys: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of an opening of a script, which has no domain to cut."""
    return {"blocks": [], **keys}


def check_keys(
    given: Iterable[str], needed: tuple[str, ...], allowed: tuple[str, ...], kind: str
) -> None:
    """Refuse keys that a kind of thing does not have, and the absence of those that it needs."""
    have = list(given)
    keys = ", ".join((*needed, *allowed))
    kind = f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"
    instead = f"{kind} has {keys}" if keys else "take it out"
    faults = [
        Fault(f"{kind} has no such key", instead, (key,))
        for key in have
        if key not in (*needed, *allowed)
    ]
    faults += [
        Fault("is missing", f"{kind} has {keys}", (key,)) for key in needed if key not in have
    ]
    if faults:
        raise refusals(faults)


class RegionTable(Table):
    """A region of another rock; a block belongs to the region with most of it, or the last."""

    name: StrictStr
    """Name, to which within of joint sets may refer."""
    polygon: Boundary
    """Corners [x, y], m; or {file = "site.dxf", layer = "REGIONS_shale"}."""
    rock: StrictStr | None = None
    """Rock of its blocks; that of the domain if absent."""
    joint: StrictStr | None = None
    """Joint along its outline, which is then cut; it is not cut if absent."""
    one_block: StrictBool = False
    """True: no line crosses it, so that it is one block (a lintel, a boulder); its outline is cut.
    """


class BlockPatternTable(Table):
    """Masonry: courses of equal blocks from the lower left corner of a rectangle."""

    name: StrictStr = "masonry"
    """Name, for the report."""
    pattern: Literal["running-bond", "stack-bond"] = "running-bond"
    """Head joints of successive courses: staggered or in line."""
    corner: Point
    """Lower left corner of the rectangle [x, y], m."""
    size: Size
    """Width and height of the rectangle, m."""
    brick: Size
    """Width and height of a block, m."""
    joint: StrictStr | None = None
    """Joint of bed and head joints: [joint.NAME]; that of the pair of rocks, or the default, if
    absent."""
    head_joint: StrictStr | None = None
    """Joint of the head joints, if it differs."""


def unknown(name: str, known: Iterable[str], kind: str, place: tuple[str | int, ...]) -> Fault:
    """Return the fault of a name that nothing has."""
    names = list(known)
    remedy = spelling.advice(name, names, kind=kind)
    return Fault(f"there is no {kind} '{name}'", remedy, place)


def openings_of(
    entries: Sequence[OpeningTable], block_number: dict[str, int], edge_joint: NDArray[np.str_]
) -> tuple[OpeningBlocks, ...]:
    """Return the openings with the numbers of their blocks and welded edges."""
    openings: dict[str, OpeningBlocks] = {}
    owner: dict[int, str] = {}
    for one in entries:
        where = f"opening '{shortened(one.name)}'"
        check_text(one.name, "opening")
        if one.name in openings or one.name in block_number:
            taken = "an opening" if one.name in openings else "a block"
            remedy = "give it another name: stages excavate openings and blocks by their names"
            raise ModelError(f"there already is {taken} with this name", where=where, remedy=remedy)
        numbers = []
        for name in one.blocks:
            number = number_of(name, block_number, "block", where)
            if number in owner:
                what = f"block '{shortened(name)}' already belongs to opening '{owner[number]}'"
                raise ModelError(what, where=where, remedy="put each block in one opening only")
            owner[number] = one.name
            numbers.append(number)
        welded = np.zeros(0, np.int64)
        if one.weld is not None:
            welded = np.flatnonzero(edge_joint == one.weld).astype(np.int64)
            if not len(welded):
                what = f"no edge has the joint '{shortened(one.weld)}'"
                remedy = "name the joint between the inside and the outside"
                raise ModelError(what, where=f"{where}, weld", remedy=remedy)
        block = np.array(sorted(numbers), np.int64)
        openings[one.name] = OpeningBlocks(name=one.name, block=block, welded=welded)
    return tuple(openings.values())
