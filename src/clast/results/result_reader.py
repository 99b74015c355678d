"""Reads result files, those of a killed run included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model.model import Floats
from clast.model.surcharge import Surcharge
from clast.results import validate
from clast.results.frames import VERTICES, FrameStore, absent_in_frame
from clast.results.open_file import AGAIN, QUICKLY_CHECKED, ask, check_ours
from clast.results.recording import Recording
from clast.results.run_report import main_parameters
from clast.results.schema import (
    BOLT_POINTS,
    BOLT_STATES,
    CHANNELS,
    CONTACTS,
    KIND_FIELDS,
    LINK_STATES,
    PLANE_VECTORS,
    TableSchema,
)
from clast.results.water_record import waters_in

VALUE_MAX = 1e150
"""No place and no force is that large."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Results(Recording):
    """The content of a result file.  Coordinates are the user's; arrays are read when asked for."""

    path: Path
    case_text: str
    about: dict[str, Any]
    """Process, contact law, rocks and their numbers, as clast info prints them."""
    versions: dict[str, str]
    """Version of clast and of the libraries it uses."""
    frame_stages: tuple[str, ...] = ()
    """Name of the stage of each frame; empty where the run has no stages."""
    frame_rows: NDArray[Any] = field(repr=False)
    """Table of the frames: time, and the rows of the other tables until then."""

    @property
    def file(self) -> Path:
        """The result file."""
        return self.path

    @property
    def version(self) -> str:
        """Version of the clast that made the run."""
        return self.versions.get("clast", "unknown")

    @property
    def _frames(self) -> FrameStore:
        return self

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
        for column in CONTACTS.columns:
            if column.checked:
                self._check_sound(rows[column.name][None], column.checked, [frame])
        if ((rows["joint"] < 0) | (rows["joint"] >= len(self.joint_name))).any():
            raise self._damaged(f"frame {frame} has contacts along joints that do not exist")
        return rows

    def beside(self, name: str, frame: int) -> Floats:
        """Return an array of a frame beside those of blocks (``schema.BESIDE``)."""
        count = {BOLT_POINTS: len(self.bolt_of_point), CHANNELS: len(self.channels.edge)}[name]
        rows = slice(frame * count, (frame + 1) * count)
        values: Floats = ask(self.path, lambda file: file[name][rows])
        self._check_sound(values[None], name.partition("_")[0].rstrip("s") + "s", [frame])
        return values

    def _damaged(self, fault: str) -> CaseError:
        return CaseError(f"is damaged: {fault}", where=str(self.path), remedy=AGAIN)

    def _check_sound(self, values: Floats, what: str, frames: Sequence[int]) -> None:
        """Raise CaseError where values (frames, ...) are not numbers, or cannot be squared."""
        sound = (np.abs(values) < VALUE_MAX).reshape(len(values), -1).all(axis=1)
        if not sound.all():
            frame = frames[int(np.argmin(sound))]
            raise self._damaged(f"frame {frame} has {what} that are not numbers")

    def _rows(self, table: TableSchema, index: int | None = None) -> NDArray[Any]:
        # Until the run is finished only what belongs to whole frames is sure to be there.
        end = None if self.report else self.frame_rows[table.counter][-1]
        place = table.places(self.names_of(table))[index if index and table.apart else 0]
        rows: NDArray[Any] = ask(self.path, lambda file: file[place][:end])
        self._check_rows(table, rows)
        return rows if index is None or table.apart else table.one(rows, index)

    def _check_rows(self, table: TableSchema, rows: NDArray[Any]) -> None:
        """Raise CaseError where a table has NaN where none may be, or states without names."""
        for column in table.timed:
            values = rows[column.name]
            what = "" if column.may_be_nan or np.isfinite(values).all() else "are not numbers"
            if column.words and ((values < 0) | (values >= len(column.words))).any():
                what = "do not exist"
            if what:
                raise self._damaged(f"/{table.name} has values of '{column.name}' that {what}")

    def __repr__(self) -> str:
        points = ", ".join(self.point_name[:4])
        return (
            f"Results('{self.title}', {len(self.block_name)} blocks, {len(self.times)} frames from "
            f"{self.times[0]:.6g} to {self.times[-1]:.6g} s\n"
            f"    in {self.path}; measured points: {points or 'none'})"
        )


def read_results(path: Path | str, *, whole: int = QUICKLY_CHECKED) -> Results:
    """Return the content of a result file, arrays being read when they are asked for.

    ``clast.read("out.vtkhdf")``; the file may be one that a run still writes, or that a killed run
    has left.  Raises CaseError where it is none of clast's, is damaged or cannot be read.

    Files of at most ``whole`` bytes are checked from end to end, others only where they are read.
    """
    path = Path(path)
    return ask(path, lambda file: _results(path, file), whole=whole)


def _results(path: Path, file: Any) -> Results:
    check_ours(file)
    frames = validate.frames_of(file)
    parts = validate.parts_of_model(file, len(frames))
    validate.check_data(file, frames, parts)
    about, prefix = file["model"].attrs, "version of "
    made = validate.about_of(file)
    return Results(
        path=path,
        title=str(about["title"]),
        case_text=validate.text(file, "model/case"),
        about=made,
        begins=made.get("begins", {}),
        versions={
            key.removeprefix(prefix): str(number)
            for key, number in about.items()
            if key.startswith(prefix)
        },
        times=frames["time"],
        **parts,
        origin=np.asarray(about["origin"]),
        gravity=np.asarray(about["gravity"]),
        water=waters_in(file["model"], int(parts["block_start"][-1])),
        surcharge=Surcharge.of_plain(made.get("surcharge")),
        report=validate.report_of(file),
        frame_stages=validate.stages_of(file, made.get("stages", ()), len(frames)),
        frame_rows=frames,
    )


FLOW_KEYS = ("into_rock", "out_of_rock", "runoff", "pressure")
"""Columns of flows that a summary has."""


def summary(results: Results) -> dict[str, Any]:
    """Return the summary of a result file for ``clast info``; every value is ready for JSON."""
    report = results.report
    moved = np.hypot(*(results.vertices(-1) - results.vertices(0)).T)
    return {
        "file": str(results.path),
        "size_bytes": results.path.stat().st_size,
        "title": results.title,
        **main_parameters(results.about),
        "about": results.about,
        "version": results.version,
        "versions": results.versions,
        "finished": report.finished if report else False,
        "outcome": report.outcome if report else "the run did not end; its frames are kept",
        "frames": len(results.times),
        "time": [float(results.times[0]), float(results.times[-1])],
        "blocks": len(results.block_name),
        "fixed_blocks": int(results.fixed.sum()),
        "excavated_blocks": int((absent_in_frame(results, -1) & ~results.awaited(-1)).sum()),
        "vertices": int(results.block_start[-1]),
        "rocks": list(results.rock_name),
        "joints": list(results.joint_name),
        "stages": list(results.about.get("stages", ())),
        "fields": list(results.field_names),
        "largest_displacement": float(moved.max()),
        "contacts": len(results.contacts(-1)),
        "bolts": _states(results.bolts(-1).state, BOLT_STATES),
        "linings": {name: _extremes(results, name) for name in results.lining_name},
        "links": _states(
            [results.link(name)["state"][-1] for name in results.link_name], LINK_STATES
        ),
        "measured_points": {
            name: {
                "displacement": history.displacement[-1].tolist(),
                "velocity": history.velocity[-1].tolist(),
                "rotation": float(history.rotation[-1]),
            }
            for name, history in zip(
                results.point_name, map(results.history, results.point_name), strict=True
            )
        },
        "convergences": {
            name: {
                "convergence": float(results.convergence(name).convergence[-1]),
                "distance": float(np.hypot(*np.diff(results.point_start[pair], axis=0)[0])),
            }
            for name, pair in zip(results.convergence_name, results.convergence_points, strict=True)
        },
        "flows": {
            name: {key: float(results.inflow(name)[key][-1]) for key in FLOW_KEYS}
            for name in results.flow_name
        },
        "reactions": {
            name: {
                "force": results.reaction(name).force[-1].tolist(),
                "moment": float(results.reaction(name).moment[-1]),
            }
            for name in results.reaction_name
        },
        "energy": {name: float(values[-1]) for name, values in results.energy.items()},
        "report": report.as_dict() if report else None,
    }


def _extremes(results: Results, name: str) -> dict[str, float | None]:
    """Return the extremes along a lining at the end, in N/m and N, None without strengths."""
    lining = results.lining(name)
    extremes: dict[str, float | None] = {
        f"{which}_{column}": float(extreme(getattr(lining, column)[-1]))
        for column in ("normal_force", "shear_force", "moment")
        for which, extreme in (("least", np.min), ("largest", np.max))
    }
    used = lining.utilisation[-1]
    return {**extremes, "utilisation": None if np.isnan(used).all() else float(np.nanmax(used))}


def _states(state: Any, words: Sequence[str]) -> dict[str, int]:
    counts = np.bincount(np.asarray(state, np.int64), minlength=len(words))
    return {name: int(n) for name, n in zip(words, counts, strict=True) if n}


def stretches(dataset: Any, first: int, apart: int, shape: tuple[int, int]) -> NDArray[Any]:
    """Return rows of a dataset from ``first`` on, and as many again every ``apart`` rows.

    ``shape`` is how often and how many, that of the answer (times, rows, ...).  All are read in one
    go: one by one takes HDF5 a hundred times as long.
    """
    import h5py

    times, rows = shape
    tail = dataset.shape[1:]
    once = times if apart else min(times, 1)
    values = np.empty((once * rows, *tail), dataset.dtype)
    if values.size:
        space, zeros, ones = dataset.id.get_space(), (0,) * len(tail), (1,) * len(tail)
        count, stride = (once, *ones), (max(apart, rows), *ones)
        space.select_hyperslab((first, *zeros), count, stride, (rows, *tail))
        kind = h5py.h5t.py_create(values.dtype)
        dataset.id.read(h5py.h5s.create_simple(values.shape), space, values, kind)
    values = values.reshape(once, rows, *tail)
    return values if apart else np.repeat(values, times, axis=0)
