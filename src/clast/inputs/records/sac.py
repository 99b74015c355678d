"""Records in SAC, the binary layout of seismology, by obspy (extra ``records``)."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError
from clast.inputs.declaring.text import read_bytes
from clast.inputs.records.series import RecordSeries

LAYOUT = "SAC is binary, with a header of 632 bytes; name such a file, or give its format"


def read_sac(path: Path) -> RecordSeries:
    """Return the record in a file; raises CaseError where it is none, or obspy is not installed.

    The first value is at 0 s.  Files do not say in a reliable way which unit they are in.
    """
    name = str(path)
    trace = _trace(read_bytes(path, LAYOUT), name)
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
        raise CaseError(
            "SAC files are read by obspy, which is not installed",
            where=name,
            remedy='install it: pip install "clast[records]"; or write the record as CSV',
        ) from None
    try:
        return SACTrace.read(BytesIO(content))
    # obspy answers damaged files with errors of many kinds
    except Exception as error:
        what = f"is not a SAC file: {type(error).__name__}"
        raise CaseError(what, where=name, remedy=LAYOUT) from None
