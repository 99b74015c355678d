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
from clast.model.stage_records import Event, Mover, StageRecord
from clast.model.state import Ledger
from clast.model.supports import GROUND, RIGID, LiningJoints, LinkLines
from clast.results.open_file import MalformedError
from clast.results.recording import BoltLines, EdgeJoints, SupportsRecord
from clast.results.run_report import Report, about_in, report_from_dict
from clast.results.schema import (
    BOLT_POINTS,
    FRAME_ROW,
    FRAME_STAGE,
    KIND_FIELDS,
    LINING_JOINTS,
    MODEL,
    MOVING_FIELDS,
    POLYGON,
    TABLES,
    Things,
)


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
    start, rock = of_model(file, "block_start"), of_model(file, "block_rock")
    fixed = of_model(file, "fixed")
    name, rock_name = names(file, "model/block_name"), names(file, "model/rock_name")
    count = len(start) - 1
    if count < 1 or start[0] != 0 or (np.diff(start) < 3).any():
        raise MalformedError("/model/block_start does not say where blocks start")
    if not len(rock) == len(fixed) == len(name) == count:
        raise MalformedError("/model has not one rock, name and mark of each block")
    if rock.min() < 0 or rock.max() >= len(rock_name):
        raise MalformedError("/model/block_rock names rocks that do not exist")
    return StoredBlocks(
        start=start, rock=rock, fixed=fixed.astype(np.bool_), name=name, rock_name=rock_name
    )


def joints_of(file: Any, blocks: StoredBlocks) -> EdgeJoints:
    """Return the joints of a file; raises MalformedError."""
    name, edge = names(file, "model/joint_name"), of_model(file, "edge_joint")
    if len(edge) != blocks.start[-1]:
        raise MalformedError("/model/edge_joint has not one joint for each edge")
    if edge.min() < -1 or edge.max() >= len(name):
        raise MalformedError("/model/edge_joint names joints that do not exist")
    return EdgeJoints(name=name, edge=edge)


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
    start = of_model(file, "point_start")
    if len(start) != len(name) or len(set(name)) < len(name) or not np.isfinite(start).all():
        raise MalformedError("/model/point_start is not a place for each measured point")
    return name, start


def bolts_of(file: Any, frames: NDArray[Any]) -> BoltLines:
    """Return the bolts of a file, none where there are none; raises MalformedError."""
    if "bolt_name" not in file["model"]:
        return BoltLines()
    name, point = names(file, "model/bolt_name"), of_model(file, "bolt_of_point")
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
    along, face = of_model(file, "lining_along"), of_model(file, "lining_face")
    if not len(along) == len(face) == len(name) or not np.isfinite(along).all():
        raise MalformedError("/model/lining_along is not a place for each joint of a lining")
    if face.min() < 0 or face.max() >= blocks.start[-1]:
        raise MalformedError("/model/lining_face names vertices that do not exist")
    section = of_model(file, "lining_section")
    fits = len(section) == len(name) and (section[:, [0, 2]] > 0.0).all()
    if not fits or not (section[:, 1] >= 0.0).all() or not np.isfinite(section[:, 0]).all():
        raise MalformedError("/model/lining_section is not a section for each joint of a lining")
    return LiningJoints(name=name, along=along, face=face, section=section)


def supports_of(file: Any, blocks: int, reactions: int, links: tuple[str, ...]) -> SupportsRecord:
    """Return the supports and links of a file; raises MalformedError."""
    of_block = _indices(file, "reaction_of_block", (reactions, blocks))
    name = _indices(file, "link_line", (len(links),))
    lines = LinkLines(
        name=tuple(links[one] for one in name),
        block=_indices(file, "link_block", (blocks, blocks), (0, GROUND)),
        holds=_indices(file, "link_holds", (RIGID + 1,) * 3),
        at=_points(file, "link_at"),
        along=_points(file, "link_along"),
    )
    if len({len(one) for one in (name, lines.block, lines.holds, lines.at, lines.along)}) != 1:
        raise MalformedError("/model has links that are inconsistent")
    return SupportsRecord(of_block=of_block, links=lines)


def _indices(file: Any, name: str, below: tuple[int, ...], least: Any = 0) -> Ints:
    """Return whole numbers of the model from the least to below the limit of a column."""
    numbers = of_model(file, name, "does not match the blocks, supports and links")
    if (numbers < np.array(least)).any() or (numbers >= np.array(below)).any():
        raise MalformedError(f"/model/{name} does not match the blocks, supports and links")
    return numbers


def _points(file: Any, name: str) -> Floats:
    """Return points (k, 2) of the model."""
    points = of_model(file, name, "has no points")
    if not np.isfinite(points).all():
        raise MalformedError(f"/model/{name} has no points")
    return points


def names_in(file: Any, things: Things) -> tuple[str, ...]:
    """Return the names of the things of a file that has a list of them, none without."""
    name = f"{things.name}_name"
    return names(file, f"model/{name}") if name in file["model"] else ()


def check_arrays(file: Any, frames: NDArray[Any], blocks: StoredBlocks) -> None:
    """Raise MalformedError unless there are arrays of vertices and blocks for all frames."""
    count = len(blocks.rock)
    for one in MOVING_FIELDS:
        rows = count if one.of_blocks else blocks.start[-1]
        _check_length(_numbers(file, f"VTKHDF/{one.place}", "f", one.shape), len(frames) * rows)
    for name in KIND_FIELDS:
        _check_length(_numbers(file, f"VTKHDF/CellData/{name}", "iu"), count)


def check_tables(file: Any, frames: NDArray[Any], names: Mapping[Things, tuple[str, ...]]) -> None:
    """Raise MalformedError unless all tables have the rows of all frames.

    ``names`` are those of the things of tables.
    """
    for one in TABLES:
        whose = names[one.of] if one.of else ()
        row = one.row if one.of is None or one.apart else one.rows(len(whose))
        for place in one.places(whose) if one.of is None or whose else ():
            _check_length(_rows_of(file, place, row), frames[one.counter][-1])


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
        if not np.array_equal(_numbers(file, f"VTKHDF/{name}", "iu")[:], values):
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
    """Return how a file was made; raises MalformedError."""
    try:
        return about_in(text(file, "model/about"))
    except (TypeError, ValueError, RecursionError) as error:
        raise MalformedError(f"{error}") from error


def names(file: Any, place: str) -> tuple[str, ...]:
    """Return the texts of a dataset."""
    return tuple(_dataset(file, place).asstr()[:])


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

    dataset = _group(file, place)
    if not isinstance(dataset, h5py.Dataset) or dataset.external or dataset.is_virtual:
        raise MalformedError(f"/{place} is not a dataset of this file")
    if dataset.chunks is None:
        whole = dataset.id.get_storage_size() >= dataset.nbytes
    else:
        pieces = [-(-n // rows) for n, rows in zip(dataset.shape, dataset.chunks, strict=True)]
        whole = dataset.id.get_num_chunks() >= math.prod(pieces)
    if not whole:
        raise MalformedError(f"/{place} claims more data than the file holds")
    return dataset


def _numbers(
    file: Any,
    place: str,
    kinds: str,
    tail: tuple[int, ...] = (),
    fault: str = "does not hold the expected data",
) -> Any:
    """Return a dataset of rows of numbers of some ``kinds`` (numpy's letters) and shape."""
    dataset = _dataset(file, place)
    shape = dataset.shape
    if dataset.dtype.kind not in kinds or not shape or shape[1:] != tail:
        raise MalformedError(f"/{place} {fault}")
    return dataset


def of_model(file: Any, name: str, fault: str = "does not hold the expected data") -> Any:
    """Return the numbers of a dataset of the model, none where it is of things that are not there.

    Raises MalformedError where they are not of the kind and shape of the schema.
    """
    one = next(one for one in MODEL if one.name == name)
    if one.of is not None and name not in file["model"]:
        return np.zeros((0, *one.shape), np.float64 if one.kind == "f" else np.int64)
    values = _numbers(file, f"model/{name}", one.kind, one.shape, fault)[:]
    return values.astype(np.float64 if one.kind == "f" else np.int64)


def _rows_of(file: Any, place: str, row: np.dtype[Any]) -> Any:
    """Return a table that has the columns of ``row``, and may have more."""
    table = _dataset(file, place)
    columns = table.dtype.fields or {}
    for name, (kind, *_) in (row.fields or {}).items():
        same = name in columns and columns[name][0].shape == kind.shape
        if not same or columns[name][0].base.kind != kind.base.kind or table.ndim != 1:
            raise MalformedError(f"/{place} has no column '{name}' as it should be")
    return table
