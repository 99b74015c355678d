"""Fingerprints of a model, a method and files: these must be the same to go on."""

from __future__ import annotations

import dataclasses
import os
import stat
from collections.abc import Mapping
from enum import Enum
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from clast.errors import CaseError

SHAPE = ("origin", "block_name", "block_start", "block_rock", "fixed", "vertices", "area")
"""Parts of a model that no stage changes: the blocks."""


def fingerprints(**things: Any) -> dict[str, str]:
    """Return a fingerprint of every field of some dataclasses: ``model.vertices`` and so on."""
    return {
        f"{name}.{field.name}": digest(getattr(thing, field.name))
        for name, thing in things.items()
        for field in dataclasses.fields(thing)
    }


def digest(value: Any) -> str:
    """Return a fingerprint of anything: of its class, and of its content."""
    checksum = sha256()
    _feed(checksum, value)
    return checksum.hexdigest()[:16]


def _feed(checksum: Any, value: Any) -> None:
    """Add a value to a checksum, with its type, so that equal contents of other types differ."""
    if isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
        array = np.ascontiguousarray(value)
        checksum.update(f"{array.dtype.str}{array.shape}".encode())
        checksum.update(array.tobytes())
        return
    kind = type(value)
    checksum.update(f"<{kind.__module__}.{kind.__qualname__}".encode())
    if value is None or isinstance(value, bool | int | float | str | bytes | slice):
        checksum.update(repr(value).encode(errors="surrogatepass"))
    elif isinstance(value, Enum):
        checksum.update(value.name.encode())
    else:
        for name, part in _parts(value).items():
            _feed(checksum, name)
            _feed(checksum, part)
    checksum.update(b">")


def _parts(value: Any) -> Mapping[Any, Any]:
    """Return the content of an object, by name or place."""
    if isinstance(value, Mapping):
        return value
    if isinstance(value, tuple | list | np.ndarray):
        return dict(enumerate(value))
    if isinstance(value, set | frozenset):
        return dict(enumerate(sorted(value, key=repr)))
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if hasattr(value, "__qualname__"):
        return {"name": f"{value.__module__}.{value.__qualname__}"}
    # what is computed when it is first asked for is not part of a thing
    computed = {name for name, one in vars(type(value)).items() if isinstance(one, cached_property)}
    held = getattr(value, "__dict__", {})
    return {name: held[name] for name in sorted(held) if name not in computed}


def content_of(path: Path, most: int) -> bytes:
    """Return the content of a regular file of at most ``most`` bytes.

    A path in a file may be a device, a pipe or a folder: nothing waits for a pipe or reads a
    device.  Raises CaseError for a path that is no such file, OSError for a file that cannot be
    read.
    """
    if stat.S_ISDIR(path.stat().st_mode):
        raise CaseError("is a directory", where=str(path))
    # what is there now may be something else than a moment ago, and must not hold us up either
    number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(number, "rb") as file:
        status = os.fstat(number)
        if not stat.S_ISREG(status.st_mode):
            raise CaseError("is a device, a pipe or the like", where=str(path))
        if status.st_size > most:
            raise CaseError(f"has {status.st_size:.3g} bytes, more than is read", where=str(path))
        return file.read(most + 1)[:most]


NAMED_BYTES_MAX = 500_000_000
"""Files that a case names are not read above this size, bytes."""


def print_of_named(path: Path) -> str:
    """Return the SHA-256 of a file that a case names, "" where there is none."""
    try:
        return sha256(content_of(path, NAMED_BYTES_MAX)).hexdigest()
    except (OSError, ValueError, CaseError):
        return ""


def print_of_text(text: str) -> str:
    """Return the SHA-256 of a text, whatever ends its lines."""
    plain = text.replace("\r\n", "\n").replace("\r", "\n")
    return sha256(plain.encode(errors="surrogatepass")).hexdigest()


def print_of_text_in(path: Path) -> str:
    """Return the SHA-256 of the text in a regular file, "" where there is none."""
    try:
        return print_of_text(content_of(path, NAMED_BYTES_MAX).decode())
    except (OSError, ValueError, CaseError):
        return ""
