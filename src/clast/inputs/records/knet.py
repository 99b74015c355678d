"""Records in the layout of K-NET and KiK-net: 17 lines of heading, then counts, eight a line.

Acceleration is count x numerator / denominator of the line 'Scale Factor 3920(gal)/6182761'.  The
counts are as the instrument gave them, with its offset: no base line is corrected here.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.inputs.declaring.text import read_text
from clast.inputs.records.series import RecordSeries, header_number, numbers_of

HEADING = 17
"""Lines of the heading."""
NUMBER = r"([-+.\dEe]+)"
FREQUENCY, DURATION, SCALE, LAST = 11, 12, 14, 17
"""Lines of the heading that are read, counted from 1."""
BEGINNINGS = {
    FREQUENCY: "Sampling Freq",
    DURATION: "Duration Time",
    SCALE: "Scale Factor",
    LAST: "Memo",
}
"""Line of the heading -> how it begins."""
LAYOUT = "K-NET has 17 lines of heading, from 'Origin Time' to 'Memo.', then counts, eight a line"


def read_knet(path: Path) -> RecordSeries:
    """Return the record in a file, acceleration in gal; raises CaseError with file, line, remedy.

    The first value is at 0 s.  The number of counts must be that of duration and frequency, to
    within the second to which the duration is rounded.
    """
    name = str(path)
    lines = read_text(path, "name a K-NET file; its path begins at the case file").splitlines()
    if not any(line.strip() for line in lines):
        raise CaseError("is empty", where=name, remedy=LAYOUT)
    for number, beginning in BEGINNINGS.items():
        line = lines[number - 1] if number <= len(lines) else ""
        if not line.startswith(beginning):
            what = f"does not begin with '{beginning}'"
            raise CaseError(what, where=f"{name}: line {number}", remedy=LAYOUT)

    def given(number: int, pattern: str, example: str) -> float:
        remedy = f"the line reads e.g. '{example}'"
        return header_number(pattern, lines[number - 1], f"{name}: line {number}", remedy)

    frequency = given(FREQUENCY, rf"\s{NUMBER}\s*Hz", "Sampling Freq(Hz) 100Hz")
    duration = given(DURATION, rf"\s{NUMBER}\s*$", "Duration Time(s) 60")
    example = "Scale Factor 3920(gal)/6182761"
    scale = given(SCALE, rf"\s{NUMBER}\s*\(gal\)", example)
    scale /= given(SCALE, rf"\(gal\)\s*/\s*{NUMBER}", example)
    remedy = "give whole counts separated by spaces"
    counts = numbers_of(enumerate(lines[HEADING:], start=HEADING + 1), name, remedy)
    if len(counts) < 2 or abs(len(counts) - frequency * duration) >= frequency:
        raise CaseError(
            f"{duration:g} s at {frequency:g} Hz are {frequency * duration:g} values, but "
            f"{len(counts)} follow",
            where=f"{name}: line {DURATION}",
            remedy=(
                "the file is cut short or was edited: get the original file, or correct the "
                "duration"
            ),
        )
    return RecordSeries(
        name=name,
        format="k-net",
        time=np.arange(len(counts)) / frequency,
        values=scale * counts[:, None],
        quantity="acceleration",
        unit="gal",
    )


def is_knet(text: str) -> bool:
    """Return whether a text begins as the files of K-NET do."""
    return re.match(r"\s*Origin Time", text) is not None
