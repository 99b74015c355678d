"""Which edges of a block are near, where it has so many that to try them all would take long."""

from __future__ import annotations

import numpy as np

from clast.block.polygon import vertex_after
from clast.compute.jit import kernel

FEW = 48
"""As many edges are tried one after the other; of more those that are near are found first."""


@kernel()
def edges_within(window, reach, vertices, first, last, found):
    """Write the edges of a block within ``reach``, m, of a window, by their boxes; return how many.

    In their order.  ``window`` is xmin, ymin, xmax, ymax, m.
    """
    xmin, ymin = window[0] - reach, window[1] - reach
    xmax, ymax = window[2] + reach, window[3] + reach
    count = 0
    for k in range(first, last):
        after = vertex_after(k, first, last)
        if (
            min(vertices[k, 0], vertices[after, 0]) <= xmax
            and max(vertices[k, 0], vertices[after, 0]) >= xmin
            and min(vertices[k, 1], vertices[after, 1]) <= ymax
            and max(vertices[k, 1], vertices[after, 1]) >= ymin
        ):
            found[count] = k
            count += 1
    return count


@kernel()
def first_at_least(values, bound):
    """Return which of ascending values is the first at least ``bound``; their number if none."""
    low, high = 0, len(values)
    while low < high:
        middle = (low + high) // 2
        if values[middle] < bound:
            low = middle + 1
        else:
            high = middle
    return low


@kernel()
def left_to_right(edges, vertices, first, last):
    """Return the left ends, m, of edges of a block in their order, the edges, and the widest, m."""
    left = np.empty(len(edges))
    widest = 0.0
    for k in range(len(edges)):
        here, there = vertices[edges[k], 0], vertices[vertex_after(edges[k], first, last), 0]
        left[k] = min(here, there)
        widest = max(widest, abs(here - there))
    order = np.argsort(left)
    return left[order], edges[order], widest


@kernel()
def edges_around(window, reach, vertices, first, last):
    """Return the edges of a block within ``reach``, m, of a window, as ``left_to_right`` does."""
    found = np.empty(last - first, np.int64)
    count = edges_within(window, reach, vertices, first, last, found)
    return left_to_right(found[:count], vertices, first, last)


@kernel()
def edges_near(point, reach, listed, vertices, first, last, found):
    """Write the edges whose boxes come within ``reach``, m, of a point, in order; return how many.

    ``listed`` are edges as ``left_to_right`` gives them.
    """
    (px, py), (left, edges, widest) = point, listed
    count = 0
    for k in range(first_at_least(left, px - reach - widest), len(left)):
        if left[k] > px + reach:
            break
        e = edges[k]
        f = vertex_after(e, first, last)
        if (
            max(vertices[e, 0], vertices[f, 0]) < px - reach
            or max(vertices[e, 1], vertices[f, 1]) < py - reach
            or min(vertices[e, 1], vertices[f, 1]) > py + reach
        ):
            continue
        at = count
        while at > 0 and found[at - 1] > e:
            found[at] = found[at - 1]
            at -= 1
        found[at] = e
        count += 1
    return count
