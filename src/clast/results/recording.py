"""Recordings: reading the results of a run just made and of a result file, in the same way."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast import spelling, thumbnails
from clast.errors import CaseError, shortened
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.stage_records import DRAWN, Event, StageRecord
from clast.model.state import State
from clast.model.supports import LiningJoints, LinkLines
from clast.model.surcharge import Surcharge
from clast.model.water import Water
from clast.results.frames import ABSENT, VERTICES, FrameStore
from clast.results.result_tables import (
    BlockHistory,
    BoltHistory,
    Channels,
    Columns,
    ContactHistory,
    ConvergenceHistory,
    FlowHistory,
    FrameBolts,
    FrameContacts,
    FrameFlow,
    LiningHistory,
    PointHistory,
    ReactionHistory,
)
from clast.results.run_report import Report, version_of
from clast.results.schema import (
    BESIDE,
    BOLT_POINTS,
    BOLT_TABLE,
    CHANNELS,
    COMPONENTS,
    CONTACT_TABLE,
    CONVERGENCE_TABLE,
    ENERGY,
    FLOW_TABLE,
    FLOWS,
    HISTORY,
    LINING_TABLE,
    LINK_TABLE,
    MEASURED_FLOW_TABLE,
    MEASURED_FLOWS,
    OVER_TIME,
    REACTION_TABLE,
    STEPS,
    TableSchema,
    places_of_flows,
    pressing_lines,
)

NOTEBOOK = "clast.pictures.notebook"
"""Makes the view for a notebook; it is in a layer above and only imported when it is wanted."""
BLOCK_ROW = np.dtype([*HISTORY.row.descr, ("stress", "f8", 3)])


@dataclass(frozen=True, kw_only=True)
class Frame:
    """One instant of a run as it was recorded; n blocks, nv vertices."""

    number: int
    time: float
    """Time, s."""
    recording: Recording = field(repr=False)

    @property
    def stage(self) -> str:
        """Name of its stage, "" where the run has no stages."""
        stages = self.recording.frame_stages
        return stages[self.number] if stages else ""

    @property
    def vertices(self) -> Floats:
        """Vertices, m, shape (nv, 2)."""
        return self.recording.vertices(self.number)

    def field(self, name: str) -> NDArray[Any]:
        """Return a field of the blocks, shape (n,), (n, 2) or (n, 3)."""
        return self.recording.field(name, self.number)

    @property
    def contacts(self) -> FrameContacts:
        """The contacts that carry a force, as a table."""
        return self.recording.contacts(self.number)

    @property
    def flow(self) -> FrameFlow:
        """The water in joints, as a table."""
        return self.recording.flow(self.number)

    @property
    def water_table(self) -> tuple[Floats, ...]:
        """Lines through points of joints with no pressure, m, (c, 2) each, one by wet part."""
        return self.flow.water_table


@dataclass(frozen=True, kw_only=True, repr=False)
class Recording:
    """The records of a run; n blocks, nv vertices.  Coordinates are the user's.

    Frames are numbered from 0, negative numbers count from the end.  Nothing is interpolated.
    A run just made (``Run``) and a result file (``Results``) are recordings: each has a place of
    its frames (``_frames``) and of its rows of tables (``_rows``).
    """

    title: str
    times: Floats
    """Time of each frame, s, shape (frames,)."""
    block_name: tuple[str, ...]
    block_start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    block_rock: Ints
    """Rock index of each block, shape (n,)."""
    fixed: Bools
    """True where a block cannot move at all, shape (n,)."""
    rock_name: tuple[str, ...]
    point_name: tuple[str, ...]
    point_start: Floats
    """Where each measured point was at the start, m, shape (k, 2)."""
    joint_name: tuple[str, ...]
    edge_joint: Ints
    """Joint index of the edge from each vertex to the next, (nv,); -1: none, its contacts take that
    of their blocks or rocks, or the default."""
    measured_contact_name: tuple[str, ...] = ()
    convergence_name: tuple[str, ...] = ()
    convergence_points: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """The two measured points of each convergence, by their numbers, shape (k, 2)."""
    bolt_name: tuple[str, ...] = ()
    bolt_of_point: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """Bolt of each of the points that bolts lie along, shape (q,)."""
    reaction_name: tuple[str, ...] = ()
    reaction_of_block: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    """Reaction and block that it holds or moves, shape (b, 2)."""
    link_name: tuple[str, ...] = ()
    link_lines: LinkLines = field(default_factory=LinkLines)
    """The links with a place, where they were at the start."""
    lining_joints: LiningJoints = field(default_factory=LiningJoints)
    flow_name: tuple[str, ...] = ()
    """Boundaries and wells of water that flows in joints, and the sum of all."""
    measured_flow_name: tuple[str, ...] = ()
    channels: Channels = field(default_factory=Channels)
    """The channels of that water."""
    origin: Floats = field(default_factory=lambda: np.zeros(2))
    """Point that coordinates of the model are relative to, m, shape (2,)."""
    gravity: Floats = field(default_factory=lambda: np.zeros(2))
    """Acceleration of gravity, m/s2, shape (2,)."""
    water: tuple[Water, ...] = ()
    """Water on outer faces and in joints."""
    surcharge: Surcharge = field(default_factory=Surcharge)
    """Fill and axles of load trains, about the ``origin``."""
    report: Report | None
    """How the run went; None where it never came to write one."""
    begins: Mapping[str, str] = field(default_factory=dict)
    """Stage with which each load, water or table that stages name begins."""

    @property
    def file(self) -> Path | None:
        """The result file; None where nothing was written."""
        raise NotImplementedError

    def begun_at(self, frame: int) -> dict[str, float | None]:
        """Return when the loads that stages name have begun, s, by name; None: not by a frame."""
        stages, begun = self.frame_stages, dict[str, float | None]()
        frame %= len(self.times)
        for name, stage in self.begins.items():
            # a stage begins with the last frame of the one before
            first = stages.index(stage) if stage in stages else len(stages)
            begun[name] = None if first > frame else float(self.times[max(0, first - 1)])
        return begun

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

    def drawn(self, drawpoint: str) -> tuple[Floats, Floats]:
        """Return when blocks left at a drawpoint, s, and all mass drawn by then, kg/m, (k,) each.

        Raises CaseError for a name at which nothing left.
        """
        those = [one for one in self.events if one.kind == DRAWN]
        some = [one for one in those if one.what == drawpoint]
        if not some:
            raise CaseError(
                f"nothing has left at a drawpoint '{shortened(drawpoint)}'",
                where=self.name,
                remedy=spelling.advice(drawpoint, {one.what for one in those}, kind="drawpoint"),
            )
        return np.array([one.time for one in some]), np.cumsum([one.mass for one in some])

    @property
    def frame_stages(self) -> tuple[str, ...]:
        """Name of the stage of each frame; empty where the run has no stages."""
        return self._frames.frame_stages

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
        known = (*self.field_names, *COMPONENTS, VERTICES)
        if name not in known:
            raise unknown_name("field", name, known)
        if name in COMPONENTS:
            whole, part = COMPONENTS[name]
            return self.field(whole, frame)[..., part]
        count = int(self.block_start[-1]) if name == VERTICES else len(self.block_name)
        if frame is None:
            return self._frames.series(name, range(len(self.times)), 0, count)
        number = self._number(frame)
        one: NDArray[Any] = self._frames.series(name, range(number, number + 1), 0, count)[0]
        return one

    def vertices(self, frame: int = -1) -> Floats:
        """Return the vertices of a frame, m, shape (nv, 2); frame -1 is the last."""
        return self.field(VERTICES, frame)

    def contacts(self, frame: int = -1) -> FrameContacts:
        """Return the contacts of a frame that carry a force, as a table."""
        return FrameContacts(self._frames.contact_rows(self._number(frame)), self.block_start)

    def _number(self, frame: int) -> int:
        """Return a frame's number counted from 0; negative ones count from the end."""
        count = len(self.times)
        if not -count <= frame < count:
            raise CaseError(
                f"there is no frame {frame}",
                remedy=f"there are {count} frames: 0 to {count - 1}, or -1 for the last",
            )
        return frame % count

    def frame(
        self, number: int = -1, *, at: float | None = None, stage: str | None = None
    ) -> Frame:
        """Return a frame by its number, the one nearest to the time ``at``, s, or of a stage.

        That is the last one of the stage.  Raises CaseError for a number or a time that lies
        outside of the run, and for a stage that does not exist.
        """
        times = self.times
        if stage is not None:
            stages = self.frame_stages
            if stage not in stages:
                raise unknown_name("stage", stage, tuple(dict.fromkeys(stages)))
            number = len(stages) - 1 - stages[::-1].index(stage)
        if at is not None:
            slack = 1e-9 * max(float(np.ptp(times)), abs(at))
            if not times[0] - slack <= at <= times[-1] + slack:
                raise CaseError(
                    f"there is no frame at t = {at:g} s",
                    remedy=f"the frames lie between {times[0]:g} and {times[-1]:g} s",
                )
            number = int(np.abs(times - at).argmin())
        number = self._number(number)
        return Frame(number=number, time=float(times[number]), recording=self)

    def block(self, name: str) -> BlockHistory:
        """Return how the block ``name`` moved, a row per frame, as a table."""
        if name not in self.block_name:
            raise unknown_name("block", name, self.block_name)
        number, frames = self.block_name.index(name), range(len(self.times))
        rows = np.zeros(len(frames), BLOCK_ROW)
        rows["time"] = self.times
        for field_name in (BLOCK_ROW.names or ())[1:]:
            rows[field_name] = self._frames.series(field_name, frames, number, number + 1)[:, 0]
        first, past = (int(end) for end in self.block_start[number : number + 2])
        vertices = self._frames.series(VERTICES, frames, first, past)
        return BlockHistory(rows, name, number, vertices, self.frame_stages)

    def table(self, name: str, of: str | None = None) -> Columns:
        """Return a table with a row per instant or step: "energy", "steps", "history", "bolts", ...

        ``of`` names the measured point or the bolt, in tables of these.  Raises CaseError for a
        table or a name that does not exist.
        """
        known = {one.name: one for one in OVER_TIME}
        if name not in known:
            raise unknown_name("table", name, tuple(known))
        return Columns(self._rows_called(known[name], of), known[name], of or "")

    def names_of(self, table: TableSchema) -> tuple[str, ...]:
        """Return the names of the things of a table; none for a table of the run."""
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
        """Return the history of the measured point ``name``, a row per instant, as a table."""
        return PointHistory(self._rows_called(HISTORY, name), HISTORY, name)

    def bolt_history(self, name: str) -> BoltHistory:
        """Return the force of the bolt ``name``, a row per instant, as a table."""
        return BoltHistory(self._rows_called(BOLT_TABLE, name), BOLT_TABLE, name)

    def measured_contact(self, name: str) -> ContactHistory:
        """Return the history of the measured contact ``name``, a row per step, as a table."""
        return ContactHistory(self._rows_called(CONTACT_TABLE, name), CONTACT_TABLE, name)

    def convergence(self, name: str) -> ConvergenceHistory:
        """Return the convergence ``name`` of two points, m, a row per instant, as a table.

        It is positive where they approach along the line between them at the start.
        """
        return ConvergenceHistory(
            self._rows_called(CONVERGENCE_TABLE, name), CONVERGENCE_TABLE, name
        )

    def reaction(self, name: str) -> ReactionHistory:
        """Return a reaction of supports, a row per instant, as a table."""
        return ReactionHistory(self._rows_called(REACTION_TABLE, name), REACTION_TABLE, name)

    def link(self, name: str) -> Columns:
        """Return the history of a link, a row per instant: time, force, moment, state."""
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
        """Return forces and moments along a lining, a row per instant."""
        if name not in self.lining_name:
            raise unknown_name("lining", name, self.lining_name)
        joints = self.lining_joints
        places = joints.of(name)
        every = self._rows(LINING_TABLE)
        rows = [LINING_TABLE.one(every, int(k)) for k in places]
        along, face, section = joints.along[places], joints.face[places], joints.section[places]
        return LiningHistory(along, face, section, rows)

    @property
    def lined(self) -> Bools:
        """True for the segments of linings, shape (n,)."""
        rocks = [f"lining {name}" for name in self.lining_name]
        return np.isin(np.asarray(self.rock_name)[self.block_rock], rocks)

    def awaited(self, frame: int) -> Bools:
        """Return which blocks have not come by a frame: linings of later stages, shape (n,)."""
        return np.asarray(self._number(frame) < self._comes)

    @cached_property
    def _comes(self) -> Ints:
        """First frame of segments of linings, the number of frames for none; 0 for rock, (n,)."""
        comes = np.zeros(len(self.block_name), np.int64)
        lined = np.flatnonzero(self.lined)
        if len(lined):
            frames, first = range(len(self.times)), int(lined[0])
            rows = self._frames.series(ABSENT, frames, first, int(lined[-1]) + 1)
            absent = rows[:, lined - first] != 0.0
            comes[lined] = np.where(absent.all(axis=0), len(frames), absent.argmin(axis=0))
        return comes

    def bolts(self, frame: int = -1) -> FrameBolts:
        """Return the bolts of a frame: where they are, their forces and states."""
        number = self._number(frame)
        if not self.bolt_name:
            return FrameBolts((), np.zeros((0, 2)), self.bolt_of_point, None)
        rows = self._rows(BOLT_TABLE)
        row = rows[int(np.abs(rows["time"] - self.times[number]).argmin())]
        points = self._frames.beside(BOLT_POINTS, number)
        return FrameBolts(self.bolt_name, points, self.bolt_of_point, row)

    def flow(self, frame: int = -1) -> FrameFlow:
        """Return the water in the joints of a frame: where it is, pressures, flows, as a table."""
        number, channels = self._number(frame), self.channels
        values = np.zeros((0, BESIDE[CHANNELS][0]))
        if len(channels.edge):
            values = self._frames.beside(CHANNELS, number)
        return FrameFlow(channels, values, self.vertices(number), self.block_start)

    def inflow(self, name: str) -> FlowHistory:
        """Return the water at a boundary, well or opening, a row per instant, as a table.

        Its ``inflow`` is the flow out of the rock, m2/s: into a tunnel.  A measured flow goes by
        its own name, too.
        """
        table = FLOW_TABLE if name in self.flow_name else MEASURED_FLOW_TABLE
        known = (*self.flow_name, *self.measured_flow_name)
        if name not in known:
            raise unknown_name(FLOWS.meaning, str(name), known)
        return FlowHistory(self._rows_called(table, name), table, name)

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

        ``frame``, ``field``, ``contacts`` and ``look`` as in ``clast.plot_results``; ``ax``: axes
        to draw on, without arrows.  Raises CaseError as it does.
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
        from clast.results.libraries import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> Any:
        """Return fields of blocks and histories of the run as an xarray.Dataset.

        Its dimensions are frame, block, vertex, instant, point, bolt, and the components.  Raises
        CaseError where xarray is not installed.
        """
        from clast.results.libraries import to_xarray

        return to_xarray(self)

    def _repr_html_(self) -> str:
        last = len(self.times) - 1
        moved = np.hypot(*self.field("displacement", last).T)
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
        "joint_name": tuple(one.name for one in joints),
        "edge_joint": model.edge_joint,
        "measured_contact_name": model.measured_contacts.name,
        "convergence_name": model.convergences.name,
        "convergence_points": model.convergences.point,
        "bolt_name": model.bolts.name,
        "bolt_of_point": model.bolts.bolt,
        "reaction_name": model.reactions.name,
        "reaction_of_block": model.reactions.of_block,
        "link_name": model.links,
        "link_lines": model.link_lines,
        "lining_joints": model.lining_joints,
        "flow_name": FLOWS.names(model),
        "measured_flow_name": MEASURED_FLOWS.names(model),
        "channels": _channels_of(model),
        "origin": model.origin,
        "gravity": np.asarray(model.gravity),
        "water": model.water,
        "surcharge": model.surcharge,
    }


def _channels_of(model: Model) -> Channels:
    flow = model.flow
    network = flow.network if flow else None
    if flow is None or network is None:
        return Channels()
    return Channels(
        edge=network.edge,
        share=network.share,
        node=network.node,
        place=places_of_flows(model),
        line=pressing_lines(model)[0],
        of_line=pressing_lines(model)[1],
        weight=flow.weight,
    )


@dataclass(frozen=True, kw_only=True, repr=False)
class Run(Recording):
    """A run just made: its recording, its model, and its last state.

    Frames are in memory where the run wrote no file, else they are read from it when asked for.
    """

    model: Model
    state: State
    """State at the end, relative to the model's origin (see ``final``)."""
    report: Report
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
    case_text: str = ""
    """The case as a TOML text; "" where no text can hold it."""
    about: Mapping[str, Any] = field(default_factory=dict)
    """How the run was simulated (results.provenance)."""

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

    def save(self, path: str | Path) -> Path:
        """Write the run to a result file (.vtkhdf), as with ``output``; return its path.

        Frames that were dropped as they did not fit into memory are not in it.  Raises CaseError
        for a file that cannot be written.
        """
        from clast.results.saving import save_run

        return save_run(self, Path(path))

    def frames_made(self) -> Any:
        """Return the place of its frames, in memory or in its file."""
        return self._frames

    def _rows(self, table: TableSchema, index: int | None = None) -> NDArray[Any]:
        rows = self.tables[table.name]
        return rows if index is None else table.one(rows, index)

    @cached_property
    def _frames(self) -> FrameStore:
        return self.open_frames()

    def __repr__(self) -> str:
        end = "finished" if self.report.finished else "not finished"
        where = f"{len(self.times)} frames in {self.output or 'memory'}"
        return (
            f"Run('{self.title}', {self.model.block_count} blocks, {end} at t = "
            f"{self.state.time:.6g} s after {self.report.steps} steps\n"
            f"    {where}; measured points: {', '.join(self.point_name[:4]) or 'none'})"
        )


def unknown_name(kind: str, name: str, known: Sequence[str]) -> CaseError:
    """Return the error for a name that does not exist, with the nearest one that does."""
    name = str(name)
    return CaseError(f"there is no {kind} '{name}'", remedy=spelling.advice(name, known, kind=kind))
