"""Who writes blocks to a file, by the ending of its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from clast.errors import CaseError, shortened

Arrays = Mapping[str, Any]
"""vertices, block_start, rock and edge_joint, as the writers of files take them."""
Found = TypeVar("Found")


def _dxf(path: Path, blocks: Arrays) -> None:
    from clast.rockmass.drawings.blocks_out import write_blocks_dxf

    # Names of layers have no colons.
    joints = [name.replace(":", "-") for name in blocks["edge_joint"]]
    write_blocks_dxf(path, **{**blocks, "edge_joint": joints})


def _csv(path: Path, blocks: Arrays) -> None:
    from clast.rockmass.drawings.blocks_out import write_blocks_csv

    write_blocks_csv(path, **blocks)


def _npz(path: Path, blocks: Arrays) -> None:
    from clast.rockmass.drawings.blocks_out import write_blocks_npz

    write_blocks_npz(path, **blocks)


BLOCK_WRITERS: dict[str, Callable[[Path, Arrays], None]] = {
    ".dxf": _dxf,
    ".csv": _csv,
    ".npz": _npz,
}
"""Ending of a file's name -> who writes blocks to it."""


def writer(
    path: Path, writers: Mapping[str, Callable[[Path, Found], None]]
) -> Callable[[Path, Found], None]:
    """Return the writer for a file with that name; CaseError where there is none."""
    found = writers.get(path.suffix.casefold())
    if found is None:
        ending = shortened(path.suffix) or "nothing"
        raise CaseError(
            f"ends in {ending}, which is not a known format",
            where=str(path),
            remedy=f"use a name ending in {', '.join(writers)}",
        )
    if not path.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(path), remedy="create it first")
    return found
