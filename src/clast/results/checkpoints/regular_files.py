"""Content of regular files alone: a path in a file may be a device, a pipe or a folder."""

from __future__ import annotations

import os
import stat
from hashlib import sha256
from pathlib import Path

from clast.errors import CaseError


def content_of(path: Path, most: int) -> bytes:
    """Return the content of a regular file of at most ``most`` bytes.

    Nothing waits for a pipe or reads a device.  Raises CaseError for a path that is no such file,
    OSError for a file that cannot be read.
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


def print_of(path: Path, most: int) -> str:
    """Return the SHA-256 of a regular file of at most ``most`` bytes, "" where there is none."""
    try:
        return sha256(content_of(path, most)).hexdigest()
    except (OSError, ValueError, CaseError):
        return ""


def print_of_text(text: str) -> str:
    """Return the SHA-256 of a text, whatever ends its lines."""
    plain = text.replace("\r\n", "\n").replace("\r", "\n")
    return sha256(plain.encode(errors="surrogatepass")).hexdigest()


def print_of_text_in(path: Path, most: int) -> str:
    """Return the SHA-256 of the text in a regular file, "" where there is none."""
    try:
        return print_of_text(content_of(path, most).decode())
    except (OSError, ValueError, CaseError):
        return ""
