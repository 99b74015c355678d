"""Accelerograms from text files: two or three columns, t, ax and ay, with or without a heading."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clast.errors import CaseError, mistyped
from clast.inputs.declaring.text import read_text
from clast.inputs.records.instants import check_heading
from clast.model.model import Floats, Ints

SEPARATOR = re.compile(r"[,;\s]+")
"""Columns are separated by commas, semicolons or blanks."""
REMEDY = "give lines of two or three numbers: time in s, acceleration x, acceleration y"
BESIDE = "name a text file of numbers; its path begins at the folder of the case file"
UNITS = {
    r"(?<![a-z0-9])g(?![a-z0-9])": ("g", 9.81),
    r"(?<![a-z])gals?(?![a-z])|\bcm/s|\bcm s-": ("cm/s2", 0.01),
    r"\bmm/s": ("mm/s2", 0.001),
    r"(?<![a-z])m/s|\bm s-": ("m/s2", 1.0),
}
"""How headings name the unit of acceleration -> the unit, and its size in m/s2."""


@dataclass(frozen=True, kw_only=True)
class Record:
    """An accelerogram as it stands in a file."""

    time: Floats
    """Instants, shape (k,)."""
    acceleration: Floats
    """Acceleration (x, y), shape (k, 2)."""
    columns: int
    """Columns of the file, 2 or 3; without the third there is no acceleration y."""
    lines: Ints
    """Line of the file, from 1, of each instant, shape (k,)."""
    unit: tuple[str, float] | None
    """Unit of acceleration that the heading names and its size in m/s2, or None."""


def read_record(path: Path) -> Record:
    """Return the accelerogram in a file.

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
        if row is None and not rows and not _looks_like_numbers(words):
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
    table = np.array(rows)
    acceleration = np.zeros((len(table), 2))
    acceleration[:, : table.shape[1] - 1] = table[:, 1:]
    return Record(
        time=np.ascontiguousarray(table[:, 0]),
        acceleration=acceleration,
        columns=table.shape[1],
        lines=np.array(lines),
        unit=_unit(" ".join(heading)),
    )


def _unit(heading: str) -> tuple[str, float] | None:
    """Return the one unit of acceleration that a heading names and its size in m/s2, or None."""
    named = [unit for pattern, unit in UNITS.items() if re.search(pattern, heading.lower())]
    return named[0] if len(named) == 1 else None


def _numbers(words: list[str]) -> list[float] | None:
    """Return words as finite numbers, or None where one is none."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return None
    return numbers if all(map(math.isfinite, numbers)) else None


def _looks_like_numbers(words: list[str]) -> bool:
    """Return whether a line is rather a row with a slip than a heading."""
    return 2 * sum(word[:1] in "+-.0123456789" for word in words) >= len(words)
