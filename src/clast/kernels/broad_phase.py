"""Pairs of blocks whose boxes overlap, in a time linear in the number of blocks.

A hierarchy of uniform grids: each block is filed in one cell of the level whose cells are just
larger than the block, and looks for partners in its own and all coarser levels.  So blocks a
thousand times different in size cost no more than equal ones.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

LEVELS = 48
"""Cell sizes differ by 2 from level to level; 48 levels span a ratio of 1e14."""


@njit(cache=True)
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


@njit(cache=True)
def _file(box, level, smallest, xmin, ymin):
    """Return the cell (n, 2) of each box's lower left corner on its own level."""
    cell = np.empty((len(box), 2), np.int64)
    for b in range(len(box)):
        size = smallest * 2.0 ** level[b]
        cell[b, 0] = int(np.floor((box[b, 0] - xmin) / size))
        cell[b, 1] = int(np.floor((box[b, 1] - ymin) / size))
    return cell


@njit(cache=True)
def _first_at_least(level, row, column, order, cell_level, cell, low, high):
    """Return the first position in ``order[low:high]`` not before (level, row, column)."""
    while low < high:
        middle = (low + high) // 2
        b = order[middle]
        before = cell_level[b] < level
        if cell_level[b] == level:
            before = cell[b, 1] < row or (cell[b, 1] == row and cell[b, 0] < column)
        if before:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True)
def _collect(box, fixed, level, cell, order, smallest, xmin, ymin, pairs):
    """Fill ``pairs`` with overlapping boxes and return how many there are (it may be too small)."""
    count = len(box)
    level_start = np.zeros(LEVELS + 1, np.int64)
    for b in range(count):
        level_start[level[b] + 1] += 1
    for k in range(LEVELS):
        level_start[k + 1] += level_start[k]
    found = 0
    for b in range(count):
        for k in range(level[b], LEVELS):
            if level_start[k + 1] == level_start[k]:
                continue
            size = smallest * 2.0**k
            # a box of this level is filed by its lower left corner and reaches one cell further
            left = int(np.floor((box[b, 0] - xmin) / size)) - 1
            right = int(np.floor((box[b, 2] - xmin) / size))
            bottom = int(np.floor((box[b, 1] - ymin) / size)) - 1
            top = int(np.floor((box[b, 3] - ymin) / size))
            low = level_start[k]
            for row in range(bottom, top + 1):
                low = _first_at_least(k, row, left, order, level, cell, low, level_start[k + 1])
                for position in range(low, level_start[k + 1]):
                    other = order[position]
                    if cell[other, 1] != row or cell[other, 0] > right:
                        break
                    if other == b or (k == level[b] and other < b):
                        continue
                    if fixed[b] and fixed[other]:
                        continue
                    if (
                        box[b, 0] <= box[other, 2]
                        and box[other, 0] <= box[b, 2]
                        and box[b, 1] <= box[other, 3]
                        and box[other, 1] <= box[b, 3]
                    ):
                        if found < len(pairs):
                            pairs[found, 0] = min(b, other)
                            pairs[found, 1] = max(b, other)
                        found += 1
    return found


def overlapping_pairs(box: NDArray[np.float64], fixed: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return pairs (lower, higher) of overlapping boxes, sorted, shape (m, 2).

    ``box`` (n, 4) holds (xmin, ymin, xmax, ymax) in m, already widened by the reach; pairs of two
    blocks that are ``fixed`` (n,) are left out.  O(n log n) for sorting, O(n) otherwise.
    """
    if len(box) < 2:
        return np.zeros((0, 2), np.int64)
    level, smallest = _levels(box)
    xmin, ymin = box[:, 0].min(), box[:, 1].min()
    cell = _file(box, level, smallest, xmin, ymin)
    order = np.lexsort((cell[:, 0], cell[:, 1], level))
    pairs = np.empty((8 * len(box) + 64, 2), np.int64)
    found = _collect(box, fixed, level, cell, order, smallest, xmin, ymin, pairs)
    if found > len(pairs):
        pairs = np.empty((found, 2), np.int64)
        _collect(box, fixed, level, cell, order, smallest, xmin, ymin, pairs)
    pairs = pairs[:found]
    return np.ascontiguousarray(pairs[np.argsort(pairs[:, 0] * len(box) + pairs[:, 1])])
