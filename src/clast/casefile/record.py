"""Accelerograms from text files: two or three columns, t, ax and ay, with or without a heading."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from clast.casefile.text import read_text
from clast.errors import CaseError
from clast.model import Floats

SEPARATOR = re.compile(r"[,;\s]+")
"""Columns are separated by commas, semicolons or blanks."""
REMEDY = "give lines of two or three numbers: time in s, acceleration x, acceleration y"


def read_record(path: Path) -> tuple[Floats, Floats]:
    """Return time (k,) and acceleration (k, 2) of an accelerogram as they stand in a file.

    Empty lines and those that begin with # are left out, and so is a heading.  Raises CaseError
    naming the line.
    """
    rows: list[list[float]] = []
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        words = SEPARATOR.split(line.strip(" \t,;\ufeff"))
        if words == [""] or words[0].startswith("#"):
            continue
        row = _numbers(words)
        if row is None and not rows:
            continue  # a heading
        columns = len(rows[0]) if rows else 0
        if row is None or len(row) not in (2, 3) or (columns and len(row) != columns):
            raise CaseError(
                f"'{line.strip()}' is no line of an accelerogram",
                where=f"{path}: line {number}",
                remedy=REMEDY,
            )
        rows.append(row)
    if not rows:
        raise CaseError("holds no numbers", where=str(path), remedy=REMEDY)
    table = np.array(rows)
    acceleration = np.zeros((len(table), 2))
    acceleration[:, : table.shape[1] - 1] = table[:, 1:]
    return np.ascontiguousarray(table[:, 0]), acceleration


def _numbers(words: list[str]) -> list[float] | None:
    """Return words as numbers, or None where one is none."""
    try:
        return [float(word) for word in words]
    except ValueError:
        return None
