"""Pages as files: the endings of their names, and that no half of one is left."""

from __future__ import annotations

from pathlib import Path

from clast.errors import CaseError
from clast.rockmass.drawings.drawing_files import replaced

SUFFIXES = (".html", ".htm")
"""Endings of the names of pages."""


def html_path(path: Path | str) -> Path:
    """Return the path of a page to write; raises CaseError for a name with another ending."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise CaseError(
            f"pages cannot be written as '{path.suffix or path.name}'",
            where=str(path),
            remedy=f"end the name in {' or '.join(SUFFIXES)}",
        )
    return path


def write_html(text: str, path: Path) -> Path:
    """Write a page and return its path; raises CaseError where it cannot, and leaves no part."""
    with replaced(path) as file:
        file.write(text.encode("utf-8"))
    return path
