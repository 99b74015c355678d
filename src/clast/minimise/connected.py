"""Regions: blocks that contacts connect.

Blocks of two regions share no contact; fixed blocks belong to none and connect nothing.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


@kernel()
def _root(parent, i):
    """Return the first block of the tree that i is in, and shorten the way there."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@kernel()
def regions(pairs, fixed):
    """Return the region of each block, shape (n,), and their number; fixed blocks are in the last.

    ``pairs`` (q, 2) are the blocks that share contacts.  Regions are numbered by their first block.
    """
    count = len(fixed)
    parent = np.arange(count)
    for q in range(len(pairs)):
        i, j = pairs[q, 0], pairs[q, 1]
        if fixed[i] or fixed[j]:
            continue
        a, b = _root(parent, i), _root(parent, j)
        if a != b:
            parent[max(a, b)] = min(a, b)
    region = np.empty(count, np.int64)
    found = 0
    for i in range(count):
        if not fixed[i]:
            first = _root(parent, i)
            if first == i:
                region[i] = found
                found += 1
            else:
                region[i] = region[first]
    for i in range(count):
        if fixed[i]:
            region[i] = found
    return region, found + 1


@kernel()
def spread(pairs, fixed):
    """Return the mean difference of the numbers of the blocks of ``pairs`` (q, 2).

    Pairs with a block that is ``fixed`` (n,) do not count; 0 where there are no others.
    """
    total, counted = 0, 0
    for q in range(len(pairs)):
        if not (fixed[pairs[q, 0]] or fixed[pairs[q, 1]]):
            total += pairs[q, 1] - pairs[q, 0]
            counted += 1
    return total / counted if counted > 0 else 0.0


@kernel()
def region_of_contacts(region, count, vertex_block, edge_block):
    """Return the region of each contact, shape (m,): of the one of its blocks that is not fixed.

    ``count`` is the number of regions; fixed blocks have the last.
    """
    result = np.empty(len(vertex_block), np.int64)
    for c in range(len(result)):
        own = region[vertex_block[c]]
        result[c] = own if own != count - 1 else region[edge_block[c]]
    return result


@kernel()
def free_blocks(wanted, region, fixed):
    """Return which free blocks (n,) are in regions ``wanted`` (r,), their number, and that of all.

    ``region`` (n,) is that of each block; those that are ``fixed`` (n,) are not free.
    """
    found, count, free = np.empty(len(region), np.bool_), 0, 0
    for i in range(len(region)):
        found[i] = wanted[region[i]] & (not fixed[i])
        count += found[i]
        free += not fixed[i]
    return found, count, free
