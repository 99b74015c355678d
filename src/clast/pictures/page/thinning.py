"""Rows of contacts and joints that find no room on a page: left out evenly in space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Floats

CELLS = 12
"""Bits of a coordinate along Morton's curve."""
ALWAYS = -1.0
"""Order of rows that are always kept."""


def spread(places: Floats) -> Floats:
    """Return an order of places (k, 2), 0 to 1: those below a share lie evenly among all.

    Along Morton's curve, of 2, 4, 8, ... in turn one lies in each half, quarter, eighth, ... of 0
    to 1, in which is chance, so that nothing regular in the places shows (Owen's scrambled nets,
    1995).
    """
    size = float(np.ptp(places, axis=0).max(initial=0.0)) or 1.0
    cell = ((places - places.min(axis=0)) / size * (2**CELLS - 1)).astype(np.int64)
    code = sum(((cell >> bit & 1) @ [1, 2]) << 2 * bit for bit in range(CELLS))
    rank = np.empty(len(places), np.int64)
    rank[np.argsort(code, kind="stable")] = np.arange(len(places))
    chance = np.random.default_rng(0)
    bits, found = len(places).bit_length(), np.zeros_like(rank)
    for bit in range(bits):
        flip = chance.integers(0, 2, (int(rank.max(initial=0) >> bit + 1) + 1) << bit)
        digit = (rank >> bit & 1) ^ flip[((rank >> bit + 1) << bit) + found]
        found = 2 * found + digit
    return np.asarray((found + 0.5) / 2**bits)


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

    The order is that of places, the same in all frames, so that what is left out is left out in all
    of them; the largest of a frame stays.  All rows of a large run do not find room in memory: what
    is twice the budget is cut at once.
    """

    bytes: int
    """Bytes of a row."""
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
