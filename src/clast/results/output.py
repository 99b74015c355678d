"""The place of results: an existing file is looked at first, and taken for one run."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import BinaryIO

from clast.errors import CaseError
from clast.results import locks
from clast.results.open_file import is_result_file

ELSEWHERE = "choose another name for the results"


def check_output(path: Path) -> Path:
    """Return the path of a file that results can be written to, or raise CaseError.

    Symbolic links are followed.  An existing file may only be an older result file, or empty.
    """
    try:
        return _checked(path)
    except (OSError, ValueError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise CaseError(
            f"cannot be written to: {reason}", where=str(path), remedy=ELSEWHERE
        ) from error


def _checked(path: Path) -> Path:
    real = path.resolve()
    exists = real.exists()
    what, remedy = "", ELSEWHERE
    if real.is_dir():
        what = "is a directory, not a file to write results to"
        remedy = f"name a file in it, e.g. {path / 'out.vtkhdf'}"
    elif not real.parent.is_dir():
        what, remedy = f"the directory {real.parent} does not exist", "create it first"
    elif exists and not stat.S_ISREG(real.stat().st_mode):
        what = "is a device, a pipe or the like; it is not overwritten"
    elif not os.access(real.parent, os.W_OK) or (exists and not os.access(real, os.W_OK)):
        what, remedy = (
            "cannot be written: permission denied",
            f"{ELSEWHERE} or change its permissions",
        )
    elif exists and real.stat().st_size and not is_result_file(real):
        what = "exists and is not a clast result file, or a damaged one; it is not overwritten"
        remedy = f"{ELSEWHERE}, or remove it"
    if what:
        raise CaseError(what, where=str(path), remedy=remedy)
    hidden(real).exists()  # a name that is too long for it is refused by the system
    return real


def hidden(path: Path) -> Path:
    """Return the file that the first frame is written to before it gets its name."""
    return path.with_name(f".{path.name}.part")


def fresh(part: Path) -> BinaryIO:
    """Return a new file at a hidden name, open for writing; an older one is removed.

    Nobody else's file is written to: a link is removed, not followed.
    """
    part.unlink(missing_ok=True)
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0)
    return open(os.open(part, flags | getattr(os, "O_BINARY", 0), 0o666), "w+b")


def claimed(path: Path) -> BinaryIO:
    """Return the hidden file beside a result file, empty, open and locked for one run.

    Raises CaseError where another run has it, or has given it its name already, and where
    something else is in its place.
    """
    part = hidden(path)
    while True:
        file = _opened(part)
        if not locks.claim(file):
            file.close()
            raise _in_use(path)
        if _is_at(file, part):
            break
        file.close()  # its run ended before the lock was ours
    if path.exists():
        with open(path, "r+b", buffering=0) as older:
            if not locks.claim(older):
                part.unlink()
                file.close()
                raise _in_use(path)
    file.truncate(0)
    return file


def _opened(part: Path) -> BinaryIO:
    """Return a hidden file, new or left by a run that was killed: no link, pipe or device."""
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        file = open(os.open(part, flags | getattr(os, "O_BINARY", 0), 0o666), "r+b", buffering=0)
    except OSError as error:
        if not part.is_symlink() and not part.exists():
            raise
        raise _occupied(part) from error
    status = os.fstat(file.fileno())
    # a file with a second name is somebody's who did not mean it to be emptied
    if not stat.S_ISREG(status.st_mode) or status.st_nlink > 1:
        file.close()
        raise _occupied(part)
    return file


def _occupied(part: Path) -> CaseError:
    return CaseError(
        "has the name of the temporary result file, but does not come from a run; it is not "
        "overwritten",
        where=str(part),
        remedy=f"remove it, or {ELSEWHERE}",
    )


def taken_up(path: Path) -> BinaryIO:
    """Return a result file, open and locked for a run that goes on with it.

    Raises CaseError where another run has it.
    """
    flags = os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    file = open(os.open(path, flags | getattr(os, "O_BINARY", 0)), "r+b", buffering=0)
    if not locks.claim(file) or not _is_at(file, path):
        file.close()
        raise _in_use(path)
    return file


def _in_use(path: Path) -> CaseError:
    return CaseError(
        "another run is writing to it",
        where=str(path),
        remedy=f"wait until it has finished, or {ELSEWHERE}",
    )


def _is_at(file: BinaryIO, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False
