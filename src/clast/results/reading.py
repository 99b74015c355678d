"""Reads result files, those of a killed run included."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model import Bools, Floats, Ints
from clast.results.journal import complete_journal
from clast.results.layout import FORMAT, history_path
from clast.results.run import (
    PointHistory,
    Report,
    columns,
    report_from_dict,
    unknown_name,
)

PLANE_VECTORS = ("displacement", "velocity")
"""Fields that VTK wants with a third component, which is zero."""


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
    frame_rows: NDArray[Any] = field(repr=False)
    """Table of the frames: time, and the rows of the other tables until then."""

    def vertices(self, frame: int = -1) -> Floats:
        """Return the vertices of a frame, m, shape (nv, 2); frame -1 is the last."""
        count = int(self.block_start[-1])
        return self._rows("VTKHDF/Points", frame, count)[:, :2]

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
        with _opened(self.path) as file:
            return tuple(file["VTKHDF/CellData"])

    def contacts(self, frame: int = -1) -> FrameContacts:
        """Return the contacts of a frame."""
        index = self.frame_index(frame)
        ends = self.frame_rows["contacts"]
        first = ends[index - 1] if index else 0
        with _opened(self.path) as file:
            rows = file["contacts"][first : ends[index]]
        return FrameContacts(**columns(rows))

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``."""
        if name not in self.point_name:
            raise unknown_name("measured point", name, self.point_name)
        return PointHistory(**columns(self._table(history_path(name), "instants")))

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

    def _rows(self, place: str, frame: int, count: int) -> NDArray[Any]:
        first = self.frame_index(frame) * count
        with _opened(self.path) as file:
            return file[place][first : first + count]

    def _table(self, place: str, counter: str) -> NDArray[Any]:
        with _opened(self.path) as file:
            # Until the run is finished only what belongs to whole frames is sure to be there.
            end = None if self.report else self.frame_rows[counter][-1]
            return file[place][:end]


def read_results(path: Path | str) -> Results:
    """Open a result file; raises CaseError where it is none or cannot be read."""
    path = Path(path)
    with _opened(path) as file:
        _check_ours(path, file)
        model = file["model"]
        frames = file["frames"][: int(file["VTKHDF/Steps"].attrs["NSteps"])]
        text = file["report/json"].asstr()[()] if "report/json" in file else ""
        prefix = "version of "
        return Results(
            path=path,
            title=str(model.attrs["title"]),
            case_text=model["case"].asstr()[()],
            versions={
                key.removeprefix(prefix): str(number)
                for key, number in model.attrs.items()
                if key.startswith(prefix)
            },
            times=frames["time"],
            block_name=_names(model["block_name"]),
            block_start=model["block_start"][:],
            block_rock=model["block_rock"][:],
            fixed=model["fixed"][:],
            rock_name=_names(model["rock_name"]),
            point_name=_names(model["point_name"]),
            point_start=model["point_start"][:],
            report=report_from_dict(json.loads(text)) if text else None,
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


def _names(dataset: Any) -> tuple[str, ...]:
    return tuple(dataset.asstr()[:])


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open a result file for reading; what goes wrong becomes a CaseError."""
    import h5py

    where = str(path)
    if path.is_dir():
        raise CaseError("is a directory, not a result file", where=where)
    if not path.exists():
        raise CaseError(
            "there is no such file", where=where, remedy="clast run CASE -o FILE writes one"
        )
    try:
        complete_journal(path)
        # Viewers and a run that still writes may have the file open: no lock is asked for.
        with h5py.File(path, "r", locking=False) as file:
            yield file
    except PermissionError as error:
        raise CaseError("may not be read", where=where, remedy="ask for permission") from error
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        raise CaseError(
            "is no result file of clast, or is damaged",
            where=where,
            remedy="run the case again to make a new one",
        ) from error


def _check_ours(path: Path, file: Any) -> None:
    if "VTKHDF" not in file or "model" not in file or "format" not in file["model"].attrs:
        raise CaseError(
            "is an HDF5 file, but no result file of clast",
            where=str(path),
            remedy="name a file that clast run has written",
        )
    written = int(file["model"].attrs["format"])
    if written > FORMAT:
        raise CaseError(
            f"was written by a newer clast (layout {written}, this one knows {FORMAT})",
            where=str(path),
            remedy="update clast",
        )
