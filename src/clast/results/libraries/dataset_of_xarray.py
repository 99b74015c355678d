"""A recording as an xarray.Dataset."""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.results.libraries.optional_libraries import library
from clast.results.schema import BLOCK_FIELDS, LINK, OVER_TIME, PLANE, TENSOR, Column, Per

COMPONENTS = {PLANE: "component", TENSOR: "stress_component", LINK: "link_component"}
"""Dimension of vectors, of stresses and of forces of links."""
ROWS = {Per.INSTANT: "instant", Per.STEP: "step_number"}
"""Dimension of the rows of a table."""


def to_xarray(recording: Any) -> Any:
    """Return fields and histories of a recording; see ``Recording.to_xarray``."""
    xarray = library("xarray")
    coordinates: dict[str, Any] = {
        "time": ("frame", recording.times, {"units": "s"}),
        "block": list(recording.block_name),
        "component": list(PLANE),
        "stress_component": list(TENSOR),
        "vertex_block": ("vertex", _owners(recording)),
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
        if field.name in recording.field_names:
            parts = (COMPONENTS[field.parts],) if field.parts else ()
            dimensions = ("frame", "block", *parts)
            about = {"long_name": field.meaning, "units": field.unit}
            variables[field.name] = dimensions, recording.field(field.name), about
    for table in OVER_TIME:
        if not recording.lacks(table):
            _add_table(recording, table, variables, coordinates)
    about = {"title": recording.title, "file": recording.name}
    return xarray.Dataset(variables, coordinates, about)


def _owners(recording: Any) -> list[str]:
    """Return the name of the block of each vertex."""
    names = np.asarray(recording.block_name, object)
    return list(np.repeat(names, np.diff(recording.block_start)))


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
    said = name.replace("_", " ")
    known = said.endswith(column.meaning)
    about: dict[str, Any] = {
        "long_name": said if known else f"{said}: {column.meaning}",
        "units": column.unit,
    }
    if column.words:
        about["flag_values"] = list(range(len(column.words)))
        about["flag_meanings"] = " ".join(word.replace(" ", "_") for word in column.words)
    return about
