"""Checkpoint files: written whole or not at all, and checked to the last byte when read.

A file is HDF5 with, behind it, its length and checksum, which HDF5 passes over:

    /checkpoint    what is held, as JSON; attributes say the layout and the version of clast
    /arrays/N      the arrays that it refers to, those of tables as their bytes
    sums:          length of the HDF5 part (u64, little-endian), its SHA-256, 8 bytes "clastchk"
"""

from __future__ import annotations

import io
import json
import os
import stat
import struct
from collections.abc import Mapping
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.results.checkpoints.checkpoint import Checkpoint
from clast.results.checkpoints.plain import (
    NotPlainError,
    UnknownClassError,
    put_together,
    taken_apart,
)
from clast.results.opening import is_result_file
from clast.results.output import hidden

LAYOUT = 1
"""Version of the layout of checkpoint files."""
SUMS = struct.Struct("<Q32s8s")
MARK = b"clastchk"
ENDING = ".checkpoint.h5"
SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""How every HDF5 file begins."""


def checkpoint_path(output: Path, stage: str = "") -> Path:
    """Return where the checkpoint of a result file is: that of now, or of the end of a stage."""
    safe = "".join(
        sign if sign.isalnum() or sign in "-_ " else f"%{ord(sign):02X}" for sign in stage
    )
    return output.with_name(f"{output.stem}{'.' if safe else ''}{safe}{ENDING}")


def check_place(path: Path) -> None:
    """Raise CaseError where something else than a checkpoint is at a path, which stays."""
    if (path.exists() or path.is_symlink()) and not is_checkpoint(path):
        raise CaseError(
            "exists and is no checkpoint of clast, or a damaged one; it is not written over",
            where=str(path),
            remedy="remove it or move it away, or choose another name for the results",
        )


def is_checkpoint(path: Path) -> bool:
    """Return whether a file is a whole checkpoint, of whatever layout."""
    try:
        return stat.S_ISREG(path.stat().st_mode) and _image(path.read_bytes()) is not None
    except OSError:
        return False


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint in the place of an earlier one, which stays until this one is on the disk.

    Raises CaseError for what it cannot hold, OSError where it cannot be written.
    """
    check_place(path)
    part = hidden(path)
    image = _as_bytes(checkpoint)
    try:
        with open(part, "wb") as file:
            file.write(image)
            file.write(SUMS.pack(len(image), sha256(image).digest(), MARK))
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with suppress(OSError):
            part.unlink()
        raise
    _sync_folder(path.parent)


def read_checkpoint(path: Path, known: Mapping[str, type]) -> Checkpoint:
    """Return the checkpoint in a file; ``known`` are classes of scripts that it may hold.

    Raises CaseError for what is none, is damaged or is of another clast.
    """
    image = _sound_image(path)
    with h5py.File(io.BytesIO(image), "r") as file:
        held, version = file["checkpoint"], str(file["checkpoint"].attrs["version"])
        if int(held.attrs["layout"]) > LAYOUT:
            raise CaseError(
                f"was written by a newer clast ({version})", where=str(path), remedy="update clast"
            )
        group = file["arrays"]
        arrays = [_array(group[str(number)]) for number in range(len(group))]
        written = json.loads(held[()])
    try:
        found = put_together(written, arrays, known)
    except UnknownClassError as error:
        raise CaseError(
            f"holds what this clast does not know: {error}",
            where=str(path),
            remedy=f"resume with clast {version}, which has written it; what a script has added "
            "must be given again: clast.resume(file, model=...)",
        ) from None
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise CaseError(f"is damaged: {error}", where=str(path)) from error
    if not isinstance(found, Checkpoint):
        raise CaseError("is no checkpoint of a run", where=str(path))
    return found


def _as_bytes(checkpoint: Checkpoint) -> bytes:
    """Return the HDF5 part of a checkpoint file."""
    arrays: list[NDArray[Any]] = []
    try:
        written = taken_apart(checkpoint, arrays, "")
    except NotPlainError as error:
        raise CaseError(
            f"no checkpoint can hold a {error.kind}",
            where=error.place,
            remedy="let the own state of an action be a number, a text, an array, a tuple or a "
            "frozen dataclass of these",
        ) from None
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver=("v108", "v108")) as file:
        held = file.create_dataset("checkpoint", data=json.dumps(written, ensure_ascii=True))
        held.attrs["layout"] = LAYOUT
        held.attrs["version"] = checkpoint.version
        group = file.create_group("arrays")
        for number, array in enumerate(arrays):
            _put(group, str(number), array)
    return buffer.getvalue()


def _put(group: Any, name: str, array: NDArray[Any]) -> None:
    """Write an array; one of rows or of texts as its bytes."""
    if array.dtype.kind in "biuf":
        group.create_dataset(name, data=array)
        return
    content = np.frombuffer(np.ascontiguousarray(array).tobytes(), np.uint8)
    one = group.create_dataset(name, data=content)
    one.attrs["dtype"] = json.dumps(array.dtype.descr)
    one.attrs["shape"] = np.array(array.shape, np.int64)


def _array(dataset: Any) -> NDArray[Any]:
    """Return an array as it was."""
    content: NDArray[Any] = dataset[()] if dataset.shape else np.asarray(dataset[()])
    if "dtype" not in dataset.attrs:
        return content
    entries = json.loads(dataset.attrs["dtype"])
    if entries[0][0] == "":
        kind = np.dtype(entries[0][1])
    else:
        kind = np.dtype([(name, of, *map(tuple, shape)) for name, of, *shape in entries])
    return np.frombuffer(content.tobytes(), kind).reshape(tuple(dataset.attrs["shape"])).copy()


def _image(content: bytes) -> bytes | None:
    """Return the HDF5 part of a whole checkpoint file, None where it is none."""
    if len(content) < SUMS.size:
        return None
    length, checksum, mark = SUMS.unpack(content[-SUMS.size :])
    image = content[: -SUMS.size]
    whole = mark == MARK and length == len(image) and sha256(image).digest() == checksum
    return image if whole else None


def _sound_image(path: Path) -> bytes:
    """Return the HDF5 part of a checkpoint file; raises CaseError for what is none."""
    where = str(path)
    try:
        if path.exists() and not stat.S_ISREG(path.stat().st_mode):
            raise CaseError(
                "is a directory or a device, not a checkpoint",
                where=where,
                remedy=f"name a file that ends in {ENDING}",
            )
        content = path.read_bytes()
    except FileNotFoundError:
        raise CaseError(
            "there is no such file",
            where=where,
            remedy=f"name a checkpoint: the name of the result file with {ENDING}",
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise CaseError(f"cannot be read: {reason}", where=where) from error
    image = _image(content)
    if image is not None:
        return image
    if is_result_file(path):
        raise CaseError(
            "is a result file, not a checkpoint",
            where=where,
            remedy=f"name the checkpoint beside it: {checkpoint_path(path)}",
        )
    if content.startswith(SIGNATURE) and (b"clastchk" in content or path.name.endswith(ENDING)):
        raise CaseError(
            "is damaged: it is cut off, or bytes are not what was written",
            where=where,
            remedy="resume from another checkpoint of the run, or run the case again",
        )
    raise CaseError(
        "is no checkpoint of clast", where=where, remedy=f"name a file that ends in {ENDING}"
    )


def _sync_folder(folder: Path) -> None:
    """Have the names in a folder written to the disk, where the system can."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
