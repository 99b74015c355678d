"""Pairs of blocks whose boxes overlap, in a time linear in the number of blocks.

A hierarchy of uniform grids: each block is filed in one cell of the level whose cells are just
larger than the block, and looks for partners in its own and all coarser levels.  So blocks a
thousand times different in size cost no more than equal ones.  The cells are kept in a hash table,
so that empty ones cost nothing.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import MANY, PART, bounds, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do

LEVELS = 48
"""Cell sizes differ by 2 from level to level; 48 levels span a ratio of 1e14."""


@kernel()
def _sizes(box):
    """Return the larger side of each box (n,)."""
    size = np.empty(len(box))
    for b in range(len(box)):
        size[b] = max(box[b, 2] - box[b, 0], box[b, 3] - box[b, 1])
    return size


@kernel()
def _origin(box, size):
    """Return the cell size of level 0, larger than its boxes, and where the cells begin, m."""
    smallest, xmin, ymin = np.inf, np.inf, np.inf
    for b in range(len(box)):
        smallest = min(smallest, size[b])
        xmin, ymin = min(xmin, box[b, 0]), min(ymin, box[b, 1])
    return smallest * 1.001, xmin, ymin  # so that round-off cannot let a box reach two cells on


@kernel()
def _cells(first, last, box, size, origin, level, cell):
    """Write the level of each box and the cell of its lower left corner there, (n, 2)."""
    smallest, xmin, ymin = origin
    for b in range(first, last):
        step = 0
        side = smallest
        while side < size[b] and step < LEVELS - 1:
            side *= 2.0
            step += 1
        level[b] = step
        cell[b, 0] = int(np.floor((box[b, 0] - xmin) / side))
        cell[b, 1] = int(np.floor((box[b, 1] - ymin) / side))


@kernel(parallel=True)
def _cells_shared(box, size, origin, level, cell):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(box))):
            first, last = bounds(part, len(box))
            _cells(first, last, box, size, origin, level, cell)


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
    filled = np.empty(slots, np.int64)
    for s in range(slots):
        filled[s] = start[s]
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
def _collect(first, last, filed, slots, origin, occupied, pairs):
    """Fill ``pairs`` with what overlaps boxes ``first`` to ``last`` - 1; return how many there are.

    There may be more than fit.  ``filed`` are boxes, which are fixed, levels, cells and blocks in
    the order in which they are filed, ``slots`` (s + 1,) the first of each slot of the hash table,
    ``origin`` the size of the smallest cells and where they begin, m.
    """
    box, fixed, level, cell, order = filed
    smallest, xmin, ymin = origin
    mask, found = len(slots) - 2, 0
    for b in range(first, last):
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
                    for other in range(slots[slot], slots[slot + 1]):
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


@kernel(parallel=True)
def _collect_parts(filed, slots, origin, occupied, room, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(found)):
            last = min((part + 1) * PART, len(filed[0]))
            found[part] = _collect(part * PART, last, filed, slots, origin, occupied, room[part])


@kernel()
def _joined(room, found):
    """Return the pairs of all parts, one after the other, of (parts, room, 2)."""
    pairs = np.empty((found.sum(), 2), np.int64)
    at = 0
    for part in range(len(found)):
        for q in range(found[part]):
            pairs[at, 0], pairs[at, 1] = room[part, q, 0], room[part, q, 1]
            at += 1
    return pairs


@kernel()
def _collected(filed, slots, origin):
    """Return the pairs of overlapping boxes in the order in which they are filed, shape (m, 2)."""
    box, _, level, _, _ = filed
    occupied = np.zeros(LEVELS, np.bool_)
    for b in range(len(box)):
        occupied[level[b]] = True
    found = np.zeros(parts(len(box)), np.int64)
    most = 8 * min(PART, len(box)) + 64
    while True:
        room = np.empty((len(found), most, 2), np.int64)
        _collect_parts(filed, slots, origin, occupied, room, found)
        if found.max() <= most:
            return _joined(room, found)
        most = found.max()


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
def _put_in_order(low, high, order, blocks, filed):
    box, fixed, level, cell = blocks
    boxes, held, levels, cells = filed
    for position in range(low, high):
        b = order[position]
        held[position], levels[position] = fixed[b], level[b]
        cells[position, 0], cells[position, 1] = cell[b, 0], cell[b, 1]
        for side in range(4):
            boxes[position, side] = box[b, side]


@kernel(parallel=True)
def _put_in_order_shared(order, blocks, filed):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(order))):
            low, high = bounds(part, len(order))
            _put_in_order(low, high, order, blocks, filed)


@kernel()
def _in_order(order, box, fixed, level, cell):
    """Return boxes, which are fixed, levels and cells in the order given (n,)."""
    blocks = box, fixed, level, cell
    filed = np.empty_like(box), np.empty_like(fixed), np.empty_like(level), np.empty_like(cell)
    if len(order) >= MANY:
        _put_in_order_shared(order, blocks, filed)
    else:
        _put_in_order(0, len(order), order, blocks, filed)
    return filed


@kernel()
def overlapping_pairs(box, fixed):
    """Return pairs (lower, higher) of overlapping boxes, sorted, shape (m, 2).

    ``box`` (n, 4) holds (xmin, ymin, xmax, ymax) in m, already widened by the reach; pairs of two
    blocks that are ``fixed`` (n,) are left out.  O(n).
    """
    count = len(box)
    if count < 2:
        return np.zeros((0, 2), np.int64)
    size, level, cell = _sizes(box), np.empty(count, np.int64), np.empty((count, 2), np.int64)
    origin = _origin(box, size)
    if count >= MANY:
        _cells_shared(box, size, origin, level, cell)
    else:
        _cells(0, count, box, size, origin, level, cell)
    slots, order = _file(level, cell)
    filed = (*_in_order(order, box, fixed, level, cell), order)
    pairs = _collected(filed, slots, origin)
    return _sort_by(_sort_by(pairs, 1, count), 0, count)


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
def _overlapping(first, last, pairs, box, kept):
    """Write the overlapping pairs of ``first`` to ``last`` - 1 from ``first`` on; return how many.

    Each is written, and written over where it does not overlap: nothing is to be foretold.
    """
    at = first
    for q in range(first, last):
        a, b = pairs[q, 0], pairs[q, 1]
        kept[at, 0], kept[at, 1] = a, b
        at += _overlap(box, a, b)
    return at - first


@kernel(parallel=True)
def _overlapping_shared(pairs, box, kept, found):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, len(found)):
            first, last = bounds(part, len(pairs))
            found[part] = _overlapping(first, last, pairs, box, kept)


@kernel()
def overlapping_of(pairs, box):
    """Return which of the ``pairs`` (q, 2) of boxes (n, 4) overlap, in their order."""
    kept, found = np.empty_like(pairs), np.empty(parts(len(pairs)), np.int64)
    if len(pairs) >= MANY:
        _overlapping_shared(pairs, box, kept, found)
    else:
        for part in range(len(found)):
            first, last = bounds(part, len(pairs))
            found[part] = _overlapping(first, last, pairs, box, kept)
    result, at = np.empty((found.sum(), 2), np.int64), 0
    for part in range(len(found)):
        for q in range(part * PART, part * PART + found[part]):
            result[at, 0], result[at, 1] = kept[q, 0], kept[q, 1]
            at += 1
    return result
