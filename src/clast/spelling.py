"""The nearest valid word to one that nobody knows."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

LISTED = 20
"""Longest list of known words that a message spells out."""


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word that looks most like ``word``, or None where none looks like it."""
    by_lower = {name.lower(): name for name in known}
    found = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[found[0]] if found else None


def advice(word: str, known: Iterable[str], *, kind: str) -> str:
    """Return the remedy for an unknown word: the nearest known one, else all where they are few."""
    words = list(known)
    close = nearest(word, words)
    if close is not None:
        return f"did you mean '{close}'?"
    if not words:
        return f"there is no {kind} at all"
    if len(words) <= LISTED:
        return f"the {kind}s are: " + ", ".join(words)
    return f"there are {len(words)} {kind}s, from '{words[0]}' to '{words[-1]}'"
