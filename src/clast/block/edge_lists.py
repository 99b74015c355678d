"""Edges of polygons: those near a point, sorted lists of them, and how two of them cross."""

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


@kernel()
def side(ax, ay, bx, by, px, py):
    """Return twice the area of triangle A, B, P: positive where P is left of A to B."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@kernel()
def cross(a, b, e, f, vertices, dx, dy):
    """Return whether segment a to b, moved by (dx, dy), and segment e to f cross properly."""
    ax, ay = vertices[a, 0] + dx, vertices[a, 1] + dy
    bx, by = vertices[b, 0] + dx, vertices[b, 1] + dy
    ex, ey, fx, fy = vertices[e, 0], vertices[e, 1], vertices[f, 0], vertices[f, 1]
    if (side(ax, ay, bx, by, ex, ey) > 0.0) == (side(ax, ay, bx, by, fx, fy) > 0.0):
        return False
    return (side(ex, ey, fx, fy, ax, ay) > 0.0) != (side(ex, ey, fx, fy, bx, by) > 0.0)


@kernel()
def behind(p, e, vertices, direction):
    """Return how far vertex p lies behind the line of edge e, m."""
    x, y = vertices[p, 0] - vertices[e, 0], vertices[p, 1] - vertices[e, 1]
    return y * direction[e, 0] - x * direction[e, 1]


@kernel()
def crossing_point(a, b, e, f, vertices):
    """Return where segments a to b and e to f cross, m, x and y."""
    ax, ay, bx, by = vertices[a, 0], vertices[a, 1], vertices[b, 0], vertices[b, 1]
    ex, ey, fx, fy = vertices[e, 0], vertices[e, 1], vertices[f, 0], vertices[f, 1]
    here, there = side(ex, ey, fx, fy, ax, ay), side(ex, ey, fx, fy, bx, by)
    if here == there:  # to the last bit in line
        return ax, ay
    share = here / (here - there)
    return ax + share * (bx - ax), ay + share * (by - ay)


@kernel()
def sideways(a, b, e, f, vertices, direction):
    """Return how far an end in front of the other edge stands out, m, and the way back, x and y.

    From the crossing along its edge; of the two edges the one that stands out less.  The way back
    is the unit vector along which the block of a to b moves, that of e to f being still.
    """
    x, y = crossing_point(a, b, e, f, vertices)
    at_end = behind(a, e, vertices, direction) > 0.0
    p, to = (b, -1.0) if at_end else (a, 1.0)
    at_other = behind(e, a, vertices, direction) > 0.0
    q, fro = (f, 1.0) if at_other else (e, -1.0)
    of_p = np.hypot(vertices[p, 0] - x, vertices[p, 1] - y)
    of_q = np.hypot(vertices[q, 0] - x, vertices[q, 1] - y)
    if of_p <= of_q:
        return of_p, to * direction[a, 0], to * direction[a, 1]
    return of_q, fro * direction[e, 0], fro * direction[e, 1]
