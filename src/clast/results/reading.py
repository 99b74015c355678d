"""Reads result files, those of a killed run included."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model import Bools, Floats, Ints
from clast.results import structure
from clast.results.layout import FORMAT, history_path
from clast.results.opening import AGAIN, ask, check_ours
from clast.results.run import PointHistory, Report, columns, unknown_name
from clast.results.tables import CONTACT_ROW, POINT_ROW

PLANE_VECTORS = ("displacement", "velocity")
"""Fields that VTK wants with a third component, which is zero."""
LARGEST = 1e150
"""No place and no force is that large."""
QUICKLY_CHECKED = 2**28
"""Size of a file that is checked from end to end in less than half a second, bytes."""


@dataclass(frozen=True, kw_only=True)
class FrameContacts:
    """The contacts of one frame that carry a force; m contacts."""

    position: Floats
    """Invading vertex, m, shape (m, 2)."""
    normal: Floats
    """Outward unit normal of the edge, shape (m, 2)."""
    normal_force: Floats
    """Normal force, N/m, compression positive, shape (m,)."""
    shear_force: Floats
    """Shear force on the vertex along the edge's direction, N/m, shape (m,)."""
    vertex: Ints
    """Invading vertex, shape (m,)."""
    edge: Ints
    """Entrance edge: index of its first vertex, shape (m,)."""
    mode: Ints
    """0 open, 1 slide, 2 lock, shape (m,)."""

    @property
    def force(self) -> Floats:
        """Force on the invading vertex's block, N/m, shape (m, 2)."""
        # Polygons run counter-clockwise: the edge's direction is its outward normal turned left.
        along = np.column_stack([-self.normal[:, 1], self.normal[:, 0]])
        forces: Floats = (
            self.normal_force[:, None] * self.normal + self.shear_force[:, None] * along
        )
        return forces

    def __len__(self) -> int:
        return len(self.vertex)


@dataclass(frozen=True, kw_only=True)
class Results:
    """What a result file holds.  Coordinates are the user's; arrays are read when asked for."""

    path: Path
    """The file."""
    title: str
    """Title of the case."""
    case_text: str
    """The case file as it was run."""
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
    layout: int = FORMAT
    """Version of the file's layout."""
    frame_rows: NDArray[Any] = field(repr=False)
    """Table of the frames: time, and the rows of the other tables until then."""

    def vertices(self, frame: int = -1) -> Floats:
        """Return the vertices of a frame, m, shape (nv, 2); frame -1 is the last."""
        count = int(self.block_start[-1])
        vertices: Floats = self._rows("VTKHDF/Points", frame, count)[:, :2]
        self._check_sound(vertices, "vertices", frame)
        return vertices

    def field(self, name: str, frame: int = -1) -> NDArray[Any]:
        """Return a field of the blocks, shape (n,), (n, 2) or (n, 3); see ``field_names``."""
        if name not in self.field_names:
            raise unknown_name("field", name, self.field_names)
        count = len(self.block_rock)
        if name in ("block", "rock", "fixed"):
            return self._rows(f"VTKHDF/CellData/{name}", 0, count)
        values = self._rows(f"VTKHDF/CellData/{name}", frame, count)
        return values[:, :2] if name in PLANE_VECTORS else values

    @cached_property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        return ask(self.path, lambda file: tuple(file["VTKHDF/CellData"]))

    def contacts(self, frame: int = -1) -> FrameContacts:
        """Return the contacts of a frame."""
        index = self.frame_index(frame)
        ends = self.frame_rows["contacts"]
        first = ends[index - 1] if index else 0
        rows = ask(self.path, lambda file: file["contacts"][first : ends[index]])
        found = FrameContacts(**{name: rows[name] for name in CONTACT_ROW.names or ()})
        with np.errstate(over="ignore", invalid="ignore"):
            self._check_sound(found.force, "contact forces", frame)
        self._check_sound(found.position, "contacts", frame)
        return found

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``."""
        if name not in self.point_name:
            raise unknown_name("measured point", name, self.point_name)
        rows = self._table(history_path(name, self.layout), "instants")
        return PointHistory(**{name: rows[name] for name in POINT_ROW.names or ()})

    @property
    def energy(self) -> dict[str, Floats]:
        """Energy ledger over time: ``time``, s, and every entry, J per m, each of shape (t,)."""
        return columns(self._table("energy", "instants"))

    @property
    def steps(self) -> dict[str, NDArray[Any]]:
        """Accepted steps: time, step, passes, contacts, penetration, travel, each of shape (t,)."""
        return columns(self._table("steps", "steps"))

    def frame_index(self, frame: int) -> int:
        """Return a frame's number counted from 0; negative ones count from the end."""
        count = len(self.times)
        if not -count <= frame < count:
            raise CaseError(
                f"there is no frame {frame}",
                where=str(self.path),
                remedy=f"the file has {count} frames: 0 to {count - 1}, or -1 for the last",
            )
        return frame % count

    def _check_sound(self, values: Floats, what: str, frame: int) -> None:
        """Raise CaseError where values are no numbers, or none that can be squared."""
        if not (np.abs(values) < LARGEST).all():
            raise CaseError(
                f"is damaged: frame {self.frame_index(frame)} has {what} that are no numbers",
                where=str(self.path),
                remedy=AGAIN,
            )

    def _rows(self, place: str, frame: int, count: int) -> NDArray[Any]:
        first = self.frame_index(frame) * count
        rows: NDArray[Any] = ask(self.path, lambda file: file[place][first : first + count])
        return rows

    def _table(self, place: str, counter: str) -> NDArray[Any]:
        # Until the run is finished only what belongs to whole frames is sure to be there.
        end = None if self.report else self.frame_rows[counter][-1]
        rows: NDArray[Any] = ask(self.path, lambda file: file[place][:end])
        return rows


def read_results(path: Path | str, *, whole: int = QUICKLY_CHECKED) -> Results:
    """Open a result file; raises CaseError where it is none, is damaged or cannot be read.

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
    return Results(
        path=path,
        layout=layout,
        title=str(about["title"]),
        case_text=structure.text(file, "model/case"),
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
        point_name=points[0],
        point_start=points[1],
        report=structure.report_of(file),
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
        "versions": results.versions,
        "finished": report.finished if report else False,
        "outcome": report.outcome if report else "the run did not end; its frames are kept",
        "frames": len(results.times),
        "time": [float(results.times[0]), float(results.times[-1])],
        "blocks": len(results.block_name),
        "fixed_blocks": int(results.fixed.sum()),
        "vertices": int(results.block_start[-1]),
        "rocks": list(results.rock_name),
        "fields": list(results.field_names),
        "largest_displacement": float(moved.max()),
        "contacts": len(results.contacts(-1)),
        "measured_points": {name: _last_row(results, name) for name in results.point_name},
        "energy": {name: float(values[-1]) for name, values in results.energy.items()},
        "report": report.as_dict() if report else None,
    }


def _last_row(results: Results, name: str) -> dict[str, Any]:
    history = results.history(name)
    return {
        "displacement": history.displacement[-1].tolist(),
        "velocity": history.velocity[-1].tolist(),
        "rotation": float(history.rotation[-1]),
    }
