"""Checkpoint files: written whole or not at all, and checked to the last byte when read.

A file is HDF5 with, behind it, its length and checksum, which HDF5 passes over:

    /checkpoint    its content, as JSON; attributes give the layout and the version of clast
    /arrays/N      the arrays that it refers to, those of tables as their bytes
    sums:          length of the HDF5 part (u64, little-endian), its SHA-256, 8 bytes "clastchk"
"""

from __future__ import annotations

import io
import json
import os
import struct
from collections.abc import Mapping
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError, shortened
from clast.results.checkpoints.checkpoint import Checkpoint
from clast.results.checkpoints.encode import (
    NotPlainError,
    UnknownClassError,
    put_together,
    taken_apart,
)
from clast.results.checkpoints.fingerprints import content_of
from clast.results.open_file import is_result_file
from clast.results.output import fresh, hidden

LAYOUT = 4
"""Version of the layout of checkpoint files."""
FILE_BYTES_MAX = 2**31
"""Checkpoints above this size are not read, bytes."""
SUMS = struct.Struct("<Q32s8s")
MARK = b"clastchk"
ENDING = ".checkpoint.h5"
SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""How every HDF5 file begins."""
RESULTS = ".vtkhdf"
"""Usual ending of result files, which the names of their checkpoints leave out."""
PLAIN = "biuf"
"""Kinds of numbers that HDF5 knows as NumPy does (its letters); others are written as bytes."""
AS_BYTES = "biufcSUV"
"""Kinds that are written as bytes."""


def checkpoint_path(output: Path, stage: str = "") -> Path:
    """Return where the checkpoint of a result file is: that of now, or of the end of a stage.

    No two files and stages share one.  The dot before a stage is the only one that is left:
    ``n.vtkhdf`` with a stage ``rest`` has n.rest.checkpoint.h5, ``n.rest.vtkhdf`` has
    n%2Erest.checkpoint.h5; ``a.h5``, without the usual ending, has a%2Eh5%.checkpoint.h5.
    """
    usual = output.suffix == RESULTS
    name = (output.stem if usual else output.name).replace("%", "%25").replace(".", "%2E")
    safe = "".join(
        sign if sign.isalnum() or sign in "-_ " else f"%{ord(sign):02X}" for sign in stage
    )
    return output.with_name(f"{name}{'' if usual else '%'}{'.' if safe else ''}{safe}{ENDING}")


def check_place(path: Path) -> None:
    """Raise CaseError where something else than a checkpoint is at a path, which stays."""
    if (path.exists() or path.is_symlink()) and not is_checkpoint(path):
        raise CaseError(
            "exists and is not a clast checkpoint, or a damaged one; it is not overwritten",
            where=str(path),
            remedy="remove it or move it away, or choose another name for the results",
        )


def is_checkpoint(path: Path) -> bool:
    """Return whether a file is a whole checkpoint, of whatever layout."""
    try:
        return _image(content_of(path, FILE_BYTES_MAX)) is not None
    except (OSError, CaseError):
        return False


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint in the place of an earlier one, which stays until this one is on the disk.

    Raises CaseError for data it cannot hold, OSError where it cannot be written.
    """
    check_place(path)
    part = hidden(path)
    image = _as_bytes(checkpoint)
    try:
        with fresh(part) as file:
            file.write(image)
            file.write(SUMS.pack(len(image), sha256(image).digest(), MARK))
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with suppress(OSError):
            part.unlink()
        raise
    with suppress(OSError):
        number = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)


def read_checkpoint(path: Path, known: Mapping[str, type]) -> Checkpoint:
    """Return the checkpoint in a file; ``known`` are classes of scripts that it may hold.

    Whoever wrote it may have meant harm: a right checksum says only that the bytes are those that
    were written.  All that is made of them are clast's own dataclasses, with fields of their types.
    Raises CaseError for a file that is not a checkpoint, is damaged or comes from another version.
    """
    image = _sound_image(path)
    try:
        with h5py.File(io.BytesIO(image), "r") as file:
            # The version of clast that has written a checkpoint of this layout.
            attributes = file["checkpoint"].attrs
            version, layout = shortened(str(attributes["version"])), int(attributes["layout"])
            if layout != LAYOUT:
                age, remedy = "a newer", "update clast"
                if layout < LAYOUT:
                    age, remedy = "an older", f"resume with clast {version}, or run the case again"
                what = f"was written by {age} version of clast ({version})"
                raise CaseError(what, where=str(path), remedy=remedy)
            group = file["arrays"]
            arrays = [_array(_stored(group, str(number))) for number in range(len(group))]
            written = json.loads(file["checkpoint"][()])
    except CaseError:
        raise
    except Exception as error:  # HDF5 raises whatever it likes where its structures are wrong
        raise damaged(path, "its parts do not fit together") from error
    try:
        checkpoint = put_together(written, arrays, known)
    except UnknownClassError as error:
        raise CaseError(
            f"holds data unknown to this version: {error}",
            where=str(path),
            remedy=f"resume with clast {version}, which wrote it; objects of a script "
            "must be given again: clast.resume(file, model=...)",
        ) from None
    except (LookupError, TypeError, ValueError, AttributeError, RuntimeError) as error:
        raise damaged(path, "its content is not as expected") from error
    if not isinstance(checkpoint, Checkpoint):
        raise CaseError(
            "is not a checkpoint of a run",
            where=str(path),
            remedy=f"name a file that ends in {ENDING}",
        )
    return checkpoint


def damaged(path: Path, why: str) -> CaseError:
    """Return the error for a checkpoint from which a run cannot go on."""
    return CaseError(
        f"is damaged: {why}",
        where=str(path),
        remedy="resume from another checkpoint of the run, or run the case again",
    )


def _as_bytes(checkpoint: Checkpoint) -> bytes:
    arrays: list[NDArray[Any]] = []
    try:
        written = taken_apart(checkpoint, arrays, "")
    except NotPlainError as error:
        raise CaseError(
            f"a checkpoint cannot hold a {error.kind}",
            where=error.place,
            remedy="make the state of the action a number, a text, an array, a tuple or a "
            "frozen dataclass of these",
        ) from None
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver=("v108", "v108")) as file:
        held = file.create_dataset("checkpoint", data=json.dumps(written, ensure_ascii=True))
        held.attrs["layout"] = LAYOUT
        held.attrs["version"] = checkpoint.version
        group = file.create_group("arrays")
        for number, array in enumerate(arrays):
            _put_array(group, str(number), array)
    return buffer.getvalue()


def _image(content: bytes) -> bytes | None:
    """Return the HDF5 part of a whole checkpoint file, None where it is none."""
    if len(content) < SUMS.size:
        return None
    length, checksum, mark = SUMS.unpack(content[-SUMS.size :])
    image = content[: -SUMS.size]
    whole = mark == MARK and length == len(image) and sha256(image).digest() == checksum
    return image if whole else None


def _sound_image(path: Path) -> bytes:
    """Return the HDF5 part of a checkpoint file; raises CaseError for a file that is none."""
    where = str(path)
    try:
        content = content_of(path, FILE_BYTES_MAX)
    except FileNotFoundError:
        raise CaseError(
            "there is no such file",
            where=where,
            remedy=f"name a checkpoint: the name of the result file with {ENDING}",
        ) from None
    except CaseError as error:
        remedy = f"name a file that ends in {ENDING}"
        raise CaseError(f"{error.what}, not a checkpoint", where=where, remedy=remedy) from None
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
        raise damaged(path, "it is cut off, or bytes differ from those written")
    raise CaseError(
        "is not a clast checkpoint", where=where, remedy=f"name a file that ends in {ENDING}"
    )


def _put_array(group: Any, name: str, array: NDArray[Any]) -> None:
    """Write an array; one of rows or of texts as its bytes."""
    if array.dtype.kind in PLAIN:
        group.create_dataset(name, data=array)
        return
    content = np.frombuffer(np.ascontiguousarray(array).tobytes(), np.uint8)
    one = group.create_dataset(name, data=content)
    one.attrs["dtype"] = json.dumps(array.dtype.descr)
    one.attrs["shape"] = np.array(array.shape, np.int64)


def _stored(group: Any, name: str) -> Any:
    """Return a dataset all of whose bytes are in the file, one by one."""
    if not isinstance(group.get(name, getlink=True), h5py.HardLink):
        raise ValueError(f"/arrays/{name} is not in this file")
    array = group[name]
    if not isinstance(array, h5py.Dataset) or array.shape is None:
        raise TypeError(f"/arrays/{name} is not an array")
    if array.chunks is not None or array.external or array.is_virtual:
        raise ValueError(f"/arrays/{name} is not in one piece")
    if array.dtype.kind not in PLAIN or array.id.get_storage_size() != array.nbytes:
        raise ValueError(f"/arrays/{name} claims more data than the file holds")
    return array


def _array(dataset: Any) -> NDArray[Any]:
    content: NDArray[Any] = dataset[()] if dataset.shape else np.asarray(dataset[()])
    if "dtype" in dataset.attrs:
        kind = _kind(json.loads(dataset.attrs["dtype"]))
        shape = tuple(int(size) for size in dataset.attrs["shape"])
        content = np.frombuffer(content.tobytes(), kind).reshape(shape).copy()
    content.flags.writeable = False
    return content


def _kind(entries: Any) -> np.dtype[Any]:
    if entries[0][0] == "":
        kind = np.dtype(entries[0][1])
    else:
        kind = np.dtype([(name, of, *map(tuple, shape)) for name, of, *shape in entries])
    if kind.hasobject or kind.kind not in AS_BYTES:
        raise TypeError("holds more than numbers")
    return kind
