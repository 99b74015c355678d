"""Which format a record has, and who reads it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from clast.inputs.declaring.text import read_text
from clast.inputs.records.at2 import read_at2
from clast.inputs.records.columns import BESIDE
from clast.inputs.records.csv import read_csv
from clast.inputs.records.knet import is_knet, read_knet
from clast.inputs.records.sac import read_sac
from clast.inputs.records.series import RecordSeries

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
HEADING = 12
"""Lines within which AT2 names NPTS."""


def format_of(path: Path) -> str:
    """Return the format of a file by its ending, else by how its text begins; csv if by neither.

    Raises CaseError where a file of unknown ending cannot be read as text.
    """
    known = ENDINGS.get(path.suffix.lower())
    if known is not None:
        return known
    text = read_text(path, BESIDE)
    if is_knet(text):
        return "k-net"
    return "at2" if any("NPTS" in line.upper() for line in text.splitlines()[:HEADING]) else "csv"
