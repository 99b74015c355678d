"""Writes the result file while the run goes: a temporal VTKHDF file and tables beside it."""

from __future__ import annotations

import json
import math
import os
import platform
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

from clast.errors import CaseError, ResultsLost
from clast.model.model import Floats, Ints, Model
from clast.results.checkpoints.checkpoint import Recorded, extended, read_lineage, write_lineage
from clast.results.checkpoints.reopen import check_fit, lengths_after, rows_after
from clast.results.journal import JournalledFile
from clast.results.output import check_output, claimed, hidden, taken_up
from clast.results.result_tables import GrowingTable
from clast.results.run_report import Report, about_model, version_of
from clast.results.schema import (
    BESIDE,
    BOLT_POINTS,
    CHANNELS,
    CHUNK_BYTES,
    CHUNK_ROWS,
    ENERGY,
    FIELDS,
    FORMAT,
    FRAME_ROW,
    FRAME_STAGE,
    KIND_FIELDS,
    MODEL,
    MOVING,
    MOVING_FIELDS,
    OVER_TIME,
    POLYGON,
    TABLES,
    VTKHDF_VERSION,
    Per,
    TableSchema,
)
from clast.results.water_record import write_water

# Newer formats mark a file as being written, and nothing opens it after the process was killed.
FILE_FORMAT = ("v108", "v108")
# What a kill cuts in two it cuts at a page: headers that change, 268 to 374 bytes, lie within one.
IN_ONE_PAGE = {"alignment_threshold": 128, "alignment_interval": 512}
PACKED: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
LARGE = 64
"""Rows that get a chunk for themselves: of a frame, or of an array of the model."""
CHECKED = {"fletcher32": True}


class ResultFile:
    """The result file of one run, taken for it from the beginning.

    The first frame is written beside ``path`` and then takes its name, so that an earlier result
    is there until a new one is.  Viewers may read along.  The frames after it take effect one by
    one, whole or not at all, through a journal.
    """

    def __init__(
        self, path: Path, model: Model, case_text: str, storage: JournalledFile | None = None
    ) -> None:
        # Raise CaseError where a title or name has characters that no text of HDF5 can hold.
        texts = [model.title, *model.block_name, *model.measured_points.name]
        texts += [*model.bolts.name, *model.bolts.kind, *model.reactions.name, *model.links]
        texts += [*model.lining_joints.name, *model.convergences.name]
        rocks, joints = model.rocks, model.joint_table.joints
        texts += [*(rock.name for rock in rocks), *(joint.name for joint in joints)]
        for text in texts:
            if "\0" in text or text.encode(errors="replace").decode() != text:
                raise CaseError(
                    f"{text!r} contains a character that a result file cannot store",
                    remedy="give it another title or name",
                )
        self.path = check_output(path)
        self._model = model
        self._case_text = case_text
        self.about: Mapping[str, Any] = {}
        """How the run is simulated (results.provenance), to be set before the first frame."""
        self._storage = storage or JournalledFile(claimed(self.path))
        self.stage = 0
        """Number of the stage of the next frame, where ``about`` has stages."""
        self._file: Any = None
        self._columns: dict[str, _Column] = {}
        self._frames = 0
        self._saved = {one.name: 0 for one in OVER_TIME}
        self._contacts = 0
        self.lineage = extended((), 0)
        """Which runs have written the file; the last is this one."""
        weakref.finalize(self, _let_go, self._storage, hidden(self.path))

    def frame(
        self,
        time: float,
        arrays: Mapping[str, Floats],
        contacts: NDArray[Any],
        tables: Mapping[str, GrowingTable],
        beside: Mapping[str, Floats],
    ) -> None:
        """Add a frame: arrays by place in /VTKHDF, contacts, and the new rows of the tables.

        ``beside`` are arrays by their names (``schema.BESIDE``).
        """
        if self._frames:
            with self._guarded():
                self._put_frame(time, arrays, contacts, tables, beside)
            return
        try:
            with self._guarded("make room, or choose another place"):
                self._open(h5py.File(self._storage, "w", libver=FILE_FORMAT, **IN_ONE_PAGE))
                file = self._file
                model = self._model
                _write_grid(file.create_group("VTKHDF"), model)
                _write_model(file.create_group("model"), model, self._case_text, self.about)
                _growing(file, "frames", dtype=FRAME_ROW)
                if self.about.get("stages"):
                    _growing(file, FRAME_STAGE, dtype="i8")
                for one in TABLES:
                    name = {"bolts": BOLT_POINTS, "flow": CHANNELS}.get(one.name, "")
                    width, rows = BESIDE.get(name, (0, lambda _: 0))
                    if rows(model):
                        _growing(file, name, (width,), batch=rows(model))
                    if one.is_kept(model):
                        _write_table(file, one, model)
                write_lineage(self._file, self.lineage)
                self._put_frame(time, arrays, contacts, tables, beside)
                self._file.close()
                self._storage.commit()
                os.replace(hidden(self.path), self.path)
                self._open(h5py.File(self._storage, "r+", libver=FILE_FORMAT))
        except BaseException:
            self._file.close()
            _let_go(self._storage, hidden(self.path))
            raise

    def go_on(self, recorded: Recorded) -> tuple[Floats, dict[str, NDArray[Any]]]:
        """Cut an earlier run's file back to the frames of a checkpoint, and go on from them.

        Returns the times of these frames, s, and the rows of each table until the last of them.
        """
        with self._guarded():
            self._open(h5py.File(self._storage, "r+", libver=FILE_FORMAT))
            self._frames, self._contacts = recorded.frames, int(recorded.frame["contacts"][0])
            self._saved = rows_after(recorded.frame, self._model)
            # Take all that came after its first ``self._frames`` frames out of an open result file.
            file = self._file
            # In the order in which a frame is taken back: for a viewer it goes first.
            file["VTKHDF/Steps"].attrs.modify("NSteps", np.int64(self._frames))
            for name, length in lengths_after(self._model, self._frames, recorded.frame).items():
                if name in file:
                    file[name].resize(min(length, len(file[name])), axis=0)
            if "report" in file:
                del file["report"]
            first = self._frames // CHUNK_ROWS * CHUNK_ROWS
            self._put_offsets(first)
            write_source(self._file["model"], self._model, self._case_text, self.about)
            self.lineage = extended(read_lineage(self._file), self._frames)
            write_lineage(self._file, self.lineage)
            self._file.flush()
            self._storage.commit()
            times: Floats = self._file["frames"]["time"]
            return times, self._read_tables()

    def sync(self) -> None:
        """Have all frames written to the disk itself."""
        with self._guarded():
            self._storage.sync()

    def finish(self, report: Report, tables: Mapping[str, GrowingTable]) -> None:
        """Write the remaining rows and the report, and close the file."""
        with self._guarded():
            self._put_tables(self._new_rows(tables))
            for name in _step_offsets(self._model, np.zeros(0, np.int64)):
                self._column(f"VTKHDF/Steps/{name}").end_at(self._frames)
            group = self._file.create_group("report")
            plain = report.as_dict()
            group["json"] = json.dumps(plain, ensure_ascii=False, default=float)
            for name, value in plain.items():
                if isinstance(value, bool | int | float | str):
                    group.attrs[name] = value
            self._file.close()
            self._storage.commit()
            self._storage.close()

    def _open(self, file: Any) -> None:
        self._file = file
        self._columns.clear()
        # HDF5 must not be left to close it when Python, which it writes through, is gone.
        weakref.finalize(self, file.close)

    def _column(self, name: str) -> _Column:
        if name not in self._columns:
            self._columns[name] = _Column(self._file[name])
        return self._columns[name]

    @contextmanager
    def _guarded(self, remedy: str = "make room; frames written before are kept") -> Iterator[None]:
        """Turn errors of HDF5 and of the disk into one that a user can act on."""
        try:
            yield
        except (OSError, RuntimeError, ValueError) as error:
            number = getattr(error, "errno", None)
            raise ResultsLost(
                f"the results cannot be written: {os.strerror(number) if number else error}",
                where=str(self.path),
                remedy=remedy,
            ) from error

    def _put_frame(
        self,
        time: float,
        arrays: Mapping[str, Floats],
        contacts: NDArray[Any],
        tables: Mapping[str, GrowingTable],
        beside: Mapping[str, Floats],
    ) -> None:
        """Put a frame behind the last one that was completed; it may be tried again."""
        number, contact_end = self._frames, self._contacts + len(contacts)
        new = self._new_rows(tables)
        for name, rows in arrays.items():
            self._column(f"VTKHDF/{name}").put(number * len(rows), rows)
        if number % CHUNK_ROWS == 0:
            self._put_offsets(number)
        self._column("contacts").put(self._contacts, contacts)
        for name, values in beside.items():
            if len(values):
                self._column(name).put(number * len(values), values)
        self._put_tables(new)
        ends = (time, len(tables["steps"]), len(tables["energy"]), contact_end)
        self._column("frames").put(number, np.array([ends], FRAME_ROW))
        if self.about.get("stages"):
            self._column(FRAME_STAGE).put(number, np.array([self.stage]))
        # Viewers read along: for them a frame counts when all of it is in the file.
        self._file.flush()
        self._file["VTKHDF/Steps"].attrs.modify("NSteps", np.int64(number + 1))
        self._file.flush()
        # Last of all, for VTK 9.7 crashes on more values than NSteps; one too few reads as 0.
        self._column("VTKHDF/Steps/Values").put(number, np.array([time]))
        self._file.flush()
        self._storage.commit()
        self._frames, self._contacts = number + 1, contact_end
        self._saved = {name: len(table) for name, table in tables.items()}

    def _put_offsets(self, number: int) -> None:
        """Put the offsets of a chunk of frames, which are known beforehand, from ``number`` on."""
        frames = np.arange(number, number + CHUNK_ROWS)
        for name, offsets in _step_offsets(self._model, frames).items():
            self._column(f"VTKHDF/Steps/{name}").put(number, offsets)

    def _new_rows(self, tables: Mapping[str, GrowingTable]) -> dict[str, NDArray[Any]]:
        """Return the rows of each table that came after the last frame."""
        return {name: table.since(self._saved[name]) for name, table in tables.items()}

    def _read_tables(self) -> dict[str, NDArray[Any]]:
        """Return all rows of each table: those that ``_put_tables`` has put there."""
        tables = {}
        for one in OVER_TIME:
            rows = one.rows(one.count(self._model))
            if one.apart and one.of:
                time = self._file[ENERGY.name]["time"]
                tables[one.name] = np.zeros(len(time), rows)
                tables[one.name]["time"] = time
                for index, place in enumerate(one.places(one.of.names(self._model))):
                    one.put_one(tables[one.name], index, self._file[place][()])
            else:
                kept = one.is_kept(self._model)
                tables[one.name] = self._file[one.name][()] if kept else np.zeros(0, rows)
        return tables

    def _put_tables(self, new: Mapping[str, NDArray[Any]]) -> None:
        for one in OVER_TIME:
            if not one.is_kept(self._model):
                continue
            first, rows = self._saved[one.name], new[one.name]
            for index, place in enumerate(one.places(one.of.names(self._model) if one.of else ())):
                self._column(place).put(first, one.one(rows, index) if one.apart else rows)


def reopened(path: Path, model: Model, recorded: Recorded) -> JournalledFile:
    """Return the result file that a checkpoint goes on from, taken for the run.

    Raises CaseError where it is missing, in use, or does not fit the checkpoint.
    """
    check_fit(path, model, recorded)
    file = taken_up(check_output(path))
    try:
        check_fit(path, model, recorded)  # nobody else changes it from here on
        return JournalledFile.again(file)
    except BaseException:
        file.close()
        raise


class _Column:
    """A dataset that grows, written at h5py's low level: a fifth of the high level's time."""

    def __init__(self, dataset: Any) -> None:
        self._id = dataset.id
        self.length, *self._tail = dataset.shape
        self._type = h5py.h5t.py_create(dataset.dtype, logical=True)
        self._dtype = dataset.dtype

    def put(self, first: int, rows: NDArray[Any]) -> None:
        """Write rows from row ``first`` on; the dataset grows as far as needed."""
        if len(rows) == 0:
            return
        rows = np.ascontiguousarray(rows, self._dtype)
        shape, end = (len(rows), *self._tail), first + len(rows)
        if end > self.length:
            self._id.set_extent((end, *self._tail))
            self.length = end
        place = self._id.get_space()
        place.select_hyperslab((first, *(0 for _ in self._tail)), shape)
        self._id.write(h5py.h5s.create_simple(shape), place, rows, self._type)

    def end_at(self, length: int) -> None:
        """Leave out all rows behind ``length``."""
        self._id.set_extent((length, *self._tail))
        self.length = length


def _let_go(storage: JournalledFile, part: Path) -> None:
    """Close the file as it was when changes last took effect, and remove it if they never did."""
    if storage.is_at(part):
        part.unlink()
    storage.close()


def _step_offsets(model: Model, frames: Ints) -> dict[str, NDArray[Any]]:
    """Return the entries of some ``frames`` in each dataset of offsets in /VTKHDF/Steps.

    Every frame is one part, part 0, with the same connectivity and with points and fields of its
    own.
    """
    return {
        "NumberOfParts": np.ones_like(frames),
        "PartOffsets": np.zeros_like(frames),
        "CellOffsets": np.zeros_like(frames)[:, None],
        "PointOffsets": frames * len(model.vertices),
        MOVING: frames * model.block_count,
    }


def _write_table(file: Any, one: TableSchema, model: Model) -> None:
    if one.of is None:
        batch = min(CHUNK_ROWS, max(LARGE, 8 * model.block_count)) if one.per is Per.FRAME else 1
        _growing(file, one.name, dtype=one.row, batch=batch)
    elif one.apart:
        for place in one.places(one.of.names(model)):
            _growing(file, place, dtype=one.row)
    else:
        row = one.rows(one.count(model))
        # a chunk holds as many bytes as one of the other tables, not as many rows
        rows = int(np.clip(CHUNK_ROWS * ENERGY.row.itemsize // row.itemsize, 1, CHUNK_ROWS))
        file.create_dataset(
            one.name, shape=(0,), maxshape=(None,), chunks=(rows,), dtype=row, **CHECKED
        )


def _write_grid(grid: Any, model: Model) -> None:
    """Write the polygons, which never change, and make room for changing values."""
    vertices, blocks = len(model.vertices), model.block_count
    grid.attrs["Version"] = np.array(VTKHDF_VERSION)
    # The reader wants a string of fixed length here.
    grid.attrs["Type"] = np.bytes_("UnstructuredGrid")
    grid["NumberOfPoints"] = np.array([vertices])
    grid["NumberOfCells"] = np.array([blocks])
    grid["NumberOfConnectivityIds"] = np.array([vertices])
    _fixed(grid, "Connectivity", np.arange(vertices))
    _fixed(grid, "Offsets", model.block_start)
    _fixed(grid, "Types", np.full(blocks, POLYGON, np.uint8))
    for one in MOVING_FIELDS:
        _growing(grid, one.place, one.shape, batch=blocks if one.of_blocks else vertices)
    _fixed(grid, "CellData/block", np.arange(blocks))
    _fixed(grid, "CellData/rock", model.block_rock)
    _fixed(grid, "CellData/fixed", (model.fixed & ~model.lined).astype(np.uint8))
    for one in FIELDS:
        grid[one.place].attrs["about"] = one.about
    steps = grid.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(0)
    _growing(steps, "Values")
    for name, entry in _step_offsets(model, np.zeros(0, np.int64)).items():
        _growing(steps, name, entry.shape[1:], dtype=entry.dtype)
    steps["ConnectivityIdOffsets"] = steps["CellOffsets"]
    for one in MOVING_FIELDS:
        place = one.place.replace("CellData", "CellDataOffsets")
        if one.of_blocks and place != MOVING:
            steps[place] = steps[MOVING]
    for name in KIND_FIELDS:
        steps[f"CellDataOffsets/{name}"] = steps["PartOffsets"]


def _write_model(group: Any, model: Model, case_text: str, about: Mapping[str, Any]) -> None:
    """Write the model, as far as readers of the results need it."""
    group.attrs["format"] = FORMAT
    group.attrs["title"] = model.title
    group.attrs["plane"] = model.plane.name
    group.attrs["gravity"] = model.gravity
    group.attrs["origin"] = model.origin
    versions = {"Python": platform.python_version(), "HDF5": h5py.version.hdf5_version}
    versions |= {name: version_of(name) for name in ("clast", "numpy", "numba", "scipy", "h5py")}
    for package, number in versions.items():
        group.attrs[f"version of {package}"] = number
    write_source(group, model, case_text, about)
    for one in MODEL:
        if one.of is not None and not one.of.names(model):
            continue
        values = one.values(model)
        if not one.kind:
            group.create_dataset(one.name, data=list(values), dtype=h5py.string_dtype())
        elif len(values) >= LARGE:
            _fixed(group, one.name, values)
        else:
            group[one.name] = values
    write_water(group, model.water)


def write_source(group: Any, model: Model, case_text: str, about: Mapping[str, Any]) -> None:
    """Write the text of the case and its settings, in the place of the earlier ones."""
    settings = json.dumps({**about, **about_model(model)}, ensure_ascii=False, default=float)
    for name, text in {"case": case_text, "about": settings}.items():
        if name not in group or group[name].asstr()[()] != text:
            group.pop(name, None)
            group[name] = text


def _growing(
    group: Any, name: str, shape: tuple[int, ...] = (), *, dtype: DTypeLike = "f8", batch: int = 1
) -> None:
    """Create an empty dataset that is appended to, ``batch`` rows at a time."""
    # Whole batches to a chunk: reading one frame then reads little else.  What shares a chunk with
    # later rows is not compressed: that would be done again, and elsewhere, at every frame.  Single
    # numbers are not either: they save a tenth.
    alone, size = batch >= LARGE, np.dtype(dtype).itemsize * math.prod(shape)
    rows = batch if alone else batch * max(8, CHUNK_BYTES // (batch * size))
    packs = alone and size > np.dtype(float).itemsize
    group.create_dataset(
        name,
        shape=(0, *shape),
        maxshape=(None, *shape),
        chunks=(rows, *shape),
        dtype=dtype,
        **CHECKED,
        **(PACKED if packs else {}),
    )


def _fixed(group: Any, name: str, values: NDArray[Any]) -> None:
    group.create_dataset(name, data=values, chunks=values.shape, **CHECKED, **PACKED)
