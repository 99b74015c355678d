"""Targets of exports: names that are still free."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from clast.errors import CaseError


def check_ending(path: Path, ending: str, what: str) -> None:
    """Raise CaseError unless the name of a file has an ending."""
    if path.suffix.casefold() != ending:
        raise CaseError(
            f"is not a valid name for {what}",
            where=str(path),
            remedy=f"use a name ending in {ending}",
        )


def numbered(path: Path, frames: Iterable[int], ending: str) -> list[Path]:
    """Return the file of each frame: out.pvd, 7 -> out-0007.vtu."""
    return [path.with_name(f"{path.stem}-{frame:04d}{ending}") for frame in frames]


def check_free(paths: Iterable[Path]) -> None:
    """Raise CaseError for the first file that exists, or whose folder does not."""
    for path in paths:
        if path.exists() or path.is_symlink():
            raise CaseError(
                "already exists", where=str(path), remedy="choose another name, or remove it"
            )
        if not path.absolute().parent.is_dir():
            raise CaseError("its folder does not exist", where=str(path), remedy="create it first")
