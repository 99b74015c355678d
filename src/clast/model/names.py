"""Rules for names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from clast.errors import ModelError, shortened

CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\ud800-\udfff]")
"""Characters that names do not have: they break files, terminals and pictures."""
LONGEST_NAME = 200
"""Most characters of a name."""


def check_names(kind: str, names: Sequence[str]) -> None:
    """Refuse names that are not text, blank, too long, not printable, or there twice."""
    if not all(isinstance(name, str) for name in names):
        wrong = next(name for name in names if not isinstance(name, str))
        raise ModelError(
            f"{shortened(repr(wrong))} is not a valid name",
            where=kind,
            remedy='give names as text, e.g. "1"',
        )
    for number, name in enumerate(names, start=1):
        check_text(name, f"{kind} {number}")
    if len(set(names)) < len(names):
        ordered = sorted(names)
        twice = next(name for name, after in pairwise(ordered) if name == after)
        raise ModelError(
            f"there are two {kind}s with that name",
            where=f"{kind} '{shortened(twice)}'",
            remedy="rename one of them",
        )


def check_text(name: str, label: str) -> None:
    """Refuse a name that is blank, too long or not printable; ``label`` names its owner."""
    for what, bad in (
        ("has no name", lambda name: not name.strip()),
        (f"has a name of more than {LONGEST_NAME} characters", lambda n: len(n) > LONGEST_NAME),
        ("has a name with a character that cannot be printed", CONTROL.search),
    ):
        if bad(name):
            raise ModelError(
                what,
                where=f"{label} {shortened(repr(name))}",
                remedy="give it a short name of letters, digits and blanks",
            )
