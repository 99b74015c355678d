"""The nearest valid word to an unknown one, and how a terminal is shown foreign words."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterable, Mapping

from clast.errors import CaseError, shortened

LISTED = 20
"""Longest list of known words that a message spells out."""

UNSEEN = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""Characters that command a terminal instead of being shown, or that it cannot show."""
LONG_WORD = re.compile(r"(\S{120})\S{181,}(\S{60})")
"""A word too long to be read: its beginning and its end are kept."""
LONG_LINE = re.compile(r"^(.{1500}).{501,}(.{300})$", re.MULTILINE)


def nearest(word: str, known: Iterable[str]) -> str | None:
    """Return the known word that looks most like ``word``, or None where none looks like it."""
    by_lower = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[close[0]] if close else _abbreviated(word.lower(), by_lower)


def _abbreviated(word: str, by_lower: Mapping[str, str]) -> str | None:
    """Return the only word that is "sigma_yy" for "syy": initials, and the last part as it is."""
    found = []
    for low, name in by_lower.items():
        *first, last = low.split("_")
        if first and word == "".join(part[:1] for part in first) + last:
            found.append(name)
    return found[0] if len(found) == 1 else None


def _plural(noun: str) -> str:
    if noun.endswith("ss"):
        return f"{noun}es"
    return noun if noun.endswith("s") else f"{noun}s"


def advice(word: str, known: Iterable[str], *, kind: str) -> str:
    """Return the remedy for an unknown word: the nearest known one, else all where they are few."""
    words = list(known)
    close = nearest(word, words)
    if close is not None:
        return f"did you mean '{close}'?"
    if not words:
        return f"there is no {kind} at all"
    several = " or ".join(map(_plural, kind.split(" or ")))
    if len(words) <= LISTED:
        return f"the {several} are: " + ", ".join(words)
    return f"there are {len(words)} {several}, from '{words[0]}' to '{words[-1]}'"


def require_known(
    word: str, known: Collection[str], *, kind: str, where: str = "", what: str = ""
) -> None:
    """Raise CaseError for a word that is not among the ``known`` ones; ``what`` is the fault."""
    if word not in known:
        what = what or f"there is no {kind} '{shortened(str(word))}'"
        raise CaseError(what, where=where, remedy=advice(str(word), known, kind=kind))


def visible(text: str) -> str:
    """Return a text with characters that would command a terminal written out, as in JSON."""
    return UNSEEN.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def without_long_words(text: str) -> str:
    """Return a message without the middle of words and lines that are far too long."""
    return LONG_LINE.sub(r"\1 ... \2", LONG_WORD.sub(r"\1...\2", text))
