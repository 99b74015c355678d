"""Overlap of two blocks that their contacts do not account for, found by edges that cross.

Candidate edges and corner rules look at vertices: a vertex behind an edge.  Two blocks can overlap
without a vertex inside either, or with one that no rule lets in: a sharp corner that has slid off
the end of an edge, or through a thin corner and out again on its far side; two faces whose ends
have passed each other.  Such blocks would go through each other unopposed.  Their edges cross, and
the shorter way out of a crossing, of a vertex over an edge, is a contact as well.
"""

from __future__ import annotations

import numpy as np

from clast.block import polygon
from clast.contact import crossing_kernels as kernel
from clast.model.model import Floats, Ints
from clast.model.state import ContactMemory

TAKEN_BACK = 1.01
"""Share of a contact's penetration that must undo a crossing which it accounts for."""
SHALLOW = 1e-3
"""Crossings less deep than this are left alone, in units of critdis."""
NEIGHBOUR = 1.5
"""A new crossing less deep than this times what touches one of the blocks anyway is left alone: a
corner that bears on a surface is below the next block's corner before it comes upon that block."""
HANDED_ON = 2.0
"""How much deeper than what the pair remembers a contact may be that takes over from another."""

Chosen = tuple[Ints, Ints, Ints, Floats]
"""Vertex, edge, pair and gap, m, of contacts in the order of the pairs of blocks, (m,) each."""


def with_crossings(
    chosen: Chosen,
    pairs: Ints,
    outlines: tuple[Floats, Floats, Ints],
    vertex_block: Ints,
    memory: ContactMemory,
    front: Floats,
    critdis: float,
) -> Chosen:
    """Return the contacts, and with them those that crossings ask for which they do not explain.

    ``outlines`` are vertices (nv, 2), directions of edges and the first vertex of each block,
    ``front`` (n,) how far the vertices of each block may have moved in a step, m.  A contact that
    was closed at the end of the last step goes on where it explains a crossing.  Else the shorter
    way out of it becomes a contact, if a step's motion or what the pair remembers explains it.
    """
    vertex, edge, pair, gap = chosen
    box = polygon.boxes(outlines[0], outlines[2])
    contacts = (vertex, edge, gap, vertex_block)
    found = kernel.unseen(outlines, box, pairs, contacts, pair, TAKEN_BACK, SHALLOW * critdis)
    if not len(found[0]):
        return chosen
    which, of_pair = np.unique(found[3], return_inverse=True)
    remembered, depth = _remembered(memory, chosen, pairs, which, vertex_block)
    deepest = np.zeros(len(front))
    for blocks in (vertex_block[vertex], vertex_block[edge]):
        np.maximum.at(deepest, blocks, -gap)
    own, other = pairs[which].T
    around = NEIGHBOUR * np.maximum(deepest[own], deepest[other])
    limit = np.stack(
        [
            np.where(depth > 0.0, 0.0, around),
            critdis + front[own] + front[other] + HANDED_ON * depth,
        ],
        axis=1,
    )
    at, of_gap = kernel.ways_out(found, pairs, remembered, limit[of_pair], TAKEN_BACK, outlines)
    return _merged(chosen, at, of_gap)


def _remembered(
    memory: ContactMemory, chosen: Chosen, pairs: Ints, wanted: Ints, vertex_block: Ints
) -> tuple[tuple[Ints, Ints, Ints, Ints], Floats]:
    """Return vertex, edge and pair of closed contacts of ``wanted`` pairs (k,), and the depth.

    Those (m,) that are not ``chosen`` any more, with the block of each vertex; the largest
    penetration of each pair, m, (k,).
    """
    width = len(vertex_block)
    own, other = vertex_block[memory.vertex], memory.block
    key = np.minimum(own, other) * width + np.maximum(own, other)
    keys = pairs[wanted, 0] * width + pairs[wanted, 1]
    at = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
    rows = (keys[at] == key) & (memory.gap < 0.0)
    depth = np.zeros(len(wanted))
    np.maximum.at(depth, at[rows], -memory.gap[rows])
    there = chosen[0] * width + chosen[1]
    rows &= ~np.isin(memory.vertex * width + memory.edge, there)
    return (memory.vertex[rows], memory.edge[rows], wanted[at[rows]], vertex_block), depth


def _merged(chosen: Chosen, added: Ints, gap: Floats) -> Chosen:
    """Return contacts with those ``added`` (k, 3): vertex, edge, pair; with ``gap`` (k,), m."""
    if not len(added):
        return chosen
    vertex, edge, pair = (np.concatenate(both) for both in zip(chosen[:3], added.T, strict=True))
    order = np.lexsort((edge, vertex, pair))
    gaps = np.concatenate((chosen[3], gap))
    return vertex[order], edge[order], pair[order], gaps[order]
