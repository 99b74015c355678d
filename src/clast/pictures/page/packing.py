"""Numbers of many frames as short texts: 16 bits each, differences, deflate, base64.

A block's displacement is linear over the block and stays so from step to step, so that six numbers
a frame place all of its vertices: displacement of its centroid, rotation, three of strain.  Each
of them, and each field, is rounded to a 65,535th of its range over the run or coarser, then kept as
the difference from the frame before, or as the change of that difference where motion is steady;
small numbers have a low byte and a high byte that is nearly always 0, so that the two are kept
apart, and compressed.  Rows of contacts and joints that find no room are left out evenly in space.
"""

from __future__ import annotations

import base64
import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.block.polygon import moments
from clast.model.model import Floats, Ints

LEVELS = 65_535
"""Steps that the range of a number is divided into, at most."""


def packed(values: Floats, least: float = 0.0, levels: int = LEVELS) -> dict[str, Any]:
    """Return numbers (frames, n) for the page: the ends of their range and a text.

    Each is rounded to so many ``levels`` of the range, or to a multiple of ``least`` where that is
    coarser; where there are numbers on both sides of zero, zero is a level.  NaN and infinity
    become 0.
    """
    values = np.nan_to_num(np.asarray(values, np.float64), posinf=0.0, neginf=0.0)
    low, high = float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))
    if not values.size:
        low = high = 0.0
    span = high - low
    if low < 0.0 < high:
        least = max(least, span / (levels - 1))
    if least * levels > span:
        # zero stays zero
        first, last = math.floor(low / least), math.ceil(high / least)
        low, high, levels = first * least, last * least, max(1, last - first)
        span = high - low
    share = (values - low) / span if span > 0.0 else np.zeros(values.shape)
    steps = _differences(np.rint(levels * share).astype(np.int64))
    coded, changes = _zigzag(steps), _zigzag(_differences(steps))
    order = 1
    if np.log2(1.0 + changes).sum() < np.log2(1.0 + coded).sum():
        coded, order = changes, 2
    return {"low": low, "high": high, "levels": levels, "order": order, "data": raw(coded, "<u2")}


def _differences(levels: Ints) -> Ints:
    """Return the change of 16-bit numbers (frames, n) from frame to frame, -32768 to 32767."""
    first = np.zeros((1, *levels.shape[1:]), np.int64)
    change = np.diff(np.concatenate([first, levels]), axis=0)
    return np.asarray((change + 32_768) % 65_536 - 32_768)


def _zigzag(change: Ints) -> NDArray[np.uint16]:
    """Return 0, -1, 1, -2, ... as 0, 1, 2, 3, ..."""
    return np.where(change < 0, -2 * change - 1, 2 * change).astype(np.uint16)


def raw(numbers: NDArray[Any], kind: str) -> str:
    """Return an array as a text: its bytes as ``kind``, such as "<f4", deflated, in base64."""
    # all first bytes, then all second ones: like stands by like, which packs better
    flat = np.ascontiguousarray(numbers, kind).ravel()
    planes = flat.view(np.uint8).reshape(len(flat), flat.itemsize).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")


def affine(start: Floats, frames: Iterable[Floats], block_start: Ints) -> dict[str, Floats]:
    """Return how blocks have moved from their ``start`` (nv, 2) in f frames (nv, 2), by name.

    ``x`` and ``y``: displacement of a block's centroid, m; ``angle``: its rotation,
    counter-clockwise, rad, without jumps of a full turn; ``xx``, ``yy``, ``xy``: the stretch less
    one, in the axes of the start, from the polar decomposition F = R U.  Each has the shape (f, n).
    """
    first, corners = block_start[:-1], np.diff(block_start)
    owner = np.repeat(np.arange(len(corners)), corners)
    middle = moments(start, block_start)[1]
    arm = start - middle[owner]
    inverse = np.linalg.inv(_sums(arm, arm, first))
    rows = []
    for here in frames:
        now = moments(here, block_start)[1]
        (f_xx, f_xy), (f_yx, f_yy) = (_sums(here - now[owner], arm, first) @ inverse).T.swapaxes(
            0, 1
        )
        turn = np.arctan2(f_yx - f_xy, f_xx + f_yy)
        cosine, sine = np.cos(turn), np.sin(turn)
        xx, yy = cosine * f_xx + sine * f_yx - 1.0, cosine * f_yy - sine * f_xy - 1.0
        rows.append([*(now - middle).T, turn, xx, yy, cosine * f_xy + sine * f_yy])
    names = ("x", "y", "angle", "xx", "yy", "xy")
    motion = dict(zip(names, np.array(rows).swapaxes(0, 1), strict=True))
    return motion | {"angle": np.unwrap(motion["angle"], axis=0)}


def _sums(left: Floats, right: Floats, first: Ints) -> Floats:
    """Return the sums over each block of the products of two vectors (nv, 2), (n, 2, 2)."""
    return np.asarray(np.add.reduceat(left[:, :, None] * right[:, None, :], first, axis=0))


ALWAYS = -1.0
"""Order of rows that are always kept."""


def spread(places: Floats) -> Floats:
    """Return an order of places (k, 2), 0 to 1: those below a share lie evenly among all.

    Along Morton's curve, of 2, 4, 8, ... in turn one lies in each half, quarter, eighth, ... of 0
    to 1, in which is chance, so that nothing regular in the places shows (Owen's scrambled nets,
    1995).
    """
    size = float(np.ptp(places, axis=0).max(initial=0.0)) or 1.0
    cell = ((places - places.min(axis=0)) / size * (2**12 - 1)).astype(np.int64)
    code = sum(((cell >> bit & 1) @ [1, 2]) << 2 * bit for bit in range(12))
    rank = np.empty(len(places), np.int64)
    rank[np.argsort(code, kind="stable")] = np.arange(len(places))
    chance = np.random.default_rng(0)
    bits, order = len(places).bit_length(), np.zeros_like(rank)
    for bit in range(bits):
        flip = chance.integers(0, 2, (int(rank.max(initial=0) >> bit + 1) + 1) << bit)
        digit = (rank >> bit & 1) ^ flip[((rank >> bit + 1) << bit) + order]
        order = 2 * order + digit
    return np.asarray((order + 0.5) / 2**bits)


def room_of_each(sizes: Sequence[int], budget: float) -> float:
    """Return how many bytes of a budget each table may take: small ones leave theirs to others."""
    left = budget
    for number, size in enumerate(sorted(sizes)):
        room = left / (len(sizes) - number)
        if size >= room:
            return room
        left -= size
    return budget


@dataclass
class Rows:
    """Rows of each frame, and in which order they are kept where there is no room for all.

    The order is that of places, the same in all frames, so that rows left out are left out in all
    of them; the largest of a frame stays.  All rows of a large run do not fit in memory: as soon as
    they exceed twice the budget they are cut back to it.
    """

    bytes: int
    """Those of a row."""
    budget: float
    """Bytes that all tables of a page may take."""
    total: int = 0
    """Rows of all frames, with those that are not kept."""
    rows: list[NDArray[Any]] = field(default_factory=list)
    """Rows of each frame, (m, columns) each."""
    order: list[Floats] = field(default_factory=list)
    """Order of each of them, (m,)."""

    def add(self, rows: NDArray[Any], order: Floats) -> None:
        """Add the rows (m, columns) of the next frame."""
        self.total += len(rows)
        self.rows.append(rows)
        self.order.append(order)
        if self.bytes * sum(map(len, self.rows)) > 2.0 * self.budget:
            self._cut(int(self.budget / self.bytes))

    def _cut(self, most: int) -> None:
        """Keep at most so many rows, the first by their order, beside the largest of each frame."""
        every = np.concatenate(self.order)
        if len(every) <= most:
            return
        past = max(0.0, float(np.partition(every, most)[most]))
        for frame, order in enumerate(self.order):
            kept = order < past
            self.rows[frame], self.order[frame] = self.rows[frame][kept], order[kept]

    def first(self, most: int) -> tuple[NDArray[Any], list[int]]:
        """Return at most so many, the first by their order, and how many of each frame."""
        self._cut(most)
        return np.concatenate(self.rows), list(map(len, self.rows))
