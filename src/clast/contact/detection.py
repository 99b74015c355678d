"""From the blocks' outlines to the contacts of a step.

Broad phase (boxes) -> candidate edges (signed gap to the lengthened edge, entrance test) ->
corner rule -> contacts with their memory, strength and rows of the equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.contact.arrays import Contacts
from clast.contact.memory import recall
from clast.interfaces import CornerRule, DisplacementFunction
from clast.kernels import broad_phase, narrow_phase, polygon
from clast.model import Bools, Floats, Ints, JointTable, Model
from clast.state import ContactMemory, State


@dataclass(frozen=True, kw_only=True)
class Reach:
    """How far contact detection looks, m."""

    front: float
    """In front of an edge: contacts that may close within the step."""
    depth: float
    """Behind an edge, beyond the remembered penetration: how deep a vertex may have moved."""
    critdis: float
    """Length by which edges are extended where corners coincide."""
    tip: float = 0.0
    """Length by which edges are extended for a vertex that touches with its tip alone."""


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


def near_pairs(vertices: Floats, block_start: Ints, fixed: Bools, distance: float) -> Ints:
    """Return pairs (lower, higher) of blocks nearer than ``distance`` by their boxes, (q, 2)."""
    half = 0.5 * distance
    box = polygon.boxes(vertices, block_start) + np.array([-half, -half, half, half])
    return broad_phase.overlapping_pairs(box, fixed)


def pair_penetration(block_start: Ints, pairs: Ints, memory: ContactMemory) -> Floats:
    """Return the largest remembered penetration of each pair of blocks, m, shape (q,).

    It belongs to the pair, not to the vertex: as blocks roll over each other a deep (soft) contact
    is handed from a vertex of one to a vertex of the other.
    """
    depth = np.zeros(len(pairs))
    if len(memory) == 0 or len(pairs) == 0:
        return depth
    own = np.searchsorted(block_start, memory.vertex, side="right") - 1
    width = len(block_start)
    wanted = np.minimum(own, memory.block) * width + np.maximum(own, memory.block)
    keys = pairs[:, 0] * width + pairs[:, 1]
    at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    there = keys[at] == wanted
    np.maximum.at(depth, at[there], -memory.gap[there])
    return depth


def find_candidates(
    vertices: Floats,
    block_start: Ints,
    pairs: Ints,
    memory: ContactMemory,
    reach: Reach,
    shift: Floats | None = None,
) -> Candidates:
    """Return every edge that a vertex could be in contact with (see the module's kernels).

    ``shift`` (nv, 2) is how far the velocities would carry each vertex in the step, m; nothing if
    not given.
    """
    direction, length = polygon.edges(vertices, block_start)
    box = polygon.boxes(vertices, block_start)
    vertex_block = np.repeat(np.arange(len(block_start) - 1), np.diff(block_start))
    depth = pair_penetration(block_start, pairs, memory)
    capacity = 64 + 16 * len(pairs)
    while True:
        count, start, vertex, edge, pair, gap, along = narrow_phase.candidates(
            vertices,
            np.zeros_like(vertices) if shift is None else shift,
            block_start,
            direction,
            length,
            box,
            pairs,
            depth,
            reach.front,
            reach.depth,
            reach.critdis,
            reach.tip,
            capacity,
        )
        if count <= capacity:
            break
        capacity = count
    vertex, edge = vertex[:count], edge[:count]
    remembered = narrow_phase.remembered_edges(
        start, vertex, edge, vertex_block, memory.vertex, memory.block, memory.edge
    )
    return Candidates(
        group_start=start,
        vertex=vertex,
        edge=edge,
        pair=pair[:count],
        gap=gap[:count],
        along=along[:count],
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
    pairs = near_pairs(state.vertices, model.block_start, model.fixed, around)
    shift = None
    if drift is not None:
        block = model.vertex_block
        basis = displacement.basis(state.vertices - centroid[block])
        shift = np.einsum("vxk,vk->vx", basis, drift[block])
    candidates = find_candidates(
        state.vertices, model.block_start, pairs, state.memory, reach, shift
    )
    chosen = np.flatnonzero(corner_rule.choose(candidates, state.vertices))
    return _contacts(model, displacement, state, centroid, pairs, candidates, chosen, reach)


def _contacts(
    model: Model,
    displacement: DisplacementFunction,
    state: State,
    centroid: Floats,
    pairs: Ints,
    candidates: Candidates,
    chosen: Ints,
    reach: Reach,
) -> Contacts:
    """Return the chosen candidates with memory, strength and rows."""
    vertex, edge = candidates.vertex[chosen], candidates.edge[chosen]
    i, j = candidates.vertex_block[vertex], candidates.vertex_block[edge]
    touching, pair = np.unique(candidates.pair[chosen], return_inverse=True)
    gap = candidates.gap[chosen]
    tangent = candidates.direction[edge]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    at = state.vertices[vertex]
    foot = at - gap[:, None] * normal
    at_vertex = displacement.basis(at - centroid[i])
    at_edge = displacement.basis(foot - centroid[j])
    joint = joints_of_pairs(model.joint_table, model.block_rock, pairs[touching])[pair]
    joints = model.joint_table.joints
    row = recall(state.memory, vertex, j, edge)
    known = row >= 0
    memory = state.memory
    cohesion = np.array([one.cohesion for one in joints])[joint]
    tensile = np.array([one.tensile_strength for one in joints])[joint]
    # bonds exist only along joints that are closed at the start of the run
    intact = (state.time == 0.0) & (np.abs(gap) <= reach.critdis)
    bonded = np.where(known, _take(memory.bonded, row, known), intact)
    return Contacts(
        vertex=vertex,
        edge=edge,
        vertex_block=i,
        edge_block=j,
        pair=np.ascontiguousarray(pair),
        pairs=pairs[touching],
        gap=gap,
        normal=normal,
        foot=foot,
        length=narrow_phase.contact_lengths(
            vertex,
            edge,
            i,
            j,
            candidates.pair[chosen],
            state.vertices,
            model.block_start,
            candidates.direction,
            candidates.length,
            reach.critdis,
        ),
        normal_vertex=np.einsum("mxk,mx->mk", at_vertex, normal),
        normal_edge=-np.einsum("mxk,mx->mk", at_edge, normal),
        tangent_vertex=np.einsum("mxk,mx->mk", at_vertex, tangent),
        tangent_edge=-np.einsum("mxk,mx->mk", at_edge, tangent),
        friction=np.tan(np.radians([one.friction_angle for one in joints]))[joint],
        cohesion=np.where(bonded, cohesion, 0.0),
        tensile_strength=np.where(bonded, tensile, 0.0),
        bonded=bonded,
        known=known,
        shear_force=_take(memory.shear_force, row, known),
        normal_force=_take(memory.normal_force, row, known),
        multiplier=_take(memory.multiplier, row, known),
        mode=_take(memory.mode, row, known),
        friction_base=np.full(len(chosen), np.nan),
    )


def _take(values, row: Ints, known: Bools):  # type: ignore[no-untyped-def]
    """Return the remembered values (m,), zero where nothing is known."""
    result = np.zeros(len(row), values.dtype)
    result[known] = values[row[known]]
    return result


def find_tunnelled(model: Model, vertices: Floats, memory: ContactMemory) -> tuple[float, int, int]:
    """Return depth beyond what contacts know, m, vertex and block of the deepest jump.

    (0, -1, -1) where no vertex lies deeper in a block than the contacts of the two do.
    """
    pairs = near_pairs(vertices, model.block_start, model.fixed, 0.0)
    box = polygon.boxes(vertices, model.block_start)
    depth = pair_penetration(model.block_start, pairs, memory)
    jump, vertex, block = narrow_phase.deepest_jump(vertices, model.block_start, box, pairs, depth)
    return float(jump), int(vertex), int(block)
