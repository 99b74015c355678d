"""Texts that count as numbers."""

from __future__ import annotations

import re

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
LARGEST = 1e20
"""Largest number that is believed."""


def number_of(word: str) -> float | None:
    """Return the number that a word is, of at most LARGEST, or None; d may stand for e."""
    if not NUMBER.fullmatch(word):
        return None
    value = float(re.sub("[dD]", "e", word))
    return value if abs(value) <= LARGEST else None
