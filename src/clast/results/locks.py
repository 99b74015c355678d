"""Locks on a result file: one run writes it, and nobody reads it while a frame takes effect.

They are locks of the system on two bytes of the file, which end with the process that holds them,
however it ends, and stay with the file when it is renamed.  Viewers know nothing of them and are
not kept out.  Where a file system has no locks, none are held.
"""

from __future__ import annotations

import errno
import os
import struct
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

RUN, CONTENT = 0, 1
"""The byte that a run locks as long as it goes on, and the one that says who is at the content."""
PATIENCE = 5.0
"""How long others are waited for before they are taken to be stuck, s."""
SHORTEST, LONGEST = 0.0005, 0.01
"""Pauses between two looks whether others have finished, s."""
TAKEN = {errno.EACCES, errno.EAGAIN}
FLOCK = struct.Struct("@hhqqi")
"""Linux' struct flock: kind, from where, first byte, length, process (none)."""


def claim(file: BinaryIO) -> bool:
    """Take a file for a run until it is closed; False where another run has it."""
    return _lock(file, "F_WRLCK", RUN)


@contextmanager
def changing(file: BinaryIO, patience: float = PATIENCE) -> Iterator[None]:
    """Keep readers of the content out in the block; waits ``patience``, s, for one at most."""
    with _held(file, "F_WRLCK", patience):
        yield


@contextmanager
def reading(file: BinaryIO, patience: float = PATIENCE) -> Iterator[None]:
    """Keep the content as it is in the block."""
    with _held(file, "F_RDLCK", patience):
        yield


@contextmanager
def _held(file: BinaryIO, kind: str, patience: float) -> Iterator[None]:
    end, pause = time.monotonic() + patience, SHORTEST
    while not _lock(file, kind, CONTENT) and time.monotonic() < end:
        # a reader that others hold up must not cost a run processor time
        time.sleep(pause)
        pause = min(LONGEST, 2.0 * pause)
    try:
        yield
    finally:
        _lock(file, "F_UNLCK", CONTENT)


def _lock(file: BinaryIO, kind: str, byte: int) -> bool:
    """Lock or unlock a byte without waiting; False where somebody else has locked it."""
    system: Any = fcntl
    if system is None:
        return True
    # Locks of an open file, where there are any: those of a process would end when it closes the
    # file elsewhere, as it does after reading it.
    command = getattr(system, "F_OFD_SETLK", None)
    try:
        if command is not None:
            wanted = FLOCK.pack(getattr(system, kind), os.SEEK_SET, byte, 1, 0)
            system.fcntl(file, command, wanted.ljust(FLOCK.size + 4, b"\0"))
        else:
            kinds = {"F_WRLCK": system.LOCK_EX, "F_RDLCK": system.LOCK_SH, "F_UNLCK": 0}
            how = kinds[kind] | system.LOCK_NB if kinds[kind] else system.LOCK_UN
            system.lockf(file, how, 1, byte)
    except OSError as error:
        return error.errno not in TAKEN
    return True
