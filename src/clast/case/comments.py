"""Text of a case file beside its tables: comments, and values that are to be given."""

from __future__ import annotations

from collections.abc import Iterable

from clast import spelling

TO_BE_GIVEN = "to be given"
"""Value of a key that a drawing does not know."""
WIDTH = 98
"""Most characters of a line of a comment, where words allow."""


def comment(text: str, indent: str = "") -> list[str]:
    """Return a text as lines of comments, broken between words."""
    words = spelling.visible(" ".join(text.split())).split(" ")
    lines, line = [], f"# {indent}{words[0]}"
    for word in words[1:]:
        if len(line) + 1 + len(word) > WIDTH:
            lines.append(line)
            line = f"# {' ' * len(indent)}{word}"
        else:
            line += f" {word}"
    return [*lines, line]


def listed(title: str, items: Iterable[str]) -> list[str]:
    """Return a title and items as comments; nothing where there are no items."""
    lines = [line for item in items for line in comment(item, "- ")]
    return ["#", f"# {title}", *lines] if lines else []
