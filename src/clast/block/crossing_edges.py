"""Two edges of blocks that cross: whether they do, where, and how far behind each other they are.

An edge is named by its first vertex; ``vertices`` are (nv, 2), m, ``direction`` (nv, 2) the unit
directions of the edges that start there.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel


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
