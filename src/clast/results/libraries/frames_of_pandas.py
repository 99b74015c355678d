"""The tables of a recording as pandas.DataFrame."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.results.libraries.optional_libraries import library
from clast.results.schema import BLOCK_FIELDS, OVER_TIME


def to_pandas(recording: Any) -> dict[str, Any]:
    """Return the tables of a recording by their names; see ``Recording.to_pandas``."""
    pandas = library("pandas")
    found = {"blocks": _blocks(recording, pandas), "contacts": _contacts(recording, pandas)}
    for table in OVER_TIME:
        if recording.lacks(table):
            continue
        if table.of is None:
            found[table.name] = pandas.DataFrame(dict(recording.table(table.name)))
            continue
        parts = []
        for name in recording.names_of(table):
            part = pandas.DataFrame(dict(recording.table(table.name, name)))
            part.insert(0, table.of.name, name)
            parts.append(part)
        if parts:
            found[table.name] = pandas.concat(parts, ignore_index=True)
    return found


def _blocks(recording: Any, pandas: Any) -> Any:
    """Return a row per frame and block, indexed by frame number and name of the block."""
    frames, blocks = len(recording.times), len(recording.block_name)
    index = pandas.MultiIndex.from_product(
        [range(frames), recording.block_name], names=["frame", "block"]
    )
    columns: dict[str, Any] = {"time": np.repeat(recording.times, blocks)}
    for field in BLOCK_FIELDS:
        if field.name not in recording.field_names:
            continue  # an earlier clast wrote the file
        values = recording.field(field.name).reshape(frames * blocks, -1)
        names = [f"{field.component or field.name}_{part}" for part in field.parts]
        for name, column in zip(names or [field.name], values.T, strict=True):
            columns[name] = column
    rock = np.asarray(recording.rock_name, object)[recording.block_rock]
    return pandas.DataFrame({**columns, "rock": np.tile(rock, frames)}, index=index)


def _contacts(recording: Any, pandas: Any) -> Any:
    """Return a row per frame and contact, with names of blocks."""
    parts = []
    names = np.asarray(recording.block_name, object)
    for frame, time in enumerate(recording.times):
        table = recording.contacts(frame)
        part = pandas.DataFrame(dict(table))
        for end in ("vertex_block", "edge_block"):
            part[end] = names[table[end]]
        part.insert(0, "frame", frame)
        part.insert(1, "time", float(time))
        parts.append(part)
    return pandas.concat(parts, ignore_index=True)
