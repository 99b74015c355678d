"""Finding a contact again in the memory of the last step."""

from __future__ import annotations

import numpy as np
from numba import njit

from clast.kernels.narrow_phase import find_key


@njit(cache=True)
def rows_of(vertex, block, edge, memory_vertex, memory_block, memory_edge):
    """Return the memory row of each contact, or -1, shape (m,).

    The same edge first; else a row of the same (vertex, block) whose edge is no longer in
    contact: the vertex has slid round to the next edge and takes its memory along.  Contacts of
    one (vertex, block) stand together; no row is given twice.
    """
    count = len(vertex)
    rows = np.full(count, -1, np.int64)
    start = 0
    while start < count:
        stop = start + 1
        while stop < count and vertex[stop] == vertex[start] and block[stop] == block[start]:
            stop += 1
        first = find_key(vertex[start], block[start], memory_vertex, memory_block)
        if first >= 0:
            last = first
            while (
                last < len(memory_vertex)
                and memory_vertex[last] == vertex[start]
                and memory_block[last] == block[start]
            ):
                last += 1
            taken = np.zeros(last - first, np.bool_)
            for c in range(start, stop):
                for row in range(first, last):
                    if memory_edge[row] == edge[c]:
                        rows[c] = row
                        taken[row - first] = True
            for c in range(start, stop):
                if rows[c] >= 0:
                    continue
                for row in range(first, last):
                    if not taken[row - first]:
                        rows[c] = row
                        taken[row - first] = True
                        break
        start = stop
    return rows
