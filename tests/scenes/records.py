"""One short record of acceleration in the layouts of several kinds of files."""

from __future__ import annotations

import numpy as np

from clast.inputs.records.series import STANDARD_GRAVITY

COUNTS = np.round(8000.0 * np.sin(0.37 * np.arange(40)) * np.hanning(40)).astype(int)
GAL = COUNTS * 1000.0 / 8000.0
INTERVAL = 0.01

AT2_HEADING = """\
PEER STRONG MOTION DATABASE RECORD
MADE UP, 01/01/2000, NOWHERE, 000
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=   40, DT=   .0100 SEC,
"""
KNET_HEADING = """\
Origin Time       2000/01/01 00:00:00
Lat.              0.0
Long.             0.0
Depth. (km)       10
Mag.              5.0
Station Code      NONE01
Station Lat.      0.0
Station Long.     0.0
Station Height(m) 1
Record Time       2000/01/01 00:00:15
Sampling Freq(Hz) 100Hz
Duration Time(s)  1
Dir.              N-S
Scale Factor      1000(gal)/8000
Max. Acc. (gal)   900.0
Last Correction   2000/01/01 00:00:00
Memo.
"""


def in_lines(values, a_line, form):
    """Return values in lines of so many."""
    lines = [values[k : k + a_line] for k in range(0, len(values), a_line)]
    return "".join(" ".join(form(value) for value in line) + "\n" for line in lines)


def at2_text(values=GAL * 0.01 / STANDARD_GRAVITY):
    return AT2_HEADING + in_lines(values, 5, lambda value: f"{value:.16E}")


def knet_text(counts=COUNTS):
    return KNET_HEADING + in_lines(counts, 8, lambda count: f"{count:8d}")


def csv_text(values):
    rows = [f"{INTERVAL * k!r},{value!r}" for k, value in enumerate(values.tolist())]
    return "t,a\n" + "\n".join(rows) + "\n"
