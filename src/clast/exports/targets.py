"""Frames to export, and files for them whose names are still free."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from clast.errors import CaseError
from clast.results import Recording


def frames_in(results: Recording, wanted: Sequence[int] | None) -> list[int]:
    """Return the numbers of the frames ``wanted``, from 0; all for None."""
    if wanted is None:
        return list(range(len(results.times)))
    if not len(wanted):
        raise CaseError("no frame is given", remedy="give one, or leave frames out for all")
    return list(dict.fromkeys(results.frame(int(number)).number for number in wanted))


def edge_joints(results: Recording) -> list[str]:
    """Return the joint of the edge that begins at each vertex, "" for none; nv names."""
    names = (*results.joint_name, "")  # the index -1 is the last
    return [names[k] for k in results.edge_joint]


def check_ending(path: Path, ending: str, what: str) -> None:
    """Raise CaseError unless the name of a file has an ending."""
    if path.suffix.casefold() != ending:
        remedy = f"use a name ending in {ending}"
        raise CaseError(f"is not a valid name for {what}", where=str(path), remedy=remedy)


def numbered(path: Path, frames: Iterable[int], ending: str) -> list[Path]:
    """Return the file of each frame: out.pvd, 7 -> out-0007.vtu."""
    return [path.with_name(f"{path.stem}-{frame:04d}{ending}") for frame in frames]


def check_free(paths: Iterable[Path]) -> None:
    """Raise CaseError for the first file that exists, or whose folder does not."""
    for path in paths:
        if path.exists() or path.is_symlink():
            what = "already exists"
            raise CaseError(what, where=str(path), remedy="choose another name, or remove it")
        if not path.absolute().parent.is_dir():
            raise CaseError("its folder does not exist", where=str(path), remedy="create it first")
