"""Opens result files for reading: as they were when a frame last took effect, and unchanged."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from clast.errors import CaseError
from clast.results import locks
from clast.results.journal import read_journal
from clast.results.page_checksums import CheckedFile, DamagedPageError
from clast.results.schema import FORMAT

QUICKLY_CHECKED = 2**28
"""Size of a file that is checked from end to end in less than half a second, bytes."""
AGAIN = "run the case again to write a new one"

Answer = TypeVar("Answer")


class MalformedError(Exception):
    """A result file whose parts do not fit together; says which."""


def ask(path: Path, question: Callable[[Any], Answer], *, whole: int = 0) -> Answer:
    """Return the answer of ``question`` about the open file (h5py); errors become a CaseError.

    Files of at most ``whole`` bytes are checked from end to end before, others only where they are
    read.  Nothing is written: the unfinished write of a run that was killed is completed in memory.
    """
    failure: Exception = MalformedError("it changes all the time")
    try:
        # How often a file is read again that has changed meanwhile, where locks do not prevent it
        for _ in range(20):
            before = path.stat()
            if stat.S_ISDIR(before.st_mode):
                remedy = "name a file in it; clast study collect reports on a folder of a study"
                raise CaseError("is a directory, not a result file", remedy=remedy)
            if not stat.S_ISREG(before.st_mode):
                raise CaseError("is a device, a pipe or the like, no result file")
            try:
                return _answer(path, question, whole)
            except PermissionError:
                raise
            except Exception as error:
                failure = error
            after = path.stat()
            if (before.st_mtime_ns, before.st_size) == (after.st_mtime_ns, after.st_size):
                break
    except CaseError as error:
        failure = error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        what, remedy = f"cannot be read: {reason}", "name a result file of a run"
        if isinstance(error, PermissionError):
            what, remedy = "cannot be read: permission denied", "change its permissions"
        elif isinstance(error, FileNotFoundError):
            what, remedy = "there is no such file", "clast run CASE -o FILE writes one"
        raise CaseError(what, where=str(path), remedy=remedy) from error
    # An error that no longer holds the file: HDF5 must not keep it to the very end.
    one: BaseException | None = failure
    while one is not None:
        one.__traceback__ = None
        one = one.__cause__ or one.__context__
    raise _as_case_error(failure, path) from failure


def is_result_file(path: Path) -> bool:
    """Return whether a file is one that clast has written, of whatever layout."""
    try:
        return ask(path, _has_our_mark)
    except CaseError:
        return False


def check_ours(file: Any) -> None:
    """Raise CaseError for a file that clast has not written, or in a layout of another version."""
    if not _has_our_mark(file):
        raise CaseError(
            "is an HDF5 file, but not a clast result file",
            remedy="name a file that clast run has written",
        )
    layout = int(file["model"].attrs["format"])
    if layout != FORMAT:
        age, remedy = ("a newer", "update clast") if layout > FORMAT else ("an older", AGAIN)
        known = f"(layout {layout}, this one knows {FORMAT})"
        raise CaseError(f"was written by {age} version of clast {known}", remedy=remedy)


def _has_our_mark(file: Any) -> bool:
    return "VTKHDF" in file and "model" in file and "format" in file["model"].attrs


def _answer(path: Path, question: Callable[[Any], Answer], whole: int) -> Answer:
    import h5py

    with open(path, "rb", buffering=0) as file, locks.reading(file):
        # as a journal at its end wants it to be
        journal = read_journal(file)
        checked = CheckedFile(file, *(journal or (file.seek(0, os.SEEK_END),)))
        try:
            # What a newer clast has written, or another program, is said before what is broken.
            with h5py.File(checked, "r") as content:
                if _has_our_mark(content):
                    check_ours(content)
                    if checked.sums is None:
                        raise MalformedError("its checksums are missing")
                    if os.fstat(file.fileno()).st_size <= whole:
                        checked.check_all()
                answer = question(content)
        except CaseError:
            raise
        except Exception as error:
            if not checked.damage:
                raise
            raise DamagedPageError(checked.damage) from error
        if checked.damage:
            raise DamagedPageError(checked.damage)
        return answer


def _as_case_error(error: Exception, path: Path) -> CaseError:
    if isinstance(error, CaseError):
        return CaseError(error.what, where=error.where or str(path), remedy=error.remedy)
    specific = isinstance(error, MalformedError | DamagedPageError)
    reason = f"is damaged: {error}" if specific else "is not a clast result file, or is damaged"
    return CaseError(reason, where=str(path), remedy=AGAIN)
