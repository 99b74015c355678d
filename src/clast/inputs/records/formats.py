"""Formats of records, and their readers: PEER's AT2, K-NET, SAC, and columns."""

from __future__ import annotations

import re
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.inputs.declaring.text import read_bytes, read_text
from clast.inputs.records.columns import BESIDE, read_csv
from clast.inputs.records.series import UNITS, RecordSeries, number_of, numbers_of, unit_of_heading

AT2_HEADING_LINES_MAX = 12
"""Lines within which NPTS and DT are looked for."""
NUMBER = r"([-+.\dEe]+)"
COUNTED = (
    re.compile(rf"NPTS\s*=\s*{NUMBER}\s*,?\s*DT\s*=\s*{NUMBER}", re.IGNORECASE),
    re.compile(rf"^\s*{NUMBER}\s+{NUMBER}\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
"""How the last line of the heading gives the number of values and the interval, new and old."""
AT2_LAYOUT = (
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
        raise CaseError("is empty", where=name, remedy=AT2_LAYOUT)
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
        raise CaseError("DT is not in seconds", where=where, remedy="give DT in s")
    values = numbers_of(
        enumerate(lines[last + 1 :], start=last + 2),
        name,
        "give finite numbers separated by spaces",
    )
    if len(values) != int(count):
        what = f"NPTS is {int(count)}, but {len(values)} values follow"
        remedy = "the file is cut short or was edited: get the original file, or correct NPTS"
        raise CaseError(what, where=where, remedy=remedy)
    heading = " ".join(lines[: last + 1]).lower()
    named = [quantity for quantity in UNITS if quantity in heading]
    return RecordSeries(
        name=name,
        format="at2",
        time=interval * np.arange(len(values), dtype=np.float64),
        values=values[:, None],
        quantity=named[0] if len(named) == 1 else None,
        unit=unit_of_heading(lines[: last + 1]),
    )


def _counted(lines: list[str], name: str) -> tuple[int, tuple[str, str]]:
    """Return the index of the line with NPTS and DT, and the two as they are written."""
    for index, line in enumerate(lines[:AT2_HEADING_LINES_MAX]):
        for pattern in COUNTED:
            match = pattern.search(line)
            if match:
                return index, (match[1], match[2])
    raise CaseError(
        "its heading has no line with NPTS and DT",
        where=f"{name}: lines 1 to {min(len(lines), AT2_HEADING_LINES_MAX)}",
        remedy=AT2_LAYOUT,
    )


KNET_HEADING_LINES = 17
"""Lines of the heading."""
FREQUENCY, DURATION, SCALE, LAST = 11, 12, 14, 17
"""Lines of the heading that are read, counted from 1."""
BEGINNINGS = {
    FREQUENCY: "Sampling Freq",
    DURATION: "Duration Time",
    SCALE: "Scale Factor",
    LAST: "Memo",
}
"""Line of the heading -> how it begins."""
KNET_LAYOUT = (
    "K-NET has 17 lines of heading, from 'Origin Time' to 'Memo.', then counts, eight a line"
)


def read_knet(path: Path) -> RecordSeries:
    """Return the record in a file, acceleration in gal; raises CaseError with file, line, remedy.

    The first value is at 0 s.  Acceleration is count x numerator / denominator of the line 'Scale
    Factor 3920(gal)/6182761', with the offset of the instrument.  The number of counts must be that
    of duration and frequency, to within the second to which the duration is rounded.
    """
    name = str(path)
    lines = read_text(path, "name a K-NET file; its path begins at the case file").splitlines()
    if not any(line.strip() for line in lines):
        raise CaseError("is empty", where=name, remedy=KNET_LAYOUT)
    for number, beginning in BEGINNINGS.items():
        line = lines[number - 1] if number <= len(lines) else ""
        if not line.startswith(beginning):
            what = f"does not begin with '{beginning}'"
            raise CaseError(what, where=f"{name}: line {number}", remedy=KNET_LAYOUT)

    def given(number: int, pattern: str, example: str) -> float:
        """Return the positive number that a pattern finds in a line of the heading."""
        match = re.search(pattern, lines[number - 1], re.IGNORECASE)
        value = number_of(match[1]) if match else None
        if value is None or value <= 0.0:
            where, remedy = f"{name}: line {number}", f"the line reads e.g. '{example}'"
            raise CaseError("is not valid on this line", where=where, remedy=remedy)
        return value

    frequency = given(FREQUENCY, rf"\s{NUMBER}\s*Hz", "Sampling Freq(Hz) 100Hz")
    duration = given(DURATION, rf"\s{NUMBER}\s*$", "Duration Time(s) 60")
    example = "Scale Factor 3920(gal)/6182761"
    scale = given(SCALE, rf"\s{NUMBER}\s*\(gal\)", example)
    scale /= given(SCALE, rf"\(gal\)\s*/\s*{NUMBER}", example)
    remedy = "give whole counts separated by spaces"
    counts = numbers_of(
        enumerate(lines[KNET_HEADING_LINES:], start=KNET_HEADING_LINES + 1), name, remedy
    )
    if len(counts) < 2 or abs(len(counts) - frequency * duration) >= frequency:
        what = (
            f"{duration:g} s at {frequency:g} Hz are {frequency * duration:g} values, but "
            f"{len(counts)} follow"
        )
        remedy = (
            "the file is cut short or was edited: get the original file, or correct the duration"
        )
        raise CaseError(what, where=f"{name}: line {DURATION}", remedy=remedy)
    return RecordSeries(
        name=name,
        format="k-net",
        time=np.arange(len(counts)) / frequency,
        values=scale * counts[:, None],
        quantity="acceleration",
        unit="gal",
    )


SAC_LAYOUT = "SAC is binary, with a header of 632 bytes; name such a file, or give its format"


def read_sac(path: Path) -> RecordSeries:
    """Return the record in a file; raises CaseError where it is none, or obspy is not installed.

    The first value is at 0 s.  Files do not reliably say which unit they are in.
    """
    name = str(path)
    trace = _trace(read_bytes(path, SAC_LAYOUT), name)
    if trace.leven is not None and not trace.leven:
        remedy = "resample it at equal intervals"
        raise CaseError("has a changing interval", where=name, remedy=remedy)
    values = np.asarray(trace.data, np.float64)
    interval = float(trace.delta) if trace.delta is not None else 0.0
    if values.ndim != 1 or len(values) < 2 or not interval > 0.0:
        what = f"has {values.size} values every {interval:g} s"
        raise CaseError(what, where=name, remedy="give a record of 2 values or more")
    if not np.isfinite(values).all():
        first = int(np.flatnonzero(~np.isfinite(values))[0])
        what = f"value {first + 1} is not finite"
        raise CaseError(what, where=name, remedy="fill the gap, or cut the record before it")
    return RecordSeries(
        name=name,
        format="sac",
        # the header holds the interval in single precision: 0.01 s is 0.00999999978
        time=float(np.format_float_positional(np.float32(interval)))
        * np.arange(len(values), dtype=np.float64),
        values=values[:, None],
    )


def _trace(content: bytes, name: str) -> Any:
    """Return the trace that obspy reads."""
    try:
        from obspy.io.sac import SACTrace
    except ImportError:
        what = "SAC files are read by obspy, which is not installed"
        remedy = 'install it: pip install "clast[records]"; or write the record as CSV'
        raise CaseError(what, where=name, remedy=remedy) from None
    try:
        return SACTrace.read(BytesIO(content))
    # obspy answers damaged files with errors of many kinds
    except Exception as error:
        what = f"is not a SAC file: {type(error).__name__}"
        raise CaseError(what, where=name, remedy=SAC_LAYOUT) from None


READERS: dict[str, Callable[[Path], RecordSeries]] = {
    "csv": read_csv,
    "at2": read_at2,
    "k-net": read_knet,
    "sac": read_sac,
}
"""Format -> its reader."""
ENDINGS = {
    ".csv": "csv",
    ".at2": "at2",
    ".vt2": "at2",
    ".dt2": "at2",
    ".sac": "sac",
    **{f".{side}{level}": "k-net" for side in ("ns", "ew", "ud") for level in ("", "1", "2")},
}
"""Ending of a file's name, in small letters -> format."""


def format_of(path: Path) -> str:
    """Return the format of a file by its ending, else by how its text begins; csv if by neither."""
    known = ENDINGS.get(path.suffix.lower())
    if known is not None:
        return known
    text = read_text(path, BESIDE)
    if re.match(r"\s*Origin Time", text):
        return "k-net"
    return (
        "at2"
        if any("NPTS" in line.upper() for line in text.splitlines()[:AT2_HEADING_LINES_MAX])
        else "csv"
    )
