"""Contacts: corners of a rock on segments, corners of the profile on edges of the rock.

Two polygons that do not overlap touch first where a corner of one meets an edge of the other: these
pairs are all there is.  A state is an array: centroid x, y, m, angle, rad, velocity, m/s, and spin,
rad/s.
"""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel
from clast.trajectory.ground import CLOSE, ROUND_OFF, distance_to

ON_SEGMENT, ON_EDGE = 0, 1
"""A rock's corner i on segment k; corner k of the profile on a rock's edge i."""
BESIDE = 1e-6
"""Sine of the angle by which a normal at a corner may lie beside those of its segments."""
MOST = 16
"""Contacts at a time, at most."""


@kernel()
def tolerances(ground, rock):
    """Return the gap that counts as none, and that within which a rock touches, m."""
    exact = ROUND_OFF * (ground.box[3] + rock.numbers[2])
    return exact, max(CLOSE * rock.numbers[2], 10.0 * exact)


@kernel()
def frame(ground, rock, state, kind, i, k):
    """Return a pair's normal (2), arm (2), m, gap, m, and margin, m: below 0 beside the face.

    The normal points into the rock, the arm from its centroid to the contact.
    """
    c, s = np.cos(state[2]), np.sin(state[2])
    if kind == ON_SEGMENT:
        bx, by = rock.corners[i, 0], rock.corners[i, 1]
        rx, ry = c * bx - s * by, s * bx + c * by
        nx, ny = ground.normal[k, 0], ground.normal[k, 1]
        dx, dy = state[0] + rx - ground.start[k, 0], state[1] + ry - ground.start[k, 1]
        along = dx * ground.way[k, 0] + dy * ground.way[k, 1]
        return nx, ny, rx, ry, dx * nx + dy * ny, min(along, ground.length[k] - along)
    ex = c * rock.way[i, 0] - s * rock.way[i, 1]
    ey = s * rock.way[i, 0] + c * rock.way[i, 1]
    rx, ry = ground.corner[k, 0] - state[0], ground.corner[k, 1] - state[1]
    along = rx * ex + ry * ey - rock.offset[i]
    gap = rx * ey - ry * ex - rock.support[i]
    return -ey, ex, rx, ry, gap, min(along, rock.length[i] - along)


@kernel()
def is_before(ground, state, kind, k, nx, ny):
    """Return whether the centroid is on the air's side of a pair's segment.

    A convex rock that touches a segment is there as a whole.  At a corner of the profile the normal
    lies between those of its segments: the front of a rock that slides over it strikes nothing.
    """
    if kind == ON_EDGE:
        one, other = ground.way[ground.beside[k, 0]], ground.way[ground.beside[k, 1]]
        return nx * one[0] + ny * one[1] >= -BESIDE and nx * other[0] + ny * other[1] <= BESIDE
    dx, dy = state[0] - ground.start[k, 0], state[1] - ground.start[k, 1]
    return dx * ground.normal[k, 0] + dy * ground.normal[k, 1] > 0.0


@kernel()
def barrier_of(ground, kind, k):
    """Return the barrier of a pair, -1 where it is of the profile."""
    return ground.barrier[k if kind == ON_SEGMENT else ground.beside[k, 0]]


@kernel()
def face_of(ground, kind, k, nx, ny):
    """Return the segment of a pair: at a corner the one whose normal is closer."""
    if kind == ON_SEGMENT:
        return k
    one, other = ground.beside[k]
    first = ground.normal[one, 0] * nx + ground.normal[one, 1] * ny
    second = ground.normal[other, 0] * nx + ground.normal[other, 1] * ny
    return one if first >= second else other


@kernel()
def place_along(ground, state, pair, rx, ry):
    """Return the place of a pair along the profile, m; the arm (rx, ry) leads to it."""
    kind, _i, k = pair
    if kind != ON_SEGMENT:
        return ground.along[ground.beside[k, 1]]
    dx, dy = state[0] + rx - ground.start[k, 0], state[1] + ry - ground.start[k, 1]
    return ground.along[k] + dx * ground.way[k, 0] + dy * ground.way[k, 1]


@kernel()
def pairs_within(ground, rock, state, broken, reach):
    """Return the pairs (p, 3) of kind, i and k that are within ``reach`` of the rock's circle.

    ``broken`` says which barriers have failed.
    """
    n, radius = len(rock.length), rock.numbers[2]
    pairs = np.empty((n * (len(ground.length) + len(ground.corner)), 3), np.int64)
    count = 0
    for k in range(len(ground.length)):
        b = ground.barrier[k]
        gone = b >= 0 and broken[b]
        if not gone and distance_to(ground, k, state[0], state[1]) <= radius + reach:
            for i in range(n):
                pairs[count] = ON_SEGMENT, i, k
                count += 1
    for k in range(len(ground.corner)):
        b = ground.barrier[ground.beside[k, 0]]
        gone = b >= 0 and broken[b]
        dx, dy = ground.corner[k, 0] - state[0], ground.corner[k, 1] - state[1]
        if not gone and np.hypot(dx, dy) <= radius + reach:
            for i in range(n):
                pairs[count] = ON_EDGE, i, k
                count += 1
    return pairs[:count]


@kernel()
def touching(ground, rock, state, broken):
    """Return the pairs (p, 3) that touch, p at most MOST."""
    touch = tolerances(ground, rock)[1]
    near = pairs_within(ground, rock, state, broken, touch)
    count = 0
    for p in range(len(near)):
        kind, i, k = near[p]
        nx, ny, _rx, _ry, gap, margin = frame(ground, rock, state, kind, i, k)
        if abs(gap) <= touch and margin >= -touch and is_before(ground, state, kind, k, nx, ny):
            if count < MOST:
                near[count] = near[p]
                count += 1
    return near[:count]
