"""What two polygons have in common, by plain integration: an oracle beside shapely's overlays."""

from __future__ import annotations

from itertools import pairwise

import numpy as np


def area_in_common(one, other) -> float:
    """Return the area that two polygons share, m2: the integral over x of what they share in y.

    Between the abscissas of vertices and crossings the integrand is linear, so that its middle
    gives it exactly; round-off in the vertices changes it by as little.
    """
    one, other = np.asarray(one, float), np.asarray(other, float)
    abscissas = [*one[:, 0], *other[:, 0]]
    for a, b in edges(one):
        for c, d in edges(other):
            u, v = b - a, d - c
            det = u[0] * v[1] - u[1] * v[0]
            if abs(det) > 1e-12 * np.hypot(*u) * np.hypot(*v):
                s = ((c - a)[0] * v[1] - (c - a)[1] * v[0]) / det
                if 0.0 < s < 1.0:
                    abscissas.append((a + s * u)[0])
    xs = np.unique(abscissas)
    total = 0.0
    for left, right in pairwise(xs):
        middle = 0.5 * (left + right)
        shared = sum(
            max(0.0, min(top, upper) - max(low, lower))
            for low, top in chords(one, middle)
            for lower, upper in chords(other, middle)
        )
        total += (right - left) * shared
    return total


def edges(loop):
    return list(zip(loop, np.roll(loop, -1, axis=0), strict=True))


def chords(loop, x):
    """Return the intervals of y in which a polygon covers the vertical line at x."""
    ys = sorted(
        a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1])
        for a, b in edges(loop)
        if (a[0] <= x) != (b[0] <= x)
    )
    return list(zip(ys[::2], ys[1::2], strict=True))
