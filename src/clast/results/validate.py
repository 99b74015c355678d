"""Whether the parts of a result file fit together; looked at once, when it is opened.

A file that passes can be read without an error, and without more memory than the file's own numbers
take.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Bools, Floats, Ints
from clast.model.stages.records import Event, Mover, StageRecord
from clast.model.state import Ledger
from clast.model.supports.lining_joints import LiningJoints
from clast.model.water.water import Water
from clast.results.open_file import MalformedError
from clast.results.provenance import about_in
from clast.results.recording import BoltLines, EdgeJoints
from clast.results.run_report import Report, report_from_dict
from clast.results.schema import (
    BOLT_POINTS,
    CONTACTS,
    ENERGY,
    FRAME_ROW,
    FRAME_STAGE,
    KIND_FIELDS,
    LINING_JOINTS,
    MOVING_FIELDS,
    OVER_TIME,
    POLYGON,
    TableSchema,
    Things,
)
from clast.results.water_record import waters_in


@dataclass(frozen=True, kw_only=True)
class StoredBlocks:
    """The blocks of a result file; n blocks."""

    start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    rock: Ints
    """Rock index of each block, shape (n,)."""
    fixed: Bools
    """True where a block cannot move at all, shape (n,)."""
    name: tuple[str, ...]
    """Name of each block."""
    rock_name: tuple[str, ...]
    """Name of each rock."""


def blocks_of(file: Any) -> StoredBlocks:
    """Return the blocks of a file; raises MalformedError."""
    start = _whole(file, "model/block_start", "iu")
    rock = _whole(file, "model/block_rock", "iu")
    fixed = _whole(file, "model/fixed", "biu")
    name, rock_name = names(file, "model/block_name"), names(file, "model/rock_name")
    count = len(start) - 1
    if count < 1 or start[0] != 0 or (np.diff(start.astype(np.int64)) < 3).any():
        raise MalformedError("/model/block_start does not say where blocks start")
    if not len(rock) == len(fixed) == len(name) == count:
        raise MalformedError("/model has not one rock, name and mark of each block")
    if rock.min() < 0 or rock.max() >= len(rock_name):
        raise MalformedError("/model/block_rock names rocks that do not exist")
    return StoredBlocks(
        start=start.astype(np.int64),
        rock=rock.astype(np.int64),
        fixed=fixed.astype(np.bool_),
        name=name,
        rock_name=rock_name,
    )


def joints_of(file: Any, blocks: StoredBlocks) -> EdgeJoints | None:
    """Return the joints of a file, None where an older version wrote it; raises MalformedError."""
    if not {"joint_name", "edge_joint"} & set(file["model"]) and not _contacts_have_joints(file):
        return None
    name = names(file, "model/joint_name")
    edge = _whole(file, "model/edge_joint", "i")
    if len(edge) != blocks.start[-1]:
        raise MalformedError("/model/edge_joint has not one joint for each edge")
    if edge.min() < -1 or edge.max() >= len(name):
        raise MalformedError("/model/edge_joint names joints that do not exist")
    return EdgeJoints(name=name, edge=edge.astype(np.int64))


def frames_of(file: Any) -> NDArray[Any]:
    """Return the table of the frames that count; raises MalformedError."""
    frames = _rows_of(file, "frames", FRAME_ROW)
    count = int(_group(file, "VTKHDF/Steps").attrs["NSteps"])
    if not 1 <= count <= len(frames):
        raise MalformedError(f"/VTKHDF/Steps says {count} frames, and /frames has {len(frames)}")
    rows: NDArray[Any] = frames[:count]
    ends = np.column_stack([rows[name] for name in ("steps", "instants", "contacts")])
    forward = np.isfinite(rows["time"]).all() and (np.diff(rows["time"]) >= 0.0).all()
    if not forward or (np.diff(ends, axis=0, prepend=0) < 0).any():
        raise MalformedError("/frames does not go forward")
    return rows


def stages_of(file: Any, stages: Sequence[str], frames: int) -> tuple[str, ...]:
    """Return the name of the stage of each frame, none without stages; raises MalformedError."""
    if FRAME_STAGE not in file:
        return ()
    rows = _numbers(file, FRAME_STAGE, "iu")
    _check_length(rows, frames)
    number = rows[:frames]
    if number.min() < 0 or number.max() >= len(stages) or (np.diff(number) < 0).any():
        raise MalformedError(f"/{FRAME_STAGE} has frames of stages that do not exist")
    return tuple(stages[one] for one in number)


def points_of(file: Any) -> tuple[tuple[str, ...], Floats]:
    """Return names and starts (k, 2) of the measured points; raises MalformedError."""
    name = names(file, "model/point_name")
    start = _whole(file, "model/point_start", "f", (2,))
    if len(start) != len(name) or len(set(name)) < len(name) or not np.isfinite(start).all():
        raise MalformedError("/model/point_start is not a place for each measured point")
    return name, start


def bolts_of(file: Any, frames: NDArray[Any]) -> BoltLines:
    """Return the bolts of a file, none where an older version wrote it; raises MalformedError."""
    if "bolt_name" not in file["model"]:
        return BoltLines()
    name = names(file, "model/bolt_name")
    point = _whole(file, "model/bolt_of_point", "iu").astype(np.int64)
    count = len(name)
    if not count or not np.array_equal(np.unique(point), np.arange(count)):
        raise MalformedError("/model/bolt_of_point does not match the bolts")
    if (np.diff(point) < 0).any():
        raise MalformedError("/model/bolt_of_point is not in the order of the bolts")
    _check_length(_numbers(file, BOLT_POINTS, "f", (2,)), len(frames) * len(point))
    return BoltLines(name=name, point=point)


def lining_joints_of(file: Any, blocks: StoredBlocks) -> LiningJoints:
    """Return the joints of linings of a file, none where there are none; raises MalformedError."""
    name = names_in(file, LINING_JOINTS)
    if not name:
        return LiningJoints()
    along = _whole(file, "model/lining_along", "f").astype(np.float64)
    face = _whole(file, "model/lining_face", "iu", (2,)).astype(np.int64)
    if not len(along) == len(face) == len(name) or not np.isfinite(along).all():
        raise MalformedError("/model/lining_along is not a place for each joint of a lining")
    if face.min() < 0 or face.max() >= blocks.start[-1]:
        raise MalformedError("/model/lining_face names vertices that do not exist")
    return LiningJoints(name=name, along=along, face=face, section=_sections(file, len(name)))


def _sections(file: Any, joints: int) -> NDArray[Any]:
    """Return the sections of the joints of linings, (k, 3), none in files of older versions."""
    if "lining_section" not in file["model"]:
        return np.zeros((0, 3))
    found = _whole(file, "model/lining_section", "f", (3,)).astype(np.float64)
    fits = len(found) == joints and (found[:, [0, 2]] > 0.0).all()
    if not fits or not (found[:, 1] >= 0.0).all() or not np.isfinite(found[:, 0]).all():
        raise MalformedError("/model/lining_section is not a section for each joint of a lining")
    return found


def measured_contacts_of(file: Any) -> tuple[str, ...]:
    """Return the names of the measured contacts of a file."""
    if "measured_contact_name" not in file["model"]:
        return ()
    return names(file, "model/measured_contact_name")


def names_in(file: Any, things: Things) -> tuple[str, ...]:
    """Return the names of the things of a file that has a list of them, none without."""
    name = f"{things.name}_name"
    return names(file, f"model/{name}") if name in file["model"] else ()


def check_arrays(file: Any, frames: NDArray[Any], blocks: StoredBlocks) -> None:
    """Raise MalformedError unless there are arrays of vertices and blocks for all frames."""
    count = len(blocks.rock)
    for one in MOVING_FIELDS:
        if one.since and one.place not in _group(file, "VTKHDF"):
            continue
        rows = count if one.of_blocks else blocks.start[-1]
        _check_length(_numbers(file, f"VTKHDF/{one.place}", "f", one.shape), len(frames) * rows)
    for name in KIND_FIELDS:
        _check_length(_numbers(file, f"VTKHDF/CellData/{name}", "iu"), count)


def check_tables(
    file: Any, frames: NDArray[Any], names: Mapping[Things, tuple[str, ...]], layout: int
) -> None:
    """Raise MalformedError unless all tables have the rows of all frames.

    ``names`` are those of the things that tables tell of.
    """
    kinds = (kind.kind for kind, *_ in (_dataset(file, ENERGY.name).dtype.fields or {}).values())
    if any(kind != "f" for kind in kinds):
        raise MalformedError("/energy is not a table of energies")
    missing = missing_tables(file)
    for one in OVER_TIME:
        whose = names.get(one.of, ()) if one.of else ()
        if (one.of and not whose) or one.name in missing:
            continue
        for place in one.places(whose, layout):
            _check_length(_rows_of(file, place, *_wanted(one, len(whose))), frames[one.counter][-1])
    _check_length(_rows_of(file, CONTACTS.name, *_wanted(CONTACTS, 0)), frames["contacts"][-1])


def missing_tables(file: Any) -> frozenset[str]:
    """Return the names of the tables that an earlier clast did not write."""
    tables = (one for one in OVER_TIME if one.may_be_missing)
    places = {one.name: one.of.path if one.of and one.of.path else one.name for one in tables}
    return frozenset(name for name, place in places.items() if place not in file)


def _wanted(one: TableSchema, count: int) -> tuple[np.dtype[Any], frozenset[str]]:
    """Return a row of a table of ``count`` things, and its columns that may be missing."""
    apart = one.of is None or one.of.path
    later = frozenset(column.name for column in one.columns if column.since)
    return one.row if apart else one.rows(count), later


def _contacts_have_joints(file: Any) -> bool:
    return "joint" in (_dataset(file, CONTACTS.name).dtype.names or ())


def check_grid(file: Any, frames: NDArray[Any], blocks: StoredBlocks) -> None:
    """Raise MalformedError unless viewers find the polygons of all frames."""
    vertices, count = int(blocks.start[-1]), len(blocks.rock)
    wanted = {
        "NumberOfPoints": np.array([vertices]),
        "NumberOfCells": np.array([count]),
        "NumberOfConnectivityIds": np.array([vertices]),
        "Connectivity": np.arange(vertices),
        "Offsets": blocks.start,
        "Types": np.full(count, POLYGON),
    }
    for name, values in wanted.items():
        if not np.array_equal(_whole(file, f"VTKHDF/{name}", "iu"), values):
            raise MalformedError(f"/VTKHDF/{name} does not match the blocks")
    _check_length(_numbers(file, "VTKHDF/Steps/Values", "f"), len(frames) - 1)
    for name, tail in {"NumberOfParts": (), "PartOffsets": (), "CellOffsets": (1,)}.items():
        _check_length(_numbers(file, f"VTKHDF/Steps/{name}", "iu", tail), len(frames))
    for frame, vertex in ((0, 0), (len(frames) - 1, (len(frames) - 1) * vertices)):
        if _numbers(file, "VTKHDF/Steps/PointOffsets", "iu")[frame] != vertex:
            raise MalformedError("/VTKHDF/Steps/PointOffsets does not match the blocks")


def _check_length(dataset: Any, rows: int) -> None:
    if dataset.ndim == 0 or len(dataset) < rows:
        raise MalformedError(f"{dataset.name} ends before the last frame")


def report_of(file: Any) -> Report | None:
    """Return the report of a file, None where its run did not end; raises MalformedError."""
    if "report" not in file:
        return None
    try:
        plain = json.loads(_dataset(file, "report/json").asstr()[()])
        hints = get_type_hints(Report)
        for one in fields(Report):
            if one.name in plain and not _fits(plain[one.name], hints[one.name]):
                raise TypeError(one.name)
        if not all(_fits(energy, float) for energy in plain["ledger"].values()):
            raise TypeError("ledger")
        for name, kind in (("stages", StageRecord), ("events", Event)):
            if not all(_is(kind, one) for one in plain.get(name, ())):
                raise TypeError(name)
        return report_from_dict(plain)
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        raise MalformedError("/report/json is not a report of a run") from error


def about_of(file: Any) -> dict[str, Any]:
    """Return how a file was made, nothing if an older version wrote it.

    Raises MalformedError.
    """
    if "about" not in file["model"]:
        return {}
    try:
        return about_in(text(file, "model/about"))
    except (TypeError, ValueError, RecursionError) as error:
        raise MalformedError(f"{error}") from error


def water_of(file: Any, blocks: StoredBlocks) -> tuple[Water, ...]:
    """Return the water of a file; raises MalformedError."""
    found = waters_in(file["model"], int(blocks.start[-1]))
    if found is None:
        raise MalformedError("/model/water does not hold the expected data")
    return found


def names(file: Any, place: str) -> tuple[str, ...]:
    """Return the texts of a dataset."""
    found: tuple[str, ...] = tuple(_dataset(file, place).asstr()[:])
    return found


def text(file: Any, place: str) -> str:
    """Return the text of a dataset."""
    return str(_dataset(file, place).asstr()[()])


def _is(kind: Any, plain: Any) -> bool:
    """Return whether plain data have the entries of a record, each of its type, and no others."""
    hints = get_type_hints(kind)
    needed = {entry.name for entry in fields(kind) if entry.default is MISSING}
    if not isinstance(plain, Mapping) or not needed <= set(plain) <= set(hints):
        return False
    return all(
        _is(hints[key], value) if hints[key] is Mover else _fits(value, hints[key])
        for key, value in plain.items()
    )


def _fits(value: object, hint: Any) -> bool:
    """Return whether a value of JSON can be of a type of the report."""
    if hint is float:
        return isinstance(value, int | float) and not isinstance(value, bool)
    if hint is int:
        return isinstance(value, int) and not isinstance(value, bool)
    if hint in (bool, str):
        return isinstance(value, hint)
    if get_origin(hint) is tuple:
        return isinstance(value, list)
    if hint is Ledger or get_origin(hint) is Mapping:
        return isinstance(value, Mapping)
    return True


def _group(file: Any, place: str) -> Any:
    """Return a group, or a dataset, of this file and no other; raises MalformedError."""
    import h5py

    here = file
    for name in place.split("/"):
        link = here.get(name, getlink=True) if isinstance(here, h5py.Group) else None
        if not isinstance(link, h5py.HardLink):
            raise MalformedError(f"/{place} is missing, or not in this file")
        here = here[name]
    return here


def _dataset(file: Any, place: str) -> Any:
    """Return a dataset all of whose numbers are in the file; raises MalformedError."""
    import h5py

    found = _group(file, place)
    if not isinstance(found, h5py.Dataset) or found.external or found.is_virtual:
        raise MalformedError(f"/{place} is not a dataset of this file")
    if found.chunks is None:
        whole = found.id.get_storage_size() >= found.nbytes
    else:
        pieces = [-(-n // rows) for n, rows in zip(found.shape, found.chunks, strict=True)]
        whole = found.id.get_num_chunks() >= math.prod(pieces)
    if not whole:
        raise MalformedError(f"/{place} claims more data than the file holds")
    return found


def _numbers(file: Any, place: str, kinds: str, tail: tuple[int, ...] = ()) -> Any:
    """Return a dataset of rows of numbers of some ``kinds`` (numpy's letters) and shape."""
    found = _dataset(file, place)
    if found.dtype.kind not in kinds or found.shape is None or found.shape[1:] != tail:
        raise MalformedError(f"/{place} does not hold the expected data")
    if found.ndim != 1 + len(tail):
        raise MalformedError(f"/{place} does not hold the expected data")
    return found


def _whole(file: Any, place: str, kinds: str, tail: tuple[int, ...] = ()) -> NDArray[Any]:
    """Return the numbers of a dataset."""
    values: NDArray[Any] = _numbers(file, place, kinds, tail)[:]
    return values


def _rows_of(file: Any, place: str, row: np.dtype[Any], later: frozenset[str] = frozenset()) -> Any:
    """Return a table that has the columns of ``row`` but for ``later`` ones, and may have more."""
    found = _dataset(file, place)
    columns = found.dtype.fields or {}
    for name, (kind, *_) in (row.fields or {}).items():
        if name in later and name not in columns:
            continue
        same = name in columns and columns[name][0].shape == kind.shape
        if not same or columns[name][0].base.kind != kind.base.kind or found.ndim != 1:
            raise MalformedError(f"/{place} has no column '{name}' as it should be")
    return found
