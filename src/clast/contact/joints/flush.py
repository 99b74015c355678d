"""Which edges lie flush: strength that faces carry along as they slide on belongs to these."""

from __future__ import annotations

import numpy as np

from clast.block.polygon import SMALL_ANGLE
from clast.model.model import Floats, Ints
from clast.model.state import ContactMemory


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


def had_by_faces(
    kept: tuple[Floats, ...],
    memory: ContactMemory,
    ends: tuple[Ints, Ints],
    direction: Floats,
    block_start: Ints,
) -> tuple[Floats, ...]:
    """Return the earlier values of the faces of contacts, (k,) each, nan where neither has borne.

    ``kept`` are numbers of the rows of the ``memory``, (r,) each; where contacts of a face differ,
    the largest by size counts.  ``ends`` are vertex and edge of the contacts (k,).
    """
    vertex, edge = ends
    along = flush_edges(memory.vertex, memory.edge, direction, block_start)
    mine = flush_edges(vertex, edge, direction, block_start)
    found = []
    for values in kept:
        # of every edge, and of -1, which is none; NaN where nothing is known of it
        low, high = np.full((2, len(direction) + 1), np.nan)
        for own in along:
            flush = own >= 0
            for face in (own[flush], memory.edge[flush]):
                np.fmax.at(high, face, values[flush])
                np.fmin.at(low, face, values[flush])
        face = np.where(-low > high, low, high)
        result = np.full(len(vertex), np.nan)
        for own in mine:
            for of_face in (face[own], face[edge]):
                larger = (own >= 0) & ~(np.abs(of_face) <= np.abs(result))
                result = np.where(larger & ~np.isnan(of_face), of_face, result)
        found.append(result)
    return tuple(found)
