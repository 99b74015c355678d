"""Whether the times of a record are seconds: the evidence of heading and interval against it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from clast.errors import CaseError, shortened
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
LONGEST, SHORTEST, LARGEST = 1e9, 1e-9, 1e12
"""Longest time and shortest interval, s, and largest value, of a record that is believed."""
SLOW, FEW = 1.0, 5
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
        raise CaseError(
            f"the heading says that times are in {unit[1]}",
            where=f"{path}: its heading",
            remedy="give the time in s: convert the first column, and name the column t",
        )
    if COUNTER.fullmatch(parted[0] if len(parted) > 1 else words[0]):
        raise CaseError(
            "the first column counts the values: it is not time",
            where=f"{path}: its heading",
            remedy="give the time in s in the first column, in place of the counter",
        )


def check_sizes(time: Floats, values: Floats, name: str) -> None:
    """Refuse numbers that overflow where a record is integrated or differentiated."""
    shortest = float(np.diff(time).min())
    if float(np.abs(time).max()) > LONGEST or shortest < SHORTEST:
        raise CaseError(
            f"times up to {float(np.abs(time).max()):.3g} s, {shortest:.3g} s apart, cannot be a "
            "record",
            where=name,
            remedy="give the time in s in the first column",
        )
    if float(np.abs(values).max()) > LARGEST:
        raise CaseError(
            f"values of up to {float(np.abs(values).max()):.3g} are far too large",
            where=name,
            remedy="correct the file, its unit or its scale",
        )


def doubted_times(time: Floats, name: str) -> str | None:
    """Return the evidence against times (k,) being seconds: a second or more between them."""
    interval = float(time[-1] - time[0]) / (len(time) - 1)
    if len(time) < FEW or interval < SLOW:
        return None
    counted = "counts the values, or is in ms" if interval == SLOW else "is in ms"
    return (
        f"{shortened(name)} has a value every {interval:g} s, which no record of an earthquake "
        f"has: if its time {counted}, give it in s"
    )
