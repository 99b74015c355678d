"""Reads result files, those of a killed run included."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model.model import Bools, Floats, Ints
from clast.model.stages.records import Event, StageRecord
from clast.model.water.water import Water
from clast.results import structure
from clast.results.frames import (
    KIND_FIELDS,
    VERTICES,
    Frame,
    block_of,
    bolts_of,
    contacts_of,
    field_of,
    frame_of,
    gone_in_frame,
    unknown_name,
)
from clast.results.layout import BOLT_STATES, FORMAT, PLANE_VECTORS, history_path
from clast.results.opening import AGAIN, ask, check_ours
from clast.results.provenance import main_parameters
from clast.results.run import Report
from clast.results.structure import BoltLines, EdgeJoints
from clast.results.tables import (
    BlockHistory,
    BoltHistory,
    Columns,
    FrameBolts,
    FrameContacts,
    PointHistory,
    no_joints,
    rows_of_bolt,
)

LARGEST = 1e150
"""No place and no force is that large."""
SOUND = {
    "position": "contacts",
    "normal": "normals",
    "normal_force": "normal forces",
    "shear_force": "shear forces",
}
"""Columns of the contacts that are looked at, and what they are called."""
QUICKLY_CHECKED = 2**28
"""Size of a file that is checked from end to end in less than half a second, bytes."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Results:
    """What a result file holds.  Coordinates are the user's; arrays are read when asked for."""

    path: Path
    """The file."""
    title: str
    """Title of the case."""
    case_text: str
    """The case file as it was run."""
    about: dict[str, Any]
    """Process, contact law, rocks and their numbers, as clast info prints them."""
    versions: dict[str, str]
    """Version of clast and of what it is built on."""
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
    report: Report | None
    """How the run went; None where it never came to write one."""
    joints: EdgeJoints | None = field(default=None, repr=False)
    """The joints; None where an earlier clast wrote the file."""
    bolt_lines: BoltLines = field(default_factory=BoltLines, repr=False)
    """The bolts."""
    origin: Floats = field(default_factory=lambda: np.zeros(2), repr=False)
    """Point that coordinates of the model are relative to, m, shape (2,)."""
    water: tuple[Water, ...] = field(default=(), repr=False)
    """Water on outer faces and in joints."""
    layout: int = FORMAT
    """Version of the file's layout."""
    frame_stages: tuple[str, ...] = ()
    """Name of the stage of each frame; empty where the run has no stages."""
    frame_rows: NDArray[Any] = field(repr=False)
    """Table of the frames: time, and the rows of the other tables until then."""

    @property
    def name(self) -> str:
        """Name of the file."""
        return self.path.name

    @property
    def begins(self) -> Mapping[str, str]:
        """Stage with which each load, water or table that stages name begins."""
        begins: Mapping[str, str] = self.about.get("begins", {})
        return begins

    @property
    def stages(self) -> tuple[StageRecord, ...]:
        """How each stage went; none where the run has no stages, or did not end."""
        return self.report.stages if self.report else ()

    @property
    def events(self) -> tuple[Event, ...]:
        """What happened in the run; nothing is known where it did not end."""
        return self.report.events if self.report else ()

    @property
    def joint_name(self) -> tuple[str, ...]:
        """Name of each joint.  Raises CaseError where an earlier clast wrote the file."""
        return self._known_joints.name

    @property
    def edge_joint(self) -> Ints:
        """Joint index of the edge from each vertex to the next, shape (nv,).

        -1: none of its own; its contacts take that of their blocks or rocks, or the default.
        Raises CaseError where an earlier clast wrote the file.
        """
        return self._known_joints.edge

    @property
    def _known_joints(self) -> EdgeJoints:
        if self.joints is None:
            raise no_joints(str(self.path))
        return self.joints

    def field(self, name: str, frame: int | None = None) -> NDArray[Any]:
        """Return a field of the blocks, of all frames or of one.

        Shape (frames, n), (frames, n, 2) or (frames, n, 3), without the first of them for one
        frame.  ``field_names`` says which there are; parts of them are called sigma_yy,
        displacement_x and so on; "vertices" is (frames, nv, 2), m.  Raises CaseError for a field or
        a frame that does not exist.
        """
        return field_of(self, name, frame)

    def vertices(self, frame: int = -1) -> Floats:
        """Return the vertices of a frame, m, shape (nv, 2); frame -1 is the last."""
        return field_of(self, VERTICES, frame)

    def contacts(self, frame: int = -1) -> FrameContacts:
        """Return the contacts of a frame that carry a force, as a table."""
        return contacts_of(self, frame)

    def frame(
        self, number: int = -1, *, at: float | None = None, stage: str | None = None
    ) -> Frame:
        """Return a frame by its number, the one nearest to the time ``at``, s, or of a stage.

        That is the last one of the stage.  Raises CaseError for a number or a time that lies
        outside of the run, and for a stage that does not exist.
        """
        return frame_of(self, number, at, stage)

    def block(self, name: str) -> BlockHistory:
        """Return how the block ``name`` moved, a row per frame, as a table.

        Raises CaseError for a block that does not exist.
        """
        return block_of(self, name, self.block_name)

    @cached_property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        return ask(self.path, lambda file: tuple(file["VTKHDF/CellData"]))

    def series(self, name: str, frames: range, first: int, past: int) -> NDArray[Any]:
        """Return rows ``first`` to ``past`` - 1 of a field in some frames, (frames, rows, ...)."""
        kind = name in KIND_FIELDS
        count = int(self.block_start[-1]) if name == VERTICES else len(self.block_rock)
        place = "VTKHDF/Points" if name == VERTICES else f"VTKHDF/CellData/{name}"
        start, apart = (first, 0) if kind else (first + frames.start * count, frames.step * count)

        def rows(file: Any) -> NDArray[Any]:
            return stretches(file[place], start, apart, (len(frames), past - first))

        values = ask(self.path, rows)
        if name == VERTICES:
            self._check_sound(values, "vertices", frames)
        return values[:, :, :2] if name in (*PLANE_VECTORS, VERTICES) else values

    def contact_rows(self, frame: int) -> NDArray[Any]:
        """Return a row for every contact of a frame that carries a force."""
        ends = self.frame_rows["contacts"]
        first = ends[frame - 1] if frame else 0
        rows: NDArray[Any] = ask(self.path, lambda file: file["contacts"][first : ends[frame]])
        for name, what in SOUND.items():
            self._check_sound(rows[name][None], what, [frame])
        self._check_joints(rows, frame)
        return rows

    def _check_joints(self, rows: NDArray[Any], frame: int) -> None:
        """Raise CaseError where contacts lie along joints that do not exist."""
        if self.joints is None or not len(rows) or "joint" not in (rows.dtype.names or ()):
            return
        if rows["joint"].min() < 0 or rows["joint"].max() >= len(self.joints.name):
            raise CaseError(
                f"is damaged: frame {frame} has contacts along joints that do not exist",
                where=str(self.path),
                remedy=AGAIN,
            )

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``, a row per instant, as a table.

        Raises CaseError for a point that does not exist.
        """
        if name not in self.point_name:
            raise unknown_name("measured point", name, self.point_name)
        return PointHistory(self._table(history_path(name, self.layout), "instants"))

    @property
    def bolt_name(self) -> tuple[str, ...]:
        """Name of each bolt."""
        return self.bolt_lines.name

    def bolt_history(self, name: str) -> BoltHistory:
        """Return what the bolt ``name`` bore, a row per instant, as a table.

        Raises CaseError for a bolt that does not exist.
        """
        if name not in self.bolt_name:
            raise unknown_name("bolt", name, self.bolt_name)
        return BoltHistory(
            rows_of_bolt(self._table("bolts", "instants"), self.bolt_name.index(name))
        )

    def bolts(self, frame: int = -1) -> FrameBolts:
        """Return the bolts of a frame: where they are, their forces and states."""
        lines = self.bolt_lines
        rows = self._table("bolts", "instants") if lines.name else np.zeros(0)
        return bolts_of(self, frame, lines.name, lines.point, rows)

    def bolt_points(self, frame: int) -> Floats:
        """Return the points of the bolts in a frame, m, shape (q, 2)."""
        first = frame * len(self.bolt_lines.point)
        past = first + len(self.bolt_lines.point)
        points: Floats = ask(self.path, lambda file: file["bolt_points"][first:past])
        self._check_sound(points[None], "bolts", [frame])
        return points

    @property
    def energy(self) -> Columns:
        """Energy ledger over time: ``time``, s, and every entry, J per m, each of shape (t,)."""
        return Columns(self._table("energy", "instants"))

    @property
    def steps(self) -> Columns:
        """Accepted steps: time, step, passes, contacts, penetration, travel, each of shape (t,)."""
        return Columns(self._table("steps", "steps"))

    def _check_sound(self, values: Floats, what: str, frames: Sequence[int]) -> None:
        """Raise CaseError where values (frames, ...) are no numbers, or cannot be squared."""
        sound = (np.abs(values) < LARGEST).reshape(len(values), -1).all(axis=1)
        if not sound.all():
            raise CaseError(
                f"is damaged: frame {frames[int(np.argmin(sound))]} has {what} that are no numbers",
                where=str(self.path),
                remedy=AGAIN,
            )

    def _table(self, place: str, counter: str) -> NDArray[Any]:
        # Until the run is finished only what belongs to whole frames is sure to be there.
        end = None if self.report else self.frame_rows[counter][-1]
        rows: NDArray[Any] = ask(self.path, lambda file: file[place][:end])
        return rows

    def __repr__(self) -> str:
        points = ", ".join(self.point_name[:4])
        return (
            f"Results('{self.title}', {len(self.block_name)} blocks, {len(self.times)} frames from "
            f"{self.times[0]:.6g} to {self.times[-1]:.6g} s\n"
            f"    in {self.path}; measured points: {points or 'none'})"
        )


def read_results(path: Path | str, *, whole: int = QUICKLY_CHECKED) -> Results:
    """Return what a result file holds, arrays being read when they are asked for.

    ``clast.read("out.vtkhdf")``; the file may be one that a run still writes, or that a killed run
    has left.  Raises CaseError where it is none of clast's, is damaged or cannot be read.

    Files of at most ``whole`` bytes are checked from end to end, others only where they are read.
    """
    path = Path(path)
    return ask(path, lambda file: _results(path, file), whole=whole)


def _results(path: Path, file: Any) -> Results:
    layout = check_ours(file)
    blocks, frames = structure.blocks_of(file), structure.frames_of(file)
    structure.check_arrays(file, frames, blocks)
    structure.check_grid(file, frames, blocks)
    points = structure.points_of(file, layout, frames["instants"][-1])
    about, prefix = file["model"].attrs, "version of "
    made = structure.about_of(file)
    return Results(
        path=path,
        layout=layout,
        title=str(about["title"]),
        case_text=structure.text(file, "model/case"),
        about=made,
        versions={
            key.removeprefix(prefix): str(number)
            for key, number in about.items()
            if key.startswith(prefix)
        },
        times=frames["time"],
        block_name=blocks.name,
        block_start=blocks.start,
        block_rock=blocks.rock,
        fixed=blocks.fixed,
        rock_name=blocks.rock_name,
        joints=structure.joints_of(file, blocks),
        bolt_lines=structure.bolts_of(file, frames),
        origin=np.asarray(about["origin"]),
        water=structure.water_of(file, blocks),
        point_name=points[0],
        point_start=points[1],
        report=structure.report_of(file),
        frame_stages=structure.stages_of(file, made.get("stages", ()), len(frames)),
        frame_rows=frames,
    )


def summary(results: Results) -> dict[str, Any]:
    """Return what ``clast info`` says of a result file; every value is ready for JSON."""
    report = results.report
    moved = np.hypot(*(results.vertices(-1) - results.vertices(0)).T)
    return {
        "file": str(results.path),
        "size_bytes": results.path.stat().st_size,
        "title": results.title,
        **main_parameters(results.about),
        "about": results.about,
        "version": results.versions.get("clast", "unknown"),
        "versions": results.versions,
        "finished": report.finished if report else False,
        "outcome": report.outcome if report else "the run did not end; its frames are kept",
        "frames": len(results.times),
        "time": [float(results.times[0]), float(results.times[-1])],
        "blocks": len(results.block_name),
        "fixed_blocks": int(results.fixed.sum()),
        "excavated_blocks": int(gone_in_frame(results, -1).sum()),
        "vertices": int(results.block_start[-1]),
        "rocks": list(results.rock_name),
        "joints": list(results.joints.name) if results.joints else [],
        "stages": list(results.about.get("stages", ())),
        "fields": list(results.field_names),
        "largest_displacement": float(moved.max()),
        "contacts": len(results.contacts(-1)),
        "bolts": _count_bolts(results),
        "measured_points": {name: _last_row(results, name) for name in results.point_name},
        "energy": {name: float(values[-1]) for name, values in results.energy.items()},
        "report": report.as_dict() if report else None,
    }


def _count_bolts(results: Results) -> dict[str, int]:
    """Return how many bolts are in which state at the end."""
    state = results.bolts(-1).state
    return {name: int(np.sum(state == k)) for k, name in enumerate(BOLT_STATES) if k in state}


def _last_row(results: Results, name: str) -> dict[str, Any]:
    history = results.history(name)
    return {
        "displacement": history.displacement[-1].tolist(),
        "velocity": history.velocity[-1].tolist(),
        "rotation": float(history.rotation[-1]),
    }


def stretches(dataset: Any, first: int, apart: int, shape: tuple[int, int]) -> NDArray[Any]:
    """Return rows of a dataset from ``first`` on, and as many again every ``apart`` rows.

    ``shape`` is how often and how many, that of the answer (times, rows, ...).  All are read in one
    go: one by one takes HDF5 a hundred times as long.
    """
    import h5py

    times, rows = shape
    tail = dataset.shape[1:]
    once = times if apart else min(times, 1)
    found = np.empty((once * rows, *tail), dataset.dtype)
    if found.size:
        space, zeros, ones = dataset.id.get_space(), (0,) * len(tail), (1,) * len(tail)
        count, stride = (once, *ones), (max(apart, rows), *ones)
        space.select_hyperslab((first, *zeros), count, stride, (rows, *tail))
        kind = h5py.h5t.py_create(found.dtype)
        dataset.id.read(h5py.h5s.create_simple(found.shape), space, found, kind)
    found = found.reshape(once, rows, *tail)
    return found if apart else np.repeat(found, times, axis=0)
