"""Candidate edges of every vertex, before a corner rule chooses among them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block import polygon
from clast.contact import memory_kernels as memory_kernel
from clast.contact import narrow_phase, seams
from clast.contact.search_distance import Reach
from clast.model.model import Floats, Ints
from clast.model.state import ContactMemory


@dataclass(frozen=True, kw_only=True)
class Candidates:
    """Candidate edges, grouped by (vertex, block of the edge); m candidates in k groups."""

    group_start: Ints
    """First candidate of each group, shape (k + 1,)."""
    vertex: Ints
    """Vertex, shape (m,)."""
    edge: Ints
    """Candidate edge (index of its first vertex), shape (m,)."""
    pair: Ints
    """Index of the pair of blocks, shape (m,)."""
    gap: Floats
    """Signed distance to the edge's line, m, shape (m,)."""
    along: Floats
    """Distance of the foot from the edge's first vertex along the edge, m, shape (m,)."""
    remembered: Ints
    """Entrance edge of each group in the last step, or -1, shape (k,)."""
    direction: Floats
    """Unit direction of the edge that starts at each vertex, shape (nv, 2)."""
    length: Floats
    """Length of that edge, m, shape (nv,)."""
    vertex_block: Ints
    """Block of each vertex, shape (nv,)."""
    block_start: Ints
    """First vertex of each block, shape (n + 1,)."""
    critdis: float
    """Length by which edges are extended where corners coincide, m."""


def pair_penetration(block_start: Ints, pairs: Ints, memory: ContactMemory) -> Floats:
    """Return the largest remembered penetration of each pair of blocks, m, shape (q,).

    It belongs to the pair, not to the vertex: as blocks roll over each other a deep (soft) contact
    is handed from a vertex of one to a vertex of the other.
    """
    depth: Floats = memory_kernel.deepest_by_pair(
        pairs,
        polygon.owners(block_start),
        len(block_start) - 1,
        memory.vertex,
        memory.block,
        memory.gap,
    )
    return depth


def find_candidates(
    vertices: Floats,
    block_start: Ints,
    pairs: Ints,
    memory: ContactMemory,
    reach: Reach,
    shift: Floats | None = None,
    strain: Floats | None = None,
) -> Candidates:
    """Return every edge that a vertex could be in contact with (see the module's kernels).

    ``shift`` (nv, 2) is how far the velocities would carry each vertex in the step, m, ``strain``
    (n, 3) that of the blocks; nothing if not given.
    """
    direction, length = polygon.edges(vertices, block_start)
    box = polygon.boxes(vertices, block_start)
    vertex_block = polygon.owners(block_start)
    depth = pair_penetration(block_start, pairs, memory)
    bearing = (
        *seams.rows_by_block(memory.vertex, memory.block, vertex_block, len(box)),
        memory.vertex,
        memory.block,
        memory.edge,
        memory.gap,
        np.zeros((len(box), 3)) if strain is None else strain,
    )
    start, vertex, edge, pair, gap, along = narrow_phase.candidates(
        (vertices, np.zeros_like(vertices) if shift is None else shift, direction, length),
        (block_start, box, vertex_block),
        pairs,
        depth,
        reach.travel_of(len(box)),
        (reach.front, reach.depth, reach.critdis, reach.tip),
        bearing,
    )
    remembered = memory_kernel.remembered_edges(
        start, vertex, edge, vertex_block, memory.vertex, memory.block, memory.edge
    )
    return Candidates(
        group_start=start,
        vertex=vertex,
        edge=edge,
        pair=pair,
        gap=gap,
        along=along,
        remembered=remembered,
        direction=direction,
        length=length,
        vertex_block=vertex_block,
        block_start=block_start,
        critdis=reach.critdis,
    )
