"""A record as it stands in its file, and the units of records as headings write them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from clast.errors import CaseError, mistyped
from clast.model.model import Floats, Ints

STANDARD_GRAVITY = 9.80665
"""The unit of records in g, m/s2 (CGPM 1901)."""
UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"m/s2": 1.0, "g": STANDARD_GRAVITY, "cm/s2": 0.01, "gal": 0.01, "mm/s2": 1e-3},
    "velocity": {"m/s": 1.0, "cm/s": 0.01, "mm/s": 1e-3},
    "displacement": {"m": 1.0, "cm": 0.01, "mm": 1e-3},
}
"""Quantity -> unit -> its size in SI."""


@dataclass(frozen=True, kw_only=True)
class RecordSeries:
    """A record of ground motion as its file has it."""

    name: str
    """The file, as messages name it."""
    format: str
    """Name of the format: csv, at2, k-net, sac."""
    time: Floats
    """Instants, s, rising, shape (k,)."""
    values: Floats
    """Values in the file's unit, shape (k, 1), or (k, 2) for two components x and y."""
    quantity: str | None = None
    """acceleration, velocity or displacement where the file says it, or None."""
    unit: str | None = None
    """Unit where the file says it, or None."""
    guess: tuple[str, float] | None = None
    """Unit of acceleration, and its size in m/s2, that words of a heading seem to name, or None."""
    lines: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """Line of the file, from 1, of each instant, shape (k,); none for files of other formats."""


def numbers_of(lines: Iterable[tuple[int, str]], name: str, remedy: str) -> Floats:
    """Return all numbers of lines of words, shape (k,); ``lines`` have their number and text."""
    numbers: list[float] = []
    for number, line in lines:
        for word in line.split():
            value = number_of(word)
            if value is None:
                what, where = f"{mistyped(word)} is not a finite number", f"{name}: line {number}"
                raise CaseError(what, where=where, remedy=remedy)
            numbers.append(value)
    return np.array(numbers, np.float64)


def number_of(word: str) -> float | None:
    """Return a word as a finite number, or None where it is none."""
    try:
        value = float(word)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


MARKED = re.compile(r"\bUNITS?\b\s*(?:OF|IN|ARE|IS)?\s*[:=]?\s*(.+)", re.IGNORECASE)
"""The unit after the word unit in a heading."""
EXPRESSION = re.compile(
    r"[\s(\[\"']*((?:m|cm|mm)(?:s|[/*.^()\-0-9])*|g|gals?|g's)(?=[\s)\],;:\"']|\.?$)", re.IGNORECASE
)
"""A unit at the beginning of a text whose seconds are s and whose powers are ^."""
PER_SECOND = "/s s^-1 s-1 *s^-1 .s-1 .s^-1 /(s)"
PER_SECOND_SQUARED = (
    "/s/s /s^2 /s2 /(s^2) /(s2) /(s*s) /s*s s^-2 s-2 *s^-2 *s-2 .s-2 .s^-2 /s^(2) s^(-2)"
)
RATES = {
    "": "",
    **dict.fromkeys(PER_SECOND.split(), "/s"),
    **dict.fromkeys(PER_SECOND_SQUARED.split(), "/s2"),
}
"""How a length is divided by time -> as the case file writes it."""


def unit_of_heading(lines: Sequence[str]) -> str | None:
    """Return the one unit that a heading names, in the words of the case file.

    None where it names none, one that is not known, or several.
    """
    units = [unit_of(marked[1]) for line in lines if (marked := MARKED.search(line))]
    return units[0] if len(set(units)) == 1 else None


def unit_of(text: str) -> str | None:
    """Return the unit that a text begins with, in the words of the case file, or None."""
    plain = text.strip().lower().replace("**", "^").replace("\u00b2", "2").replace("\u22c5", ".")
    plain = re.sub(r"\bsec(?:onds?|s)?(?![a-z])|(?<=[/*.])sec(?:onds?|s)?(?![a-z])", "s", plain)
    plain = re.sub(r"\s+per\s+", "/", plain)
    plain = re.sub(r"\bs(?:quared?)\b|\s+squared?\b", "^2", plain)
    plain = re.sub(r"\s*([/*^])\s*", r"\1", plain)
    # m s-2: a blank that stands for a product
    plain = re.sub(r"^([\s(\[]*(?:m|cm|mm)) (s\^?-[12])", r"\1\2", plain)
    expression = EXPRESSION.match(plain)
    if expression is None:
        return None
    unit = expression[1].rstrip(".")
    if unit in ("g", "g's", "gal", "gals"):
        return unit.removesuffix("'s").removesuffix("s")
    length = re.match("cm|mm|m", unit)
    if length is None:
        return None
    written = unit[length.end() :]
    rate = RATES.get(written.rstrip(")"), RATES.get(written))
    return None if rate is None else length[0] + rate
