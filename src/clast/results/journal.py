"""A file whose changes take effect together, whenever the process is killed.

HDF5 overwrites its indexes and headers piece by piece, and a kill between two pieces, or in the
middle of one (Linux stops a write at a page of 4096 bytes), leaves a file that nothing reads.
:class:`JournalledFile` lies between HDF5 and the disk.  What HDF5 appends is written at once:
nothing refers to it yet.  What it overwrites is kept in memory until :meth:`JournalledFile.commit`

1. writes all of it behind the end of the file, as a journal that ends with its length and checksum;
2. overwrites the old bytes;
3. cuts the journal off.

Killed before the journal is whole, the file is as it was, with unused bytes behind its end, which
HDF5 passes over.  Killed later, :func:`complete_journal` does steps 2 and 3 again.

    journal:  record, record, ..., trailer
    record:   place and length of the bytes (2 x u64, little-endian), the bytes
    trailer:  end of the file without the journal, length of the records (2 x u64), their CRC-32
              (u32), 8 bytes "clastjnl"
"""

from __future__ import annotations

import os
import struct
import time
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO

from clast.errors import CaseError

RECORD = struct.Struct("<QQ")
TRAILER = struct.Struct("<QQI8s")
MARK = b"clastjnl"
PATIENCE = 1.0
"""How long the writer of a journal is waited for before it is taken to be dead, s."""


class JournalledFile:
    """A file object for h5py to write into; only :meth:`commit` changes what was there before.

    It never fails while HDF5 writes, which HDF5 would not recover from: what finds no room on the
    disk stays in memory, and ``commit`` raises OSError; it may be called again.
    """

    def __init__(self, path: Path) -> None:
        self._file: BinaryIO = open(path, "r+b", buffering=0)
        self._end = self._committed = self._file.seek(0, os.SEEK_END)
        self._place = 0
        # The last bytes written to each stretch, in the order in which they were written.
        self._changes: dict[tuple[int, int], bytes] = {}
        self._applying = False

    # What h5py calls ---------------------------------------------------------------------------

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place; returns it, bytes from the start."""
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._end}[whence]
        self._place = start + offset
        return self._place

    def tell(self) -> int:
        """Return the place, bytes from the start."""
        return self._place

    def readinto(self, buffer: memoryview) -> int:
        """Fill the buffer from the place on, changes not yet committed included."""
        view = memoryview(buffer).cast("B")
        count = max(0, min(len(view), self._end - self._place))
        read = self._read_at(self._place, count)
        view[:count] = read.ljust(count, b"\0")
        for (start, length), new in self._changes.items():
            first = max(start, self._place)
            last = min(start + length, self._place + count)
            if first < last:
                view[first - self._place : last - self._place] = new[first - start : last - start]
        self._place += count
        return count

    def read(self, count: int) -> bytes:
        """Return ``count`` bytes from the place on, or as many as there are."""
        buffer = bytearray(count)
        return bytes(buffer[: self.readinto(memoryview(buffer))])

    def write(self, data: memoryview) -> int:
        """Append the bytes, or keep them for the next commit where they change what is there."""
        new = bytes(data)
        start, length = self._place, len(new)
        self._place += length
        self._end = max(self._end, self._place)
        if not self._appended(start, new):
            self._changes.pop((start, length), None)
            self._changes[start, length] = new
        return length

    def truncate(self, size: int) -> int:
        """Let the file end at ``size`` bytes after the next commit."""
        self._end = size
        return size

    def flush(self) -> None:
        """Do nothing: ``commit`` decides when changes take effect."""

    # What the writer of results calls ------------------------------------------------------------

    def commit(self) -> None:
        """Let all changes take effect, together; raises OSError where the disk is full."""
        if self._applying:
            # An interrupt came in between; its journal is whole.
            self._committed = _complete(self._file)
            self._applying = False
        # HDF5 follows no address beyond the end that the superblock, at 0, gives: it goes first.
        changes = sorted(self._changes.items(), key=lambda change: change[0][0] != 0)
        pieces = [(start, new) for (start, _), new in changes]
        self._write_at(self._end, journal := _journal(self._end, pieces))
        self._file.truncate(self._end + len(journal))
        self._applying = True
        for start, new in pieces:
            self._write_at(start, new)
        self._file.truncate(self._end)
        self._committed = self._end
        self._changes.clear()
        self._applying = False

    def close(self) -> None:
        """Close the file as it was after the last commit."""
        if not self._file.closed and not self._applying:
            self._file.truncate(self._committed)
        self._file.close()

    def _appended(self, start: int, new: bytes) -> bool:
        """Write the bytes behind all that counts; False where they are not, or find no room."""
        changed = max((first + length for first, length in self._changes), default=0)
        if self._applying or start < max(self._committed, changed):
            return False
        try:
            self._write_at(start, new)
        except OSError:
            return False
        return True

    def _read_at(self, place: int, count: int) -> bytes:
        self._file.seek(place)
        return _read(self._file, count)

    def _write_at(self, place: int, data: bytes) -> None:
        self._file.seek(place)
        _write(self._file, data)


def complete_journal(path: Path) -> None:
    """Complete what a process that was killed had begun to write to the file, if anything.

    Raises CaseError where that is needed and the file may not be written.
    """
    patience = time.monotonic() + PATIENCE
    while left := _has_journal(path):
        # A writer that is alive cuts its journal off within milliseconds.
        if time.monotonic() >= patience:
            break
        time.sleep(0.01)
    if not left:
        return
    try:
        with open(path, "r+b", buffering=0) as file:
            _complete(file)
    except OSError as error:
        raise CaseError(
            "its run was killed while it wrote a frame, which has to be completed",
            where=str(path),
            remedy="make the file writable, or copy it, and open it again",
        ) from error


def _has_journal(path: Path) -> bool:
    with open(path, "rb", buffering=0) as file:
        return _read_journal(file) is not None


def _complete(file: BinaryIO) -> int:
    """Overwrite what the journal at the end of the file says, and cut it off; return the end."""
    found = _read_journal(file)
    if found is None:
        return file.seek(0, os.SEEK_END)
    end, records = found
    at = 0
    while at < len(records):
        start, length = RECORD.unpack_from(records, at)
        at += RECORD.size
        file.seek(start)
        _write(file, records[at : at + length])
        at += length
    file.truncate(end)
    return end


def _journal(end: int, pieces: Iterable[tuple[int, bytes]]) -> bytes:
    """Return the journal of a file that ends at ``end``: bytes and the places they go to."""
    records = b"".join(RECORD.pack(start, len(new)) + new for start, new in pieces)
    return records + TRAILER.pack(end, len(records), zlib.crc32(records), MARK)


def _read_journal(file: BinaryIO) -> tuple[int, bytes] | None:
    """Return where the file ends without its journal, and the records; None without a journal."""
    size = file.seek(0, os.SEEK_END)
    if size < TRAILER.size:
        return None
    file.seek(size - TRAILER.size)
    trailer = _read(file, TRAILER.size)
    if len(trailer) < TRAILER.size:
        return None
    end, length, checksum, mark = TRAILER.unpack(trailer)
    if mark != MARK or end + length + TRAILER.size != size:
        return None
    file.seek(end)
    records = _read(file, length)
    if len(records) < length or zlib.crc32(records) != checksum:
        return None
    return end, records


def _read(file: BinaryIO, count: int) -> bytes:
    """Return ``count`` bytes, or as many as there are: one call may give fewer."""
    pieces = []
    while count and (piece := file.read(count)):
        pieces.append(piece)
        count -= len(piece)
    return b"".join(pieces)


def _write(file: BinaryIO, data: bytes) -> None:
    """Write all the bytes: one call may write fewer."""
    view = memoryview(data)
    while view:
        view = view[file.write(view) :]
