"""Records as columns: time and one or two components, in a unit that the case file gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.inputs.records.columns import Record, read_record
from clast.inputs.records.series import RecordSeries

UNEVEN = 0.1
"""Share of the interval by which instants may be off: times are rounded where they are printed."""


def read_csv(path: Path) -> RecordSeries:
    """Return the record in a file of two or three columns; raises CaseError with file and line.

    Instants must rise by the same interval.
    """
    record = read_record(path)
    check_rising(record, path)
    _check_even(record, path)
    return RecordSeries(
        name=str(path),
        format="csv",
        time=record.time,
        values=record.acceleration[:, : record.columns - 1],
        guess=record.unit,
    )


def check_rising(record: Record, path: Path) -> None:
    """Refuse instants that are not later than those before, by their line."""
    if len(record.time) < 2:
        remedy = "a record has at least 2 instants"
        raise CaseError("has only one line of numbers", where=str(path), remedy=remedy)
    for late in np.flatnonzero(np.diff(record.time) <= 0.0)[:1]:
        raise CaseError(
            f"time does not rise: {record.time[late + 1]:g} s comes after {record.time[late]:g} s",
            where=f"{path}: line {record.lines[late + 1]}",
            remedy="order the lines by time, each instant once; time is the first column",
        )


def _check_even(record: Record, path: Path) -> None:
    """Refuse gaps: intervals that are not all the same, by the line after the first of them."""
    interval = np.diff(record.time)
    usual = float(np.sort(interval)[(len(interval) - 1) // 2])
    for gap in np.flatnonzero(np.abs(interval - usual) > UNEVEN * usual)[:1]:
        raise CaseError(
            f"{interval[gap]:g} s lie before {record.time[gap + 1]:g} s, but {usual:g} s between "
            "most instants",
            where=f"{path}: line {record.lines[gap + 1]}",
            remedy="fill the gap, or give the record at equal intervals",
        )
