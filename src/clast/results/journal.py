"""A file whose changes take effect together, whenever the process is killed.

HDF5 overwrites its indexes and headers piece by piece, and a kill between two pieces, or in the
middle of one (Linux stops a write at a page of 4096 bytes), leaves a file that nothing reads.
``JournalledFile`` lies between HDF5 and the disk.  New bytes of HDF5 are written at once: nothing
refers to them yet.  Overwritten bytes are kept in memory until ``JournalledFile.commit``

1. writes all of it behind the end of the file, as a journal that ends with its length and checksum;
2. overwrites the old bytes;
3. cuts the journal off.

Killed before the journal is whole, the file is as it was, with unused bytes behind its end, which
HDF5 passes over.  Killed later, readers of clast look at the journal in place of the old bytes;
they never write.  The checksums behind the end (``clast.results.page_checksums``) change with the
rest.

    journal:  record, record, ..., trailer
    record:   place and length of the bytes (2 x u64, little-endian), the bytes
    trailer:  end of the file without the journal, length of the records (2 x u64), their CRC-32
              (u32), 8 bytes "clastjnl"
"""

from __future__ import annotations

import errno
import os
import struct
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np

from clast.results import locks
from clast.results.page_checksums import (
    END_PLACE,
    PAGE,
    FileObject,
    Piece,
    Sums,
    packed,
    page_count,
    read_at,
    sums_length,
    unpacked,
)

RECORD = struct.Struct("<QQ")
TRAILER = struct.Struct("<QQI8s")
MARK = b"clastjnl"


class JournalledFile(FileObject):
    """A file object for h5py to write into; only ``commit`` changes bytes that were there before.

    ``file`` is open and empty (or see ``again``).  It never fails while HDF5 writes, which HDF5
    would not recover from: bytes that find no room on the disk stay in memory, and ``commit``
    raises OSError; it may be called again.
    """

    def __init__(self, file: BinaryIO) -> None:
        super().__init__(file, end=0)
        self._committed = 0
        # The last bytes written to each stretch, in the order in which they were written.
        self._changes: dict[tuple[int, int], bytes] = {}
        self._changes_end = 0
        self._applying = False
        self._sums: Sums = np.zeros(0, np.uint32)
        self._touched: set[int] = set()
        self._process = os.getpid()

    @classmethod
    def again(cls, file: BinaryIO) -> JournalledFile:
        """Return the file object of a whole file that was written before, as its last commit was.

        A journal that a kill has left takes effect; bytes behind the end are passed over.
        """
        size, one = _complete(file), cls(file)
        one._end = int.from_bytes(read_at(file, END_PLACE, 8), "little")
        sums = unpacked(read_at(file, one._end, sums_length(one._end)), one._end)
        if one._end > size or sums is None:
            raise OSError(errno.EIO, "its checksums are missing")
        one._sums, one._committed = sums, one._end + sums_length(one._end)
        return one

    def sync(self) -> None:
        """Have all that has taken effect written to the disk itself."""
        os.fsync(self._file.fileno())

    def write(self, data: memoryview) -> int:
        """Append the bytes, or keep them for the next commit where they change existing ones."""
        new = bytes(data)
        self._touch(min(self._place, self._end), self._place + len(new))
        self._put(self._place, new)
        self._place += len(new)
        self._end = max(self._end, self._place)
        return len(new)

    def truncate(self, size: int) -> int:
        """Let the file end at ``size`` bytes after the next commit."""
        self._touch(min(size, self._end), max(size, self._end))
        self._end = size
        return size

    def commit(self) -> None:
        """Let all changes take effect, together; raises OSError where the disk is full."""
        if self._applying:
            # An interrupt came in between; its journal is whole.
            self._committed = _complete(self._file)
            self._applying = False
        self._renew_sums()
        end = self._end + sums_length(self._end)
        self._put(self._end, packed(self._sums, self._end))
        # HDF5 follows no address beyond the end that the superblock, at 0, gives: it goes first.
        changes = sorted(self._changes.items(), key=lambda change: change[0][0] != 0)
        pieces = [(start, new) for (start, _), new in changes]
        # The journal of a file that ends at ``end``: bytes and the places they go to.
        records = b"".join(RECORD.pack(start, len(new)) + new for start, new in pieces)
        journal = records + TRAILER.pack(end, len(records), zlib.crc32(records), MARK)
        behind = max(end, self._committed)
        self._write_at(behind, journal)
        self._file.truncate(behind + len(journal))
        self._applying = True
        with locks.changing(self._file):
            for start, new in pieces:
                self._write_at(start, new)
            self._file.truncate(end)
        self._committed = end
        self._changes.clear()
        self._changes_end = 0
        self._touched.clear()
        self._applying = False

    def is_at(self, path: Path) -> bool:
        """Return whether the file, if it is open and this process writes it, is at ``path``."""
        try:
            return self._is_ours() and os.path.samestat(os.fstat(self._file.fileno()), path.stat())
        except (OSError, ValueError):
            return False

    def close(self) -> None:
        """Close the file as it was after the last commit."""
        if not self._file.closed and not self._applying and self._is_ours():
            self._file.truncate(self._committed)
        self._file.close()

    def _is_ours(self) -> bool:
        """Return whether this process opened the file, and not the one that it was forked from."""
        return os.getpid() == self._process

    def _renew_sums(self) -> None:
        count = page_count(self._end)
        sums = np.zeros(count, np.uint32)
        kept = min(count, len(self._sums))
        sums[:kept] = self._sums[:kept]
        changes: dict[int, list[Piece]] = {}
        for (start, length), new in self._changes.items():
            for page in range(start // PAGE, page_count(start + length)):
                changes.setdefault(page, []).append((start, new))
        for page in {page for page in self._touched if page < count}:
            first, length = page * PAGE, min(PAGE, self._end - page * PAGE)
            sums[page] = zlib.crc32(self._overlaid(first, length, changes.get(page, ())))
        self._sums = sums

    def _touch(self, first: int, last: int) -> None:
        self._touched.update(range(first // PAGE, page_count(last)))

    def _put(self, start: int, new: bytes) -> None:
        """Write the bytes, or keep those that change bytes in use or find no room."""
        kept = min(len(new), max(0, self._committed - start))
        for place, piece in ((start, new[:kept]), (start + kept, new[kept:])):
            if piece and not self._appended(place, piece):
                self._changes.pop((place, len(piece)), None)
                self._changes[place, len(piece)] = piece
                self._changes_end = max(self._changes_end, place + len(piece))

    def _appended(self, start: int, new: bytes) -> bool:
        """Write the bytes behind all that counts; False where they are not, or find no room."""
        if self._applying or not self._is_ours() or start < max(self._committed, self._changes_end):
            return False
        try:
            self._write_at(start, new)
        except OSError:
            return False
        return True

    def _read(self, place: int, count: int) -> bytes:
        """Return the bytes from ``place`` on, changes not yet committed included."""
        changes = ((start, new) for (start, _), new in self._changes.items())
        return self._overlaid(place, count, changes)

    def _write_at(self, place: int, data: bytes) -> None:
        self._file.seek(place)
        _write(self._file, data)


def read_journal(file: BinaryIO) -> tuple[int, list[Piece]] | None:
    """Return where the file ends without its journal, and the bytes that are to replace others.

    None where there is no journal, or none that is whole.
    """
    size = file.seek(0, os.SEEK_END)
    trailer = read_at(file, max(0, size - TRAILER.size), TRAILER.size)
    if len(trailer) < TRAILER.size:
        return None
    end, length, checksum, mark = TRAILER.unpack(trailer)
    if mark != MARK or end + length + TRAILER.size > size:
        return None
    records = read_at(file, size - TRAILER.size - length, length)
    if len(records) < length or zlib.crc32(records) != checksum:
        return None
    pieces, at = [], 0
    while at + RECORD.size <= length:
        start, count = RECORD.unpack_from(records, at)
        at += RECORD.size
        pieces.append((start, records[at : at + count]))
        at += count
    whole = at == length and all(start + len(new) <= end for start, new in pieces)
    return (end, pieces) if whole else None


def _complete(file: BinaryIO) -> int:
    """Apply the journal at the end of the file, and cut it off; return the end."""
    journal = read_journal(file)
    if journal is None:
        return file.seek(0, os.SEEK_END)
    end, pieces = journal
    with locks.changing(file):
        for start, new in pieces:
            file.seek(start)
            _write(file, new)
        file.truncate(end)
    return end


def _write(file: BinaryIO, data: bytes) -> None:
    """Write all the bytes: one call may write fewer."""
    view = memoryview(data)
    while view:
        view = view[file.write(view) :]
