"""Whether the parts of a result file fit together; looked at once, when it is opened.

A file that passes can be read without an error, and without more memory than the file's own numbers
take.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Ints
from clast.model.supports import GROUND, RIGID, LiningJoints, LinkLines
from clast.results.checkpoints.encode import is_well_typed
from clast.results.open_file import MalformedError
from clast.results.result_tables import Channels
from clast.results.run_report import CHECKS, Report, report_from_dict
from clast.results.schema import (
    BESIDE,
    BOLT_POINTS,
    CHANNELS,
    CONVERGENCES,
    FLOWS,
    FRAME_ROW,
    FRAME_STAGE,
    KIND_FIELDS,
    LINING_JOINTS,
    LINKS,
    MEASURED_CONTACTS,
    MEASURED_FLOWS,
    MODEL,
    MOVING_FIELDS,
    POLYGON,
    REACTIONS,
    TABLES,
    Things,
)

Parts = dict[str, Any]
"""Fields of a recording."""


def _require(condition: Any, fault: str) -> None:
    if not condition:
        raise MalformedError(fault)


def parts_of_model(file: Any, frames: int) -> Parts:
    """Return the content of /model of a file with so many frames; raises MalformedError."""
    parts = _blocks(file)
    blocks, corners = len(parts["block_name"]), int(parts["block_start"][-1])
    parts |= {**_edge_joints(file, corners), **_points(file), **_bolts(file, frames)}
    for things in (MEASURED_CONTACTS, REACTIONS, LINKS, FLOWS, MEASURED_FLOWS):
        parts[f"{things.name}_name"] = _names_of(file, things)
    parts["lining_joints"] = _lining_joints(file, corners)
    parts["channels"] = _channels(file, corners, frames)
    if pairs := _names_of(file, CONVERGENCES):
        point = _indices(file, "convergence_points", (len(parts["point_name"]),) * 2)
        _require(len(point) == len(pairs), "/model/convergence_points has not two of each")
        parts |= {"convergence_name": pairs, "convergence_points": point}
    return {**parts, **_supports(file, blocks, len(parts["reaction_name"]), parts["link_name"])}


def _blocks(file: Any) -> Parts:
    start, rock, fixed = (of_model(file, one) for one in ("block_start", "block_rock", "fixed"))
    name, rock_name = names(file, "model/block_name"), names(file, "model/rock_name")
    count = len(start) - 1
    _require(
        count >= 1 and start[0] == 0 and (np.diff(start) >= 3).all(),
        "/model/block_start does not say where blocks start",
    )
    _require(
        len(rock) == len(fixed) == len(name) == count,
        "/model has not one rock, name and mark of each block",
    )
    _require(
        rock.min() >= 0 and rock.max() < len(rock_name),
        "/model/block_rock names rocks that do not exist",
    )
    parts = {"block_start": start, "block_rock": rock, "fixed": fixed.astype(np.bool_)}
    return {**parts, "block_name": name, "rock_name": rock_name}


def _edge_joints(file: Any, corners: int) -> Parts:
    name, edge = names(file, "model/joint_name"), of_model(file, "edge_joint")
    _require(len(edge) == corners, "/model/edge_joint has not one joint for each edge")
    exist = edge.min() >= -1 and edge.max() < len(name)
    _require(exist, "/model/edge_joint names joints that do not exist")
    return {"joint_name": name, "edge_joint": edge}


def frames_of(file: Any) -> NDArray[Any]:
    """Return the table of the frames that count; raises MalformedError."""
    frames = _rows_of(file, "frames", FRAME_ROW)
    count = int(_group(file, "VTKHDF/Steps").attrs["NSteps"])
    _require(
        1 <= count <= len(frames),
        f"/VTKHDF/Steps says {count} frames, and /frames has {len(frames)}",
    )
    rows: NDArray[Any] = frames[:count]
    ends = np.column_stack([rows[name] for name in ("steps", "instants", "contacts")])
    forward = np.isfinite(rows["time"]).all() and (np.diff(rows["time"]) >= 0.0).all()
    _require(
        forward and (np.diff(ends, axis=0, prepend=0) >= 0).all(), "/frames does not go forward"
    )
    return rows


def stages_of(file: Any, stages: Sequence[str], frames: int) -> tuple[str, ...]:
    """Return the name of the stage of each frame, none without stages; raises MalformedError."""
    if FRAME_STAGE not in file:
        return ()
    rows = _numbers(file, FRAME_STAGE, "iu")
    _check_length(rows, frames)
    number = rows[:frames]
    exist = number.min() >= 0 and number.max() < len(stages) and (np.diff(number) >= 0).all()
    _require(exist, f"/{FRAME_STAGE} has frames of stages that do not exist")
    return tuple(stages[one] for one in number)


def _points(file: Any) -> Parts:
    name, start = names(file, "model/point_name"), of_model(file, "point_start")
    _require(
        len(start) == len(name) == len(set(name)) and np.isfinite(start).all(),
        "/model/point_start is not a place for each measured point",
    )
    return {"point_name": name, "point_start": start}


def _bolts(file: Any, frames: int) -> Parts:
    if "bolt_name" not in file["model"]:
        return {}
    name, point = names(file, "model/bolt_name"), of_model(file, "bolt_of_point")
    each = len(name) and np.array_equal(np.unique(point), np.arange(len(name)))
    _require(each, "/model/bolt_of_point does not match the bolts")
    _require((np.diff(point) >= 0).all(), "/model/bolt_of_point is not in the order of the bolts")
    _check_length(_numbers(file, BOLT_POINTS, "f", (2,)), frames * len(point))
    return {"bolt_name": name, "bolt_of_point": point}


def _channels(file: Any, corners: int, frames: int) -> Channels:
    if not _names_of(file, FLOWS):
        return Channels()
    edge, share = (
        _indices(file, "channel_edge", (corners, corners)),
        of_model(file, "channel_share"),
    )
    node = of_model(file, "channel_node")
    whole = len(edge) == len(share) == len(node) and (node >= 0).all()
    _require(whole and (np.abs(share - 0.5) <= 0.5 + 1e-6).all(), "/model/channel_share is wrong")
    _check_length(_numbers(file, CHANNELS, "f", (BESIDE[CHANNELS][0],)), frames * len(edge))
    place, weight = of_model(file, "flow_place"), of_model(file, "flow_weight")
    _require(len(place) == len(_names_of(file, FLOWS)), "/model/flow_place is wrong")
    _require(len(weight) == 1 and weight[0] >= 0.0, "/model/flow_weight is wrong")
    line, of_line = of_model(file, "flow_line"), of_model(file, "flow_of_line")
    whole = len(line) == len(of_line) and ((of_line >= 0) & (of_line < len(place))).all()
    _require(whole, "/model/flow_of_line is wrong")
    outside = {"place": place, "line": line, "of_line": of_line, "weight": float(weight[0])}
    return Channels(edge=edge, share=share, node=node, **outside)


def _lining_joints(file: Any, corners: int) -> LiningJoints:
    name = _names_of(file, LINING_JOINTS)
    if not name:
        return LiningJoints()
    along, face = of_model(file, "lining_along"), of_model(file, "lining_face")
    _require(
        len(along) == len(face) == len(name) and np.isfinite(along).all(),
        "/model/lining_along is not a place for each joint of a lining",
    )
    exist = face.min() >= 0 and face.max() < corners
    _require(exist, "/model/lining_face names vertices that do not exist")
    section = of_model(file, "lining_section")
    fits = len(section) == len(name) and (section[:, [0, 2]] > 0.0).all()
    _require(
        fits and (section[:, 1] >= 0.0).all() and np.isfinite(section[:, 0]).all(),
        "/model/lining_section is not a section for each joint of a lining",
    )
    return LiningJoints(name=name, along=along, face=face, section=section)


def _supports(file: Any, blocks: int, reactions: int, links: tuple[str, ...]) -> Parts:
    name = _indices(file, "link_line", (len(links),))
    at, along = (
        of_model(file, "link_at", "has no points"),
        of_model(file, "link_along", "has no points"),
    )
    for place, points in (("link_at", at), ("link_along", along)):
        _require(np.isfinite(points).all(), f"/model/{place} has no points")
    lines = LinkLines(
        name=tuple(links[one] for one in name),
        block=_indices(file, "link_block", (blocks, blocks), (0, GROUND)),
        holds=_indices(file, "link_holds", (RIGID + 1,) * 3),
        at=at,
        along=along,
    )
    counts = {len(one) for one in (name, lines.block, lines.holds, at, along)}
    _require(len(counts) == 1, "/model has links that are inconsistent")
    return {
        "reaction_of_block": _indices(file, "reaction_of_block", (reactions, blocks)),
        "link_lines": lines,
    }


def _indices(file: Any, name: str, below: tuple[int, ...], least: Any = 0) -> Ints:
    """Return whole numbers of the model from the least to below the limit of a column."""
    numbers = of_model(file, name, "does not match the blocks, supports and links")
    within = (numbers >= np.array(least)).all() and (numbers < np.array(below)).all()
    _require(within, f"/model/{name} does not match the blocks, supports and links")
    return numbers


def _names_of(file: Any, things: Things) -> tuple[str, ...]:
    name = f"{things.name}_name"
    return names(file, f"model/{name}") if name in file["model"] else ()


def check_data(file: Any, frames: NDArray[Any], parts: Parts) -> None:
    """Raise MalformedError unless arrays, tables and polygons of all frames are in a file.

    ``parts`` are those of its model.
    """
    vertices, count = int(parts["block_start"][-1]), len(parts["block_name"])
    for one in MOVING_FIELDS:
        rows = count if one.of_blocks else vertices
        _check_length(_numbers(file, f"VTKHDF/{one.place}", "f", one.shape), len(frames) * rows)
    for name in KIND_FIELDS:
        _check_length(_numbers(file, f"VTKHDF/CellData/{name}", "iu"), count)
    things = {"lining_joint_name": parts["lining_joints"].name, **parts}
    for table in TABLES:
        whose = things.get(f"{table.of.name}_name", ()) if table.of else ()
        row = table.row if table.of is None or table.apart else table.rows(len(whose))
        for place in table.places(whose) if table.of is None or whose else ():
            _check_length(_rows_of(file, place, row), frames[table.counter][-1])
    _check_grid(file, len(frames), parts["block_start"])


def _check_grid(file: Any, frames: int, block_start: Ints) -> None:
    """Raise MalformedError unless viewers find the polygons of all frames."""
    vertices, count = int(block_start[-1]), len(block_start) - 1
    wanted = {
        "NumberOfPoints": np.array([vertices]),
        "NumberOfCells": np.array([count]),
        "NumberOfConnectivityIds": np.array([vertices]),
        "Connectivity": np.arange(vertices),
        "Offsets": block_start,
        "Types": np.full(count, POLYGON),
    }
    for name, values in wanted.items():
        same = np.array_equal(_numbers(file, f"VTKHDF/{name}", "iu")[:], values)
        _require(same, f"/VTKHDF/{name} does not match the blocks")
    _check_length(_numbers(file, "VTKHDF/Steps/Values", "f"), frames - 1)
    for name, tail in {"NumberOfParts": (), "PartOffsets": (), "CellOffsets": (1,)}.items():
        _check_length(_numbers(file, f"VTKHDF/Steps/{name}", "iu", tail), frames)
    for frame in (0, frames - 1):
        same = _numbers(file, "VTKHDF/Steps/PointOffsets", "iu")[frame] == frame * vertices
        _require(same, "/VTKHDF/Steps/PointOffsets does not match the blocks")


def _check_length(dataset: Any, rows: int) -> None:
    _require(dataset.ndim and len(dataset) >= rows, f"{dataset.name} ends before the last frame")


def report_of(file: Any) -> Report | None:
    """Return the report of a file, None where its run did not end; raises MalformedError."""
    if "report" not in file:
        return None
    try:
        report = report_from_dict(json.loads(_dataset(file, "report/json").asstr()[()]))
        if not is_well_typed(report):
            raise TypeError("a part of another type")
        return report
    except (TypeError, ValueError, KeyError, AttributeError, RecursionError) as error:
        raise MalformedError("/report/json is not a report of a run") from error


def about_of(file: Any) -> dict[str, Any]:
    """Return how a file was made; raises MalformedError."""
    try:
        # How a file was made; raises ValueError where the text is no such record.
        about = json.loads(text(file, "model/about"))
        if not isinstance(about, dict) or not all(
            is_right(about[key]) for key, is_right in CHECKS.items() if key in about
        ):
            raise ValueError("/model/about does not say how the run was made")
        return dict(about)
    except (TypeError, ValueError, RecursionError) as error:
        raise MalformedError(f"{error}") from error


def names(file: Any, place: str) -> tuple[str, ...]:
    """Return the texts of a dataset."""
    return tuple(_dataset(file, place).asstr()[:])


def text(file: Any, place: str) -> str:
    """Return the text of a dataset."""
    return str(_dataset(file, place).asstr()[()])


def _group(file: Any, place: str) -> Any:
    """Return a group, or a dataset, of this file and no other; raises MalformedError."""
    import h5py

    here = file
    for name in place.split("/"):
        link = here.get(name, getlink=True) if isinstance(here, h5py.Group) else None
        _require(isinstance(link, h5py.HardLink), f"/{place} is missing, or not in this file")
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
    _require(whole, f"/{place} claims more data than the file holds")
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
    fits = dataset.dtype.kind in kinds and shape and shape[1:] == tail
    _require(fits, f"/{place} {fault}")
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
        same = same and columns[name][0].base.kind == kind.base.kind and table.ndim == 1
        _require(same, f"/{place} has no column '{name}' as it should be")
    return table
