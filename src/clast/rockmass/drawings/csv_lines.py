"""Tables of traces, outlines and joint surveys in: CSV with a heading.

| columns | content |
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
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clast import spelling
from clast.errors import CaseError, mistyped, shortened
from clast.model.arrays import Floats
from clast.rockmass.drawings.drawing import DEFAULT_JOINT, Drawing, LeftOut, Orientations, Polyline
from clast.rockmass.drawings.drawing_files import number_of, text_of
from clast.rockmass.drawings.drawn_loops import Loop, ring, without_repeats

PLAIN = ("x1", "y1", "x2", "y2")
"""Columns of a table without a heading."""
PLAIN_NAME = re.compile(r"[a-z_][a-z0-9_ ]{0,20}")
"""Names of columns, in small letters."""
DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eEdD][+-]?\d+)?")


@dataclass(frozen=True, kw_only=True)
class CsvRow:
    """A row of a table."""

    values: Mapping[str, str]
    """Column -> its text."""
    line: int
    """Its line in the file, from 1."""
    file: str
    decimal_comma: bool

    def fault(self, what: str, remedy: str, column: str = "") -> CaseError:
        """Return the error of a fault in it, or in one of its columns."""
        where = f"{self.file}: line {self.line}" + (f", column {column}" if column else "")
        return CaseError(what, where=where, remedy=remedy)

    def text(self, column: str, default: str = "") -> str:
        """Return a text, or the default where the column is missing or empty."""
        return self.values.get(column, "").strip() or default

    def number(self, column: str) -> float:
        """Return a finite number, or raise CaseError."""
        written = self.text(column)
        value = number_of(written.replace(",", ".") if self.decimal_comma else written)
        if value is None:
            what = f"{mistyped(written)} is not a number" if written else "is empty"
            raise self.fault(what, "write a number such as 12.5", column)
        # m, or degrees
        if abs(value) > 1e12:
            raise self.fault(f"{written} is far too large", "give metres and degrees", column)
        return value

    def point(self) -> tuple[float, float]:
        """Return the numbers of its columns x and y."""
        return self.number("x"), self.number("y")


@dataclass(frozen=True, kw_only=True)
class CsvTable:
    """The rows of a file, and the meaning of its columns."""

    file: str
    columns: tuple[str, ...]
    rows: tuple[CsvRow, ...]
    notes: tuple[str, ...]

    @property
    def heading(self) -> str:
        """Return the place of its heading, for messages."""
        return f"{self.file}: its heading"


def read_csv(path: str | Path) -> Drawing:
    """Return the traces, the outline or the joint survey of a CSV file, by its heading.

    Raises CaseError with the line and the column of the fault, and for columns of none of the kinds
    of table.  Columns beside those that are read go to ``left_out``.
    """
    table = table_of(Path(path))
    for kind in KINDS:
        if set(kind.needed) <= set(table.columns):
            return kind.read(table, _left_out(table, kind))
    known = {name for kind in KINDS for name in (*kind.needed, *kind.optional)}
    pairs = [(name, spelling.nearest(name, known)) for name in table.columns if name not in known]
    close = [f"'{shortened(name)}' may be '{near}'; " for name, near in pairs if near]
    # The file may be anything: what is not a heading is not repeated.
    plain = len(table.columns) > 1 and all(map(PLAIN_NAME.fullmatch, table.columns))
    named = f"the columns {shortened(', '.join(table.columns), 100)}" if plain else "a heading"
    raise CaseError(
        f"has {named}, from which nothing is read",
        where=table.heading,
        remedy=f"{''.join(close)}it needs one of: "
        + "; ".join(", ".join(kind.needed) for kind in KINDS),
    )


def read_traces(path: str | Path) -> tuple[tuple[Polyline, ...], tuple[str, ...]]:
    """Return the traces of a CSV file, m, and the notes on omissions and changes.

    Raises CaseError where the file is not a table of traces.
    """
    drawing = read_csv(path)
    if not drawing.traces:
        remedy = "a table of traces has a heading x1,y1,x2,y2 or id,x,y"
        raise CaseError("has no traces", where=str(path), remedy=remedy)
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


def read_points(path: str | Path) -> tuple[Floats, tuple[str, ...]]:
    """Return the points of an open line in a CSV file with the columns x, y, m, (n, 2), and notes.

    Raises CaseError where the file has no such columns.
    """
    table = table_of(Path(path))
    if not {"x", "y"} <= set(table.columns):
        remedy = "a profile has the heading x,y and a row for each point, from side to side"
        raise CaseError("is not a profile", where=table.heading, remedy=remedy)
    return np.array([row.point() for row in table.rows]), table.notes


def table_of(path: Path) -> CsvTable:
    """Return the rows of a file by the names of their columns; CaseError where it has none."""
    file = str(path)
    numbered = [
        (k, line)
        for k, line in enumerate(text_of(path).split("\n"), 1)
        if line.strip(" \t;,") and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise CaseError("has no rows", where=file, remedy="begin it with a heading, such as x,y")
    separator = next((mark for mark in ("\t", ";", ",") if mark in numbered[0][1]), ",")
    split = [(k, _split(line, separator, f"{file}: line {k}")) for k, line in numbered]
    comma = any(DECIMAL_COMMA.fullmatch(cell.strip()) for _, cells in split for cell in cells)
    first, where = [cell.strip() for cell in split[0][1]], f"{file}: line {split[0][0]}"
    columns: Sequence[str] = PLAIN
    if any(number_of(cell.replace(",", ".")) is None for cell in first):
        columns = _heading(first, where)
        split = split[1:]
    elif len(first) != len(PLAIN):
        remedy = "begin it with a heading, such as x,y or id,x,y; only x1,y1,x2,y2 need none"
        raise CaseError(f"has {len(first)} columns without a heading", where=where, remedy=remedy)
    rows = []
    for k, cells in split:
        values = dict(zip(columns, cells, strict=False))
        row = CsvRow(values=values, line=k, file=file, decimal_comma=comma)
        if len(cells) < len(columns) or any(cell.strip() for cell in cells[len(columns) :]):
            remedy = "give each row as many as the heading has, in the order of its columns"
            raise row.fault(f"has {len(cells)} columns instead of {len(columns)}", remedy)
        rows.append(row)
    if not rows:
        raise CaseError("has a heading but no rows", where=file, remedy="add a row for each line")
    notes = ("decimal commas were read as points",) if comma else ()
    return CsvTable(file=file, columns=tuple(columns), rows=tuple(rows), notes=notes)


def _split(line: str, separator: str, where: str) -> list[str]:
    try:
        return next(csv.reader([line], delimiter=separator, strict=True))
    except (csv.Error, StopIteration) as error:
        what = f"cannot be split into columns: {error}"
        raise CaseError(what, where=where, remedy="close its quotes") from None


def _heading(cells: Sequence[str], where: str) -> list[str]:
    """Return the names of the columns, in small letters; CaseError where one is there twice."""
    names = [re.sub(r"[\s-]+", "_", cell.casefold()) for cell in cells]
    names = [name or f"column_{k}" for k, name in enumerate(names, 1)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        plain = PLAIN_NAME.fullmatch(twice)
        what = f"has two columns {shortened(twice)}" if plain else "is not a heading"
        raise CaseError(what, where=where, remedy="give each column a name of its own")
    return names


def _left_out(table: CsvTable, kind: TableKind) -> tuple[LeftOut, ...]:
    """Return the columns that are not read; refuse those that look like one that is."""
    known = (*kind.needed, *kind.optional)
    spare = [name for name in table.columns if name not in known]
    for name in spare:
        near = spelling.nearest(name, kind.optional)
        if near is not None and near not in table.columns:
            what = f"has a column '{shortened(name)}' that is not known"
            raise CaseError(what, where=table.heading, remedy=f"did you mean '{near}'?")
    return tuple(
        LeftOut(
            what=f"column {shortened(name)}, first value {mistyped(table.rows[0].text(name))}",
            place=table.heading,
            reason=f"{kind.name} has no such column",
        )
        for name in spare
    )


def _straight(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    ends = [np.array([row.number(name) for name in PLAIN]).reshape(2, 2) for row in table.rows]
    return _traces(table, left, zip(ends, table.rows, strict=True))


def _polylines(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    groups: dict[tuple[str, str], list[CsvRow]] = {}
    for row in table.rows:
        name = row.text("id")
        if not name:
            raise row.fault("is empty", "name the trace of the point", "id")
        groups.setdefault((name, row.text("part")), []).append(row)
    lines = []
    for (name, _), rows in groups.items():
        joints = {row.text("joint", DEFAULT_JOINT) for row in rows}
        if len(joints) > 1:
            what = f"the points of {shortened(name)} name the joints {', '.join(sorted(joints))}"
            raise rows[0].fault(what, "a trace has one joint")
        lines.append((np.array([row.point() for row in rows]), rows[0]))
    return _traces(table, left, lines)


def _traces(
    table: CsvTable, left: tuple[LeftOut, ...], lines: Iterable[tuple[Floats, CsvRow]]
) -> Drawing:
    """Return lines (n, 2), m, with their first rows as traces; those of no length are left out."""
    traces, dropped = [], list(left)
    for points, row in lines:
        kept, place = without_repeats(points, 0.0), f"line {row.line}"
        if len(kept) < 2:
            what = f"trace at ({points[0, 0]:.6g}, {points[0, 1]:.6g}) m"
            dropped.append(LeftOut(what=what, place=place, reason="it has no length"))
        else:
            joint, joint_set = row.text("joint", DEFAULT_JOINT), row.text("set")
            traces.append(Polyline(points=kept, joint=joint, joint_set=joint_set, place=place))
    return Drawing(
        file=table.file, traces=tuple(traces), notes=table.notes, left_out=tuple(dropped)
    )


def _outline(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    """Return the outline; a last corner equal to the first is dropped."""
    kept = without_repeats(np.array([row.point() for row in table.rows]), 0.0)
    if len(kept) > 1 and (kept[0] == kept[-1]).all():
        kept = kept[:-1]
    place = f"lines {table.rows[0].line} to {table.rows[-1].line}"
    corners, notes = ring(Loop(points=kept, place=place), "the outline", table.file)
    return Drawing(file=table.file, boundary=corners, notes=(*table.notes, *notes), left_out=left)


def _survey(table: CsvTable, left: tuple[LeftOut, ...]) -> Drawing:
    rows = table.rows
    orientations = Orientations(
        dip=np.array([_within(row, "dip", 90.0) for row in rows]),
        dip_direction=np.array([_within(row, "dip_direction", 360.0) % 360.0 for row in rows]),
        length=np.array([_length(row) for row in rows]),
        joint=tuple(row.text("joint", DEFAULT_JOINT) for row in rows),
        joint_set=tuple(row.text("set") for row in rows),
    )
    return Drawing(file=table.file, orientations=orientations, notes=table.notes, left_out=left)


def _within(row: CsvRow, column: str, most: float) -> float:
    value = row.number(column)
    if not 0.0 <= value <= most:
        what = f"{value:g} is not a valid {column.replace('_', ' ')}"
        raise row.fault(what, f"give degrees from 0 to {most:g}", column)
    return value


def _length(row: CsvRow) -> float:
    """Return a length above 0, NaN where it is empty."""
    if not row.text("length"):
        return math.nan
    value = row.number("length")
    if value <= 0.0:
        remedy = "give metres, or leave it empty where it was not measured"
        raise row.fault(f"{value:g} is not a valid length", remedy, "length")
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
