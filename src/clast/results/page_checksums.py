"""Checksums of a result file, page by page, and a view of it that gives out no damaged byte.

HDF5 has checksums of its own for the numbers (Fletcher's, which every viewer looks at) and for some
of the data it keeps beside them, but for none of its indexes.  So behind the end of the part that
HDF5 knows there are checksums of all of it, which HDF5 passes over::

    sums:  8 bytes "clastsum", end of the file for HDF5 (u64, little-endian), CRC-32 of each page of
           16384 bytes until there (u32 each), CRC-32 of all this (u32)

Where they lie is said by HDF5's superblock, at the start of the file.
"""

from __future__ import annotations

import errno
import os
import struct
import zlib
from collections.abc import Iterable, Sequence
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

PAGE = 16384
"""Bytes that a checksum is made of."""
HEAD = struct.Struct("<8sQ")
SUM = struct.Struct("<I")
MARK = b"clastsum"
END_PLACE = 28
"""Where HDF5's superblock of version 2 has the end of the file (u64)."""

Piece = tuple[int, bytes]
"""A place, and the bytes there."""
Sums = NDArray[np.uint32]


def page_count(end: int) -> int:
    """Return the number of pages of the first ``end`` bytes; the last may be shorter."""
    return -(-end // PAGE)


def packed(sums: Sums, end: int) -> bytes:
    """Return the checksums of the first ``end`` bytes as they are written."""
    content = HEAD.pack(MARK, end) + sums.astype("<u4").tobytes()
    return content + SUM.pack(zlib.crc32(content))


def sums_length(end: int) -> int:
    """Return how long the checksums of the first ``end`` bytes are, bytes."""
    return HEAD.size + SUM.size * (page_count(end) + 1)


def unpacked(content: bytes, end: int) -> Sums | None:
    """Return the checksums of the first ``end`` bytes from their written form, None without any."""
    content = content[: sums_length(end)]
    if len(content) < sums_length(end) or HEAD.unpack_from(content) != (MARK, end):
        return None
    if SUM.unpack(content[-SUM.size :])[0] != zlib.crc32(content[: -SUM.size]):
        return None
    return np.frombuffer(content[HEAD.size : -SUM.size], "<u4").astype(np.uint32)


class DamagedPageError(Exception):
    """Bytes of a result file that differ from those written."""


class FileObject:
    """The methods that h5py needs of a file object for reading: a place in it, and reading."""

    def __init__(self, file: BinaryIO, end: int) -> None:
        self._file = file
        self._end = end
        self._place = 0

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place; returns it, bytes from the start."""
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._end}[whence]
        self._place = start + offset
        return self._place

    def tell(self) -> int:
        """Return the place, bytes from the start."""
        return self._place

    def readinto(self, buffer: memoryview) -> int:
        """Fill the buffer from the place on; returns how many bytes there are."""
        view = memoryview(buffer).cast("B")
        count = max(0, min(len(view), self._end - self._place))
        view[:count] = self._read(self._place, count)
        self._place += count
        return count

    def read(self, count: int) -> bytes:
        """Return ``count`` bytes from the place on, or as many as there are."""
        buffer = bytearray(count)
        return bytes(buffer[: self.readinto(memoryview(buffer))])

    def flush(self) -> None:
        """Do nothing: a reader writes nothing, a writer's changes wait for its commit."""

    def _read(self, place: int, count: int) -> bytes:
        """Return the ``count`` bytes from ``place`` on, all before the end."""
        raise NotImplementedError

    def _overlaid(self, place: int, count: int, pieces: Iterable[Piece]) -> bytes:
        """Return ``count`` bytes with the pieces put in; zeros behind the end of the file."""
        content = bytearray(read_at(self._file, place, count).ljust(count, b"\0"))
        for start, new in pieces:
            first, last = max(start, place), min(start + len(new), place + count)
            if first < last:
                content[first - place : last - place] = new[first - start : last - start]
        return bytes(content)


class CheckedFile(FileObject):
    """A file object for h5py to read from: the file with some pieces replaced, and checked.

    ``file`` is read only; ``pieces`` are the bytes of a journal that replace others.
    """

    def __init__(self, file: BinaryIO, size: int, pieces: Sequence[Piece] = ()) -> None:
        super().__init__(file, size)
        self._pieces = pieces
        self._sound: set[int] = set()
        self.sums: Sums | None = None
        # What went wrong when something was read.  An error must not go through HDF5, nor be kept
        # here: it knows all that has called this, and HDF5 would never let go of the file.
        self.damage = ""
        end = int.from_bytes(self._content(END_PLACE, 8), "little")
        if 0 < end <= size:
            self.sums = unpacked(self._content(end, sums_length(end)), end)
        if self.sums is not None:
            self._end = end

    def check_all(self) -> None:
        """Raise DamagedPageError for the first page that differs from the one written."""
        self._check(0, self._end)

    def write(self, _data: memoryview) -> int:
        """Refuse: the file is read only."""
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    def truncate(self, size: int) -> int:
        """Leave the file as it is."""
        return size

    def _check(self, first: int, last: int) -> None:
        """Raise DamagedPageError where bytes from ``first`` up to ``last`` are not as written."""
        if self.sums is None or first >= last:
            return
        for page in set(range(first // PAGE, page_count(last))) - self._sound:
            first = page * PAGE
            if zlib.crc32(self._content(first, min(PAGE, self._end - first))) != self.sums[page]:
                raise DamagedPageError(
                    f"bytes {first} to {first + PAGE - 1} differ from those written"
                )
            self._sound.add(page)

    def _read(self, place: int, count: int) -> bytes:
        """Return the bytes from ``place`` on, zeros where the file is damaged."""
        try:
            self._check(place, place + count)
            return self._content(place, count)
        except (DamagedPageError, OSError) as error:
            self.damage = str(error)
            return bytes(count)

    def _content(self, place: int, count: int) -> bytes:
        """Return ``count`` bytes as the journal wants them, unchecked."""
        return self._overlaid(place, count, self._pieces)


def read_at(file: BinaryIO, place: int, count: int) -> bytes:
    """Return ``count`` bytes, or as many as there are: one call may give fewer."""
    file.seek(place)
    pieces = []
    while count and (piece := file.read(count)):
        pieces.append(piece)
        count -= len(piece)
    return b"".join(pieces)
