"""Edges of polygons: those near a point, and sorted lists of them."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel

EDGES_TRIED_MAX = 48
"""As many edges are tried one after the other; of more those that are near are found first."""


@kernel()
def edges_within(window, reach, vertices, after, first, last, near):
    """Write edges ``first`` to ``last`` - 1 within ``reach``, m, of a window; return how many.

    By their boxes, in their order.  ``window`` is xmin, ymin, xmax, ymax, m; ``after`` (nv,) is the
    vertex after each one in its block.
    """
    xmin, ymin = window[0] - reach, window[1] - reach
    xmax, ymax = window[2] + reach, window[3] + reach
    count = 0
    for k in range(first, last):
        end = after[k]
        if (
            min(vertices[k, 0], vertices[end, 0]) <= xmax
            and max(vertices[k, 0], vertices[end, 0]) >= xmin
            and min(vertices[k, 1], vertices[end, 1]) <= ymax
            and max(vertices[k, 1], vertices[end, 1]) >= ymin
        ):
            near[count] = k
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
def left_to_right(edges, vertices, after):
    """Return the left ends, m, of edges in their order, the edges, and the widest, m."""
    left = np.empty(len(edges))
    widest = 0.0
    for k in range(len(edges)):
        here, there = vertices[edges[k], 0], vertices[after[edges[k]], 0]
        left[k] = min(here, there)
        widest = max(widest, abs(here - there))
    order = np.argsort(left)
    return left[order], edges[order], widest


@kernel()
def edges_around(window, reach, vertices, after, first, last):
    """Return edges ``first`` to ``last`` - 1 near a window (edges_within) as left_to_right does."""
    near = np.empty(last - first, np.int64)
    count = edges_within(window, reach, vertices, after, first, last, near)
    return left_to_right(near[:count], vertices, after)


@kernel()
def edges_near(point, reach, listed, vertices, after, near):
    """Write the edges whose boxes come within ``reach``, m, of a point, in order; return how many.

    ``listed`` are edges as ``left_to_right`` gives them.
    """
    (px, py), (left, edges, widest) = point, listed
    count = 0
    for k in range(first_at_least(left, px - reach - widest), len(left)):
        if left[k] > px + reach:
            break
        e = edges[k]
        f = after[e]
        if (
            max(vertices[e, 0], vertices[f, 0]) < px - reach
            or max(vertices[e, 1], vertices[f, 1]) < py - reach
            or min(vertices[e, 1], vertices[f, 1]) > py + reach
        ):
            continue
        at = count
        while at > 0 and near[at - 1] > e:
            near[at] = near[at - 1]
            at -= 1
        near[at] = e
        count += 1
    return count
