"""Which edges lie flush: strength that faces carry along as they slide on belongs to these."""

from __future__ import annotations

import numpy as np

from clast.block.polygon import SMALL_ANGLE
from clast.model.model import Floats, Ints


def flush_edges(
    vertex: Ints, edge: Ints, direction: Floats, block_start: Ints
) -> tuple[Ints, Ints]:
    """Return which of its two edges each vertex (k,) has along an edge (k,), else -1, (k,) each.

    Along it means within 3 degrees, the blocks on either side; ``direction`` (nv, 2) are the unit
    vectors of edges, ``block_start`` (n + 1,) is the first vertex of each block.
    """
    before = np.arange(-1, len(direction) - 1)
    before[block_start[:-1]] = block_start[1:] - 1
    found = []
    for own in (before[vertex], vertex):
        one, other = direction[own], direction[edge]
        sine = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
        opposite = np.einsum("kx,kx->k", one, other) < 0.0
        found.append(np.where((np.abs(sine) <= SMALL_ANGLE) & opposite, own, -1))
    return found[0], found[1]
