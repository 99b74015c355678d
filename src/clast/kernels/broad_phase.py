"""Pairs of blocks whose boxes overlap, in a time linear in the number of blocks.

A hierarchy of uniform grids: each block is filed in one cell of the level whose cells are just
larger than the block, and looks for partners in its own and all coarser levels.  So blocks a
thousand times different in size cost no more than equal ones.  The cells are kept in a hash table,
so that empty ones cost nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clast.kernels.compiled import kernel

LEVELS = 48
"""Cell sizes differ by 2 from level to level; 48 levels span a ratio of 1e14."""


@kernel()
def _levels(box):
    """Return the level of each box (n,) and the cell size of level 0, larger than its boxes."""
    count = len(box)
    size = np.empty(count)
    smallest = np.inf
    for b in range(count):
        size[b] = max(box[b, 2] - box[b, 0], box[b, 3] - box[b, 1])
        if size[b] < smallest:
            smallest = size[b]
    smallest *= 1.001  # so that round-off cannot let a box reach two cells further
    level = np.empty(count, np.int64)
    for b in range(count):
        step = 0
        cell = smallest
        while cell < size[b] and step < LEVELS - 1:
            cell *= 2.0
            step += 1
        level[b] = step
    return level, smallest


@kernel()
def _cells(box, level, smallest, xmin, ymin):
    """Return the cell (n, 2) of each box's lower left corner on its own level."""
    cell = np.empty((len(box), 2), np.int64)
    for b in range(len(box)):
        size = smallest * 2.0 ** level[b]
        cell[b, 0] = int(np.floor((box[b, 0] - xmin) / size))
        cell[b, 1] = int(np.floor((box[b, 1] - ymin) / size))
    return cell


@kernel()
def _slot(level, row, column, mask):
    """Return the slot of a cell in a hash table of ``mask`` + 1 slots, a power of 2.

    The cells of a row follow each other, so that neighbours are neighbours in memory too.
    """
    return (column + row * 0x1E3779B97F4A7C15 + level * 0x165667B19E3779F9) & mask


@kernel()
def _file(level, cell):
    """Return the first position of each slot of the hash table, and the boxes by slot (n,)."""
    count = len(level)
    slots = 1
    while slots < 2 * count:
        slots *= 2
    start = np.zeros(slots + 1, np.int64)
    slot = np.empty(count, np.int64)
    for b in range(count):
        slot[b] = _slot(level[b], cell[b, 1], cell[b, 0], slots - 1)
        start[slot[b] + 1] += 1
    for s in range(slots):
        start[s + 1] += start[s]
    filled = start[:slots].copy()
    order = np.empty(count, np.int64)
    for b in range(count):
        order[filled[slot[b]]] = b
        filled[slot[b]] += 1
    return start, order


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
def _collect(box, fixed, level, cell, start, order, smallest, xmin, ymin, pairs):
    """Fill ``pairs`` with overlapping boxes and return how many there are (it may be too small).

    Boxes, levels and cells stand in the order in which they are filed; ``order`` (n,) gives their
    blocks.
    """
    count, mask = len(box), len(start) - 2
    occupied = np.zeros(LEVELS, np.bool_)
    for b in range(count):
        occupied[level[b]] = True
    found = 0
    for b in range(count):
        for k in range(level[b], LEVELS):
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
                    for other in range(start[slot], start[slot + 1]):
                        if (k == level[b] and other <= b) or level[other] != k:
                            continue
                        if cell[other, 0] != column or cell[other, 1] != row:
                            continue
                        if (fixed[b] and fixed[other]) or not _overlap(box, b, other):
                            continue
                        if found < len(pairs):
                            pairs[found, 0] = min(order[b], order[other])
                            pairs[found, 1] = max(order[b], order[other])
                        found += 1
    return found


@kernel()
def _sort_by(pairs, side, count):
    """Return the pairs sorted by their block on one side, equal ones in the order they came."""
    start = np.zeros(count + 1, np.int64)
    for q in range(len(pairs)):
        start[pairs[q, side] + 1] += 1
    for b in range(count):
        start[b + 1] += start[b]
    result = np.empty_like(pairs)
    for q in range(len(pairs)):
        b = pairs[q, side]
        result[start[b], 0] = pairs[q, 0]
        result[start[b], 1] = pairs[q, 1]
        start[b] += 1
    return result


@kernel()
def _in_order(order, box, fixed, level, cell):
    """Return boxes, which are fixed, levels and cells in the order given (n,)."""
    boxes, held = np.empty_like(box), np.empty_like(fixed)
    levels, cells = np.empty_like(level), np.empty_like(cell)
    for position in range(len(order)):
        b = order[position]
        held[position], levels[position] = fixed[b], level[b]
        cells[position, 0], cells[position, 1] = cell[b, 0], cell[b, 1]
        for side in range(4):
            boxes[position, side] = box[b, side]
    return boxes, held, levels, cells


def overlapping_pairs(box: NDArray[np.float64], fixed: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return pairs (lower, higher) of overlapping boxes, sorted, shape (m, 2).

    ``box`` (n, 4) holds (xmin, ymin, xmax, ymax) in m, already widened by the reach; pairs of two
    blocks that are ``fixed`` (n,) are left out.  O(n).
    """
    if len(box) < 2:
        return np.zeros((0, 2), np.int64)
    count = len(box)
    level, smallest = _levels(box)
    xmin, ymin = box[:, 0].min(), box[:, 1].min()
    cell = _cells(box, level, smallest, xmin, ymin)
    start, order = _file(level, cell)
    boxes, held, levels, cells = _in_order(order, box, fixed, level, cell)
    pairs = np.empty((8 * count + 64, 2), np.int64)
    found = _collect(boxes, held, levels, cells, start, order, smallest, xmin, ymin, pairs)
    if found > len(pairs):
        pairs = np.empty((found, 2), np.int64)
        _collect(boxes, held, levels, cells, start, order, smallest, xmin, ymin, pairs)
    by_pair: NDArray[np.int64] = _sort_by(_sort_by(pairs[:found], 1, count), 0, count)
    return by_pair
