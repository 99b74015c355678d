"""Tables of traces, outlines and joint surveys in: CSV with a heading.

| columns | what it is |
| --- | --- |
| x1, y1, x2, y2 [, joint [, set]] | one straight trace a row |
| id [, part], x, y [, joint [, set]] | traces of several points: rows of one id (and part) |
| x, y | an outline: its corners in their order |
| dip, dip_direction [, length] [, joint [, set]] | a joint survey in space, degrees |

Four plain columns need no heading: they are x1, y1, x2, y2.  Columns are parted by commas,
semicolons (numbers may then have decimal commas) or tabs.  Lines that begin with # are ignored.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clast import spelling
from clast.errors import CaseError, mistyped, shortened
from clast.rockmass.drawings.drawing import (
    DEFAULT_JOINT,
    Drawing,
    Floats,
    LeftOut,
    Orientations,
    Polyline,
)
from clast.rockmass.drawings.drawing_files import number_of, text_of
from clast.rockmass.drawings.drawn_loops import Loop, ring, without_repeats

PLAIN = ("x1", "y1", "x2", "y2")
"""Columns of a table without a heading."""
PLAIN_NAME = re.compile(r"[a-z_][a-z0-9_ ]{0,20}")
"""Names of columns, in small letters."""
DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eEdD][+-]?\d+)?")
LARGEST = 1e12
"""Largest coordinate that is believed."""


@dataclass(frozen=True, kw_only=True)
class CsvRow:
    """A row of a table."""

    values: Mapping[str, str]
    """Column -> its text."""
    line: int
    """Its line in the file, from 1."""
    file: str
    decimal_comma: bool

    @property
    def where(self) -> str:
        """Return file and line, for messages."""
        return f"{self.file}: line {self.line}"

    def text(self, column: str, default: str = "") -> str:
        """Return a text, or the default where the column is missing or empty."""
        return self.values.get(column, "").strip() or default

    def number(self, column: str) -> float:
        """Return a finite number, or raise CaseError."""
        written = self.text(column)
        plain = written.replace(",", ".") if self.decimal_comma else written
        value = number_of(plain)
        if value is None:
            what = f"{mistyped(written)} is not a number" if written else "is empty"
            remedy = "write a number such as 12.5"
            raise CaseError(what, where=f"{self.where}, column {column}", remedy=remedy)
        if abs(value) > LARGEST:
            remedy = "give metres and degrees"
            raise CaseError(
                f"{written} is far too large",
                where=f"{self.where}, column {column}",
                remedy=remedy,
            )
        return value


@dataclass(frozen=True, kw_only=True)
class CsvTable:
    """The rows of a file, and the meaning of its columns."""

    file: str
    columns: tuple[str, ...]
    rows: tuple[CsvRow, ...]
    notes: tuple[str, ...]


def read_csv(path: str | Path) -> Drawing:
    """Return the traces, the outline or the joint survey of a CSV file, by its heading.

    Raises CaseError with the line and the column of the fault, and for columns of none of the kinds
    of table.  Columns beside those that are read go to ``left_out``.
    """
    table = table_of(Path(path))
    for kind in KINDS:
        if set(kind.needed) <= set(table.columns):
            return kind.read(table, _left_out(table, kind))
    known = "; ".join(", ".join(kind.needed) for kind in KINDS)
    close = _misspelt(table.columns)
    # The file may be anything: what is not a heading is not repeated.
    plain = len(table.columns) > 1 and all(map(PLAIN_NAME.fullmatch, table.columns))
    named = f"the columns {shortened(', '.join(table.columns), 100)}" if plain else "a heading"
    raise CaseError(
        f"has {named}, from which nothing is read",
        where=f"{table.file}: its heading",
        remedy=f"{close}it needs one of: {known}",
    )


def read_traces(path: str | Path) -> tuple[tuple[Polyline, ...], tuple[str, ...]]:
    """Return the traces of a CSV file, m, and the notes on omissions and changes.

    Raises CaseError where the file is not a table of traces.
    """
    drawing = read_csv(path)
    if not drawing.traces:
        needed = "a heading x1,y1,x2,y2 or id,x,y"
        raise CaseError("has no traces", where=str(path), remedy=f"a table of traces has {needed}")
    return drawing.traces, _notes(drawing)


def _notes(drawing: Drawing) -> tuple[str, ...]:
    """Return the notes on a table: omissions and changes."""
    left = (f"left out: {one.what}, {one.reason}" for one in drawing.left_out)
    return (*drawing.notes, *left)


def read_outline(path: str | Path) -> tuple[Floats, tuple[str, ...]]:
    """Return the outline of a CSV file, m, counter-clockwise, shape (n, 2), and notes on changes.

    Raises CaseError where the file is not an outline, or where it crosses itself.
    """
    drawing = read_csv(path)
    if drawing.boundary is None:
        remedy = "an outline has the heading x,y and a row for each corner"
        raise CaseError("is not an outline", where=str(path), remedy=remedy)
    return drawing.boundary, _notes(drawing)


# The table ---------------------------------------------------------------------------------------


def table_of(path: Path) -> CsvTable:
    """Return the rows of a file by the names of their columns; CaseError where it has none."""
    file, text = str(path), text_of(path)
    numbered = [(k, line) for k, line in enumerate(text.split("\n"), 1) if _says(line)]
    if not numbered:
        raise CaseError("has no rows", where=file, remedy="begin it with a heading: x1,y1,x2,y2")
    separator = next((mark for mark in ("\t", ";", ",") if mark in numbered[0][1]), ",")
    split = [(k, _split(line, separator, file, k)) for k, line in numbered]
    comma = any(DECIMAL_COMMA.fullmatch(cell.strip()) for _, cells in split for cell in cells)
    first = [cell.strip() for cell in split[0][1]]
    columns: Sequence[str] = PLAIN
    if any(number_of(cell.replace(",", ".")) is None for cell in first):
        columns = _heading(first, file, split[0][0])
        split = split[1:]
    elif len(first) != len(PLAIN):
        raise CaseError(
            f"has {len(first)} columns without a heading",
            where=f"{file}: line {split[0][0]}",
            remedy="begin it with a heading, such as x,y or id,x,y; only x1,y1,x2,y2 need none",
        )
    rows = [
        CsvRow(
            values=dict(zip(columns, cells, strict=False)), line=k, file=file, decimal_comma=comma
        )
        for k, cells in split
        if _fits(cells, columns, file, k)
    ]
    if not rows:
        raise CaseError("has a heading but no rows", where=file, remedy="add a row for each line")
    notes = ("decimal commas were read as points",) if comma else ()
    return CsvTable(file=file, columns=tuple(columns), rows=tuple(rows), notes=notes)


def _says(line: str) -> bool:
    return bool(line.strip(" \t;,")) and not line.lstrip().startswith("#")


def _split(line: str, separator: str, file: str, number: int) -> list[str]:
    """Return the cells of a line."""
    try:
        return next(csv.reader([line], delimiter=separator, strict=True))
    except (csv.Error, StopIteration) as error:
        raise CaseError(
            f"cannot be split into columns: {error}",
            where=f"{file}: line {number}",
            remedy="close its quotes",
        ) from None


def _heading(cells: Sequence[str], file: str, number: int) -> list[str]:
    """Return the names of the columns, in small letters, or say which is there twice."""
    names = [re.sub(r"[\s-]+", "_", cell.casefold()) for cell in cells]
    names = [name or f"column_{k}" for k, name in enumerate(names, 1)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise CaseError(
            f"has two columns {shortened(twice)}"
            if PLAIN_NAME.fullmatch(twice)
            else "is not a heading",
            where=f"{file}: line {number}",
            remedy="give each column a name of its own",
        )
    return names


def _fits(cells: Sequence[str], columns: Sequence[str], file: str, number: int) -> bool:
    """Return true, or refuse a row of another length than the heading."""
    extra = [cell for cell in cells[len(columns) :] if cell.strip()]
    if len(cells) < len(columns) or extra:
        raise CaseError(
            f"has {len(cells)} columns instead of {len(columns)}",
            where=f"{file}: line {number}",
            remedy="give each row as many as the heading has, in the order of its columns",
        )
    return True


def _misspelt(columns: Sequence[str]) -> str:
    """Return the known columns that unknown ones may have been meant as."""
    known = {name for kind in KINDS for name in (*kind.needed, *kind.optional)}
    pairs = [(name, spelling.nearest(name, known)) for name in columns if name not in known]
    close = [f"'{shortened(name)}' may be '{near}'" for name, near in pairs if near]
    return f"{'; '.join(close)}; " if close else ""


def _left_out(table: CsvTable, kind: TableKind) -> tuple[LeftOut, ...]:
    """Return the columns that are not read; refuse those that look like one that is."""
    known = (*kind.needed, *kind.optional)
    spare = [name for name in table.columns if name not in known]
    for name in spare:
        near = spelling.nearest(name, kind.optional)
        if near is not None and near not in table.columns:
            raise CaseError(
                f"has a column '{shortened(name)}' that is not known",
                where=f"{table.file}: its heading",
                remedy=f"did you mean '{near}'?",
            )
    return tuple(
        LeftOut(
            what=f"column {shortened(name)}, first value {mistyped(table.rows[0].text(name))}",
            place=f"{table.file}: its heading",
            reason=f"{kind.name} has no such column",
        )
        for name in spare
    )


# The kinds of table ------------------------------------------------------------------------------


def _straight(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    """Return one trace a row."""
    traces: list[Polyline] = []
    dropped = list(left)
    for row in table.rows:
        points = np.array([row.number(name) for name in PLAIN]).reshape(2, 2)
        _keep(points, row, traces, dropped)
    return _drawing(table, traces, dropped)


def _polylines(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    """Return one trace for the rows of an id."""
    groups: dict[tuple[str, str], list[CsvRow]] = {}
    for row in table.rows:
        name = row.text("id")
        if not name:
            remedy = "name the trace of the point"
            raise CaseError("is empty", where=f"{row.where}, column id", remedy=remedy)
        groups.setdefault((name, row.text("part")), []).append(row)
    traces: list[Polyline] = []
    dropped = list(left)
    for (name, _), rows in groups.items():
        joints = {row.text("joint", DEFAULT_JOINT) for row in rows}
        if len(joints) > 1:
            raise CaseError(
                f"the points of {shortened(name)} name the joints {', '.join(sorted(joints))}",
                where=rows[0].where,
                remedy="a trace has one joint",
            )
        points = np.array([(row.number("x"), row.number("y")) for row in rows])
        _keep(points, rows[0], traces, dropped)
    return _drawing(table, traces, dropped)


def _keep(points: Floats, row: CsvRow, traces: list[Polyline], dropped: list[LeftOut]) -> None:
    """Add a trace, or say that it has no length."""
    kept = without_repeats(points, 0.0)
    place = f"line {row.line}"
    if len(kept) < 2:
        what = f"trace at ({points[0, 0]:.6g}, {points[0, 1]:.6g}) m"
        dropped.append(LeftOut(what=what, place=place, reason="it has no length"))
        return
    joint, joint_set = row.text("joint", DEFAULT_JOINT), row.text("set")
    traces.append(Polyline(points=kept, joint=joint, joint_set=joint_set, place=place))


def _drawing(table: CsvTable, traces: list[Polyline], dropped: list[LeftOut]) -> Drawing:
    return Drawing(
        file=table.file, traces=tuple(traces), notes=table.notes, left_out=tuple(dropped)
    )


def _outline(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    """Return the outline; a last corner equal to the first is dropped."""
    points = np.array([(row.number("x"), row.number("y")) for row in table.rows])
    kept = without_repeats(points, 0.0)
    if len(kept) > 1 and (kept[0] == kept[-1]).all():
        kept = kept[:-1]
    place = f"lines {table.rows[0].line} to {table.rows[-1].line}"
    corners, notes = ring(Loop(points=kept, place=place), "the outline", table.file)
    return Drawing(
        file=table.file, boundary=corners, notes=(*table.notes, *notes), left_out=tuple(left)
    )


def _survey(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    """Return the orientations of a joint survey."""
    rows = table.rows
    has_length = "length" in table.columns
    orientations = Orientations(
        dip=np.array([_within(row, "dip", 90.0) for row in rows]),
        dip_direction=np.array([_within(row, "dip_direction", 360.0) % 360.0 for row in rows]),
        length=np.array([_length(row) if has_length else math.nan for row in rows]),
        joint=tuple(row.text("joint", DEFAULT_JOINT) for row in rows),
        joint_set=tuple(row.text("set") for row in rows),
    )
    return Drawing(file=table.file, orientations=orientations, notes=table.notes, left_out=left)


def _within(row: CsvRow, column: str, most: float) -> float:
    value = row.number(column)
    if not 0.0 <= value <= most:
        raise CaseError(
            f"{value:g} is not a valid {column.replace('_', ' ')}",
            where=f"{row.where}, column {column}",
            remedy=f"give degrees from 0 to {most:g}",
        )
    return value


def _length(row: CsvRow) -> float:
    """Return a length above 0, NaN where it is empty."""
    if not row.text("length"):
        return math.nan
    value = row.number("length")
    if value <= 0.0:
        remedy = "give metres, or leave it empty where it was not measured"
        raise CaseError(
            f"{value:g} is not a valid length", where=f"{row.where}, column length", remedy=remedy
        )
    return value


@dataclass(frozen=True, kw_only=True)
class TableKind:
    """A kind of table: its name, its columns, and its reader."""

    name: str
    needed: tuple[str, ...]
    optional: tuple[str, ...]
    read: Callable[[CsvTable, tuple[LeftOut, ...]], Drawing]


KINDS = (
    TableKind(name="a table of traces", needed=PLAIN, optional=("joint", "set"), read=_straight),
    TableKind(
        name="a table of traces",
        needed=("id", "x", "y"),
        optional=("part", "joint", "set"),
        read=_polylines,
    ),
    TableKind(
        name="a joint survey",
        needed=("dip", "dip_direction"),
        optional=("length", "joint", "set"),
        read=_survey,
    ),
    TableKind(name="an outline", needed=("x", "y"), optional=(), read=_outline),
)
