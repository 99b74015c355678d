"""The schema of a result file: each of its datasets once, with row, unit and meaning.

The file is HDF5, with the blocks as VTKHDF so that ParaView opens it:

    /VTKHDF        temporal UnstructuredGrid, one polygon per block, one step per frame:
                   Points, PointData and CellData of all frames one after the other (``FIELDS``);
                   Connectivity, Offsets and Types once, used by every frame through Steps
    /frames        table, a row per frame: time, and how many rows of the tables below belong to
                   the frames until then
    /frame_stage   number of the stage of each frame, from 0; only where the run has stages, whose
                   names are in about of /model
    /NAME          tables (``TABLES``)
    /model         the case file's text, how it is simulated (about, JSON), versions, and ``MODEL``
    /report        how the run went; only in a file that was finished

Recording, writing, checking, reading, exports and docs/reference/result-file.md walk it.
Where a new field, column or table goes is told in docs/decisions/0104-one-schema-of-results.md.

The attribute ``runs`` of the file says which runs have written it (``checkpoints.checkpoint``).

A frame counts once ``NSteps`` of /VTKHDF/Steps says so, which is written after its data have
reached the file; a process killed at any moment leaves all frames before readable.  Behind the end
of HDF5's part there are checksums of it (``clast.results.page_checksums``), and after a kill there
may be a journal (``clast.results.journal``), which clast reads in place of the bytes that it
changes.  Arrays and tables are compressed and have HDF5's own checksums for viewers.  In names of
points that name a dataset "%" and "/" stand as %25 and %2F.  Tables are HDF5 compound datasets:
``file["energy"]["kinetic"]``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.flow.given import HEAD
from clast.model.model import Model
from clast.model.state import LEDGER

FORMAT = 2
"""Version of the layout outside of /VTKHDF; files of other layouts are not read."""
VTKHDF_VERSION = (2, 2)
"""The first version that blesses groups of one's own beside /VTKHDF."""
POLYGON = 7
"""VTK's number for a polygonal cell."""
CHUNK_BYTES = 2048
"""Bytes that small things share a chunk of the file with."""
CHUNK_ROWS = 512
"""Rows that small things share a chunk of the file with."""
PLANE, TENSOR = ("x", "y"), ("xx", "yy", "xy")
"""Components of vectors and of stresses: columns are called displacement_x, stress_xx."""
LINK = ("along", "across")
"""Components of forces of links, along and across the link."""


class Per(Enum):
    """How often a dataset has new rows."""

    RUN = "once"
    FRAME = "frame"
    INSTANT = "instant"
    """The start of the run, and every step."""
    STEP = "step"


@dataclass(frozen=True)
class Column:
    """A column of a table."""

    name: str
    unit: str
    """SI unit, "" for numbers without one."""
    meaning: str
    parts: tuple[str, ...] = ()
    """Components, () for a scalar."""
    kind: str = "f8"
    """numpy's name of its type."""
    words: tuple[str, ...] = ()
    """Meanings of its numbers, from 0 on; () where they are quantities."""
    checked: str = ""
    """Its name where its numbers are found damaged; "": they are not checked."""
    may_be_nan: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its components as separate columns, its name for a scalar."""
        return tuple(f"{self.name}_{part}" for part in self.parts) or (self.name,)

    def entry(self, *rows: int) -> tuple[Any, ...]:
        """Return its entry in a dtype, of so many ``rows`` if there are any."""
        shape = (*rows, *((len(self.parts),) if self.parts else ()))
        # a plain number is not a subarray: the dtype, and so the file, would be another
        return (self.name, self.kind, shape) if shape else (self.name, self.kind)


def _or_nan(name: str, unit: str, meaning: str, parts: tuple[str, ...] = ()) -> Column:
    return Column(name, unit, meaning, parts, may_be_nan=True)


def _number(name: str, meaning: str, words: tuple[str, ...] = ()) -> Column:
    return Column(name, "", meaning, kind="i8", words=words)


@dataclass(frozen=True)
class Things:
    """The things of which a table has a row each, at every instant."""

    name: str
    """Their singular; a recording has their names as ``NAME_name``."""
    meaning: str
    names: Callable[[Model], tuple[str, ...]]
    """Returns the names of those of a model."""
    path: str = ""
    """Group with a dataset for each, named after it; "": one dataset has wide rows of all."""


POINTS = Things("point", "measured point", lambda m: m.measured_points.name, "history")
REACTIONS = Things("reaction", "reaction", lambda m: m.reactions.name)
LINKS = Things("link", "link", lambda m: m.links)
BOLTS = Things("bolt", "bolt", lambda m: m.bolts.name)
LINING_JOINTS = Things("lining_joint", "joint of a lining", lambda m: m.lining_joints.name)
MEASURED_CONTACTS = Things(
    "measured_contact", "measured contact", lambda m: m.measured_contacts.name
)
CONVERGENCES = Things("convergence", "convergence", lambda m: m.convergences.name)
FLOWS = Things(
    "flow",
    "boundary or well of the flow",
    lambda m: (*m.flow.names, ALL_JOINTS) if m.flow else (),
)
MEASURED_FLOWS = Things(
    "measured_flow",
    "measured flow",
    lambda m: tuple(name for name, _ in m.flow.measured) if m.flow else (),
)
ALL_JOINTS = "all joints"
"""Name of the sum of all flows."""
TIME = Column("time", "s", "time")


@dataclass(frozen=True, kw_only=True)
class TableSchema:
    """A table of the file."""

    name: str
    """Its name: place in the file, and in ``Recording.table``."""
    meaning: str
    per: Per
    columns: tuple[Column, ...]
    """Its columns behind the time; those of a frame have none."""
    of: Things | None = None
    """The things with a row at each instant; None: a single row."""
    csv: str = ""
    """Name of its CSV file, its name if empty."""
    without: str = ""
    """The message where there are none of its things."""
    drawn: tuple[str, ...] = ()
    """Columns that a notebook draws over time."""

    @property
    def timed(self) -> tuple[Column, ...]:
        """Its columns with the time."""
        return self.columns if self.per is Per.FRAME else (TIME, *self.columns)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column, those of components included, "" for numbers without one."""
        return {name: one.unit for one in self.timed for name in one.names}

    @property
    def words(self) -> dict[str, tuple[str, ...]]:
        """Meanings of the numbers of those columns that have words."""
        return {one.name: one.words for one in self.columns if one.words}

    @property
    def row(self) -> np.dtype[Any]:
        """One row: of one of the things, where it is of things."""
        return np.dtype([one.entry() for one in self.timed])

    @property
    def counter(self) -> str:
        """Column of /frames that counts its rows until a frame."""
        return {Per.INSTANT: "instants", Per.STEP: "steps"}.get(self.per, self.name)

    @property
    def apart(self) -> bool:
        """Whether each of its things has a dataset."""
        return self.of is not None and self.of.path != ""

    def rows(self, count: int) -> np.dtype[Any]:
        """Return one row of all ``count`` things, as it is in memory."""
        if self.of is None:
            return self.row
        return np.dtype([TIME.entry(), *(one.entry(count) for one in self.columns)])

    def count(self, model: Model) -> int:
        """Return the number of its things in a model."""
        return 1 if self.of is None else len(self.of.names(model))

    def is_kept(self, model: Model) -> bool:
        """Return whether the run of a model has the table."""
        return self.apart or self.count(model) > 0

    def places(self, names: tuple[str, ...]) -> tuple[str, ...]:
        """Return where it is in a file of things with these names."""
        return tuple(map(history_path, names)) if self.apart else (self.name,)

    def one(self, rows: NDArray[Any], index: int) -> NDArray[Any]:
        """Return the rows of one thing from those of all."""
        single = np.zeros(len(rows), self.row)
        single["time"] = rows["time"]
        for column in self.columns:
            single[column.name] = rows[column.name][:, index]
        return single

    def put_one(self, rows: NDArray[Any], index: int, of_one: NDArray[Any]) -> None:
        """Write the rows of one thing into those of all."""
        for column in self.columns:
            rows[column.name][:, index] = of_one[column.name]


ENERGY = TableSchema(
    name="energy",
    meaning="Energy ledger, J per metre of thickness; sums since the start, except stored energy.",
    per=Per.INSTANT,
    drawn=("kinetic", "elastic", "gravity", "friction"),
    columns=tuple(Column(name, "J/m", about["kind"].value) for name, about in LEDGER.items()),
)
STEPS = TableSchema(
    name="steps",
    meaning="Accepted steps.",
    per=Per.STEP,
    drawn=("penetration",),
    columns=(
        Column("step", "s", "length of the step"),
        _number("passes", "assemblies and solves"),
        _number("contacts", "contacts of the step"),
        Column("penetration", "m", "largest penetration at its end"),
        Column("travel", "m", "largest movement of a vertex"),
        _or_nan(
            "unbalanced",
            "",
            "largest unbalanced force of a block over all forces on it; NaN: no stages",
        ),
    ),
)
HISTORY = TableSchema(
    name="history",
    meaning="Measured points; a dataset /history/NAME for each.",
    per=Per.INSTANT,
    of=POINTS,
    csv="histories",
    without="no measured points are recorded",
    drawn=("displacement_x", "displacement_y"),
    columns=(
        Column("displacement", "m", "since the start, or a reset", PLANE),
        Column("velocity", "m/s", "velocity", PLANE),
        Column("rotation", "rad", "of its block since then, counter-clockwise"),
    ),
)
BOLT_STATES = ("not installed", "intact", "yielded", "broken", "lost")
"""States of a bolt by their numbers; one is lost whose block is excavated."""
BOLT_TABLE = TableSchema(
    name="bolts",
    meaning="Rock bolts: in each row force, elongation and state of all.",
    per=Per.INSTANT,
    of=BOLTS,
    without="there are no bolts",
    drawn=("force",),
    columns=(
        Column("force", "N/m", "force, tension positive"),
        _or_nan("elongation", "m", "beyond its length without force when it was installed"),
        _number("state", "state", BOLT_STATES),
    ),
)
REACTION_TABLE = TableSchema(
    name="reactions",
    meaning="Reactions of supports: fixed blocks and points, moved blocks, viscous edges, outlines "
    "under in-situ stress.",
    per=Per.INSTANT,
    of=REACTIONS,
    without="nothing is held or moved",
    drawn=("force_x", "force_y"),
    columns=(
        Column("force", "N/m", "force of the support on the blocks", PLANE),
        Column("moment", "N m/m", "its moment about the point of the reaction"),
        _or_nan(
            "position",
            "m",
            "point of its line of action nearest to that point, NaN without a force",
            PLANE,
        ),
    ),
)
LINK_STATES = ("not installed", "intact", "yielded", "broken")
"""States of a link by their numbers."""
LINK_TABLE = TableSchema(
    name="links",
    meaning="Links between blocks: in each row force, moment and state of all.",
    per=Per.INSTANT,
    of=LINKS,
    without="there are no links",
    drawn=("force_along", "force_across"),
    columns=(
        Column("force", "N/m", "force on the first block, along and across the link", LINK),
        Column("moment", "N m/m", "moment on the first block, counter-clockwise"),
        _number("state", "state", LINK_STATES),
    ),
)
LINING_STATES = ("not installed", "intact", "cracked", "yielded", "lost")
"""States of a joint of a lining by their numbers; one is lost whose segment is excavated."""
LINING_TABLE = TableSchema(
    name="linings",
    meaning="Linings: in each row forces, moment and state of the joints of all.",
    per=Per.INSTANT,
    of=LINING_JOINTS,
    without="there are no linings",
    drawn=("normal_force",),
    columns=(
        Column("normal_force", "N/m", "normal force N, tension positive"),
        Column("shear_force", "N/m", "shear force Q, to the left on what lies before the joint"),
        Column("moment", "N m/m", "moment M, positive where it stretches the left"),
        _or_nan(
            "utilisation",
            "",
            "share of the strength of the section, 1 on its curve; NaN without strengths",
        ),
        _number("state", "state", LINING_STATES),
    ),
)
CONTACTS = TableSchema(
    name="contacts",
    meaning="Contacts that carry a force, frame after frame.",
    per=Per.FRAME,
    columns=(
        Column("position", "m", "invading vertex", PLANE, checked="contacts"),
        Column("normal", "", "outward unit normal of the edge", PLANE, checked="normals"),
        Column(
            "normal_force", "N/m", "normal force, compression positive", checked="normal forces"
        ),
        Column(
            "shear_force",
            "N/m",
            "shear force on the vertex along the direction of the edge",
            checked="shear forces",
        ),
        _number("vertex", "number of the vertex, from 0"),
        _number("edge", "first vertex of the entrance edge"),
        _number("mode", "mode", ("open", "slide", "lock")),
        _number("joint", "joint that it lies along: index into joint_name"),
        Column("opening", "m", "gap, negative where pressed"),
        Column("slip", "m", "along the edge since the contact was made"),
        Column("worn", "", "share of the strength lost: 0 at the peak, 1 at the residual one"),
        Column("strength", "N/m", "shear strength N tan(phi) + c L, which sliding contacts carry"),
    ),
)
CONTACT_TABLE = TableSchema(
    name="measured_contacts",
    meaning="Measured contacts; those of a joint with the mean over its length.",
    per=Per.STEP,
    of=MEASURED_CONTACTS,
    without="no contacts are measured",
    drawn=("normal", "shear"),
    columns=(
        Column("normal", "Pa", "normal force per length, compression positive"),
        Column("shear", "Pa", "shear force per length, signed as the slip"),
        _or_nan("opening", "m", "gap, negative where pressed; NaN without a contact"),
        _or_nan("opening_least", "m", "smallest gap"),
        _or_nan("opening_most", "m", "largest gap"),
        _or_nan("slip", "m", "slip since the contact was made; NaN without a contact"),
        _or_nan("slip_least", "m", "smallest slip"),
        _or_nan("slip_most", "m", "largest slip"),
        Column("sliding", "", "share of the length that slides, 0 to 1"),
    ),
)
CONVERGENCE_TABLE = TableSchema(
    name="convergences",
    meaning="Convergences: in each row those of all pairs of measured points.",
    per=Per.INSTANT,
    of=CONVERGENCES,
    without="no convergences are measured",
    drawn=("convergence",),
    columns=(
        Column(
            "convergence",
            "m",
            "approach of the two points along the line between them at the start, since then or a "
            "reset; negative where they move apart",
        ),
    ),
)

FLOW_COLUMNS = (
    Column("into_rock", "m2/s", "water that flows into the joints there"),
    Column("out_of_rock", "m2/s", "water that leaves the joints there"),
)
FLOW_TABLE = TableSchema(
    name="flow",
    meaning="Water that flows in joints: boundaries, wells, openings, and the sum of all.",
    per=Per.INSTANT,
    of=FLOWS,
    without="no water flows in joints",
    drawn=("into_rock", "out_of_rock"),
    columns=(
        *FLOW_COLUMNS,
        Column("runoff", "m2/s", "rain that does not enter"),
        Column("pressure", "Pa", "largest pressure at its nodes"),
        Column("content", "m2", "water in all joints, its volume without pressure; 0 of a part"),
        Column("stored", "m2/s", "what is stored in all joints; 0 of a part"),
        Column("removed", "m2", "water gone with excavated joints so far, if it takes time"),
        Column("unaccounted", "m2/s", "what is in, less what is out and stored, of all joints"),
        _number("iterations", "linear systems of the last solution, of all joints"),
    ),
)
MEASURED_FLOW_TABLE = TableSchema(
    name="measured_flows",
    meaning="Measured flows: in each row those of all.",
    per=Per.INSTANT,
    of=MEASURED_FLOWS,
    without="no flows are measured",
    drawn=("into_rock", "out_of_rock"),
    columns=FLOW_COLUMNS,
)
ENDS = ("first", "last")
"""Components of numbers at both ends of a channel."""
CHANNEL_TABLE = TableSchema(
    name="channels",
    meaning="Channels of water in a frame.",
    per=Per.FRAME,
    columns=(
        Column("start", "m", "first end", PLANE),
        Column("end", "m", "last end", PLANE),
        Column("pressure", "Pa", "pressure at both ends", ENDS),
        Column("saturation", "", "share of the capacity with which water runs down", ENDS),
        Column("aperture", "m", "hydraulic aperture at both ends", ENDS),
        Column("flow", "m2/s", "flow from the first to the last end"),
        Column("wet", "", "share under pressure, from the end that has one"),
        _number("first_node", "node at its first end"),
        _number("last_node", "node at its last end"),
        _number("left", "block to its left"),
        _number("right", "block to its right"),
    ),
)
"""Put together from ``CHANNELS`` and the blocks of the frame; in no file as such."""

TABLES = (
    *(CONTACTS, ENERGY, STEPS, BOLT_TABLE, REACTION_TABLE, LINK_TABLE, LINING_TABLE),
    *(CONTACT_TABLE, CONVERGENCE_TABLE, FLOW_TABLE, MEASURED_FLOW_TABLE, HISTORY),
)
"""All tables, in the order in which a file is begun and written."""
OVER_TIME = tuple(one for one in TABLES if one.per is not Per.FRAME)
"""Those with a row for each instant or step."""
FRAMES = (
    TIME,
    _number("steps", "rows of /steps until then"),
    _number("instants", "rows of tables with a row per instant until then"),
    _number("contacts", "rows of /contacts until then"),
)
"""Columns of /frames."""
FRAME_ROW = np.dtype([one.entry() for one in FRAMES])
FRAME_STAGE = "frame_stage"
"""Numbers of the stages of the frames."""
BOLT_POINTS = "bolt_points"
"""Points that the bolts lie along, m, frame after frame."""
CHANNELS = "channels"
"""Water in channels, frame after frame: columns pressure to wet of ``CHANNEL_TABLE``, 0 where a
channel is excavated."""
BESIDE: dict[str, tuple[int, Callable[[Model], int]]] = {
    BOLT_POINTS: (2, lambda m: len(m.bolts.block)),
    CHANNELS: (8, lambda m: len(m.flow.network.length) if m.flow and m.flow.network else 0),
}
"""Arrays beside those of blocks: width, and rows of a model in each frame."""


@dataclass(frozen=True)
class Field:
    """An array of /VTKHDF with a row per vertex or block."""

    place: str
    """Its place there: Points, PointData/NAME for vertices, CellData/NAME for blocks."""
    unit: str
    """SI unit, "" for numbers without one."""
    meaning: str
    parts: tuple[str, ...] = ()
    """Components, () for a scalar; VTK wants vectors with a third one, which is zero."""
    component: str = ""
    """Name of the components before their part, its name if empty."""
    per: Per = Per.FRAME

    @property
    def name(self) -> str:
        """Its name, as ``Recording.field`` has it."""
        return self.place.rpartition("/")[2]

    @property
    def about(self) -> str:
        """Meaning and unit, as they are written beside it."""
        return f"{self.meaning}, {self.unit}" if self.unit else self.meaning

    @property
    def of_blocks(self) -> bool:
        """Whether it has a row for each block, not for each vertex."""
        return self.place.startswith("CellData/")

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a row in the file."""
        return (3,) if self.parts else ()


FIELDS = (
    Field("Points", "m", "vertices", PLANE),
    Field(
        "PointData/displacement",
        "m",
        "displacement of the vertex since the start or a reset",
        PLANE,
    ),
    Field(
        "CellData/displacement",
        "m",
        "displacement of the centroid since the start or a reset",
        PLANE,
    ),
    Field("CellData/velocity", "m/s", "velocity of the centroid", PLANE),
    Field("CellData/rotation", "rad", "rotation since the start or a reset, counter-clockwise"),
    Field("CellData/stress", "Pa", "stress (xx, yy, xy), tension positive", TENSOR, "sigma"),
    Field("CellData/sigma_1", "Pa", "largest principal stress in the plane, tension positive"),
    Field("CellData/sigma_3", "Pa", "smallest principal stress in the plane, tension positive"),
    Field("CellData/max_shear", "Pa", "largest shear stress in the plane"),
    Field("CellData/gone", "", "1 where the block has been excavated, else 0"),
    Field("CellData/block", "", "number of the block, from 0", per=Per.RUN),
    Field("CellData/rock", "", "number of the rock, from 0", per=Per.RUN),
    Field("CellData/fixed", "", "1 where the block cannot move", per=Per.RUN),
)
"""All arrays of vertices and blocks, in the order in which a file is begun."""
MOVING_FIELDS = tuple(one for one in FIELDS if one.per is Per.FRAME)
"""Those of each frame."""
BLOCK_FIELDS = tuple(one for one in MOVING_FIELDS if one.of_blocks)
"""Those of them with a row per block."""
KIND_FIELDS = tuple(one.name for one in FIELDS if one.per is Per.RUN)
"""Names of the fields that are the same in all frames."""
PLANE_VECTORS = tuple(one.name for one in BLOCK_FIELDS if one.parts == PLANE)
"""Names of the fields of blocks that VTK wants with a third component, which is zero."""
COMPONENTS = {
    f"{one.component or one.name}_{part}": (one.name, number)
    for one in BLOCK_FIELDS
    for number, part in enumerate(one.parts)
}
"""Parts of fields that may be asked for by a name of their own."""

MOVING = f"CellDataOffsets/{BLOCK_FIELDS[0].name}"
"""Where the offsets of the blocks' arrays are stored; all arrays share them by hard links."""
OFFSETS = ("NumberOfParts", "PartOffsets", "CellOffsets", "PointOffsets", MOVING)
"""Datasets of offsets in /VTKHDF/Steps, written a chunk of frames at a time."""


@dataclass(frozen=True)
class OfModel:
    """A dataset of /model, written once."""

    name: str
    value: str | Callable[[Model], Any]
    """Place of its values in the model, or a function that returns them: texts, or an array."""
    meaning: str
    of: Things | None = None
    """Only written where there are any of these; None: always."""
    kind: str = ""
    """Kinds of its numbers (numpy's letters); "" for texts."""
    shape: tuple[int, ...] = ()
    """Shape of a row."""

    def values(self, model: Model) -> Any:
        """Return the values to write."""
        return attrgetter(self.value)(model) if isinstance(self.value, str) else self.value(model)


def _names(things: Things) -> OfModel:
    return OfModel(f"{things.name}_name", things.names, f"name of each {things.meaning}", things)


def pressing_lines(model: Model) -> tuple[Any, Any]:
    """Return the lines of boundaries whose head presses, m, (s, 2, 2), and their numbers, (s,)."""
    lines, numbers = [np.zeros((0, 2, 2))], [np.zeros(0, np.int64)]
    for number, one in enumerate(model.flow.boundaries if model.flow else ()):
        if one.presses and one.kind == HEAD:
            lines.append(one.line + model.origin)
            numbers.append(np.full(len(one.line), number))
    return np.concatenate(lines), np.concatenate(numbers)


def places_of_flows(model: Model) -> Any:
    """Return the middle of each boundary, opening or well, m, (k, 2), NaN for the rest and all."""
    place = np.full((len(FLOWS.names(model)), 2), np.nan)
    if model.flow is not None:
        for number, one in enumerate(model.flow.boundaries):
            along, middle = one.line[:, 1] - one.line[:, 0], one.line.mean(axis=1)
            long = np.hypot(*along.T)
            if not long.sum() > 0.0:
                continue
            at = np.average(middle, axis=0, weights=long)
            # within a ring; else on the boundary
            closed = np.hypot(*along.sum(axis=0)) < 1e-6 * long.sum()
            place[number] = at if closed else middle[np.hypot(*(middle - at).T).argmin()]
        for number, well in enumerate(model.flow.wells, len(model.flow.boundaries)):
            place[number] = well.at.mean(axis=0)
    return place + model.origin


MODEL = (
    OfModel("block_name", "block_name", "name of each block"),
    OfModel("rock_name", lambda m: [rock.name for rock in m.rocks], "name of each rock"),
    OfModel(
        "joint_name",
        lambda m: [joint.name for joint in m.joint_table.joints],
        "name of each joint, the default first",
    ),
    OfModel("point_name", "measured_points.name", "name of each measured point"),
    OfModel(
        "point_start",
        lambda m: m.measured_points.at + m.origin,
        "where each measured point was at the start, m",
        kind="f",
        shape=(2,),
    ),
    OfModel(
        "block_start",
        "block_start",
        "first vertex of each block; the last entry is the number of vertices",
        kind="iu",
    ),
    OfModel("block_rock", "block_rock", "rock of each block", kind="iu"),
    OfModel("fixed", lambda m: m.fixed & ~m.lined, "true where a block cannot move", kind="biu"),
    OfModel(
        "edge_joint",
        "edge_joint",
        "joint of the edge from each vertex to the next; -1: none of its own",
        kind="i",
    ),
    _names(MEASURED_CONTACTS),
    _names(CONVERGENCES),
    OfModel(
        "convergence_points",
        "convergences.point",
        "the two measured points of each convergence, by their numbers",
        CONVERGENCES,
        "iu",
        (2,),
    ),
    _names(BOLTS),
    OfModel("bolt_kind", "bolts.kind", "kind of each bolt", BOLTS),
    _names(REACTIONS),
    OfModel(
        "reaction_about",
        lambda m: m.reactions.about + m.origin,
        "point that the moment of each reaction is about, m",
        REACTIONS,
        "f",
        (2,),
    ),
    OfModel(
        "reaction_of_block",
        "reactions.of_block",
        "reaction, and a block that it holds or moves, in each row",
        REACTIONS,
        "iu",
        (2,),
    ),
    OfModel(
        "link_line",
        lambda m: np.array([m.links.index(name) for name in m.link_lines.name], np.int64),
        "which of the links each of those with a place is",
        LINKS,
        "iu",
    ),
    OfModel(
        "link_block",
        "link_lines.block",
        "the two blocks of each link with a place, -1 the ground",
        LINKS,
        "iu",
        (2,),
    ),
    OfModel("link_at", "link_lines.at", "its point at the start, m", LINKS, "f", (2,)),
    OfModel(
        "link_along",
        "link_lines.along",
        "unit vector of its direction at the start",
        LINKS,
        "f",
        (2,),
    ),
    OfModel(
        "link_holds",
        "link_lines.holds",
        "along, across, rotation: 0 free, 1 spring or dashpot, 2 rigid",
        LINKS,
        "iu",
        (3,),
    ),
    _names(LINKS),
    _names(LINING_JOINTS),
    OfModel(
        "lining_along",
        "lining_joints.along",
        "where each joint is along the middle of its lining, m",
        LINING_JOINTS,
        "f",
    ),
    OfModel(
        "lining_face",
        "lining_joints.face",
        "vertices of the segment beside each joint: outside, and inside",
        LINING_JOINTS,
        "iu",
        (2,),
    ),
    OfModel(
        "lining_section",
        "lining_joints.section",
        "thickness, m, tensile and compressive strength, Pa, infinite for none, of each "
        "joint of a lining",
        LINING_JOINTS,
        "f",
        (3,),
    ),
    _names(FLOWS),
    _names(MEASURED_FLOWS),
    OfModel(
        "channel_edge",
        "flow.network.edge",
        "edges on either side of each channel of water, by their first vertices",
        FLOWS,
        "iu",
        (2,),
    ),
    OfModel(
        "channel_share",
        "flow.network.share",
        "where either edge has its ends, as the first one runs",
        FLOWS,
        "f",
        (2, 2),
    ),
    OfModel("channel_node", "flow.network.node", "nodes at its ends, from 0", FLOWS, "iu", (2,)),
    OfModel(
        "flow_place",
        places_of_flows,
        "middle of each boundary, opening or well of the flow, m; NaN without one",
        FLOWS,
        "f",
        (2,),
    ),
    OfModel(
        "flow_line",
        lambda m: pressing_lines(m)[0],
        "lines of boundaries whose head presses on them, m",
        FLOWS,
        "f",
        (2, 2),
    ),
    OfModel(
        "flow_of_line",
        lambda m: pressing_lines(m)[1],
        "which of the boundaries each of these lines is of",
        FLOWS,
        "iu",
    ),
    OfModel(
        "flow_weight",
        lambda m: np.array([m.flow.weight]) if m.flow else np.zeros(0),
        "weight of water, N/m3, once",
        FLOWS,
        "f",
    ),
    OfModel(
        "bolt_of_point",
        "bolts.bolt",
        "bolt of each of the points that bolts lie along",
        BOLTS,
        "iu",
    ),
)
"""Datasets of the model beside its source and its water (``clast.results.water_record``)."""


def history_path(name: str) -> str:
    """Return where the history of a measured point is."""
    # HDF5 takes "." for the group itself, and "" for nothing; ".." is the group above for others
    dots = name.replace(".", "%2E") if set(name) <= {"."} else name.replace("%", "%25")
    return f"history/{dots.replace('/', '%2F') or '%'}"
