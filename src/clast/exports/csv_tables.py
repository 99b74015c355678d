"""Results as tables that spreadsheets and other programs read: a folder of CSV files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import CaseError, shortened
from clast.exports.targets import check_free, edge_joints, frames_in
from clast.results import Recording
from clast.results.result_tables import PARTS, Columns
from clast.results.schema import FLOW_TABLE, KIND_FIELDS, OVER_TIME, TableSchema
from clast.rockmass.drawings.drawing_files import write_rows

Rows = Iterator[Sequence[Any]]
"""The heading of a table and its rows."""


def write_csv(
    results: Recording,
    folder: Path | str,
    frames: Sequence[int] | None = None,
    tables: Sequence[str] | None = None,
) -> list[Path]:
    """Write tables to CSV files in a folder and return their paths; all frames and all if absent.

    ``blocks``, ``vertices`` and ``contacts`` have a row for each of them in each of the ``frames``;
    ``histories`` and ``bolts`` one for each measured point, or bolt, and instant; ``energy`` and
    ``steps`` one for each instant or step of the run.  Blocks have the mark ``gone`` once they are
    excavated, and the name of the ``stage`` of the frame where the run has stages; ``stages`` and
    ``events`` have a row for each of them.  Units are SI, numbers have every digit.  The folder is
    made if it does not exist.  Tables without rows are left out, or refused where they are named:
    raises CaseError then, and for files that exist already or cannot be written.
    """
    folder = Path(folder)
    if folder.suffix.casefold() == ".csv":
        what = "is not a valid folder name"
        raise CaseError(what, where=str(folder), remedy="leave out the .csv")
    chosen = frames_in(results, frames)
    for name in tables or ():
        if name not in TABLES:
            remedy = spelling.advice(name, TABLES, kind="table")
            raise CaseError(f"there is no table '{shortened(name)}'", where="tables", remedy=remedy)
    lacking = {name: said for name, said in _lacking(results) if name in (tables or TABLES)}
    for name, said in lacking.items():
        if tables:
            raise CaseError(said, where=results.name, remedy=f"leave the table {name} out")
    paths = {name: folder / f"{name}.csv" for name in tables or TABLES if name not in lacking}
    check_free(path for path in paths.values() if folder.is_dir())
    try:
        folder.mkdir(exist_ok=True)
    except (OSError, ValueError) as error:
        what = f"cannot be the folder of tables: {getattr(error, 'strerror', None) or error}"
        remedy = "name a folder; it is made in one that exists and may be written"
        raise CaseError(what, where=str(folder), remedy=remedy) from error
    for name, path in paths.items():
        write_rows(path, TABLES[name](results, chosen))
    return list(paths.values())


def _lacking(results: Recording) -> Iterator[tuple[str, str]]:
    """Yield the tables without rows, with the reason."""
    if not any(len(results.contacts(frame)) for frame in range(len(results.times))):
        yield "contacts", "no contacts are recorded: none carried a force, or they were left out"
    if not len(results.channels.edge):
        yield "channels", FLOW_TABLE.without
    for one in OVER_TIME:
        if one.of is not None and not results.names_of(one):
            yield one.csv or one.name, one.without
    if not results.stages:
        yield "stages", "it has no stages, or did not come to its end"
    if not results.events:
        yield "events", "nothing has happened in it, or it did not come to its end"


IN_BLOCKS = ("block", "name", "rock", "fixed")
"""Columns of the table of blocks beside their fields."""


def _blocks(results: Recording, frames: Sequence[int]) -> Rows:
    fields = [name for name in results.field_names if name not in KIND_FIELDS]
    heads = []
    for name in fields:
        shape = results.field(name, 0).shape
        heads += [name] if len(shape) == 1 else [f"{name}_{part}" for part in PARTS[shape[1]]]
    stages = results.frame_stages
    yield ("frame", "time", *(["stage"] if stages else []), *IN_BLOCKS, *heads)
    rocks = [results.rock_name[k] for k in results.field("rock", 0)]
    names, fixed = results.block_name, results.fixed.astype(int).tolist()
    for frame in frames:
        when = (frame, float(results.times[frame]), *stages[frame : frame + 1])
        values = np.column_stack([results.field(name, frame) for name in fields]).tolist()
        for block, row in enumerate(values):
            yield (*when, block, names[block], rocks[block], fixed[block], *row)


def _vertices(results: Recording, frames: Sequence[int]) -> Rows:
    joint = edge_joints(results)
    yield ("frame", "time", "block", "vertex", "x", "y", "joint")
    start = results.block_start
    owner = np.repeat(np.arange(len(start) - 1), np.diff(start)).tolist()
    for frame in frames:
        time = float(results.times[frame])
        for vertex, (x, y) in enumerate(results.vertices(frame).tolist()):
            yield (frame, time, owner[vertex], vertex, x, y, joint[vertex])


def _contacts(results: Recording, frames: Sequence[int]) -> Rows:
    yield ("frame", "time", *results.contacts(frames[0]))
    for frame in frames:
        columns = {name: values.tolist() for name, values in results.contacts(frame).items()}
        if "joint" in columns:
            names = results.joint_name
            columns["joint"] = [names[k] for k in columns["joint"]]
        yield from _with(columns.values(), frame, float(results.times[frame]))


def _channels(results: Recording, frames: Sequence[int]) -> Rows:
    yield ("frame", "time", *results.flow(frames[0]))
    for frame in frames:
        columns = [values.tolist() for values in results.flow(frame).values()]
        yield from _with(columns, frame, float(results.times[frame]))


def _over_time(table: TableSchema) -> Callable[[Recording, Sequence[int]], Rows]:
    """Return the function that gives the rows of a table with a row per instant or step."""

    def given(results: Recording, frames: Sequence[int]) -> Rows:
        if table.of is None:
            columns = results.table(table.name)
            yield tuple(columns)
            yield from _with(_lists(columns))
            return
        for number, name in enumerate(results.names_of(table)):
            columns = results.table(table.name, name)
            if number == 0:
                yield (table.of.name, *columns)
            yield from _with(_lists(columns), name)

    return given


def _lists(columns: Columns) -> Iterator[Sequence[Any]]:
    """Give the columns of a table, those in words that have words."""
    return (values.tolist() for values in columns.in_words().values())


def _stages(results: Recording, frames: Sequence[int]) -> Rows:
    columns = ("name", "start", "end", "steps", "outcome", "force_ratio", "seconds")
    yield (*columns, "mover", "mover_speed", "mover_direction")
    for one in results.stages:
        mover = one.mover
        numbers = (getattr(one, name) for name in columns)
        yield (*numbers, mover.block, mover.speed, mover.direction)


def _events(results: Recording, frames: Sequence[int]) -> Rows:
    names = ("time", "stage", "kind", "what", "text")
    yield names
    for one in results.events:
        yield tuple(getattr(one, name) for name in names)


def _with(columns: Iterable[Sequence[Any]], *before: Any) -> Rows:
    """Give the rows of columns of equal length, behind something that all of them have."""
    for row in zip(*columns, strict=True):
        yield (*before, *row)


OF_THINGS = tuple(one for one in reversed(OVER_TIME) if one.of is not None)
"""Tables of measured points, of bolts: before those of the whole run."""
TABLES: dict[str, Callable[[Recording, Sequence[int]], Rows]] = {
    "blocks": _blocks,
    "vertices": _vertices,
    "contacts": _contacts,
    "channels": _channels,
    **{one.csv or one.name: _over_time(one) for one in OF_THINGS},
    **{one.csv or one.name: _over_time(one) for one in OVER_TIME if one.of is None},
    "stages": _stages,
    "events": _events,
}
"""Name of a table, and of its file -> who gives its rows."""
