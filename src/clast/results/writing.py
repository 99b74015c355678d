"""Writes the result file while the run goes: a temporal VTKHDF file and tables beside it."""

from __future__ import annotations

import json
import os
import platform
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

from clast.errors import CaseError, ResultsLost
from clast.model import Floats, Model
from clast.results.journal import JournalledFile
from clast.results.layout import (
    ABOUT,
    CELL_ARRAYS,
    FORMAT,
    FRAME_ROW,
    POINT_ARRAYS,
    POLYGON,
    VTKHDF_VERSION,
    history_path,
)
from clast.results.run import Report
from clast.results.tables import CONTACT_ROW, ENERGY_ROW, POINT_ROW, STEP_ROW, Table

# Newer formats mark a file as being written, and nothing opens it after the process was killed.
FILE_FORMAT = ("v108", "v108")
# What a kill cuts in two it cuts at a page: headers that change, 268 to 374 bytes, lie within one.
IN_ONE_PAGE = {"alignment_threshold": 128, "alignment_interval": 512}
CHUNK_ROWS = 512
"""Rows that small things share a chunk of the file with."""


class ResultFile:
    """The result file of one run.

    The first frame is written beside ``path`` and then takes its name, so that an earlier result
    is there until a new one is.  The file stays open without a lock: viewers may read along.  The
    frames after it take effect one by one, whole or not at all, through a journal.
    """

    def __init__(self, path: Path, model: Model, case_text: str) -> None:
        self.path = path
        self._model = model
        self._case_text = case_text
        self._file: Any = None
        self._storage: JournalledFile | None = None
        self._columns: dict[str, _Column] = {}
        self._frames = 0
        self._saved = {"energy": 0, "steps": 0, "history": 0}
        self._contacts = 0

    def frame(
        self,
        time: float,
        arrays: Mapping[str, Floats],
        contacts: NDArray[Any],
        tables: Mapping[str, Table],
    ) -> None:
        """Add a frame: arrays by place in /VTKHDF, contacts, and the new rows of the tables."""
        with self._guarded():
            if self._frames:
                self._put_frame(time, arrays, contacts, tables)
                return
            part = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
            try:
                self._open(_new_file(part, self._model, self._case_text))
                self._put_frame(time, arrays, contacts, tables)
                self._file.close()
                os.replace(part, self.path)
            finally:
                part.unlink(missing_ok=True)
            self._storage = JournalledFile(self.path)
            self._open(h5py.File(self._storage, "r+", libver=FILE_FORMAT))
            # HDF5 must not be left to close it when Python, which it writes through, is gone.
            weakref.finalize(self, _close, self._file, self._storage)

    def finish(self, report: Report, tables: Mapping[str, Table]) -> None:
        """Write what is left and the report, and close the file."""
        with self._guarded():
            self._put_tables(self._new_rows(tables))
            group = self._file.create_group("report")
            plain = report.as_dict()
            group["json"] = json.dumps(plain, ensure_ascii=False, default=float)
            for name, value in plain.items():
                if isinstance(value, bool | int | float | str):
                    group.attrs[name] = value
            self._file.close()
            self._commit()
            _close(self._file, self._storage)

    def _open(self, file: Any) -> None:
        self._file = file
        self._columns = {name: _Column(file[name]) for name in _column_names(self._model)}

    def _commit(self) -> None:
        """Let what was written take effect; the first frame's file has no name until it does."""
        if self._storage is not None:
            self._storage.commit()

    @contextmanager
    def _guarded(self) -> Iterator[None]:
        """Turn errors of HDF5 and of the disk into one that a user can act on."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            number = getattr(error, "errno", None)
            raise ResultsLost(
                f"the results cannot be written: {os.strerror(number) if number else error}",
                where=str(self.path),
                remedy="make room or choose another place; frames written before are kept",
            ) from error

    def _put_frame(
        self,
        time: float,
        arrays: Mapping[str, Floats],
        contacts: NDArray[Any],
        tables: Mapping[str, Table],
    ) -> None:
        """Put a frame behind the last one that was completed; it may be tried again."""
        number, contact_end = self._frames, self._contacts + len(contacts)
        new = self._new_rows(tables)
        for name, rows in arrays.items():
            self._columns[f"VTKHDF/{name}"].put(number * len(rows), rows)
        for name, offset in _step_offsets(self._model, number).items():
            self._columns[f"VTKHDF/Steps/{name}"].put(number, offset)
        self._columns["contacts"].put(self._contacts, contacts)
        self._put_tables(new)
        ends = (time, len(tables["steps"]), len(tables["energy"]), contact_end)
        self._columns["frames"].put(number, np.array([ends], FRAME_ROW))
        # Viewers read along: for them a frame counts when all of it is in the file.
        self._file.flush()
        self._file["VTKHDF/Steps"].attrs.modify("NSteps", np.int64(number + 1))
        self._file.flush()
        # Last of all, for VTK 9.7 crashes on more values than NSteps; one too few reads as 0.
        self._columns["VTKHDF/Steps/Values"].put(number, np.array([time]))
        self._file.flush()
        self._commit()
        self._frames, self._contacts = number + 1, contact_end
        self._saved = {name: len(table) for name, table in tables.items()}

    def _new_rows(self, tables: Mapping[str, Table]) -> dict[str, NDArray[Any]]:
        """Return the rows of each table that came after the last frame."""
        return {name: table.rows[self._saved[name] :] for name, table in tables.items()}

    def _put_tables(self, new: Mapping[str, NDArray[Any]]) -> None:
        self._columns["energy"].put(self._saved["energy"], new["energy"])
        self._columns["steps"].put(self._saved["steps"], new["steps"])
        for index, name in enumerate(self._model.measured_points.name):
            rows = _point_rows(new["history"], index)
            self._columns[history_path(name)].put(self._saved["history"], rows)


class _Column:
    """A dataset that grows, written at h5py's low level: a fifth of the high level's time."""

    def __init__(self, dataset: Any) -> None:
        self._id = dataset.id
        self._length, *self._tail = dataset.shape
        self._type = h5py.h5t.py_create(dataset.dtype, logical=True)
        self._dtype = dataset.dtype

    def put(self, first: int, rows: NDArray[Any]) -> None:
        """Write rows from row ``first`` on; the dataset grows as far as needed."""
        if len(rows) == 0:
            return
        rows = np.ascontiguousarray(rows, self._dtype)
        shape, end = (len(rows), *self._tail), first + len(rows)
        if end > self._length:
            self._id.set_extent((end, *self._tail))
            self._length = end
        place = self._id.get_space()
        place.select_hyperslab((first, *(0 for _ in self._tail)), shape)
        self._id.write(h5py.h5s.create_simple(shape), place, rows, self._type)


def _close(file: Any, storage: JournalledFile | None) -> None:
    """Close the file as it was when changes last took effect."""
    file.close()
    if storage is not None:
        storage.close()


def check_output(path: Path) -> Path:
    """Return the path of a file that results can be written to, or raise CaseError."""
    where, folder = str(path), path.absolute().parent
    if path.is_dir():
        raise CaseError(
            "is a directory, not a file to write results to",
            where=where,
            remedy=f"name a file in it, e.g. {path / 'out.vtkhdf'}",
        )
    if not folder.is_dir():
        raise CaseError(
            f"the directory {path.parent} does not exist", where=where, remedy="make it first"
        )
    if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise CaseError(
            "may not be written",
            where=where,
            remedy="choose another place for the results or change its permissions",
        )
    return path.absolute()


def _column_names(model: Model) -> list[str]:
    grid = [*POINT_ARRAYS, *CELL_ARRAYS]
    steps = ["Values", *_step_offsets(model, 0)]
    histories = [history_path(name) for name in model.measured_points.name]
    return [
        *(f"VTKHDF/{name}" for name in grid),
        *(f"VTKHDF/Steps/{name}" for name in steps),
        *("frames", "contacts", "energy", "steps"),
        *histories,
    ]


MOVING = f"CellDataOffsets/{next(iter(CELL_ARRAYS)).removeprefix('CellData/')}"
"""Where the offsets of the blocks' arrays are stored; all arrays share them by hard links."""


def _step_offsets(model: Model, frame: int) -> dict[str, NDArray[Any]]:
    """Return the new entry of each dataset of offsets in /VTKHDF/Steps.

    Every frame is one part, part 0, with the same connectivity and with points and fields of its
    own.
    """
    return {
        "NumberOfParts": np.array([1]),
        "PartOffsets": np.array([0]),
        "CellOffsets": np.array([[0]]),
        "PointOffsets": np.array([frame * len(model.vertices)]),
        MOVING: np.array([frame * model.block_count]),
    }


def _new_file(path: Path, model: Model, case_text: str) -> Any:
    """Create a result file without frames and return it open."""
    file = h5py.File(path, "w", libver=FILE_FORMAT, locking=False, **IN_ONE_PAGE)
    _write_grid(file.create_group("VTKHDF"), model)
    _write_model(file.create_group("model"), model, case_text)
    _growing(file, "frames", dtype=FRAME_ROW)
    _growing(file, "contacts", dtype=CONTACT_ROW)
    _growing(file, "energy", dtype=ENERGY_ROW)
    _growing(file, "steps", dtype=STEP_ROW)
    for name in model.measured_points.name:
        _growing(file, history_path(name), dtype=POINT_ROW)
    return file


def _write_grid(grid: Any, model: Model) -> None:
    """Write the polygons, which never change, and make room for what does."""
    vertices, blocks = len(model.vertices), model.block_count
    grid.attrs["Version"] = np.array(VTKHDF_VERSION)
    # The reader wants a string of fixed length here.
    grid.attrs["Type"] = np.bytes_("UnstructuredGrid")
    grid["NumberOfPoints"] = np.array([vertices])
    grid["NumberOfCells"] = np.array([blocks])
    grid["NumberOfConnectivityIds"] = np.array([vertices])
    grid["Connectivity"] = np.arange(vertices)
    grid["Offsets"] = model.block_start
    grid["Types"] = np.full(blocks, POLYGON, np.uint8)
    for name, shape in POINT_ARRAYS.items():
        _growing(grid, name, shape, batch=vertices)
    for name, shape in CELL_ARRAYS.items():
        _growing(grid, name, shape, batch=blocks)
    grid["CellData/block"] = np.arange(blocks)
    grid["CellData/rock"] = model.block_rock
    grid["CellData/fixed"] = model.fixed.astype(np.uint8)
    for name, about in ABOUT.items():
        grid[name].attrs["about"] = about
    _make_room_for_steps(grid.create_group("Steps"), model)


def _make_room_for_steps(steps: Any, model: Model) -> None:
    steps.attrs["NSteps"] = np.int64(0)
    _growing(steps, "Values")
    for name, entry in _step_offsets(model, 0).items():
        _growing(steps, name, entry.shape[1:], dtype=entry.dtype)
    steps["ConnectivityIdOffsets"] = steps["CellOffsets"]
    for name in CELL_ARRAYS:
        place = name.replace("CellData", "CellDataOffsets")
        if place != MOVING:
            steps[place] = steps[MOVING]
    for name in ("block", "rock", "fixed"):
        steps[f"CellDataOffsets/{name}"] = steps["PartOffsets"]


def _write_model(group: Any, model: Model, case_text: str) -> None:
    """Write what was simulated, as far as readers of the results need it."""
    group.attrs["format"] = FORMAT
    group.attrs["title"] = model.title
    group.attrs["plane"] = model.plane.name
    group.attrs["gravity"] = model.gravity
    group.attrs["origin"] = model.origin
    for package, number in _versions().items():
        group.attrs[f"version of {package}"] = number
    text = h5py.string_dtype()
    group["case"] = case_text
    group.create_dataset("block_name", data=list(model.block_name), dtype=text)
    group.create_dataset("rock_name", data=[rock.name for rock in model.rocks], dtype=text)
    group.create_dataset("point_name", data=list(model.measured_points.name), dtype=text)
    group["point_start"] = model.measured_points.at + model.origin
    group["block_start"] = model.block_start
    group["block_rock"] = model.block_rock
    group["fixed"] = model.fixed


def _versions() -> dict[str, str]:
    found = {"Python": platform.python_version(), "HDF5": h5py.version.hdf5_version}
    for package in ("clast", "numpy", "numba", "scipy", "h5py"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "unknown"
    return found


def _growing(
    group: Any,
    name: str,
    shape: tuple[int, ...] = (),
    *,
    dtype: DTypeLike = "f8",
    batch: int = 1,
) -> None:
    """Create an empty dataset that is appended to, ``batch`` rows at a time."""
    # Whole batches to a chunk: reading one frame then reads little else.
    rows = batch * max(1, CHUNK_ROWS // batch)
    group.create_dataset(
        name, shape=(0, *shape), maxshape=(None, *shape), chunks=(rows, *shape), dtype=dtype
    )


def _point_rows(rows: NDArray[Any], point: int) -> NDArray[Any]:
    """Return the rows of one measured point from the rows of all."""
    one = np.zeros(len(rows), POINT_ROW)
    one["time"] = rows["time"]
    one["displacement"] = rows["displacement"][:, point]
    one["velocity"] = rows["velocity"][:, point]
    one["rotation"] = rows["rotation"][:, point]
    return one
