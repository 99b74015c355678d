"""Pairs of blocks whose boxes overlap, in a time linear in the number of blocks.

A hierarchy of uniform grids: each block is filed in one cell of the level whose cells are just
larger than the block, and looks for partners in its own and all coarser levels.  So blocks a
thousand times different in size cost no more than equal ones.  The cells are kept in a hash table,
so that empty ones cost nothing.

To find pairs anew in every step would cost as much as a fifth of a step in which most blocks rest
or fly.  So they are found with boxes wider than asked for and kept (a neighbour list; Verlet 1967).
As long as each box that is asked about lies within the one it had then, its pairs are among those
that are kept, and a look at these tells which.  The answer is that of a new search, to the pair.
"""

from __future__ import annotations

import numpy as np

from clast.block import polygon
from clast.compute.jit import kernel
from clast.compute.parallel import BLOCKS, CONTACTS, EACH, shared
from clast.model.model import Bools, Floats, Ints

GRID_LEVELS = 48
"""Cell sizes differ by 2 from level to level; 48 levels span a ratio of 1e14."""
BOXES_PER_PART = CONTACTS.part
"""Boxes, or pairs of them, that a thread takes at a time."""


def overlapping_pairs(box: Floats, fixed: Bools) -> Ints:
    """Return pairs (lower, higher) of overlapping boxes, sorted, shape (m, 2).

    ``box`` (n, 4) holds (xmin, ymin, xmax, ymax) in m, already widened by the search distance;
    pairs of two blocks that are ``fixed`` (n,) are left out.  O(n).
    """
    count = len(box)
    if count < 2:
        return np.zeros((0, 2), np.int64)
    # The origin of the grids, and level (n,) and cell (n, 2) of each box (n, 4).
    size = np.maximum(box[:, 2] - box[:, 0], box[:, 3] - box[:, 1])
    smallest = float(size.min()) * 1.001  # so that round-off cannot let a box reach two cells on
    origin = smallest, float(box[:, 0].min()), float(box[:, 1].min())
    level, cell = np.empty(len(box), np.int64), np.empty((len(box), 2), np.int64)
    _cells(len(box), box, size, origin, level, cell)
    slots = np.zeros(2 ** int(2 * count - 1).bit_length() + 1, np.int64)
    order = np.empty(count, np.int64)
    _file(level, cell, slots, order)
    filed = box[order], fixed[order], level[order], cell[order], order
    occupied = np.bincount(level, minlength=GRID_LEVELS) > 0
    counts = np.zeros(-(-count // BOXES_PER_PART), np.int64)
    most = 8 * min(BOXES_PER_PART, count) + 64
    while True:
        room = np.empty((len(counts), most, 2), np.int64)
        _collect_parts(len(counts), filed, slots, origin, occupied, room, counts)
        if counts.max() <= most:
            break
        most = int(counts.max())
    pairs = np.concatenate([one[:number] for one, number in zip(room, counts, strict=True)])
    for side in (1, 0):
        unsorted, pairs = pairs, np.empty_like(pairs)
        _sort_by(unsorted, side, np.zeros(count + 1, np.int64), pairs)
    return pairs


@shared(BLOCKS)
def _cells(first, last, box, size, origin, level, cell):
    """Write the level of each box and the cell of its lower left corner there, (n, 2)."""
    smallest, xmin, ymin = origin
    for b in range(first, last):
        step = 0
        side = smallest
        while side < size[b] and step < GRID_LEVELS - 1:
            side *= 2.0
            step += 1
        level[b] = step
        cell[b, 0] = int(np.floor((box[b, 0] - xmin) / side))
        cell[b, 1] = int(np.floor((box[b, 1] - ymin) / side))


@kernel()
def _slot(level, row, column, mask):
    """Return the slot of a cell in a hash table of ``mask`` + 1 slots, a power of 2.

    The cells of a row follow each other, so that neighbours are neighbours in memory too.
    """
    return (column + row * 0x1E3779B97F4A7C15 + level * 0x165667B19E3779F9) & mask


@kernel()
def _file(level, cell, start, order):
    """Write the first position of each slot of the hash table, into zeros, and the boxes by slot.

    A slot is one of a power of 2; ``order`` (n,) are the boxes in the order of their slots.
    """
    count, mask = len(level), len(start) - 2
    slot = np.empty(count, np.int64)
    for b in range(count):
        slot[b] = _slot(level[b], cell[b, 1], cell[b, 0], mask)
        start[slot[b] + 1] += 1
    for s in range(mask + 1):
        start[s + 1] += start[s]
    filled = start[:-1].copy()
    for b in range(count):
        order[filled[slot[b]]] = b
        filled[slot[b]] += 1


@kernel()
def _overlap(box, a, b):
    """Return True if two boxes overlap or touch."""
    return (
        box[a, 0] <= box[b, 2]
        and box[b, 0] <= box[a, 2]
        and box[a, 1] <= box[b, 3]
        and box[b, 1] <= box[a, 3]
    )


@kernel()
def _collect(first, last, filed, slots, origin, occupied, pairs):
    """Fill ``pairs`` with overlaps of boxes ``first`` to ``last`` - 1; return how many there are.

    There may be more than fit.  ``filed`` are boxes, which are fixed, levels, cells and blocks in
    the order in which they are filed, ``slots`` (s + 1,) the first of each slot of the hash table,
    ``origin`` the size of the smallest cells and where they begin, m.
    """
    box, fixed, level, cell, order = filed
    smallest, xmin, ymin = origin
    mask, count = len(slots) - 2, 0
    for b in range(first, last):
        for k in range(level[b], GRID_LEVELS):
            if not occupied[k]:
                continue
            size = smallest * 2.0**k
            # a box of this level is filed by its lower left corner and reaches one cell further
            left = int(np.floor((box[b, 0] - xmin) / size)) - 1
            right = int(np.floor((box[b, 2] - xmin) / size))
            bottom = int(np.floor((box[b, 1] - ymin) / size)) - 1
            top = int(np.floor((box[b, 3] - ymin) / size))
            for row in range(bottom, top + 1):
                for column in range(left, right + 1):
                    slot = _slot(k, row, column, mask)
                    for other in range(slots[slot], slots[slot + 1]):
                        if (k == level[b] and other <= b) or level[other] != k:
                            continue
                        if cell[other, 0] != column or cell[other, 1] != row:
                            continue
                        if (fixed[b] and fixed[other]) or not _overlap(box, b, other):
                            continue
                        if count < len(pairs):
                            pairs[count, 0] = min(order[b], order[other])
                            pairs[count, 1] = max(order[b], order[other])
                        count += 1
    return count


@shared(EACH)
def _collect_parts(first, last, filed, slots, origin, occupied, room, counts):
    """Fill the rooms of parts ``first`` to ``last`` - 1 with pairs; write how many there are."""
    for part in range(first, last):
        low, high = part * BOXES_PER_PART, min((part + 1) * BOXES_PER_PART, len(filed[0]))
        counts[part] = _collect(low, high, filed, slots, origin, occupied, room[part])


@kernel()
def _sort_by(pairs, side, start, result):
    """Write the pairs sorted by their block on one side, equal ones in the order they came.

    ``start`` (n + 1,) is room for n blocks, all 0.
    """
    for q in range(len(pairs)):
        start[pairs[q, side] + 1] += 1
    for b in range(len(start) - 1):
        start[b + 1] += start[b]
    for q in range(len(pairs)):
        b = pairs[q, side]
        result[start[b], 0] = pairs[q, 0]
        result[start[b], 1] = pairs[q, 1]
        start[b] += 1


@kernel()
def widen(box, half):
    """Widen boxes (n, 4) by ``half`` (n,), m, on all sides, in place."""
    for b in range(len(box)):
        box[b, 0], box[b, 1] = box[b, 0] - half[b], box[b, 1] - half[b]
        box[b, 2], box[b, 3] = box[b, 2] + half[b], box[b, 3] + half[b]


@kernel()
def all_within(box, wide):
    """Return whether each box (n, 4) lies within the wide one of the same number."""
    for b in range(len(box)):
        if not (
            box[b, 0] >= wide[b, 0]
            and box[b, 1] >= wide[b, 1]
            and box[b, 2] <= wide[b, 2]
            and box[b, 3] <= wide[b, 3]
        ):
            return False
    return True


@kernel()
def _overlapping(pairs, box):
    """Return whether pairs (q, 2) of boxes (n, 4) overlap, (q,)."""
    overlap = np.empty(len(pairs), np.bool_)
    _look_at_pairs(len(pairs), pairs, box, overlap)
    return overlap


@shared(CONTACTS)
def _look_at_pairs(first, last, pairs, box, overlap):
    """Write whether pairs ``first`` to ``last`` - 1 overlap."""
    for q in range(first, last):
        overlap[q] = _overlap(box, pairs[q, 0], pairs[q, 1])


SPARE_WIDENINGS = 8.0
"""By how much boxes are wider than asked for, in units of their least widening: the steps, more or
less, that a moving block takes before pairs must be found again."""
SPARE_SIDES_MIN, SPARE_SIDES_MAX = 0.1, 0.25
"""And in units of the mean side of the box itself: at least, so that what moves fast is not looked
for in every step, and at most, so that few pairs are kept in vain."""


class VerletList:
    """Pairs of blocks near each other, kept for as long as they serve (Verlet 1967).

    A run has one of its own, which may be thrown away at any time: its answer is a function of the
    arguments alone.
    """

    def __init__(self) -> None:
        # by the number of outlines: contacts are found between bodies, jumps between their blocks
        self._kept: dict[int, tuple[tuple[Ints, Bools, Bools | None], Floats, Ints]] = {}
        self.searches = 0

    def near_pairs(
        self,
        vertices: Floats,
        block_start: Ints,
        half: Floats,
        fixed: Bools,
        absent: Bools | None = None,
    ) -> Ints:
        """Return the pairs (q, 2) of blocks whose boxes, widened by ``half`` (n,), m, overlap.

        Blocks that are ``absent`` (n,) are near none.
        """
        box = polygon.boxes(vertices, block_start)
        widen(box, half)
        blocks, kept = (block_start, fixed, absent), self._kept.get(len(block_start))
        if kept is None or not (
            all(one is other for one, other in zip(blocks, kept[0], strict=True))
            and all_within(box, kept[1])
        ):
            sides = 0.5 * (box[:, 2] - box[:, 0] + box[:, 3] - box[:, 1]) - 2.0 * half
            least = np.maximum(SPARE_WIDENINGS * half, SPARE_SIDES_MIN * sides)
            spare = np.minimum(least, SPARE_SIDES_MAX * sides)
            wide = box + spare[:, None] * np.array([-1.0, -1.0, 1.0, 1.0])
            pairs = overlapping_pairs(wide, fixed)
            if absent is not None and absent.any():
                pairs = np.ascontiguousarray(pairs[~absent[pairs].any(axis=1)])
            kept = self._kept[len(block_start)] = blocks, wide, pairs
            self.searches += 1
        return kept[2].compress(_overlapping(kept[2], box), axis=0)


def near_pairs(
    near: VerletList,
    vertices: Floats,
    block_start: Ints,
    fixed: Bools,
    distance: float,
    travel: Floats | float = 0.0,
    absent: Bools | None = None,
) -> Ints:
    """Return pairs (lower, higher) of blocks that are near each other by their boxes, (q, 2).

    Nearer than ``distance``, m, plus the ``travel`` (n,) of each of the two, m.  Blocks that are
    ``absent`` (n,) are near none.
    """
    half = np.empty(len(block_start) - 1)
    half[:] = 0.5 * distance + travel
    return near.near_pairs(vertices, block_start, half, fixed, absent)
