"""Blocks out as CSV and NPZ, and NPZ in again."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np

from clast.errors import CaseError, shortened
from clast.rockmass.drawings.block_arrays import Blocks, blocks_of
from clast.rockmass.drawings.drawing_files import checked_file, replaced

HEADING = ("block", "vertex", "x", "y", "joint", "rock")
ARRAYS = ("vertices", "block_start", "rock", "edge_joint")
"""Names of the arrays of an archive."""
LARGEST_EXPANDED = 1_000_000_000
"""Most bytes that the arrays of an archive may have when they are expanded."""


def write_blocks_csv(
    path: str | Path,
    vertices: Any,
    block_start: Any,
    rock: Sequence[str],
    edge_joint: Sequence[str] | None = None,
) -> None:
    """Write blocks to a CSV file: a row for each vertex with block, vertex, x, y, joint, rock.

    Blocks count from 0, vertices from 0 in each block, coordinates are m with every digit; the
    joint is that of the edge to the next vertex.  Raises CaseError as ``write_blocks_dxf`` does.
    """
    blocks = blocks_of(vertices, block_start, rock, edge_joint)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(HEADING)
    points = blocks.vertices.tolist()
    for block, name in enumerate(blocks.rock):
        first, last = int(blocks.block_start[block]), int(blocks.block_start[block + 1])
        for k in range(first, last):
            x, y = points[k]
            table.writerow((block, k - first, repr(x), repr(y), blocks.edge_joint[k], name))
    with replaced(Path(path)) as file:
        file.write(text.getvalue().encode("utf-8"))


def write_blocks_npz(
    path: str | Path,
    vertices: Any,
    block_start: Any,
    rock: Sequence[str],
    edge_joint: Sequence[str] | None = None,
) -> None:
    """Write blocks to an archive of arrays: vertices, block_start, rock, edge_joint.

    Raises CaseError as ``write_blocks_dxf`` does.
    """
    blocks = blocks_of(vertices, block_start, rock, edge_joint)
    with replaced(Path(path)) as file:
        np.savez_compressed(
            file,
            vertices=blocks.vertices,
            block_start=blocks.block_start,
            rock=np.array(blocks.rock, dtype=np.str_),
            edge_joint=np.array(blocks.edge_joint, dtype=np.str_),
        )


def _check_size(path: Path) -> None:
    """Raise CaseError where an archive's arrays are larger than its blocks could need.

    No more is expanded of each than the archive says, whatever the array itself says.
    """
    with ZipFile(path) as archive:
        parts = [one for one in archive.infolist() if one.filename.removesuffix(".npy") in ARRAYS]
        size = sum(one.file_size for one in parts)
        if size > LARGEST_EXPANDED or len(parts) > len(ARRAYS):
            raise CaseError(
                f"has arrays of {size:.3g} bytes, more than blocks should need",
                where=str(path),
                remedy="divide it, or write it again with write_blocks_npz",
            )
        for one in parts:
            with archive.open(one) as file:
                headers = np.lib.format
                first = headers.read_magic(file) == (1, 0)
                read = headers.read_array_header_1_0 if first else headers.read_array_header_2_0
                shape, _, kind = read(file)
            if kind.hasobject or math.prod(shape) * kind.itemsize > one.file_size:
                raise CaseError(
                    f"the array {one.filename.removesuffix('.npy')} does not match its header",
                    where=str(path),
                    remedy="write it again with write_blocks_npz",
                )


def read_blocks_npz(path: str | Path) -> Blocks:
    """Return the blocks of an archive that ``write_blocks_npz`` wrote.

    Raises CaseError where it is none, or damaged, or its arrays do not belong together.
    """
    file = str(path)
    try:
        _check_size(checked_file(Path(path)))
        with np.load(path, allow_pickle=False) as archive:
            missing = [name for name in ARRAYS if name not in archive.files]
            if missing:
                raise CaseError(
                    f"has no array {', '.join(missing)}",
                    where=file,
                    remedy=f"it has {shortened(', '.join(archive.files), 100) or 'none'}",
                )
            arrays = {name: archive[name] for name in ARRAYS}
    except CaseError:
        raise
    except Exception as error:  # damaged archives end in errors of zlib, struct and others
        raise CaseError(
            f"is not an archive of blocks, or a damaged one: {shortened(str(error), 100)}",
            where=file,
            remedy="write it again with write_blocks_npz",
        ) from None
    for name in ("rock", "edge_joint"):
        if arrays[name].ndim != 1 or arrays[name].dtype.kind != "U":
            raise CaseError(
                f"the array {name} is not a list of texts", where=file, remedy="save names as texts"
            )
    for name, kinds in {"vertices": "fiu", "block_start": "iu"}.items():
        if arrays[name].dtype.kind not in kinds:
            raise CaseError(
                f"the array {name} does not hold numbers", where=file, remedy="save it as numbers"
            )
    rock, joints = arrays["rock"].tolist(), arrays["edge_joint"].tolist()
    return blocks_of(arrays["vertices"], arrays["block_start"], rock, joints, file)
