"""Recordings as objects of pandas and xarray, which are loaded when they are asked for."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.results.schema import BLOCK_FIELDS, CONTACTS, LINK, OVER_TIME, PLANE, TENSOR, Column, Per

COMPONENTS = {PLANE: "component", TENSOR: "stress_component", LINK: "link_component"}
"""Dimension of vectors, of stresses and of forces of links."""
ROWS = {Per.INSTANT: "instant", Per.STEP: "step_number"}
"""Dimension of the rows of a table."""


def library(name: str) -> Any:
    """Return a library that is an extra of clast; raises CaseError where it is not installed."""
    try:
        return import_module(name)
    except ImportError as error:
        raise CaseError(
            f"{name} is not installed", remedy=f"install it: pip install 'clast[{name}]'"
        ) from error


def to_pandas(recording: Any) -> dict[str, Any]:
    """Return the tables of a recording by their names; see ``Recording.to_pandas``."""
    pandas = library("pandas")
    tables = {"blocks": _blocks(recording, pandas), "contacts": _contacts(recording, pandas)}
    for table in OVER_TIME:
        parts = []
        for name in recording.names_of(table) if table.of else (None,):
            part = pandas.DataFrame(recording.table(table.name, name).in_words())
            if table.of is not None:
                part.insert(0, table.of.name, name)
            parts.append(part)
        if parts:
            tables[table.name] = pandas.concat(parts, ignore_index=True)
            tables[table.name].attrs["units"] = table.units
    return tables


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
        values = recording.field(field.name).reshape(frames * blocks, -1)
        names = [f"{field.component or field.name}_{part}" for part in field.parts]
        for name, column in zip(names or [field.name], values.T, strict=True):
            columns[name] = column
            units[name] = field.unit
    rock = np.asarray(recording.rock_name, object)[recording.block_rock]
    columns["rock"] = np.tile(rock, frames)
    columns["fixed"] = np.tile(recording.fixed, frames)
    blocks_table = pandas.DataFrame(columns, index=index)
    blocks_table.attrs["units"] = units
    return blocks_table


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
        part["joint"] = np.asarray(recording.joint_name, object)[table["joint"]]
        part.insert(0, "frame", frame)
        part.insert(1, "time", float(time))
        if stages:
            part.insert(2, "stage", stages[frame])
        parts.append(part)
    contacts = pandas.concat(parts, ignore_index=True)
    contacts.attrs["units"] = {"time": "s", **CONTACTS.units}
    return contacts


def to_xarray(recording: Any) -> Any:
    """Return fields and histories of a recording; see ``Recording.to_xarray``."""
    xarray = library("xarray")
    coordinates: dict[str, Any] = {
        "time": ("frame", recording.times, {"units": "s"}),
        "block": list(recording.block_name),
        "component": list(PLANE),
        "stress_component": list(TENSOR),
        "vertex_block": (
            "vertex",
            list(
                np.repeat(np.asarray(recording.block_name, object), np.diff(recording.block_start))
            ),
        ),
        "rock": ("block", np.asarray(recording.rock_name)[recording.block_rock]),
        "fixed": ("block", recording.fixed),
    }
    if recording.frame_stages:
        coordinates["stage"] = "frame", list(recording.frame_stages)
    variables: dict[str, Any] = {
        "vertices": (
            ("frame", "vertex", "component"),
            recording.field("vertices"),
            {"units": "m", "long_name": "vertices"},
        )
    }
    for field in BLOCK_FIELDS:
        parts = (COMPONENTS[field.parts],) if field.parts else ()
        about = {"long_name": field.meaning, "units": field.unit}
        values = recording.field(field.name)
        variables[field.name] = ("frame", "block", *parts), values, about
    for table in OVER_TIME:
        _add_table(recording, table, variables, coordinates)
    about = {"title": recording.title, "file": recording.name}
    return xarray.Dataset(variables, coordinates, about)


def _add_table(
    recording: Any, table: Any, variables: dict[str, Any], coordinates: dict[str, Any]
) -> None:
    """Add the columns of a table; those of points and bolts have a dimension of their names."""
    names = recording.names_of(table)
    if table.of is not None and not names:
        return
    rows = ROWS[table.per]
    parts = [recording.table(table.name, name).rows for name in names or (None,)]
    clock = f"{rows}_time"
    coordinates.setdefault(clock, (rows, parts[0]["time"], {"units": "s"}))
    things: tuple[str, ...] = ()
    if table.of is not None:
        things = (table.of.name,)
        coordinates[table.of.name] = list(names)
    for column in table.columns:
        # points and blocks both have a displacement
        name = f"{things[0] if things else table.name}_{column.name}"
        values = np.stack([part[column.name] for part in parts], axis=1)
        values = values if things else values[:, 0]
        component: tuple[str, ...] = ()
        if column.parts:
            component = (COMPONENTS[column.parts],)
            coordinates.setdefault(component[0], list(column.parts))
        variables[name] = (rows, *things, *component), values, _about(name, column)


def _about(name: str, column: Column) -> dict[str, Any]:
    """Return name, unit and the words of numbers that have them, by the CF conventions."""
    words = name.replace("_", " ")
    about: dict[str, Any] = {
        "long_name": words if words.endswith(column.meaning) else f"{words}: {column.meaning}",
        "units": column.unit,
    }
    if column.words:
        about["flag_values"] = list(range(len(column.words)))
        about["flag_meanings"] = " ".join(word.replace(" ", "_") for word in column.words)
    return about
