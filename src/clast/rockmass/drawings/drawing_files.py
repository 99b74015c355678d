"""Files in and out: each is read whole, and written whole or not at all."""

from __future__ import annotations

import csv
import io
import os
import re
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from clast.errors import CaseError

FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")
"""Beginnings of texts that spreadsheets take for formulas."""
NUMBER = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[-+]?[0-9]+)?|[-+](inf|nan)", re.IGNORECASE)
"""A number as a text, which is no formula."""
FILE_BYTES_MAX = 500_000_000
"""Drawings above this size are not read."""


def checked_file(path: Path) -> Path:
    """Return the path of a regular file that can be read, or raise CaseError."""
    where = str(path)
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise CaseError("is a directory, not a file", where=where, remedy="name a file in it")
        if not stat.S_ISREG(status.st_mode):
            what = "is a pipe, a socket or a device, not a regular file"
            raise CaseError(what, where=where, remedy="write its content into a file first")
        if status.st_size > FILE_BYTES_MAX:
            what = f"has {status.st_size:.3g} bytes, more than a drawing should have"
            remedy = "remove everything but outlines, joints, bolts and supports"
            raise CaseError(what, where=where, remedy=remedy)
        with path.open("rb"):
            return path
    except FileNotFoundError:
        raise CaseError("there is no such file", where=where, remedy="check its name") from None
    except ValueError:  # a NUL in the name
        raise CaseError("is not a valid file name", where=repr(where)) from None
    except OSError as error:
        remedy = "check the file's name and permissions"
        raise CaseError(f"cannot be read: {error.strerror}", where=where, remedy=remedy) from None


def text_of(path: Path) -> str:
    """Return the text of a file in UTF-8 or, as old programs wrote it, in Latin-1.

    Raises CaseError where there is no such file, or where it holds a NUL and so is not text.
    """
    content = checked_file(path).read_bytes()
    if b"\0" in content:
        what = f"is not a text file (byte {content.index(0)} is 0)"
        remedy = "a DXF file ends in .dxf, an archive of blocks in .npz"
        raise CaseError(what, where=str(path), remedy=remedy)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


@contextmanager
def replaced(path: Path) -> Iterator[BinaryIO]:
    """Give an open file that takes the name ``path`` when all of it is written, and not before.

    Raises CaseError where nothing can be written there; an older file is then left as it was.
    """
    with replaced_path(path) as part:
        # where somebody has put a link meanwhile, that is not followed
        flags = os.O_WRONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        with open(os.open(part, flags), "wb") as file:
            yield file


def write_rows(path: Path, rows: Iterable[Iterable[Any]]) -> int:
    """Write a table as CSV, whole or not at all; return the number of rows.

    A text that a spreadsheet would take for a formula has an apostrophe before it, by which that
    knows it for a text.  Raises CaseError as ``replaced`` does.
    """
    count = 0
    with replaced(path) as file:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="", write_through=True)
        writer = csv.writer(text, lineterminator="\n")
        for row in rows:
            writer.writerow(map(as_text, row))
            count += 1
        text.detach()
    return count


def as_text(value: Any) -> Any:
    """Return a cell of a table; of a text one that no spreadsheet computes."""
    if not isinstance(value, str) or not value.startswith(FORMULA) or NUMBER.fullmatch(value):
        return value
    return f"'{value}"


@contextmanager
def replaced_path(path: Path) -> Iterator[Path]:
    """Give the path of an empty file that takes the name ``path`` when it is written.

    It has the permissions of an older file.  Raises CaseError where nothing can be written there;
    an older file is then left as it was.
    """
    try:
        real = path.resolve()
        _check_target(real, path)
        part = real.with_name(f".{real.name}.{os.getpid()}.part")
        try:
            part.unlink(missing_ok=True)
            # a new file: where somebody has put a link, that is not followed
            part.open("xb").close()
            yield part
            with part.open("rb") as file:
                os.fsync(file.fileno())
            if real.exists():
                shutil.copymode(real, part)
            os.replace(part, real)
        finally:
            part.unlink(missing_ok=True)
    except (OSError, RuntimeError, ValueError) as error:  # loops of links, a NUL in the name
        reason = getattr(error, "strerror", None) or str(error)
        remedy = "choose another place, make room, or change its permissions"
        raise CaseError(f"cannot be written: {reason}", where=str(path), remedy=remedy) from error


def _check_target(real: Path, path: Path) -> None:
    """Refuse to write over anything but a regular file, and into folders that are not there."""
    if real.is_dir():
        remedy = f"name a file in it, e.g. {path / 'blocks.dxf'}"
        raise CaseError("is a directory, not a file to write to", where=str(path), remedy=remedy)
    if not real.parent.is_dir():
        raise CaseError(
            f"the directory {real.parent} does not exist", where=str(path), remedy="create it first"
        )
    if real.exists() and not stat.S_ISREG(real.stat().st_mode):
        what = "is a device, a pipe or the like; it is not overwritten"
        raise CaseError(what, where=str(path), remedy="choose another name")


PLAIN_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")


def number_of(word: str) -> float | None:
    """Return the number that a word is, of a size of at most 1e20, or None; d may stand for e."""
    if not PLAIN_NUMBER.fullmatch(word):
        return None
    value = float(re.sub("[dD]", "e", word))
    return value if abs(value) <= 1e20 else None
