"""Units of records as headings write them: CM/SEC**2, M/S^2, cm/s/s, g."""

from __future__ import annotations

import re
from collections.abc import Sequence

MARKED = re.compile(r"\bUNITS?\b\s*(?:OF|IN|ARE|IS)?\s*[:=]?\s*(.+)", re.IGNORECASE)
"""The unit after the word unit in a heading."""
EXPRESSION = re.compile(
    r"[\s(\[\"']*((?:m|cm|mm)(?:s|[/*.^()\-0-9])*|g|gals?|g's)(?=[\s)\],;:\"']|\.?$)", re.IGNORECASE
)
"""A unit at the beginning of a text whose seconds are s and whose powers are ^."""
RATES = {
    "": "",
    **dict.fromkeys(("/s", "s^-1", "s-1", "*s^-1", ".s-1", ".s^-1", "/(s)"), "/s"),
    **dict.fromkeys(
        (
            "/s/s",
            "/s^2",
            "/s2",
            "/(s^2)",
            "/(s2)",
            "/(s*s)",
            "/s*s",
            "s^-2",
            "s-2",
            "*s^-2",
            "*s-2",
        ),
        "/s2",
    ),
    **dict.fromkeys((".s-2", ".s^-2", "/s^(2)", "s^(-2)"), "/s2"),
}
"""How a length is divided by time -> as the case file writes it."""


def unit_of_heading(lines: Sequence[str]) -> str | None:
    """Return the one unit that a heading names, in the words of the case file.

    None where it names none, one that is not known, or several.
    """
    found = [unit_of(marked[1]) for line in lines if (marked := MARKED.search(line))]
    return found[0] if len(set(found)) == 1 else None


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
    if unit in ("g", "g's"):
        return "g"
    if unit in ("gal", "gals"):
        return "gal"
    length = re.match("cm|mm|m", unit)
    rate = None if length is None else RATES.get(unit[length.end() :].rstrip(")"), None)
    if length is not None and rate is None:
        rate = RATES.get(unit[length.end() :])
    return None if length is None or rate is None else length[0] + rate
