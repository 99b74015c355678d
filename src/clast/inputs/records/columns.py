"""Records as columns of numbers: time and one or two components, with or without a heading."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import cast

import numpy as np

from clast.errors import CaseError, mistyped, shortened
from clast.inputs.declaring.text import read_text
from clast.inputs.records.series import RecordSeries, number_of
from clast.model.model import Floats

OTHER_TIME = re.compile(
    r"(?<![a-z])(ms|msecs?|millisec\w*|us|usecs?|\u00b5s|\u03bcs|microsec\w*|min|mins|minutes?|hours?)"
    r"(?![a-z])"
)
"""Units of time that are not seconds."""
COUNTER = re.compile(
    r"\W*(index|idx|no|nr|n|i|k|id|samples?|sample[ _]?(no|nr|number|index)|steps?|points?|rows?|"
    r"count|counter|number)\W*"
)
"""Names of a column that counts the values."""
TIME_S_MAX, INTERVAL_S_MIN, VALUE_MAX = 1e9, 1e-9, 1e12
"""Longest time and shortest interval, s, and largest value, of a record that is believed."""
QUAKE_INTERVAL_S_MAX, INSTANTS_DOUBTED_MIN = 1.0, 5
"""So many instants a second or more apart, s, are seconds in no record of an earthquake."""


def check_heading(heading: Sequence[str], path: Path) -> None:
    """Refuse a record whose heading says that its first column is not the time in seconds."""
    said = [line.strip(" \t#\ufeff").lower() for line in heading if line.strip(" \t#\ufeff")]
    if not said:
        return
    parted = re.split(r"[,;\t]", said[-1])
    words = said[-1].split()
    first = parted[0] if len(parted) > 1 else said[-1]
    unit = OTHER_TIME.search(first.replace("_", " "))
    if unit:
        what = f"the heading says that times are in {unit[1]}"
        remedy = "give the time in s: convert the first column, and name the column t"
        raise CaseError(what, where=f"{path}: its heading", remedy=remedy)
    if COUNTER.fullmatch(parted[0] if len(parted) > 1 else words[0]):
        what = "the first column counts the values: it is not time"
        remedy = "give the time in s in the first column, in place of the counter"
        raise CaseError(what, where=f"{path}: its heading", remedy=remedy)


def check_sizes(time: Floats, values: Floats, name: str) -> None:
    """Refuse numbers that overflow where a record is integrated or differentiated."""
    shortest = float(np.diff(time).min())
    if float(np.abs(time).max()) > TIME_S_MAX or shortest < INTERVAL_S_MIN:
        what = (
            f"times up to {float(np.abs(time).max()):.3g} s, {shortest:.3g} s apart, cannot be a "
            "record"
        )
        raise CaseError(what, where=name, remedy="give the time in s in the first column")
    if float(np.abs(values).max()) > VALUE_MAX:
        what = f"values of up to {float(np.abs(values).max()):.3g} are far too large"
        raise CaseError(what, where=name, remedy="correct the file, its unit or its scale")


def doubted_times(time: Floats, name: str) -> str | None:
    """Return the evidence against times (k,) being seconds: a second or more between them."""
    interval = float(time[-1] - time[0]) / (len(time) - 1)
    if len(time) < INSTANTS_DOUBTED_MIN or interval < QUAKE_INTERVAL_S_MAX:
        return None
    counted = "counts the values, or is in ms" if interval == QUAKE_INTERVAL_S_MAX else "is in ms"
    return (
        f"{shortened(name)} has a value every {interval:g} s, which no record of an earthquake "
        f"has: if its time {counted}, give it in s"
    )


SEPARATOR = re.compile(r"[,;\s]+")
"""Columns are separated by commas, semicolons or blanks."""
REMEDY = "give lines of two or three numbers: time in s, acceleration x, acceleration y"
BESIDE = "name a text file of numbers; its path begins at the folder of the case file"
UNITS_IN_HEADINGS = {
    r"(?<![a-z0-9])g(?![a-z0-9])": ("g", 9.81),
    r"(?<![a-z])gals?(?![a-z])|\bcm/s|\bcm s-": ("cm/s2", 0.01),
    r"\bmm/s": ("mm/s2", 0.001),
    r"(?<![a-z])m/s|\bm s-": ("m/s2", 1.0),
}
"""How headings name the unit of acceleration -> the unit, and its size in m/s2."""


def read_record(path: Path) -> RecordSeries:
    """Return the record in a file of two or three columns, at instants of any interval.

    Empty lines and those that begin with # are left out, and so is a heading.  Raises CaseError
    naming the line.
    """
    rows: list[list[float]] = []
    lines: list[int] = []
    heading: list[str] = []
    for number, line in enumerate(read_text(path, BESIDE).splitlines(), start=1):
        words = SEPARATOR.split(line.strip(" \t,;\ufeff"))
        if words == [""] or words[0].startswith("#"):
            heading.append(line if not rows else "")
            continue
        row = _numbers(words)
        # rather a heading than a row with a slip
        wordy = 2 * sum(word[:1] in "+-.0123456789" for word in words) < len(words)
        if row is None and not rows and wordy:
            heading.append(line)
            continue
        columns = len(rows[0]) if rows else 0
        commas = "," in line.strip(" ,;") and re.search(r"[;\t]", line.strip(" \t,;"))
        if row is None or len(row) not in (2, 3) or (columns and len(row) != columns) or commas:
            raise CaseError(
                f"{mistyped(line.strip())} is not a line of an accelerogram",
                where=f"{path}: line {number}",
                remedy=REMEDY
                + ("; write decimals with a point" if commas else "; begin headings with #"),
            )
        rows.append(row)
        lines.append(number)
    check_heading(heading, path)
    if not rows:
        raise CaseError("holds no numbers", where=str(path), remedy=REMEDY)
    table, said = np.array(rows), " ".join(heading).lower()
    named = [unit for pattern, unit in UNITS_IN_HEADINGS.items() if re.search(pattern, said)]
    record = RecordSeries(
        name=str(path),
        format="csv",
        time=np.ascontiguousarray(table[:, 0]),
        values=table[:, 1:],
        guess=named[0] if len(named) == 1 else None,
        lines=np.array(lines),
    )
    _check_rising(record)
    return record


def _numbers(words: list[str]) -> list[float] | None:
    """Return words as finite numbers, or None where one is none."""
    numbers = [number_of(word) for word in words]
    return None if None in numbers else cast(list[float], numbers)


def read_csv(path: Path) -> RecordSeries:
    """Return the record in a file of two or three columns; raises CaseError with file and line."""
    record = read_record(path)
    interval = np.diff(record.time)
    usual = float(np.sort(interval)[(len(interval) - 1) // 2])
    # Share of the interval by which instants may be off: times are rounded where they are printed
    for gap in np.flatnonzero(np.abs(interval - usual) > 0.1 * usual)[:1]:
        raise CaseError(
            f"{interval[gap]:g} s lie before {record.time[gap + 1]:g} s, but {usual:g} s between "
            "most instants",
            where=f"{path}: line {record.lines[gap + 1]}",
            remedy="fill the gap, or give the record at equal intervals",
        )
    return record


def _check_rising(record: RecordSeries) -> None:
    """Refuse instants that are not later than those before, by their line."""
    if len(record.time) < 2:
        remedy = "a record has at least 2 instants"
        raise CaseError("has only one line of numbers", where=record.name, remedy=remedy)
    for late in np.flatnonzero(np.diff(record.time) <= 0.0)[:1]:
        raise CaseError(
            f"time does not rise: {record.time[late + 1]:g} s comes after {record.time[late]:g} s",
            where=f"{record.name}: line {record.lines[late + 1]}",
            remedy="order the lines by time, each instant once; time is the first column",
        )
