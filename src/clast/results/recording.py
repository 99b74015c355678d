"""Recordings: reading the results of a run just made and of a result file, in the same way."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clast import thumbnails
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.stages.records import Event, StageRecord
from clast.model.state import State
from clast.model.supports.lining_joints import LiningJoints
from clast.model.water.water import Water
from clast.results.frames import (
    ABSENT,
    VERTICES,
    Frame,
    FrameStore,
    block_of,
    bolts_of,
    contacts_of,
    field_of,
    frame_number,
    frame_of,
    unknown_name,
)
from clast.results.provenance import version_of
from clast.results.result_tables import (
    BlockHistory,
    BoltHistory,
    Columns,
    ContactHistory,
    FrameBolts,
    FrameContacts,
    LiningHistory,
    PointHistory,
    ReactionHistory,
    no_joints,
)
from clast.results.run_report import Report
from clast.results.schema import (
    BOLT_TABLE,
    CONTACT_TABLE,
    ENERGY,
    HISTORY,
    LINING_TABLE,
    LINK_TABLE,
    OVER_TIME,
    REACTION_TABLE,
    STEPS,
    TableSchema,
)
from clast.results.supports_record import SupportsRecord, supported_by

NOTEBOOK = "clast.pictures.notebook"
"""Makes the view for a notebook; it is in a layer above and only imported when it is wanted."""


@dataclass(frozen=True, kw_only=True)
class EdgeJoints:
    """The joints of a run; nv edges, each from a vertex to the next."""

    name: tuple[str, ...]
    """Name of each joint."""
    edge: Ints
    """Joint index of each edge; -1: by its pair of blocks or rocks, or the default, (nv,)."""


@dataclass(frozen=True, kw_only=True)
class BoltLines:
    """The bolts of a run: k of them along q points."""

    name: tuple[str, ...] = ()
    """Name of each bolt."""
    point: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """Bolt of each point, shape (q,)."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Recording:
    """The records of a run; n blocks, nv vertices.  Coordinates are the user's.

    A run just made (``Run``) and a result file (``Results``) are recordings: each says where its
    frames (``_frames``) and the rows of its tables (``_rows``) are.
    """

    title: str
    """Title of the case."""
    times: Floats
    """Time of each frame, s, shape (frames,)."""
    block_name: tuple[str, ...]
    """Name of each block."""
    block_start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    block_rock: Ints
    """Rock index of each block, shape (n,)."""
    fixed: Bools
    """True where a block cannot move at all, shape (n,)."""
    rock_name: tuple[str, ...]
    """Name of each rock."""
    point_name: tuple[str, ...]
    """Name of each measured point."""
    point_start: Floats
    """Where each measured point was at the start, m, shape (k, 2)."""
    joints: EdgeJoints | None = field(default=None, repr=False)
    """The joints; None for files of older versions."""
    measured_contact_name: tuple[str, ...] = ()
    """Name of each measured contact."""
    bolt_lines: BoltLines = field(default_factory=BoltLines, repr=False)
    """The bolts."""
    reaction_name: tuple[str, ...] = ()
    """Name of each reaction."""
    link_name: tuple[str, ...] = ()
    """Name of each link."""
    lining_joints: LiningJoints = field(default_factory=LiningJoints, repr=False)
    """The joints of linings."""
    supported: SupportsRecord = field(default_factory=SupportsRecord, repr=False)
    """Blocks of reactions, and places of links."""
    origin: Floats = field(default_factory=lambda: np.zeros(2), repr=False)
    """Point that coordinates of the model are relative to, m, shape (2,)."""
    gravity: Floats = field(default_factory=lambda: np.zeros(2), repr=False)
    """Acceleration of gravity, m/s2, shape (2,)."""
    water: tuple[Water, ...] = field(default=(), repr=False)
    """Water on outer faces and in joints."""
    report: Report | None
    """How the run went; None where it never came to write one."""
    begins: Mapping[str, str] = field(default_factory=dict)
    """Stage with which each load, water or table that stages name begins."""

    @property
    def file(self) -> Path | None:
        """The result file; None where nothing was written."""
        raise NotImplementedError

    @property
    def name(self) -> str:
        """Name of the result file, "run" where there is none."""
        return self.file.name if self.file else "run"

    @property
    def version(self) -> str:
        """Version of the clast that made the run."""
        return version_of("clast")

    @property
    def _frames(self) -> FrameStore:
        """Where the frames are."""
        raise NotImplementedError

    def _rows(self, table: TableSchema, index: int | None = None) -> NDArray[Any]:
        """Return the rows of a table: of the thing with this index, or of all."""
        raise NotImplementedError

    @property
    def stages(self) -> tuple[StageRecord, ...]:
        """How each stage went; none where the run has no stages, or did not end."""
        return self.report.stages if self.report else ()

    @property
    def events(self) -> tuple[Event, ...]:
        """The events of the run; none are known where it did not end."""
        return self.report.events if self.report else ()

    @property
    def frame_stages(self) -> tuple[str, ...]:
        """Name of the stage of each frame; empty where the run has no stages."""
        return self._frames.frame_stages

    @property
    def joint_name(self) -> tuple[str, ...]:
        """Name of each joint.  Raises CaseError for files of older versions."""
        return self._known_joints.name

    @property
    def edge_joint(self) -> Ints:
        """Joint index of the edge from each vertex to the next, shape (nv,).

        -1: none of its own; its contacts take that of their blocks or rocks, or the default.
        Raises CaseError for files of older versions.
        """
        return self._known_joints.edge

    @property
    def _known_joints(self) -> EdgeJoints:
        if self.joints is None:
            raise no_joints(self.name)
        return self.joints

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        return self._frames.field_names

    def field(self, name: str, frame: int | None = None) -> NDArray[Any]:
        """Return a field of the blocks, of all frames or of one.

        Shape (frames, n), (frames, n, 2) or (frames, n, 3), without the first of them for one
        frame.  ``field_names`` says which there are; parts of them are called sigma_yy,
        displacement_x and so on; "vertices" is (frames, nv, 2), m.  Raises CaseError for a field or
        a frame that does not exist.
        """
        return field_of(self._frames, name, frame)

    def vertices(self, frame: int = -1) -> Floats:
        """Return the vertices of a frame, m, shape (nv, 2); frame -1 is the last."""
        return field_of(self._frames, VERTICES, frame)

    def contacts(self, frame: int = -1) -> FrameContacts:
        """Return the contacts of a frame that carry a force, as a table."""
        return contacts_of(self._frames, frame)

    def frame(
        self, number: int = -1, *, at: float | None = None, stage: str | None = None
    ) -> Frame:
        """Return a frame by its number, the one nearest to the time ``at``, s, or of a stage.

        That is the last one of the stage.  Raises CaseError for a number or a time that lies
        outside of the run, and for a stage that does not exist.
        """
        return frame_of(self._frames, number, at, stage)

    def block(self, name: str) -> BlockHistory:
        """Return how the block ``name`` moved, a row per frame, as a table.

        Raises CaseError for a block that does not exist.
        """
        return block_of(self._frames, name, self.block_name)

    def table(self, name: str, of: str | None = None) -> Columns:
        """Return a table with a row per instant or step: "energy", "steps", "history", "bolts", ...

        ``of`` names the measured point or the bolt, in tables of these.  Raises CaseError for a
        table or a name that does not exist.
        """
        known = {one.name: one for one in OVER_TIME}
        if name not in known:
            raise unknown_name("table", name, tuple(known))
        return Columns(self._rows_called(known[name], of), known[name], of or "")

    def lacks(self, table: TableSchema) -> bool:
        """Return whether it was recorded without a table, by an earlier clast."""
        return False

    def names_of(self, table: TableSchema) -> tuple[str, ...]:
        """Return the names of the things that a table tells of; none where it tells of the run."""
        if table.of is None:
            return ()
        names: tuple[str, ...] = getattr(self, f"{table.of.name}_name")
        return names

    def _rows_called(self, table: TableSchema, of: str | None) -> NDArray[Any]:
        """Return the rows of a table, of the thing ``of`` where it is of things."""
        if table.of is None:
            return self._rows(table)
        names = self.names_of(table)
        if of not in names:
            raise unknown_name(table.of.meaning, str(of), names)
        return self._rows(table, names.index(str(of)))

    def rows_at(self, time: Floats, frames: Any) -> Any:
        """Return the rows of a history with times (k,), s, that belong to frames.

        Static steps may have several rows at one time: a frame is that of the last.
        """
        return np.maximum(np.searchsorted(time, self.times[frames] * (1.0 + 1e-12), "right") - 1, 0)

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``, a row per instant, as a table.

        Raises CaseError for a point that does not exist.
        """
        return PointHistory(self._rows_called(HISTORY, name), HISTORY, name)

    @property
    def bolt_name(self) -> tuple[str, ...]:
        """Name of each bolt."""
        return self.bolt_lines.name

    def bolt_history(self, name: str) -> BoltHistory:
        """Return the force of the bolt ``name``, a row per instant, as a table.

        Raises CaseError for a bolt that does not exist.
        """
        return BoltHistory(self._rows_called(BOLT_TABLE, name), BOLT_TABLE, name)

    def measured_contact(self, name: str) -> ContactHistory:
        """Return the history of the measured contact ``name``, a row per step, as a table.

        Raises CaseError for one that does not exist.
        """
        return ContactHistory(self._rows_called(CONTACT_TABLE, name), CONTACT_TABLE, name)

    def reaction(self, name: str) -> ReactionHistory:
        """Return a reaction of supports, a row per instant, as a table.

        Raises CaseError for one that does not exist.
        """
        return ReactionHistory(self._rows_called(REACTION_TABLE, name), REACTION_TABLE, name)

    def link(self, name: str) -> Columns:
        """Return the history of a link, a row per instant: time, force, moment, state.

        Raises CaseError for one that does not exist.
        """
        return Columns(self._rows_called(LINK_TABLE, name), LINK_TABLE, name)

    @property
    def lining_joint_name(self) -> tuple[str, ...]:
        """Name of each joint of a lining."""
        return self.lining_joints.name

    @property
    def lining_name(self) -> tuple[str, ...]:
        """Name of each lining."""
        return self.lining_joints.linings

    def lining(self, name: str) -> LiningHistory:
        """Return forces and moments along a lining, a row per instant.

        Raises CaseError for one that does not exist.
        """
        if name not in self.lining_name:
            raise unknown_name("lining", name, self.lining_name)
        joints = self.lining_joints
        own = joints.of(name)
        every = self._rows(LINING_TABLE)
        rows = [LINING_TABLE.one(every, int(k)) for k in own]
        section = joints.section[own] if len(joints.section) else joints.section
        return LiningHistory(joints.along[own], joints.face[own], section, rows)

    @property
    def lined(self) -> Bools:
        """True for the segments of linings, shape (n,)."""
        rocks = [f"lining {name}" for name in self.lining_name]
        return np.isin(np.asarray(self.rock_name)[self.block_rock], rocks)

    def awaited(self, frame: int) -> Bools:
        """Return which blocks have not come by a frame: linings of later stages, shape (n,)."""
        return np.asarray(frame_number(self._frames, frame) < self._comes)

    @cached_property
    def _comes(self) -> Ints:
        """First frame of segments of linings, the number of frames for none; 0 for rock, (n,)."""
        found = np.zeros(len(self.block_name), np.int64)
        lined = np.flatnonzero(self.lined)
        if len(lined) and ABSENT in self.field_names:
            frames, first = range(len(self.times)), int(lined[0])
            rows = self._frames.series(ABSENT, frames, first, int(lined[-1]) + 1)
            absent = rows[:, lined - first] != 0.0
            found[lined] = np.where(absent.all(axis=0), len(frames), absent.argmin(axis=0))
        return found

    def bolts(self, frame: int = -1) -> FrameBolts:
        """Return the bolts of a frame: where they are, their forces and states."""
        lines = self.bolt_lines
        rows = self._rows(BOLT_TABLE) if lines.name else np.zeros(0)
        return bolts_of(self._frames, frame, lines.name, lines.point, rows)

    @property
    def energy(self) -> Columns:
        """Energy ledger over time: ``time``, s, and every entry, J per m, each of shape (t,)."""
        return self.table(ENERGY.name)

    @property
    def steps(self) -> Columns:
        """Accepted steps: time, step, passes, contacts, penetration, travel, each of shape (t,)."""
        return self.table(STEPS.name)

    def plot(self, **wishes: Any) -> Any:
        """Return the picture of a frame, which a notebook shows; ``.save("run.pdf")`` writes it.

        ``frame``, ``field``, ``contacts`` and ``look`` as in ``clast.plot_results``.  Raises
        CaseError as it does.
        """
        return import_module(NOTEBOOK).plot(self, **wishes)

    def page(self, **wishes: Any) -> Any:
        """Return the page of the run (``clast page``) for a notebook, which shows it.

        It is a widget where anywidget is installed (``pip install 'clast[notebook]'``), else a
        frame.  ``budget`` is the size of contacts and joints, bytes, uncompressed.
        """
        return import_module(NOTEBOOK).page(self, **wishes)

    def to_pandas(self) -> dict[str, Any]:
        """Return the tables of the run as pandas.DataFrame, by their names.

        "blocks" has a row per frame and block, "contacts" one per frame and contact; the others,
        as "energy", have one per instant or step, those of points and bolts with their names.
        Raises CaseError where pandas is not installed.
        """
        from clast.results.libraries.frames_of_pandas import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> Any:
        """Return fields of blocks and histories of the run as an xarray.Dataset.

        Its dimensions are frame, block, vertex, instant, point, bolt, and the components.  Raises
        CaseError where xarray is not installed.
        """
        from clast.results.libraries.dataset_of_xarray import to_xarray

        return to_xarray(self)

    def _repr_html_(self) -> str:
        last = len(self.times) - 1
        moved = np.hypot(*field_of(self._frames, "displacement", last).T)
        drawing = thumbnails.blocks(self.vertices(last), self.block_start, self.fixed, moved)
        outcome = self.report.outcome if self.report else "the run did not end, or goes on"
        rows: list[tuple[str, object]] = [
            ("blocks", len(self.block_name)),
            ("frames", f"{len(self.times)}, to t = {self.times[-1]:.6g} s"),
            ("outcome", outcome),
            ("largest displacement", f"{float(moved.max(initial=0.0)):.4g} m"),
            ("measured points", ", ".join(self.point_name[:8]) or "none"),
        ]
        if self.report:
            rows += [("steps", self.report.steps), ("warnings", len(self.report.warnings))]
        return thumbnails.side_by_side(self.title or self.name, drawing, rows)


def parts_of(model: Model) -> dict[str, Any]:
    """Return the parts of the model in the recording of a run, by the names of its fields."""
    points, joints = model.measured_points, model.joint_table.joints
    return {
        "title": model.title,
        "block_name": model.block_name,
        "block_start": model.block_start,
        "block_rock": model.block_rock,
        "fixed": model.fixed & ~model.lined,
        "rock_name": tuple(rock.name for rock in model.rocks),
        "point_name": points.name,
        "point_start": points.at + model.origin,
        "joints": EdgeJoints(name=tuple(one.name for one in joints), edge=model.edge_joint),
        "measured_contact_name": model.measured_contacts.name,
        "bolt_lines": BoltLines(name=model.bolts.name, point=model.bolts.bolt),
        "reaction_name": model.reactions.name,
        "link_name": model.links,
        "lining_joints": model.lining_joints,
        "supported": supported_by(model),
        "origin": model.origin,
        "gravity": np.asarray(model.gravity),
        "water": model.water,
    }


EARLIER = {
    "point_rows": "history",
    "bolt_rows": "bolts",
    "energy_rows": "energy",
    "step_rows": "steps",
}
"""Names that rows of tables had as attributes of a run."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Run(Recording):
    """A run just made: its recording, its model, and its last state.

    Frames are in memory where the run wrote no file, else they are read from it when asked for.
    """

    model: Model
    """The model."""
    state: State
    """State at the end, relative to the model's origin (see ``final``)."""
    report: Report
    """How the run went."""
    output: Path | None
    """Result file, or None where nothing was written."""
    tables: Mapping[str, NDArray[Any]]
    """Rows of each table with a row per instant or step (``clast.results.schema``)."""
    open_frames: Callable[[], FrameStore]
    """Returns where its frames are: in memory, or in the file, which is opened then."""
    ended_by: int = 0
    """Number of the signal that ended the run early, 0 where none did."""
    checkpoint: Path | None = None
    """The last checkpoint of the run, which ``clast resume`` goes on from; None without any."""

    @property
    def final(self) -> State:
        """State at the end in user coordinates: the model's origin is added."""
        return dataclasses.replace(
            self.state,
            vertices=self.state.vertices + self.origin,
            points=self.state.points + self.origin,
        )

    @property
    def step_sizes(self) -> Floats:
        """Size of every accepted step, s, shape (steps,)."""
        sizes: Floats = self.steps["step"]
        return sizes

    @property
    def file(self) -> Path | None:
        """The result file; None where nothing was written."""
        return self.output

    def _rows(self, table: TableSchema, index: int | None = None) -> NDArray[Any]:
        rows = self.tables[table.name]
        return rows if index is None else table.one(rows, index)

    @cached_property
    def _frames(self) -> FrameStore:
        return self.open_frames()

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NDArray[Any]:
            """Return rows by the names that they had before ``tables``."""
            if name not in EARLIER:
                raise AttributeError(f"Run has no attribute '{name}'")
            warnings.warn(
                f'Run.{name} will go: use run.tables["{EARLIER[name]}"]',
                DeprecationWarning,
                stacklevel=2,
            )
            return self.tables[EARLIER[name]]

    def __repr__(self) -> str:
        end = "finished" if self.report.finished else "not finished"
        where = f"{len(self.times)} frames in {self.output or 'memory'}"
        return (
            f"Run('{self.title}', {self.model.block_count} blocks, {end} at t = "
            f"{self.state.time:.6g} s after {self.report.steps} steps\n"
            f"    {where}; measured points: {', '.join(self.point_name[:4]) or 'none'})"
        )
