"""Records in the layout of the PEER ground motion database: AT2, and VT2 and DT2 of the same kind.

Lines of heading, the last of which has NPTS and DT, then the values, five a line:

    PEER NGA STRONG MOTION DATABASE RECORD
    event, date, station, component
    ACCELERATION TIME SERIES IN UNITS OF G
    NPTS=   4000, DT=   .0050 SEC,
      .1234567E-02  -.2345678E-03 ...
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.inputs.declaring.text import read_text
from clast.inputs.records.series import UNITS, RecordSeries, number_of, numbers_of
from clast.inputs.records.unit_names import unit_of_heading

HEADING = 12
"""Lines within which NPTS and DT are looked for."""
NUMBER = r"([-+.\dEe]+)"
COUNTED = (
    re.compile(rf"NPTS\s*=\s*{NUMBER}\s*,?\s*DT\s*=\s*{NUMBER}", re.IGNORECASE),
    re.compile(rf"^\s*{NUMBER}\s+{NUMBER}\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
"""How the last line of the heading gives the number of values and the interval, new and old."""
LAYOUT = (
    "AT2 has lines of heading, then e.g. 'NPTS= 4000, DT= .005 SEC', then the values, five a line; "
    'give format = "csv" for columns of numbers'
)
NO_SECONDS = re.compile(
    r"DT\s*=\s*[-+.\dEe]+\s*(MS|MSEC|MILLISEC\w*|MIN|MINUTES?)\b", re.IGNORECASE
)
"""An interval that is not in s."""


def read_at2(path: Path) -> RecordSeries:
    """Return the record in a file; raises CaseError with file, line and remedy.

    The first value is at 0 s.  Quantity and unit are taken from the heading.
    """
    name = str(path)
    lines = read_text(path, "name an AT2 file; its path begins at the case file").splitlines()
    if not any(line.strip() for line in lines):
        raise CaseError("is empty", where=name, remedy=LAYOUT)
    last, counted = _counted(lines, name)
    count, interval = (number_of(word) for word in counted)
    where = f"{name}: line {last + 1}"
    if count is None or count != int(count) or count < 2.0:
        remedy = "NPTS is the number of values, 2 or more"
        raise CaseError(f"NPTS is {counted[0]}", where=where, remedy=remedy)
    if interval is None or interval <= 0.0:
        remedy = "DT is the time between two values, s, above 0"
        raise CaseError(f"DT is {counted[1]}", where=where, remedy=remedy)
    if NO_SECONDS.search(lines[last]):
        remedy = "give DT in s"
        raise CaseError("DT is not in seconds", where=where, remedy=remedy)
    values = numbers_of(
        enumerate(lines[last + 1 :], start=last + 2),
        name,
        "give finite numbers separated by spaces",
    )
    if len(values) != int(count):
        raise CaseError(
            f"NPTS is {int(count)}, but {len(values)} values follow",
            where=where,
            remedy="the file is cut short or was edited: get the original file, or correct NPTS",
        )
    heading = " ".join(lines[: last + 1])
    return RecordSeries(
        name=name,
        format="at2",
        time=interval * np.arange(len(values), dtype=np.float64),
        values=values[:, None],
        quantity=_quantity(heading),
        unit=unit_of_heading(lines[: last + 1]),
    )


def _counted(lines: list[str], name: str) -> tuple[int, tuple[str, str]]:
    """Return the index of the line with NPTS and DT, and the two as they are written."""
    for index, line in enumerate(lines[:HEADING]):
        for pattern in COUNTED:
            found = pattern.search(line)
            if found:
                return index, (found[1], found[2])
    what = "its heading has no line with NPTS and DT"
    raise CaseError(what, where=f"{name}: lines 1 to {min(len(lines), HEADING)}", remedy=LAYOUT)


def _quantity(heading: str) -> str | None:
    """Return the one quantity that a heading names, or None."""
    found = [quantity for quantity in UNITS if quantity in heading.lower()]
    return found[0] if len(found) == 1 else None
