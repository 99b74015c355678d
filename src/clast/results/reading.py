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
from clast.results.about import about_in, asked_most
from clast.results.columns import BlockHistory, Columns, FrameContacts, PointHistory
from clast.results.journal import complete_journal
from clast.results.layout import FORMAT, PLANE_VECTORS, history_path
from clast.results.recorded import (
    KIND_FIELDS,
    VERTICES,
    Frame,
    block_of,
    contacts_of,
    field_of,
    frame_of,
    unknown_name,
)
from clast.results.run import Report, report_from_dict


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
    frame_rows: NDArray[Any] = field(repr=False)
    """Table of the frames: time, and the rows of the other tables until then."""

    @property
    def name(self) -> str:
        """Name of the file."""
        return self.path.name

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

    def frame(self, number: int = -1, *, at: float | None = None) -> Frame:
        """Return a frame by its number, or the one nearest to the time ``at``, s.

        Raises CaseError for a number or a time that lies outside of the run.
        """
        return frame_of(self, number, at)

    def block(self, name: str) -> BlockHistory:
        """Return how the block ``name`` moved, a row per frame, as a table.

        Raises CaseError for a block that does not exist.
        """
        return block_of(self, name, self.block_name)

    @cached_property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        with _opened(self.path) as file:
            return tuple(file["VTKHDF/CellData"])

    def series(self, name: str, frames: range, first: int, past: int) -> NDArray[Any]:
        """Return rows ``first`` to ``past`` - 1 of a field in some frames, (frames, rows, ...)."""
        fixed = name in KIND_FIELDS
        count = int(self.block_start[-1]) if name == VERTICES else len(self.block_rock)
        place = "VTKHDF/Points" if name == VERTICES else f"VTKHDF/CellData/{name}"
        with _opened(self.path) as file:
            rows = file[place]
            starts = [0 if fixed else frame * count for frame in frames]
            values = np.stack([rows[start + first : start + past] for start in starts])
        return values[:, :, :2] if name in (*PLANE_VECTORS, VERTICES) else values

    def contact_rows(self, frame: int) -> NDArray[Any]:
        """Return a row for every contact of a frame that carries a force."""
        ends = self.frame_rows["contacts"]
        first = ends[frame - 1] if frame else 0
        with _opened(self.path) as file:
            return file["contacts"][first : ends[frame]]

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``, a row per instant, as a table.

        Raises CaseError for a point that does not exist.
        """
        if name not in self.point_name:
            raise unknown_name("measured point", name, self.point_name)
        return PointHistory(self._table(history_path(name), "instants"))

    @property
    def energy(self) -> Columns:
        """Energy ledger over time: ``time``, s, and every entry, J per m, each of shape (t,)."""
        return Columns(self._table("energy", "instants"))

    @property
    def steps(self) -> Columns:
        """Accepted steps: time, step, passes, contacts, penetration, travel, each of shape (t,)."""
        return Columns(self._table("steps", "steps"))

    def _table(self, place: str, counter: str) -> NDArray[Any]:
        with _opened(self.path) as file:
            # Until the run is finished only what belongs to whole frames is sure to be there.
            end = None if self.report else self.frame_rows[counter][-1]
            return file[place][:end]

    def __repr__(self) -> str:
        points = ", ".join(self.point_name[:4])
        return (
            f"Results('{self.title}', {len(self.block_name)} blocks, {len(self.times)} frames from "
            f"{self.times[0]:.6g} to {self.times[-1]:.6g} s\n"
            f"    in {self.path}; measured points: {points or 'none'})"
        )


def read_results(path: Path | str) -> Results:
    """Return what a result file holds, arrays being read when they are asked for.

    ``clast.read("out.vtkhdf")``; the file may be one that a run still writes, or that a killed run
    has left.  Raises CaseError where it is none of clast's or cannot be read.
    """
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
            about=about_in(model["about"].asstr()[()]) if "about" in model else {},
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
        **asked_most(results.about),
        "about": results.about,
        "version": results.versions.get("clast", "unknown"),
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
