"""From the blocks' outlines to the contacts of a step.

Broad phase (boxes) -> candidate edges (signed gap to the lengthened edge, entrance test) ->
corner rule -> contacts with their memory, strength and rows of the equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from clast.contact import neighbourhood
from clast.contact.arrays import Contacts
from clast.contact.crossings import with_crossings
from clast.contact.memory import recall
from clast.contact.rows import levers_of, movement
from clast.interfaces import CornerRule, DisplacementFunction
from clast.kernels import contacts as kernel
from clast.kernels import memory as memory_kernel
from clast.kernels import narrow_phase, polygon, seams
from clast.model import Bools, Floats, Ints, Joint, JointTable, Model
from clast.state import ContactMemory, State


@dataclass(frozen=True, kw_only=True)
class Reach:
    """How far contact detection looks, m."""

    front: float
    """In front of an edge, beside what the blocks may move."""
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


def near_pairs(
    vertices: Floats,
    block_start: Ints,
    fixed: Bools,
    distance: float,
    travel: Floats | float = 0.0,
) -> Ints:
    """Return pairs (lower, higher) of blocks that are near each other by their boxes, (q, 2).

    Nearer than ``distance``, m, plus the ``travel`` (n,) of each of the two, m.
    """
    half = np.empty(len(block_start) - 1)
    half[:] = 0.5 * distance + np.asarray(travel)
    return neighbourhood.LAST.near_pairs(vertices, block_start, half, fixed)


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


def joints_of_pairs(table: JointTable, block_rock: Ints, pairs: Ints) -> Ints:
    """Return the joint index of each pair of blocks: of the blocks, else of their rocks, (q,)."""
    joint = table.rock_pair[block_rock[pairs[:, 0]], block_rock[pairs[:, 1]]]
    if len(table.block_pair) == 0:
        return joint
    width = len(block_rock)
    own = table.block_pair[:, 0] * width + table.block_pair[:, 1]
    wanted = pairs[:, 0] * width + pairs[:, 1]
    at = np.minimum(np.searchsorted(own, wanted), len(own) - 1)
    return np.where(own[at] == wanted, table.block_pair_joint[at], joint)


def detect(
    model: Model,
    corner_rule: CornerRule,
    displacement: DisplacementFunction,
    state: State,
    centroid: Floats,
    reach: Reach,
    drift: Floats | None = None,
) -> Contacts:
    """Return the contacts of a step that starts at ``state``; ``centroid`` (n, 2) in m.

    ``drift`` (n, 6) is the displacement that the velocities would bring in the step: with it, a
    tip that would cross an edge beside which it stands now is a contact already.
    """
    around = reach.front + max(reach.critdis, reach.tip)
    travel = reach.travel_of(model.block_count)
    pairs = near_pairs(state.vertices, model.block_start, model.fixed, around, travel)
    shift = None
    if drift is not None:
        block = model.vertex_block
        offset = polygon.offsets(state.vertices, block, centroid)
        shift = movement(displacement, offset, drift, block)
    strain = np.einsum("nab,nb->na", model.compliance, state.stress)
    candidates = find_candidates(
        state.vertices, model.block_start, pairs, state.memory, reach, shift, strain
    )
    keep = corner_rule.choose(candidates, state.vertices)
    chosen = (
        candidates.vertex[keep],
        candidates.edge[keep],
        candidates.pair[keep],
        candidates.gap[keep],
    )
    chosen = with_crossings(
        chosen,
        pairs,
        (state.vertices, candidates.direction, model.block_start),
        model.vertex_block,
        state.memory,
        travel,
        reach.critdis,
    )
    return _contacts(model, displacement, state, centroid, pairs, candidates, chosen, reach)


@lru_cache(maxsize=8)
def _strengths_of(joints: tuple[Joint, ...]) -> tuple[Floats, Floats, Floats]:
    """Return tan(phi), cohesion, Pa, and tensile strength, Pa, of all joints, each (joints,)."""
    return (
        np.tan(np.radians([one.friction_angle for one in joints])),
        np.array([one.cohesion for one in joints], float),
        np.array([one.tensile_strength for one in joints], float),
    )


def _contacts(
    model: Model,
    displacement: DisplacementFunction,
    state: State,
    centroid: Floats,
    pairs: Ints,
    candidates: Candidates,
    chosen: tuple[Ints, Ints, Ints, Floats],
    reach: Reach,
) -> Contacts:
    """Return the contacts of vertex, edge, pair and gap (m,) with memory, strength and levers."""
    found, memory = candidates, state.memory
    vertex, edge, i, j, pair, gap, foot, levers, touching = kernel.chosen(
        np.ones(len(chosen[0]), np.bool_),
        chosen,
        pairs,
        (state.vertices, found.direction, found.vertex_block),
        centroid,
    )
    joint = joints_of_pairs(model.joint_table, model.block_rock, touching)
    known, bonded, shear_force, normal_force, multiplier, mode, *strengths = kernel.carried(
        recall(memory, vertex, j, edge),
        gap,
        # bonds exist only along joints that are closed at the start of the run
        reach.critdis if state.time == 0.0 else -1.0,
        (
            memory.bonded,
            memory.shear_force,
            memory.normal_force,
            memory.multiplier,
            memory.mode,
        ),
        pair,
        joint,
        _strengths_of(model.joint_table.joints),
    )
    friction, cohesion, tensile_strength = strengths
    return Contacts(
        vertex=vertex,
        edge=edge,
        vertex_block=i,
        edge_block=j,
        pair=pair,
        pairs=touching,
        gap=gap,
        normal=levers[:, :2],
        foot=foot,
        length=narrow_phase.contact_lengths(
            vertex,
            edge,
            i,
            j,
            pair,
            state.vertices,
            model.block_start,
            found.direction,
            found.length,
            reach.critdis,
        ),
        levers=levers_of(displacement, levers),
        friction=friction,
        cohesion=cohesion,
        tensile_strength=tensile_strength,
        bonded=bonded,
        known=known,
        shear_force=shear_force,
        normal_force=normal_force,
        multiplier=multiplier,
        mode=mode,
        friction_base=np.full(len(vertex), np.nan),
    )


def find_tunnelled(
    model: Model, before: Floats, vertices: Floats, memory: ContactMemory
) -> tuple[float, int, int]:
    """Return depth beyond what contacts know, m, vertex and block of the deepest jump.

    From where the vertices (nv, 2) were ``before`` the step.  (0, -1, -1) where no vertex has got
    deeper into a block than the contacts of the two have.
    """
    pairs = near_pairs(vertices, model.block_start, model.fixed, 0.0)
    box = polygon.boxes(vertices, model.block_start)
    depth = pair_penetration(model.block_start, pairs, memory)
    jump, vertex, block = narrow_phase.deepest_jump(
        before, vertices, model.block_start, box, pairs, depth
    )
    return float(jump), int(vertex), int(block)
