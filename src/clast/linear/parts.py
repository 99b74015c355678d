"""Parts of the blocks that can be worked on at the same time, and the seam between them.

The blocks are parted into strips, as many in each, across the longer side of what they fill.  Those
that are coupled to a block of an earlier strip form the seam and come last: of what is left no
strip is coupled to another one (one level of nested dissection, George 1973).  The seam keeps the
order of the strips that its blocks were in: these are its segments.  Four times as many blocks have
twice as many strips: the seam's share is the same.  The number of strips depends on that of the
blocks alone, and with it every sum: answers do not depend on the threads.
"""

from __future__ import annotations

import numpy as np

from clast.compute.chunks import CHUNK, PART, SHARED, chunks, parts
from clast.compute.jit import kernel
from clast.compute.parallel import nothing_done, prange, threads_of, to_do

LEAST, MOST = 800, 16
"""Blocks from which there are two strips, four times as many having twice as many strips, and
number of strips at most."""
SLOTS = 8192
"""Widths into which the longer side is divided to find strips of as many blocks each."""


@kernel()
def number_of_strips(count):
    """Return the number of strips of ``count`` blocks."""
    number, enough = 1, LEAST
    while count >= enough and number < MOST:
        number, enough = 2 * number, 4 * enough
    return number


@kernel()
def strips(centroid):
    """Return the strip of each block (n,), of centroids (n, 2), and the number of strips."""
    count = len(centroid)
    number = number_of_strips(count)
    strip = np.zeros(count, np.int64)
    if number == 1:
        return strip, 1
    side, first, width = 0, 0.0, 0.0
    for k in range(2):
        low, high = centroid[:, k].min(), centroid[:, k].max()
        if high - low > width:
            side, first, width = k, low, high - low
    if width == 0.0:
        return strip, 1
    slot = _slots(centroid[:, side], first, SLOTS / width)
    of_slot = _strips_of_slots(slot, number)
    for i in range(count):
        strip[i] = of_slot[slot[i]]
    return strip, number


@kernel(error_model="numpy")
def _slots(place, first, scale):
    """Return the slot of each block (n,)."""
    slot = np.empty(len(place), np.int32)
    for i in range(len(place)):
        slot[i] = min(np.int32(scale * (place[i] - first)), np.int32(SLOTS - 1))
    return slot


@kernel()
def _strips_of_slots(slot, number):
    """Return the strip of each slot: as many blocks in each as whole slots allow."""
    within = np.zeros(SLOTS, np.int64)
    for i in range(len(slot)):
        within[slot[i]] += 1
    of_slot = np.empty(SLOTS, np.int64)
    before, strip = 0, 0
    for k in range(SLOTS):
        while (strip + 1) * len(slot) <= before * number:
            strip += 1
        of_slot[k] = strip
        before += within[k]
    return of_slot


@kernel()
def _is_coupled(blocks, q):
    """Return whether any number of block q is not zero."""
    for a in range(6):
        for c in range(6):
            if blocks[q, a, c] != 0.0:
                return True
    return False


@kernel(parallel=True)
def _coupled_shared(upper, coupled):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for part in to_do(thread, progress, parts(len(upper))):
            for q in range(part * PART, min((part + 1) * PART, len(upper))):
                coupled[q] = _is_coupled(upper, q)


@kernel()
def coupled_pairs(upper):
    """Return whether the blocks of each pair are coupled at all, shape (q,)."""
    coupled = np.empty(len(upper), np.bool_)
    if len(upper) >= SHARED:
        _coupled_shared(upper, coupled)
    else:
        for q in range(len(upper)):
            coupled[q] = _is_coupled(upper, q)
    return coupled


@kernel()
def ordering(centroid, pairs, coupled):
    """Return the blocks strip by strip, the seam last (n,), and where all begins.

    First the strips and then the segments of the seam, as many, (2 strips + 1,); the last is n.
    """
    count = len(centroid)
    part, number = strips(centroid)
    if number > 1:
        strip = part.copy()
        for q in range(len(pairs)):
            i, j = pairs[q]
            if coupled[q] and strip[i] != strip[j]:
                later = i if strip[i] > strip[j] else j
                part[later] = number + strip[later]
    begin = np.zeros(2 * number + 1, np.int64)
    for i in range(count):
        begin[part[i] + 1] += 1
    for k in range(2 * number):
        begin[k + 1] += begin[k]
    at = begin[:-1].copy()
    order = np.empty(count, np.int64)
    for i in range(count):
        order[at[part[i]]] = i
        at[part[i]] += 1
    return order, begin


@kernel()
def _rows_of(low, high, order, place, pairs, rows, coupled, right, left):
    """Write how many coupled pairs begin and end with each place from ``low`` to ``high`` - 1."""
    first, last, listed = rows
    for k in range(low, high):
        i, after, before = order[k], 0, 0
        for q in range(first[i], first[i + 1]):
            if coupled[q]:
                later = place[pairs[q, 1]] > k
                after, before = after + later, before + (not later)
        for at in range(last[i], last[i + 1]):
            if coupled[listed[at]]:
                later = place[pairs[listed[at], 0]] > k
                after, before = after + later, before + (not later)
        right[k + 1], left[k + 1] = after, before


@kernel(parallel=True)
def _rows_of_shared(order, place, pairs, rows, coupled, right, left):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(order))):
            last = min((c + 1) * CHUNK, len(order))
            _rows_of(c * CHUNK, last, order, place, pairs, rows, coupled, right, left)


@kernel()
def _insert(first, at, low, high, number, new, source):
    """Insert the pair (low, high) into those from ``first`` to ``at`` - 1, in ascending order."""
    while at > first and new[at - 1, 1] > high:
        new[at, 0], new[at, 1], source[at] = low, new[at - 1, 1], source[at - 1]
        at -= 1
    new[at, 0], new[at, 1], source[at] = low, high, number


@kernel()
def _fill_rows(low, high, order, place, pairs, rows, coupled, start, new, source):
    """Write the coupled pairs that begin with the places ``low`` to ``high`` - 1."""
    right, left, listed = rows
    for k in range(low, high):
        i, at = order[k], start[k]
        for q in range(right[i], right[i + 1]):
            other = place[pairs[q, 1]]
            if coupled[q] and other > k:
                _insert(start[k], at, k, other, q, new, source)
                at += 1
        for e in range(left[i], left[i + 1]):
            q = listed[e]
            other = place[pairs[q, 0]]
            if coupled[q] and other > k:
                _insert(start[k], at, k, other, -1 - q, new, source)
                at += 1


@kernel(parallel=True)
def _fill_rows_shared(order, place, pairs, rows, coupled, start, new, source):
    progress = nothing_done()
    for thread in prange(threads_of(progress)):
        for c in to_do(thread, progress, chunks(len(order))):
            last = min((c + 1) * CHUNK, len(order))
            _fill_rows(c * CHUNK, last, order, place, pairs, rows, coupled, start, new, source)


@kernel()
def _listed(pairs, left):
    """Return the pairs (., k) of each place, in ascending order."""
    at = left[:-1].copy()
    listed = np.empty(len(pairs), np.int32)
    for q in range(len(pairs)):
        k = pairs[q, 1]
        listed[at[k]] = q
        at[k] += 1
    return listed


@kernel()
def renumbered(order, pairs, rows, coupled):
    """Return the coupled pairs by their places in ``order`` (n,), sorted, and whence each comes.

    And their own rows.  ``rows`` are right, left and listed of the pairs (linear/block_matrix.py).
    ``source`` (q,) is the pair's old number, or minus that minus one where its blocks have changed
    sides.  The pairs and their rows are short integers, to be read over and over.
    """
    count = len(order)
    place = np.empty(count, np.int64)
    for k in range(count):
        place[order[k]] = k
    right, left = np.zeros(count + 1, np.int32), np.zeros(count + 1, np.int32)
    if count >= SHARED:
        _rows_of_shared(order, place, pairs, rows, coupled, right, left)
    else:
        _rows_of(0, count, order, place, pairs, rows, coupled, right, left)
    for k in range(count):
        right[k + 1] += right[k]
        left[k + 1] += left[k]
    new, source = np.empty((right[-1], 2), np.int32), np.empty(right[-1], np.int64)
    if count >= SHARED:
        _fill_rows_shared(order, place, pairs, rows, coupled, right, new, source)
    else:
        _fill_rows(0, count, order, place, pairs, rows, coupled, right, new, source)
    return new, source, (right, left, _listed(new, left))
