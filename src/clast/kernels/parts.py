"""Parts of the blocks that can be worked on at the same time, and the seam between them.

The blocks are parted into strips, as many in each, across the longer side of what they fill.  Those
that are coupled to a block of an earlier strip form the seam and come last: of what is left no
strip is coupled to another one (one level of nested dissection, George 1973).  The number of strips
depends on that of the blocks alone, and with it every sum: answers do not depend on the threads.
"""

from __future__ import annotations

import numpy as np

from clast.kernels.compiled import kernel

LEAST, MOST = 2500, 8
"""Blocks that a strip has at least, and number of strips at most."""
SLOTS = 8192
"""Widths into which the longer side is divided to find strips of as many blocks each."""


@kernel()
def strips(centroid):
    """Return the strip of each block (n,), of centroids (n, 2), and the number of strips."""
    count = len(centroid)
    number = min(max(count // LEAST, 1), MOST)
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
    within = np.zeros(SLOTS + 1, np.int64)
    slot = np.empty(count, np.int64)
    for i in range(count):
        slot[i] = min(int(SLOTS * (centroid[i, side] - first) / width), SLOTS - 1)
        within[slot[i] + 1] += 1
    for k in range(SLOTS):
        within[k + 1] += within[k]
    for i in range(count):
        strip[i] = within[slot[i]] * number // count
    return strip, number


@kernel()
def _is_coupled(blocks, q):
    """Return whether any number of block q is not zero."""
    for a in range(6):
        for c in range(6):
            if blocks[q, a, c] != 0.0:
                return True
    return False


@kernel()
def coupled_pairs(upper):
    """Return whether the blocks of each pair are coupled at all, shape (q,)."""
    coupled = np.empty(len(upper), np.bool_)
    for q in range(len(upper)):
        coupled[q] = _is_coupled(upper, q)
    return coupled


@kernel()
def ordering(centroid, pairs, coupled):
    """Return the blocks strip by strip, the seam last (n,), and where each begins (strips + 2,)."""
    count = len(centroid)
    part, number = strips(centroid)
    if number > 1:
        strip = part.copy()
        for q in range(len(pairs)):
            i, j = pairs[q]
            if coupled[q] and strip[i] != strip[j]:
                part[i if strip[i] > strip[j] else j] = number
    begin = np.zeros(number + 2, np.int64)
    for i in range(count):
        begin[part[i] + 1] += 1
    for k in range(number + 1):
        begin[k + 1] += begin[k]
    at = begin[:-1].copy()
    order = np.empty(count, np.int64)
    for i in range(count):
        order[at[part[i]]] = i
        at[part[i]] += 1
    return order, begin


@kernel()
def renumbered(order, pairs, coupled):
    """Return the coupled pairs by their places in ``order`` (n,), sorted, and whence each comes.

    ``source`` (q,) is the pair's old number, or minus that minus one where its blocks have changed
    sides.
    """
    count = len(order)
    place = np.empty(count, np.int64)
    for k in range(count):
        place[order[k]] = k
    start = np.zeros(count + 1, np.int64)
    for q in range(len(pairs)):
        if coupled[q]:
            start[min(place[pairs[q, 0]], place[pairs[q, 1]]) + 1] += 1
    for k in range(count):
        start[k + 1] += start[k]
    new, source = np.empty((start[-1], 2), np.int64), np.empty(start[-1], np.int64)
    filled = start[:-1].copy()
    for q in range(len(pairs)):
        if not coupled[q]:
            continue
        i, j = place[pairs[q, 0]], place[pairs[q, 1]]
        low, high = min(i, j), max(i, j)
        at = filled[low]
        while at > start[low] and new[at - 1, 1] > high:
            new[at], source[at] = new[at - 1], source[at - 1]
            at -= 1
        new[at, 0], new[at, 1] = low, high
        source[at] = q if i < j else -1 - q
        filled[low] += 1
    return new, source
