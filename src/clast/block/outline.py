"""Round the outline of a block: next vertices, turns, and what counts as nothing."""

from __future__ import annotations

import numpy as np

from clast.compute.jit import kernel

SMALL_ANGLE = np.sin(np.radians(3.0))
"""Sine of the angle within which edges count as parallel (Shi 1988: 3 degrees)."""
ROUND_OFF = 1e-9
"""Share of an edge's length that is treated as zero along the edge."""


@kernel()
def vertex_before(k, first, last):
    """Return the vertex before k of the block with vertices first to last - 1."""
    return k - 1 if k > first else last - 1


@kernel()
def vertex_after(k, first, last):
    """Return the vertex after k of the block with vertices first to last - 1."""
    return k + 1 if k + 1 < last else first


@kernel()
def turn_at(e, at_end, direction, first, last):
    """Return the sine of the turn at one end of edge e: positive at a convex corner."""
    if at_end:
        f = vertex_after(e, first, last)
        return direction[e, 0] * direction[f, 1] - direction[e, 1] * direction[f, 0]
    f = vertex_before(e, first, last)
    return direction[f, 0] * direction[e, 1] - direction[f, 1] * direction[e, 0]
