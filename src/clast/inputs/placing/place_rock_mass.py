"""The rock mass of a case: from [domain] and the tables beside it to blocks.

The tables are read, with the files that they name, and cut once; the blocks go to the builder with
their rocks, and with the joints of their edges.  Edges that are welded, and those along an opening
that is rock, get a joint that no load opens.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from clast import spelling
from clast.errors import CaseError, Fault, ModelError, Place, Remark
from clast.inputs.blocks import BlockTable
from clast.inputs.builder import InputBuilder
from clast.inputs.declaring.text import asked_by
from clast.inputs.joint_sets import JointSetTable
from clast.inputs.placing.plausibility import doubted_sets, seen_sets
from clast.inputs.rock_mass import (
    SHAPES,
    BlockPatternTable,
    DomainTable,
    FileTable,
    OpeningTable,
    RegionTable,
    TraceTable,
    unknown,
)
from clast.model.model import Bools, Floats

if TYPE_CHECKING:
    from clast.rockmass import Cut, Opening, Region, Trace
    from clast.rockmass.cut_report import CutReport, Finding

SIDES: dict[str, tuple[int, Callable[[Floats], Any]]] = {
    "left": (0, np.min),
    "right": (0, np.max),
    "bottom": (1, np.min),
    "top": (1, np.max),
}
"""Side of a rectangle -> the coordinate that it has, and whether it is the least or the largest."""
KEYS_LACKING: dict[str, tuple[str, ...]] = {
    ".csv": ("layer", "unit", "select"),
    **dict.fromkeys((".geojson", ".json"), ("layer", "unit")),
    ".wkt": ("layer", "unit", "select"),
    **dict.fromkeys((".gpkg", ".shp"), ("unit",)),
}
"""Ending of a file without obligatory layer -> the keys that do not go with it."""
DEFAULT = "default"


@dataclass(frozen=True, kw_only=True)
class RockMass:
    """The tables of the domain, and of the lines that cut it."""

    domain: DomainTable
    joint_sets: Sequence[JointSetTable]
    traces: Sequence[TraceTable]
    openings: Sequence[OpeningTable]
    regions: Sequence[RegionTable]
    patterns: Sequence[BlockPatternTable]
    rocks: Sequence[str]
    """Names of the rocks of the case."""
    joints: Sequence[str]
    """Names of its joints."""

    def faults(self) -> Iterator[Fault]:
        """Give the names of rocks and joints that the case does not have."""
        named: list[tuple[Place, str | None]] = [(("domain", "rock"), self.domain.rock)]
        named += [(("region", k, "rock"), one.rock) for k, one in enumerate(self.regions)]
        for place, name in named:
            if name is not None and name not in self.rocks:
                yield unknown(name, self.rocks, "rock", place)
        if self.domain.rock is None and len(self.rocks) != 1:
            remedy = spelling.advice("", self.rocks, kind="rock")
            yield Fault("names no rock", remedy, ("domain", "rock"))
        for place, name in self._named_joints():
            if name not in (None, DEFAULT, *self.joints):
                yield unknown(str(name), self.joints, "joint", place)

    def _named_joints(self) -> Iterator[tuple[Place, str | None]]:
        """Give the places where tables name a joint, with the names."""
        groups: dict[str, Sequence[Any]] = {
            "joint_set": self.joint_sets,
            "trace": self.traces,
            "region": self.regions,
            "block_pattern": self.patterns,
        }
        for group, tables in groups.items():
            for k, table in enumerate(tables):
                yield (group, k, "joint"), table.joint
        for k, pattern in enumerate(self.patterns):
            yield ("block_pattern", k, "head_joint"), pattern.head_joint

    def cut(self, folder: Path) -> CutCase:
        """Return the blocks; files are looked for in ``folder``.  Raises ModelError."""
        from clast import rockmass

        notes: list[str] = []
        given = self._given(folder, notes)
        with given.renamed():
            cut = rockmass.cut(**given.tables)
        domain, traces, openings = (given.tables[key] for key in ("domain", "traces", "openings"))
        table = self.domain
        joints = {one.joint for one in traces} | {name for _, name in self._named_joints()}
        return CutCase(
            cut=cut,
            notes=(
                *notes,
                *seen_sets(self.joint_sets, cut.report.sets),
                *(_renamed(note, given.places) for note in cut.report.notes),
            ),
            warnings=(*cut.report.warnings, *doubted_sets(self.joint_sets)),
            fixed=_fixed(cut, np.asarray(domain.outline().corners), table.fixed_sides),
            line_joints=tuple(sorted(name for name in joints if name not in (None, DEFAULT))),
            outlines={one.name: one.outline().corners for one in openings},
        )

    def lines(self, folder: Path) -> Floats:
        """Return both ends of all lines that cut, m, shape (n, 2, 2).  Raises ModelError."""
        from clast import rockmass

        given = self._given(folder, [])
        with given.renamed():
            return rockmass.lines(**given.tables)

    def _given(self, folder: Path, notes: list[str]) -> _Given:
        """Return what ``rockmass.cut`` is given."""
        from clast import rockmass

        table = self.domain
        keys = ("section_azimuth", "tolerance", "smallest_edge", "smallest_block", "most_blocks")
        bonds = {"running-bond": rockmass.RunningBond(), "stack-bond": rockmass.StackBond()}
        traces, places = self._traces(folder, notes)
        tables = {
            "domain": rockmass.Domain(
                boundary=_boundary(table, folder, notes),
                rock=self.rocks[0] if table.rock is None else table.rock,
                **{key: getattr(table, key) for key in keys},
            ),
            "sets": [one.build() for one in self.joint_sets],
            "traces": traces,
            "openings": self._openings(folder, notes),
            "regions": self._regions(folder, notes),
            "seed": table.seed,
            "patterns": [
                rockmass.BlockPattern(**{**dict(one), "pattern": bonds[one.pattern]})
                for one in self.patterns
            ],
        }
        return _Given(tables, places)

    def _openings(self, folder: Path, notes: list[str]) -> list[Opening]:
        from clast import rockmass

        openings = []
        for table in self.openings:
            if table.file is not None:
                source = FileTable(file=table.file, layer=table.layer, unit=table.unit)
                where = f"opening '{table.name}', file"
                shape: Any = rockmass.Polygon(points=_outline(source, folder, where, notes))
            else:
                kind, needed, allowed = SHAPES[str(table.shape)]
                values = {key: getattr(table, key) for key in (*needed, *allowed)}
                given = {key: value for key, value in values.items() if value is not None}
                shape = getattr(rockmass, kind)(**given)
            openings.append(
                rockmass.Opening(
                    name=table.name,
                    shape=shape,
                    excavated=table.excavated,
                    construction_joint=table.construction_joint,
                )
            )
        return openings

    def _regions(self, folder: Path, notes: list[str]) -> list[Region]:
        from clast.rockmass import Region

        def outline(one: RegionTable) -> Any:
            return _outline(one.polygon, folder, f"region '{one.name}', polygon", notes)

        return [Region(**{**dict(one), "polygon": outline(one)}) for one in self.regions]

    def _traces(self, folder: Path, notes: list[str]) -> tuple[list[Trace], list[str]]:
        """Return all traces, and their names in messages."""
        from clast.rockmass import Trace

        traces, places = [], []
        for number, table in enumerate(self.traces, 1):
            if table.file is None:
                traces.append(Trace(points=table.points, joint=table.joint, set=table.set))
                places.append(f"trace {number}")
                continue
            where = f"trace {number}, file"
            for line in _lines(table, folder, where, notes):
                joint = table.joint if line.joint in ("", DEFAULT) else line.joint
                place = f"trace {number} ({table.file}, {line.place})"
                if joint not in (None, DEFAULT, *self.joints):
                    fault = unknown(str(joint), self.joints, "joint", ())
                    raise ModelError(fault.what, where=f"{place}, joint", remedy=fault.remedy)
                group = line.joint_set or table.set
                traces.append(Trace(points=line.points, joint=joint, set=group))
                places.append(place)
        return traces, places


@dataclass(frozen=True)
class _Given:
    """What ``rockmass.cut`` is given, with the names of its traces in messages."""

    tables: dict[str, Any]
    places: list[str]

    @contextmanager
    def renamed(self) -> Iterator[None]:
        """Name the tables of the case in the errors of the cut."""
        try:
            yield
        except ModelError as error:
            where = _renamed(error.where, self.places)
            raise ModelError(error.what, where=where, remedy=error.remedy) from None


@dataclass(frozen=True, kw_only=True, eq=False)
class CutCase:
    """The blocks of a rock mass, and their properties in the case."""

    cut: Cut
    """The blocks."""
    notes: tuple[str, ...]
    """Notes on changes and omissions."""
    warnings: tuple[str, ...]
    """Doubts about the input, each with its remedy."""
    fixed: Bools
    """True for blocks on a fixed side of the domain, shape (nb,)."""
    line_joints: tuple[str, ...]
    """Joints that tables name, whether or not edges have them."""
    outlines: Mapping[str, Floats]
    """Outlines of the openings by name, counter-clockwise, m, (c, 2) each."""

    @property
    def rocks(self) -> list[str]:
        """Rock of each block."""
        return [self.cut.rock_names[k] for k in self.cut.rock]

    @property
    def edge_joints(self) -> list[str]:
        """Joint of the edge from each vertex to the next, "" for none of its own."""
        names = (*self.cut.joint_names, "")  # the index -1 is the last
        return [names[k] for k in self.cut.edge_joint]

    def check_room(self, blocks: Sequence[BlockTable]) -> None:
        """Refuse blocks by hand that lie where the domain has blocks of its own."""
        vertex = self.cut.vertices
        owner = np.repeat(np.arange(self.cut.block_count), np.diff(self.cut.block_start))
        tree = shapely.STRtree(shapely.polygons(shapely.linearrings(vertex, indices=owner)))
        for number, one in enumerate(blocks, 1):
            if len(one.vertices) < 3 or not (shape := shapely.Polygon(one.vertices)).is_valid:
                continue  # what is wrong with it the builder says
            near = tree.geometries[tree.query(shape)]
            common = float(shapely.area(shapely.intersection(shape, near)).sum())
            # Blocks by hand of which more than this share lies in blocks that were cut are in their
            # place
            if common > 0.01 * shape.area:
                raise ModelError(
                    f"{common:.3g} m2 of it overlap the rock that is cut into blocks",
                    where=f"block {number}" + (f" '{one.name}'" if one.name else ""),
                    remedy="make room by an [[opening]] with excavated = true; or give the part as "
                    "a [[region]] with one_block = true in its place",
                )

    def add_to(self, builder: InputBuilder) -> None:
        """Add the blocks, with joints that hold where edges are welded."""
        from clast.rockmass import CONSTRUCTION, WELDED

        joints = self.edge_joints
        for name in sorted(set(joints)):
            if name == WELDED or name.startswith(CONSTRUCTION):
                builder.add_weld(name)
        builder.line_joints += self.line_joints
        builder.opening_outlines.update(self.outlines)
        builder.notes += [*self.notes, *_findings(self.cut.report)]
        names = builder.blocks(
            vertices=self.cut.vertices,
            start=self.cut.block_start,
            rock=self.rocks,
            fixed=self.fixed,
            edge_joint=joints,
        )
        for number, name in enumerate(self.cut.opening_names):
            inside = np.flatnonzero(self.cut.opening == number)
            weld = f"{CONSTRUCTION}{name}"
            if len(inside):  # it is no void from the start
                own = (names[block] for block in inside)
                builder.opening(name, own, weld if weld in joints else None)


def _fixed(cut: Cut, corners: Floats, sides: Sequence[str]) -> Bools:
    """Return True for blocks with a vertex on one of the sides, shape (nb,)."""
    held = np.zeros(cut.block_count, np.bool_)
    for side in sides:
        axis, outermost = SIDES[side]
        at = float(outermost(corners[:, axis]))
        # Vertices nearer to a side than this many cells of the grid are on it
        on = np.abs(cut.vertices[:, axis] - at) <= 1.5 * cut.report.tolerance
        here = np.logical_or.reduceat(on, cut.block_start[:-1])
        if not here.any():
            what = f"no block is at the {side}"
            remedy = f"remove '{side}': there is an opening from the start"
            raise ModelError(what, where="domain, fixed_sides", remedy=remedy)
        held |= here
    return held


def _boundary(table: DomainTable, folder: Path, notes: list[str]) -> Any:
    """Return the corners of the domain, m, (k, 2): as given, or of the ground below a profile."""
    from clast.rockmass import profile_outline

    if table.profile is None:
        return _outline(table.boundary, folder, "domain, boundary", notes)
    points: Any = table.profile
    if isinstance(points, FileTable):
        points = _profile(points, folder, "domain, profile", notes)
    return profile_outline(points, float(table.depth or 0.0), table.sides)


def _profile(source: FileTable, folder: Path, where: str, notes: list[str]) -> Floats:
    """Return the open line that a file holds, in one piece or in several end to end, m, (k, 2)."""
    from clast.rockmass.drawings.csv_lines import read_points

    path, layer = folder / source.file, _layer(source, where)
    if layer is None and path.suffix.casefold() == ".csv":
        with asked_by(where):
            points, said = read_points(path)
        notes += [f"{where}: {note}" for note in said]
        return points
    traces = _lines(TraceTable(**dict(source)), folder, where, notes)
    lines = [shapely.linestrings(one.points) for one in traces]
    joined = shapely.line_merge(shapely.multilinestrings(lines))
    if joined.geom_type != "LineString":
        of = f"the layer {layer}" if layer else source.file
        what = f"{of} has {len(shapely.get_parts(joined))} lines that do not join"
        raise ModelError(what, where=where, remedy="draw the profile as one open line")
    return shapely.get_coordinates(joined)


def _outline(source: Any, folder: Path, where: str, notes: list[str]) -> Any:
    """Return the corners that a table gives itself or names a file of, m, (k, 2)."""
    if not isinstance(source, FileTable):
        return source
    from clast.rockmass.drawings.csv_lines import read_outline
    from clast.rockmass.drawings.dxf import DxfReading, outline_of_layer
    from clast.rockmass.drawings.features import READERS, feature_outline

    path, layer = folder / source.file, _layer(source, where)
    with asked_by(where):
        if path.suffix.casefold() in READERS:
            corners, said = feature_outline(path, layer, source.select)
        elif layer is None:
            corners, said = read_outline(path)
        else:
            corners, said = outline_of_layer(path, layer, DxfReading(unit=source.unit))
    notes += [f"{where}: {note}" for note in said]
    return corners


def _lines(table: TraceTable, folder: Path, where: str, notes: list[str]) -> Sequence[Any]:
    """Return the traces of the file that a table names."""
    from clast.rockmass.drawings.csv_lines import read_traces
    from clast.rockmass.drawings.dxf import DxfReading, lines_of_layer
    from clast.rockmass.drawings.features import READERS, feature_lines

    path, layer = folder / str(table.file), _layer(table, where)
    with asked_by(where):
        if path.suffix.casefold() in READERS:
            traces, said = feature_lines(path, layer, table.select)
        elif layer is None:
            traces, said = read_traces(path)
        else:
            traces, said = lines_of_layer(path, layer, DxfReading(unit=table.unit))
        if not traces:
            what = "has no lines"
            raise CaseError(what, where=str(path), remedy="name the layer that has the joints")
    notes += [f"{where}: {note}" for note in said]
    return traces


def _layer(source: FileTable | TraceTable, where: str) -> str | None:
    """Return the layer of a drawing, None for a table; refuse keys that go with neither."""
    ending = Path(str(source.file)).suffix.casefold()
    lacking = KEYS_LACKING.get(ending, ("select",))
    for key in lacking:
        if getattr(source, key) is not None:
            what = f"a {ending[1:].upper()} file has no {key}"
            raise ModelError(what, where=where, remedy="leave it out, or name another file")
    if ending in KEYS_LACKING:
        return source.layer
    if ending != ".dxf":
        remedy = (
            "give a drawing (.dxf) with its layer, a table (.csv), or .geojson, .wkt, .gpkg, "
            ".shp; clast import converts other files"
        )
        raise ModelError(f"'{source.file}' is neither .dxf nor .csv", where=where, remedy=remedy)
    if source.layer is None:
        what = "the layer is missing"
        raise ModelError(what, where=where, remedy='name it: layer = "JOINTS_bedding"')
    return source.layer


def _renamed(text: str, places: Sequence[str]) -> str:
    """Return a text with traces called by their tables and files."""

    def place(match: re.Match[str]) -> str:
        number = int(match[1])
        return places[number - 1] if 1 <= number <= len(places) else match[0]

    return re.sub(r"\btrace (\d+)", place, text)


DONE = {
    "dangling": "of lines that border no block were taken out",
    "collapsed": "edges shorter than smallest_edge were collapsed",
    "merged": "blocks smaller than smallest_block joined a neighbour",
    "rings": "holes of blocks were split by welds",
    "coincident": "edges have lines of several joints; the later table has them",
    "snapped": "points of traces and outlines moved to others within the tolerance",
}
"""Finding of the report -> the change in words."""


def _findings(report: CutReport) -> Iterator[str]:
    """Yield the changes to lines and blocks, each with its first place."""
    from clast.rockmass.cut_report import place_text

    for key, what in DONE.items():
        finding: Finding = getattr(report, key)
        if finding.count:
            amount = f"{finding.length:.4g} m" if key == "dangling" else str(finding.count)
            first = [place_text(one, report.tolerance) for one in finding.places[:1]]
            at = f", first at {first[0]}" if first else ""
            places = tuple((float(x), float(y)) for x, y in finding.places)
            yield Remark(f"cut: {amount} {what}{at}", ("domain",), places)
    if report.short_edges:
        yield f"cut: {report.short_edges} edges remain shorter than smallest_edge"
    if report.small_blocks:
        yield f"cut: {report.small_blocks} blocks remain smaller than smallest_block"
