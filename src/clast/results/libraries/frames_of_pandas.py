"""The tables of a recording as pandas.DataFrame."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.results.libraries.optional_libraries import library
from clast.results.schema import BLOCK_FIELDS, CONTACTS, OVER_TIME


def to_pandas(recording: Any) -> dict[str, Any]:
    """Return the tables of a recording by their names; see ``Recording.to_pandas``."""
    pandas = library("pandas")
    found = {"blocks": _blocks(recording, pandas), "contacts": _contacts(recording, pandas)}
    for table in OVER_TIME:
        if recording.lacks(table):
            continue
        parts = []
        for name in recording.names_of(table) if table.of else (None,):
            part = pandas.DataFrame(recording.table(table.name, name).in_words())
            if table.of is not None:
                part.insert(0, table.of.name, name)
            parts.append(part)
        if parts:
            found[table.name] = pandas.concat(parts, ignore_index=True)
            found[table.name].attrs["units"] = table.units
    return found


def _blocks(recording: Any, pandas: Any) -> Any:
    """Return a row per frame and block, indexed by frame number and name of the block."""
    frames, blocks = len(recording.times), len(recording.block_name)
    index = pandas.MultiIndex.from_product(
        [range(frames), recording.block_name], names=["frame", "block"]
    )
    columns: dict[str, Any] = {"time": np.repeat(recording.times, blocks)}
    units = {"time": "s"}
    if recording.frame_stages:
        columns["stage"] = np.repeat(np.asarray(recording.frame_stages, object), blocks)
    for field in BLOCK_FIELDS:
        if field.name not in recording.field_names:
            continue  # an earlier clast wrote the file
        values = recording.field(field.name).reshape(frames * blocks, -1)
        names = [f"{field.component or field.name}_{part}" for part in field.parts]
        for name, column in zip(names or [field.name], values.T, strict=True):
            columns[name] = column
            units[name] = field.unit
    rock = np.asarray(recording.rock_name, object)[recording.block_rock]
    columns["rock"] = np.tile(rock, frames)
    columns["fixed"] = np.tile(recording.fixed, frames)
    found = pandas.DataFrame(columns, index=index)
    found.attrs["units"] = units
    return found


def _contacts(recording: Any, pandas: Any) -> Any:
    """Return a row per frame and contact, with names of blocks and joints."""
    parts = []
    names = np.asarray(recording.block_name, object)
    stages = recording.frame_stages
    for frame, time in enumerate(recording.times):
        table = recording.contacts(frame)
        part = pandas.DataFrame(table.in_words())
        for end in ("vertex_block", "edge_block"):
            part[end] = names[table[end]]
        if "joint" in table:
            part["joint"] = np.asarray(recording.joint_name, object)[table["joint"]]
        part.insert(0, "frame", frame)
        part.insert(1, "time", float(time))
        if stages:
            part.insert(2, "stage", stages[frame])
        parts.append(part)
    found = pandas.concat(parts, ignore_index=True)
    found.attrs["units"] = {"time": "s", **CONTACTS.units}
    return found
