"""From the blocks' outlines to the contacts of a step.

Broad phase (boxes) -> candidate edges (signed gap to the lengthened edge, entrance test) ->
corner rule -> contacts with their memory, strength and rows of the equations.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from clast.block import polygon
from clast.block.displacement import displacements
from clast.contact import contact_kernels as kernel
from clast.contact import narrow_phase
from clast.contact.candidates import Candidates, find_candidates, pair_penetration
from clast.contact.contacts import Contacts
from clast.contact.corner_rules import CornerRule
from clast.contact.crossings import with_crossings
from clast.contact.memory import recall
from clast.contact.search_distance import Reach
from clast.contact.verlet_list import VerletList, near_pairs
from clast.model.model import Floats, Ints, Joint, JointTable, Model
from clast.model.state import ContactMemory, State


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
    state: State,
    centroid: Floats,
    reach: Reach,
    drift: Floats | None = None,
    near: VerletList | None = None,
) -> Contacts:
    """Return the contacts of a step that starts at ``state``; ``centroid`` (n, 2) in m.

    ``drift`` (n, 6) is the displacement that the velocities would bring in the step: with it, a
    tip that would cross an edge beside which it stands now is a contact already.
    """
    around = reach.front + max(reach.critdis, reach.tip)
    travel = reach.travel_of(model.block_count)
    near = near or VerletList()
    pairs = near_pairs(near, state.vertices, model.block_start, model.fixed, around, travel)
    shift = None
    if drift is not None:
        block = model.vertex_block
        offset = polygon.offsets(state.vertices, block, centroid)
        shift = displacements(offset, drift, block)
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
    return _contacts(model, state, centroid, pairs, candidates, chosen, reach)


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
        levers=levers,
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
    model: Model, before: Floats, vertices: Floats, memory: ContactMemory, near: VerletList
) -> tuple[float, int, int]:
    """Return depth beyond what contacts know, m, vertex and block of the deepest jump.

    From where the vertices (nv, 2) were ``before`` the step.  (0, -1, -1) where no vertex has got
    deeper into a block than the contacts of the two have.
    """
    pairs = near_pairs(near, vertices, model.block_start, model.fixed, 0.0)
    box = polygon.boxes(vertices, model.block_start)
    depth = pair_penetration(model.block_start, pairs, memory)
    jump, vertex, block = narrow_phase.deepest_jump(
        before, vertices, model.block_start, box, pairs, depth
    )
    return float(jump), int(vertex), int(block)
