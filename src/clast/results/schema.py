"""The schema of a result file: each of its datasets once, with row, unit, meaning and version.

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

Who records, writes, checks, reads and exports walks it, and so does docs/reference/result-file.md.
Where a new field, column or table goes is told in docs/decisions/0104-one-schema-of-results.md.

The attribute ``runs`` of the file says which runs have written it (``checkpoints.lineage``).

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
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Model
from clast.model.state import LEDGER

FORMAT = 2
"""Version of the layout outside of /VTKHDF: 1 had no checksums."""
VTKHDF_VERSION = (2, 2)
"""The first version that blesses groups of one's own beside /VTKHDF."""
POLYGON = 7
"""VTK's number for a polygonal cell."""
SLIP = "opening and slip of contacts"
WORN = "the strength that contacts have lost"
STRENGTH = "shear strengths of contacts"
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


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of a table."""

    name: str
    meaning: str
    unit: str = ""
    """SI unit, "" for numbers without one."""
    parts: tuple[str, ...] = ()
    """Components, () for a scalar."""
    kind: str = "f8"
    """numpy's name of its type."""
    since: str = ""
    """Version of clast that introduced it; "" where it was there from the beginning."""
    words: tuple[str, ...] = ()
    """Meanings of its numbers, from 0 on; () where they are quantities."""
    checked: str = ""
    """Its name where its numbers are found damaged; "": they are not checked."""
    may_be_nan: bool = False
    """Whether NaN is a value."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its components as columns of their own, its own name for a scalar."""
        return tuple(f"{self.name}_{part}" for part in self.parts) or (self.name,)

    def entry(self, *rows: int) -> tuple[Any, ...]:
        """Return its entry in a dtype, of so many ``rows`` if there are any."""
        shape = (*rows, *((len(self.parts),) if self.parts else ()))
        # a plain number is not a subarray: the dtype, and so the file, would be another
        return (self.name, self.kind, shape) if shape else (self.name, self.kind)


@dataclass(frozen=True, kw_only=True)
class Things:
    """The things of which a table has a row each, at every instant."""

    name: str
    """Its singular; a recording has their names as ``NAME_name``."""
    meaning: str
    """Its name for users."""
    names: Callable[[Model], tuple[str, ...]]
    """Returns the names of those of a model."""
    since: str = ""
    """As for a column: older files have none of them."""
    path: str = ""
    """Group with a dataset for each, named after it; "": one dataset has wide rows of all."""


POINTS = Things(
    name="point",
    meaning="measured point",
    names=lambda model: model.measured_points.name,
    path="history",
)
REACTIONS = Things(
    name="reaction",
    meaning="reaction",
    since="reactions",
    names=lambda model: model.reactions.name,
)
LINKS = Things(name="link", meaning="link", since="links", names=lambda model: model.links)
BOLTS = Things(
    name="bolt", meaning="bolt", since="rock bolts", names=lambda model: model.bolts.name
)
LINING_JOINTS = Things(
    name="lining_joint",
    meaning="joint of a lining",
    since="linings",
    names=lambda model: model.lining_joints.name,
)

MEASURED_CONTACTS = Things(
    name="measured_contact",
    meaning="measured contact",
    since="measured contacts",
    names=lambda model: model.measured_contacts.name,
)

TIME = Column(name="time", unit="s", meaning="time")


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
    since: str = ""
    """As for a column; such a table is only there where there is something to tell."""
    csv: str = ""
    """Name of its CSV file, its own name if empty."""
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
        """Column of /frames that says how many rows there are until a frame."""
        return {Per.INSTANT: "instants", Per.STEP: "steps"}.get(self.per, self.name)

    def rows(self, count: int) -> np.dtype[Any]:
        """Return one row of all ``count`` things, as it is in memory."""
        if self.of is None:
            return self.row
        return np.dtype([TIME.entry(), *(one.entry(count) for one in self.columns)])

    def count(self, model: Model) -> int:
        """Return of how many things of a model it tells."""
        return 1 if self.of is None else len(self.of.names(model))

    @property
    def may_be_missing(self) -> bool:
        """Whether files with its things may lack it."""
        return self.since != (self.of.since if self.of else "")

    def is_kept(self, model: Model) -> bool:
        """Return whether there is anything to be told of a model."""
        return not self.since or self.count(model) > 0

    def places(self, names: tuple[str, ...], layout: int = FORMAT) -> tuple[str, ...]:
        """Return where it is in a file of things with these names."""
        if self.of is None or not self.of.path:
            return (self.name,)
        return tuple(history_path(name, layout) for name in names)

    def one(self, rows: NDArray[Any], index: int) -> NDArray[Any]:
        """Return the rows of one thing from those of all."""
        found = np.zeros(len(rows), self.row)
        found["time"] = rows["time"]
        for column in self.columns:
            found[column.name] = rows[column.name][:, index]
        return found

    def put_one(self, rows: NDArray[Any], index: int, of_one: NDArray[Any]) -> None:
        """Write the rows of one thing into those of all."""
        for column in self.columns:
            rows[column.name][:, index] = of_one[column.name]


ENERGY = TableSchema(
    name="energy",
    meaning="Energy ledger, J per metre of thickness; sums since the start, except stored energy.",
    per=Per.INSTANT,
    drawn=("kinetic", "elastic", "gravity", "friction"),
    columns=tuple(
        Column(name=name, unit="J/m", meaning=about["kind"].value, since=about["since"])
        for name, about in LEDGER.items()
    ),
)
STEPS = TableSchema(
    name="steps",
    meaning="Accepted steps.",
    per=Per.STEP,
    drawn=("penetration",),
    columns=(
        Column(name="step", unit="s", meaning="length of the step"),
        Column(name="passes", kind="i8", meaning="assemblies and solves"),
        Column(name="contacts", kind="i8", meaning="contacts of the step"),
        Column(name="penetration", unit="m", meaning="largest penetration at its end"),
        Column(name="travel", unit="m", meaning="largest movement of a vertex"),
        Column(
            name="unbalanced",
            meaning="largest unbalanced force of a block over all forces on it; NaN: no stages",
            since="the unbalanced force of steps",
            may_be_nan=True,
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
        Column(name="displacement", parts=PLANE, unit="m", meaning="since the start, or a reset"),
        Column(name="velocity", parts=PLANE, unit="m/s", meaning="velocity"),
        Column(name="rotation", unit="rad", meaning="of its block since then, counter-clockwise"),
    ),
)
BOLT_STATES = ("not installed", "intact", "yielded", "broken", "lost")
"""States of a bolt by their numbers; one is lost whose block is excavated."""
BOLT_TABLE = TableSchema(
    name="bolts",
    meaning="Rock bolts: in each row force, elongation and state of all.",
    per=Per.INSTANT,
    of=BOLTS,
    since="rock bolts",
    without="there are no bolts",
    drawn=("force",),
    columns=(
        Column(name="force", unit="N/m", meaning="force, tension positive"),
        Column(
            name="elongation",
            unit="m",
            meaning="beyond its length without force when it was installed",
            may_be_nan=True,
        ),
        Column(name="state", kind="i8", meaning="state", words=BOLT_STATES),
    ),
)
REACTION_TABLE = TableSchema(
    name="reactions",
    meaning="Reactions of supports: fixed blocks and points, moved blocks, viscous edges.",
    per=Per.INSTANT,
    of=REACTIONS,
    since="reactions",
    without="nothing is held or moved",
    drawn=("force_x", "force_y"),
    columns=(
        Column(name="force", parts=PLANE, unit="N/m", meaning="force of the support on the blocks"),
        Column(name="moment", unit="N m/m", meaning="its moment about the point of the reaction"),
        Column(
            name="position",
            parts=PLANE,
            unit="m",
            meaning="point of its line of action nearest to that point, NaN without a force",
            may_be_nan=True,
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
    since="links",
    without="there are no links",
    drawn=("force_along", "force_across"),
    columns=(
        Column(
            name="force",
            parts=LINK,
            unit="N/m",
            meaning="force on the first block, along and across the link",
        ),
        Column(name="moment", unit="N m/m", meaning="moment on the first block, counter-clockwise"),
        Column(name="state", kind="i8", meaning="state", words=LINK_STATES),
    ),
)
LINING_STATES = ("not installed", "intact", "cracked", "yielded", "lost")
"""States of a joint of a lining by their numbers; one is lost whose segment is excavated."""
LINING_TABLE = TableSchema(
    name="linings",
    meaning="Linings: in each row forces, moment and state of the joints of all.",
    per=Per.INSTANT,
    of=LINING_JOINTS,
    since="linings",
    without="there are no linings",
    drawn=("normal_force",),
    columns=(
        Column(name="normal_force", unit="N/m", meaning="normal force N, tension positive"),
        Column(
            name="shear_force",
            unit="N/m",
            meaning="shear force Q, to the left on what lies before the joint",
        ),
        Column(
            name="moment", unit="N m/m", meaning="moment M, positive where it stretches the left"
        ),
        Column(
            name="utilisation",
            meaning="share of the strength of the section, 1 on its curve; NaN without strengths",
            may_be_nan=True,
        ),
        Column(name="state", kind="i8", meaning="state", words=LINING_STATES),
    ),
)
CONTACTS = TableSchema(
    name="contacts",
    meaning="Contacts that carry a force, frame after frame.",
    per=Per.FRAME,
    columns=(
        Column(
            name="position", parts=PLANE, unit="m", meaning="invading vertex", checked="contacts"
        ),
        Column(
            name="normal", parts=PLANE, meaning="outward unit normal of the edge", checked="normals"
        ),
        Column(
            name="normal_force",
            unit="N/m",
            meaning="normal force, compression positive",
            checked="normal forces",
        ),
        Column(
            name="shear_force",
            unit="N/m",
            meaning="shear force on the vertex along the direction of the edge",
            checked="shear forces",
        ),
        Column(name="vertex", kind="i8", meaning="number of the vertex, from 0"),
        Column(name="edge", kind="i8", meaning="first vertex of the entrance edge"),
        Column(name="mode", kind="i8", meaning="mode", words=("open", "slide", "lock")),
        Column(
            name="joint",
            kind="i8",
            meaning="joint that it lies along: index into joint_name",
            since="the joints of edges and contacts",
        ),
        Column(name="opening", unit="m", meaning="gap, negative where pressed", since=SLIP),
        Column(
            name="slip", unit="m", meaning="along the edge since the contact was made", since=SLIP
        ),
        Column(
            name="worn",
            meaning="share of the strength lost: 0 at the peak, 1 at the residual one",
            since=WORN,
        ),
        Column(
            name="strength",
            unit="N/m",
            meaning="shear strength N tan(phi) + c L, which sliding contacts carry",
            since=STRENGTH,
        ),
    ),
)

CONTACT_TABLE = TableSchema(
    name="measured_contacts",
    meaning="Measured contacts; those of a joint with the mean over its length.",
    per=Per.STEP,
    of=MEASURED_CONTACTS,
    since="measured contacts",
    without="no contacts are measured",
    drawn=("normal", "shear"),
    columns=(
        Column(name="normal", unit="Pa", meaning="normal force per length, compression positive"),
        Column(name="shear", unit="Pa", meaning="shear force per length, signed as the slip"),
        *(
            Column(name=name, unit="m", meaning=meaning, may_be_nan=True)
            for name, meaning in (
                ("opening", "gap, negative where pressed; NaN without a contact"),
                ("opening_least", "smallest gap"),
                ("opening_most", "largest gap"),
                ("slip", "slip since the contact was made; NaN without a contact"),
                ("slip_least", "smallest slip"),
                ("slip_most", "largest slip"),
            )
        ),
        Column(name="sliding", meaning="share of the length that slides, 0 to 1"),
    ),
)

TABLES = (
    CONTACTS,
    ENERGY,
    STEPS,
    BOLT_TABLE,
    REACTION_TABLE,
    LINK_TABLE,
    LINING_TABLE,
    CONTACT_TABLE,
    HISTORY,
)
"""All tables, in the order in which a file is begun and written."""
OVER_TIME = tuple(one for one in TABLES if one.per is not Per.FRAME)
"""Those with a row for each instant or step."""
FRAMES = (
    TIME,
    Column(name="steps", kind="i8", meaning="rows of /steps until then"),
    Column(name="instants", kind="i8", meaning="rows of tables with a row per instant until then"),
    Column(name="contacts", kind="i8", meaning="rows of /contacts until then"),
)
"""Columns of /frames."""
FRAME_ROW = np.dtype([one.entry() for one in FRAMES])
FRAME_STAGE = "frame_stage"
"""Numbers of the stages of the frames."""
BOLT_POINTS = "bolt_points"
"""Points that the bolts lie along, m, frame after frame."""


@dataclass(frozen=True, kw_only=True)
class Field:
    """An array of /VTKHDF with a row per vertex or block."""

    place: str
    """Its place there: Points, PointData/NAME for vertices, CellData/NAME for blocks."""
    meaning: str
    unit: str = ""
    """SI unit, "" for numbers without one."""
    parts: tuple[str, ...] = ()
    """Components, () for a scalar; VTK wants vectors with a third one, which is zero."""
    component: str = ""
    """Name of the components before their part, its own name if empty."""
    per: Per = Per.FRAME
    since: str = ""
    """As for a column."""

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
    Field(place="Points", parts=PLANE, meaning="vertices", unit="m"),
    Field(
        place="PointData/displacement",
        parts=PLANE,
        meaning="displacement of the vertex since the start or a reset",
        unit="m",
    ),
    Field(
        place="CellData/displacement",
        parts=PLANE,
        meaning="displacement of the centroid since the start or a reset",
        unit="m",
    ),
    Field(place="CellData/velocity", parts=PLANE, meaning="velocity of the centroid", unit="m/s"),
    Field(
        place="CellData/rotation",
        meaning="rotation since the start or a reset, counter-clockwise",
        unit="rad",
    ),
    Field(
        place="CellData/stress",
        parts=TENSOR,
        component="sigma",
        meaning="stress (xx, yy, xy), tension positive",
        unit="Pa",
    ),
    Field(
        place="CellData/sigma_1",
        meaning="largest principal stress in the plane, tension positive",
        unit="Pa",
    ),
    Field(
        place="CellData/sigma_3",
        meaning="smallest principal stress in the plane, tension positive",
        unit="Pa",
    ),
    Field(place="CellData/max_shear", meaning="largest shear stress in the plane", unit="Pa"),
    Field(
        place="CellData/gone",
        meaning="1 where the block has been excavated, else 0",
        since="excavated blocks",
    ),
    Field(place="CellData/block", per=Per.RUN, meaning="number of the block, from 0"),
    Field(place="CellData/rock", per=Per.RUN, meaning="number of the rock, from 0"),
    Field(place="CellData/fixed", per=Per.RUN, meaning="1 where the block cannot move"),
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


@dataclass(frozen=True, kw_only=True)
class OfModel:
    """A dataset of /model, written once."""

    name: str
    meaning: str
    value: Callable[[Model], Any]
    """Returns the values to write: texts, or an array."""
    since: str = ""
    """As for a column."""
    of: Things | None = None
    """Only written where there are any of these; None: always."""
    texts: bool = False
    packed: bool = True
    """Whether its numbers are compressed."""


def _of_lines(key: str, model: Model) -> Any:
    """Return an array of the links that stand at a point."""
    return getattr(model.link_lines, key)


MODEL = (
    OfModel(
        name="block_name", texts=True, value=lambda m: m.block_name, meaning="name of each block"
    ),
    OfModel(
        name="rock_name",
        texts=True,
        value=lambda m: [rock.name for rock in m.rocks],
        meaning="name of each rock",
    ),
    OfModel(
        name="joint_name",
        texts=True,
        value=lambda m: [joint.name for joint in m.joint_table.joints],
        meaning="name of each joint, the default first",
        since="the joints of edges and contacts",
    ),
    OfModel(
        name="point_name",
        texts=True,
        value=lambda m: m.measured_points.name,
        meaning="name of each measured point",
    ),
    OfModel(
        name="point_start",
        packed=False,
        value=lambda m: m.measured_points.at + m.origin,
        meaning="where each measured point was at the start, m",
    ),
    OfModel(
        name="block_start",
        value=lambda m: m.block_start,
        meaning="first vertex of each block; the last entry is the number of vertices",
    ),
    OfModel(name="block_rock", value=lambda m: m.block_rock, meaning="rock of each block"),
    OfModel(
        name="fixed", value=lambda m: m.fixed & ~m.lined, meaning="true where a block cannot move"
    ),
    OfModel(
        name="edge_joint",
        value=lambda m: m.edge_joint,
        meaning="joint of the edge from each vertex to the next; -1: none of its own",
        since="the joints of edges and contacts",
    ),
    OfModel(
        name="measured_contact_name",
        of=MEASURED_CONTACTS,
        texts=True,
        value=lambda m: m.measured_contacts.name,
        meaning="name of each measured contact",
        since="measured contacts",
    ),
    OfModel(
        name="bolt_name",
        of=BOLTS,
        texts=True,
        value=lambda m: m.bolts.name,
        meaning="name of each bolt",
        since="rock bolts",
    ),
    OfModel(
        name="bolt_kind",
        of=BOLTS,
        texts=True,
        value=lambda m: m.bolts.kind,
        meaning="kind of each bolt",
        since="rock bolts",
    ),
    OfModel(
        name="reaction_name",
        of=REACTIONS,
        texts=True,
        value=lambda m: m.reactions.name,
        meaning="name of each reaction",
        since="reactions",
    ),
    OfModel(
        name="reaction_about",
        of=REACTIONS,
        packed=False,
        value=lambda m: m.reactions.about + m.origin,
        meaning="point that the moment of each reaction is about, m",
        since="reactions",
    ),
    OfModel(
        name="reaction_of_block",
        of=REACTIONS,
        packed=False,
        value=lambda m: m.reactions.of_block,
        meaning="reaction, and a block that it holds or moves, in each row",
        since="the blocks of reactions",
    ),
    OfModel(
        name="link_line",
        of=LINKS,
        packed=False,
        value=lambda m: np.array([m.links.index(name) for name in m.link_lines.name], np.int64),
        meaning="which of the links each of those with a place is",
        since="the places of links",
    ),
    *(
        OfModel(
            name=f"link_{key}",
            of=LINKS,
            packed=False,
            value=partial(_of_lines, key),
            meaning=meaning,
            since="the places of links",
        )
        for key, meaning in (
            ("block", "the two blocks of each link with a place, -1 the ground"),
            ("at", "its point at the start, m"),
            ("along", "unit vector of its direction at the start"),
            ("holds", "along, across, rotation: 0 free, 1 spring or dashpot, 2 rigid"),
        )
    ),
    OfModel(
        name="link_name",
        of=LINKS,
        texts=True,
        value=lambda m: m.links,
        meaning="name of each link",
        since="links",
    ),
    OfModel(
        name="lining_joint_name",
        of=LINING_JOINTS,
        texts=True,
        value=lambda m: m.lining_joints.name,
        meaning="name of each joint of a lining: that of the lining, a slash and its number",
        since="linings",
    ),
    OfModel(
        name="lining_along",
        of=LINING_JOINTS,
        packed=False,
        value=lambda m: m.lining_joints.along,
        meaning="where each joint is along the middle of its lining, m",
        since="linings",
    ),
    OfModel(
        name="lining_face",
        of=LINING_JOINTS,
        packed=False,
        value=lambda m: m.lining_joints.face,
        meaning="vertices of the segment beside each joint: outside, and inside",
        since="linings",
    ),
    OfModel(
        name="lining_section",
        of=LINING_JOINTS,
        packed=False,
        value=lambda m: m.lining_joints.section,
        meaning="thickness, m, tensile and compressive strength, Pa, infinite for none, of each "
        "joint of a lining",
        since="the sections of linings",
    ),
    OfModel(
        name="bolt_of_point",
        of=BOLTS,
        value=lambda m: m.bolts.bolt,
        meaning="bolt of each of the points that bolts lie along",
        since="rock bolts",
    ),
)
"""Datasets of the model beside its source and its water (``clast.results.water_record``)."""


# a slash would open a group; what stands for it must not be a name of its own
SPECIAL = str.maketrans({sign: f"%{ord(sign):02X}" for sign in "%/"})


def history_path(name: str, layout: int = FORMAT) -> str:
    """Return where the history of a measured point is."""
    if layout == 1:
        return f"history/{name.replace('/', '∕')}"
    # HDF5 takes "." for the group itself, and "" for nothing; ".." is the group above for others
    dots = name.replace(".", "%2E") if set(name) <= {"."} else name.translate(SPECIAL)
    return f"history/{dots or '%'}"
