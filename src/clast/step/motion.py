"""From the solved displacements to the next state: placing, stress, velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block import elasticity as tensors
from clast.block import polygon
from clast.block.displacement import DisplacementFunction
from clast.block.inertia import BlockFrames
from clast.contact.jacobian import places_at_once
from clast.contact.verlet_list import VerletList, near_pairs
from clast.errors import StepOutcome, StepRejected
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.step.method import Method


@dataclass(frozen=True, kw_only=True)
class Motion:
    """Where a displacement takes the system."""

    vertices: Floats
    """Vertices at the end of the step, m, shape (nv, 2)."""
    points: Floats
    """Material points at the end of the step, m, shape (np, 2)."""
    stress: Floats
    """Stress at the end of the step, Pa, shape (n, 3)."""
    velocity: Floats
    """Velocity at the end of the step, shape (n, 6)."""
    turn: Floats
    """Rotation in the step, rad, shape (n,)."""
    travel: float
    """Largest movement of a vertex, m."""
    approach: float
    """The same against blocks that it might touch in the step, m; 0 far from any."""


LARGEST_TURN = 0.1
"""Largest rotation in one step, rad, that the linearised equations are trusted with."""


STRESS, STRAIN_RATES = 0, 3
"""First column of xx, yy and xy among the stresses (n, 3), and among the velocities (n, 6)."""


def move(
    displacement: DisplacementFunction,
    positions: Floats,
    block: np.ndarray,
    centroid: Floats,
    unknowns: Floats,
) -> Floats:
    """Return positions (k, 2) of material points of the blocks ``block`` (k,) after a step.

    Written as position + movement, so that a block that does not move keeps every bit.
    """
    offset: Floats = polygon.offsets(positions, block, centroid)
    if places_at_once(displacement):
        return positions + displacement.movements(offset, unknowns, block)
    return positions + (displacement.place(offset, unknowns.take(block, axis=0)) - offset)


def end_stress(model: Model, state: State, unknowns: Floats) -> Floats:
    """Return the stress, Pa, (n, 3), after the strains of d (n, 6), in directions of the start."""
    strained: Floats = tensors.strained(state.stress, model.elasticity, unknowns)
    return strained


def advance(
    model: Model,
    method: Method,
    state: State,
    frames: BlockFrames,
    unknowns: Floats,
    end_velocity: Floats,
    stress: Floats,
    near: VerletList,
) -> Motion:
    """Return where the unknowns d (n, 6) of a step take the system.

    ``end_velocity`` (n, 6) is the velocity that the scheme gives in the frame of the start,
    ``stress`` (n, 3) the stress at the end in that frame, Pa.

    Raises StepRejected where a vertex moves further than max_displacement against a block that it
    might touch, or a block turns further than the equations bear.
    """
    turn = method.displacement.turn(unknowns)
    if not np.all(np.abs(turn) <= LARGEST_TURN):
        raise StepRejected(StepOutcome.ROTATED_TOO_FAR)
    block = model.vertex_block
    vertices = move(method.displacement, state.vertices, block, frames.centroid, unknowns)
    travel = float(polygon.travel(state.vertices, vertices))
    if not np.isfinite(travel):
        raise StepRejected(StepOutcome.NOT_FINITE)
    approach = travel
    if travel > method.max_displacement:
        approach = approach_of(model, state.vertices, vertices, near)
    if approach > method.max_displacement:
        raise StepRejected(
            StepOutcome.TRAVELLED_TOO_FAR,
            f"{approach:.3g} m against max_displacement = {method.max_displacement:.3g} m",
        )
    points = move(
        method.displacement,
        state.points,
        model.material_points.block,
        frames.centroid,
        unknowns,
    )
    return Motion(
        vertices=vertices,
        points=points,
        stress=tensors.turned(stress, STRESS, turn, 1.0),
        # the strain rate turns with the block, so that its kinetic energy stays what it was
        velocity=tensors.turned(end_velocity, STRAIN_RATES, turn, 2.0),
        turn=turn,
        travel=travel,
        approach=approach,
    )


def approach_of(model: Model, before: Floats, after: Floats, near: VerletList) -> float:
    """Return how far a vertex moves at most against a block that it might touch, m.

    From vertices ``before`` to ``after`` a step, (nv, 2).  Free flight is exact at any length, and
    so is what two blocks do together: only pairs whose ways meet count.
    """
    moved = after - before
    thrown = float(np.hypot(*moved.T).max())
    if thrown > float(np.ptp(before, axis=0).max()):
        return thrown
    start, count = model.block_start, np.diff(model.block_start)
    way = np.asarray(polygon.farthest(moved, start))
    pairs = near_pairs(near, before, start, model.fixed, 0.0, way)
    mean = np.add.reduceat(moved, start[:-1], axis=0) / count[:, None]
    own = np.asarray(polygon.farthest(moved - np.repeat(mean, count, axis=0), start))
    lower, higher = pairs.T
    against = np.hypot(*(mean[lower] - mean[higher]).T) + own[lower] + own[higher]
    # where two turn together the sum says too much
    return float(np.minimum(against, way[lower] + way[higher]).max(initial=0.0))
