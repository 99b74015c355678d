"""How far contacts are looked for, and the candidate edges of every vertex that this finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.block import polygon
from clast.contact import flush_faces
from clast.contact.memory import first_rows, pair_penetration, remembered_edges
from clast.contact.narrow_phase import PART, candidates_of_parts, join_parts
from clast.model.model import Bools, Floats, Ints
from clast.model.state import ContactMemory


@dataclass(frozen=True, kw_only=True)
class SearchDistance:
    """How far contact detection looks, m."""

    front: float
    """In front of an edge, beside the movement of the blocks."""
    depth: float
    """Behind an edge, beyond the remembered penetration: how deep a vertex may have moved."""
    critdis: float
    """Length by which edges are extended where corners coincide."""
    tip: float = 0.0
    """Length by which edges are extended for a vertex that touches with its tip alone."""
    travel: Floats | None = None
    """How far a vertex of each block may move in a step, m, shape (n,); added to both."""

    def travel_of(self, count: int) -> Floats:
        """Return the travel of ``count`` blocks, m, shape (count,); 0 where none is given."""
        return np.zeros(count) if self.travel is None else self.travel


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
    polygons: tuple[Any, ...]
    """Arrays of ``polygon.Polygons``."""
    box: Floats
    """Bounding box of each block, m, shape (n, 4)."""
    critdis: float
    """Length by which edges are extended where corners coincide, m."""

    @property
    def arrays(self) -> tuple[Any, ...]:
        """The candidates as kernels take them (corner_rules.GroupedCandidates)."""
        ends = self.group_start, self.vertex, self.edge, self.pair
        return *ends, self.gap, self.along, self.remembered


def find_candidates(
    vertices: Floats,
    block_start: Ints,
    pairs: Ints,
    memory: ContactMemory,
    reach: SearchDistance,
    shift: Floats | None = None,
    of_blocks: tuple[Floats, Bools] | None = None,
    of_vertices: tuple[Ints, Ints] | None = None,
) -> Candidates:
    """Return every edge that a vertex could be in contact with (contact/narrow_phase.py).

    ``shift`` (nv, 2) is how far the velocities would carry each vertex in the step, m, nothing if
    not given; ``of_blocks`` are the strains of the blocks (n, 3), none if not given, and which
    cannot move, (n,).  ``of_vertices`` are the block of each vertex (nv,) and its first row in the
    memory (nv + 1,), if they are known already.
    """
    box = polygon.boxes(vertices, block_start)
    if of_vertices is None:
        of_vertices = polygon.owners(block_start), first_rows(memory.vertex, len(vertices))
    vertex_block, rows = of_vertices
    polygons = polygon.polygon_arrays(vertices, block_start, vertex_block)
    if of_blocks is None:
        of_blocks = np.zeros((len(box), 3)), np.zeros(len(box), np.bool_)
    start, of_block = flush_faces.rows_by_block(
        (memory.vertex, memory.block, memory.gap), vertex_block, len(box), reach.critdis
    )
    looks = (
        np.zeros_like(vertices) if shift is None else shift,
        np.array([reach.front, reach.depth, reach.critdis, reach.tip]),
        # the fields of flush_faces.BearingContacts
        start,
        of_block,
        memory.vertex,
        memory.block,
        memory.edge,
        memory.gap,
        of_blocks[0],
        flush_faces.goes_on(pairs, box, polygons, reach.critdis),
        flush_faces.largest_settlements(memory.gap, *of_blocks, box),
    )
    depth = pair_penetration(vertex_block, pairs, memory)
    near = pairs, box, depth, reach.travel_of(len(box))
    group_start, vertex, edge, pair, gap, along = _candidate_arrays(polygons, near, looks)
    remembered = remembered_edges(
        (group_start, vertex, edge), vertex_block, (rows, memory.block, memory.edge)
    )
    return Candidates(
        group_start=group_start,
        vertex=vertex,
        edge=edge,
        pair=pair,
        gap=gap,
        along=along,
        remembered=remembered,
        polygons=polygons,
        box=box,
        critdis=reach.critdis,
    )


def _candidate_arrays(polygons: Any, near: Any, looks: Any) -> tuple[Any, ...]:
    """Return the arrays of ``narrow_phase.CandidateArrays``, from the output of its kernels."""
    count = len(near[0])
    parts = max(1, -(-count // PART))
    counts = np.zeros((parts, 2), np.int64)
    most = 64 + 6 * min(PART, count)
    while True:
        room = _room_for(parts * (most + 1))
        candidates_of_parts(parts, most, polygons, near, looks, room, counts)
        wanted = int(counts[0, 0] if parts == 1 else counts[:, 0].max())
        if wanted <= most:
            break
        most = wanted
    number, groups = counts.sum(axis=0) if parts > 1 else counts[0]
    if parts > 1:  # else it lies together already
        room, of_parts = _room_for(int(number)), room
        join_parts(parts, most, counts, of_parts, room)
    start, *arrays = room
    start[0] = 0
    return start[: groups + 1], *(one[:number] for one in arrays)


def _room_for(number: int) -> tuple[Ints, Ints, Ints, Ints, Floats, Floats]:
    """Return arrays for so many candidates: group starts, vertex, edge, pair, gap, along."""
    vertex, edge, pair = np.empty((3, number), np.int64)
    return np.empty(number + 1, np.int64), vertex, edge, pair, *np.empty((2, number))
