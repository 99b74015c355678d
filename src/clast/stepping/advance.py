"""From the solved displacements to the next state: placing, stress, velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.equations.frames import BlockFrames
from clast.errors import StepOutcome, StepRejected
from clast.interfaces import DisplacementFunction, Method
from clast.kernels import polygon
from clast.model import Floats, Model
from clast.state import State


@dataclass(frozen=True)
class ConstantAcceleration:
    """(2/h2) M d = (2/h) M v + F at the end of the step; v+ = (2/h) d - v (Shi 1988)."""

    theta: float = 0.5


@dataclass(frozen=True)
class BackwardEuler:
    """(1/h2) M d = (1/h) M v + F at the end of the step; v+ = d/h; dissipative."""

    theta: float = 1.0


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


LARGEST_TURN = 0.1
"""Largest rotation in one step, rad, that the linearised equations are trusted with."""


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
    return positions + (displacement.place(offset, unknowns.take(block, axis=0)) - offset)


def rotate_tensor(tensor: Floats, angle: Floats, shear_factor: float) -> Floats:
    """Return symmetric tensors (n, 3) turned by angles (n,), rad.

    ``shear_factor`` is 1 for stress (xx, yy, xy) and 2 for strain with engineering shear.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    xx, yy, xy = tensor[:, 0], tensor[:, 1], tensor[:, 2] / shear_factor
    both = 2.0 * cosine * sine * xy
    return np.stack(
        [
            cosine**2 * xx + sine**2 * yy - both,
            sine**2 * xx + cosine**2 * yy + both,
            shear_factor * (cosine * sine * (xx - yy) + (cosine**2 - sine**2) * xy),
        ],
        axis=1,
    )


def advance(
    model: Model,
    method: Method,
    state: State,
    frames: BlockFrames,
    unknowns: Floats,
    end_velocity: Floats,
) -> Motion:
    """Return where the unknowns d (n, 6) of a step take the system.

    ``end_velocity`` (n, 6) is the velocity that the scheme gives in the frame of the start.

    Raises StepRejected where a vertex moves further than max_displacement or a block turns
    further than the equations bear.
    """
    turn = method.displacement.turn(unknowns)
    if not np.all(np.abs(turn) <= LARGEST_TURN):
        raise StepRejected(StepOutcome.ROTATED_TOO_FAR)
    block = model.vertex_block
    vertices = move(method.displacement, state.vertices, block, frames.centroid, unknowns)
    travel = float(polygon.travel(state.vertices, vertices))
    if not np.isfinite(travel):
        raise StepRejected(StepOutcome.NOT_FINITE)
    if travel > method.max_displacement:
        raise StepRejected(
            StepOutcome.TRAVELLED_TOO_FAR,
            f"{travel:.3g} m against max_displacement = {method.max_displacement:.3g} m",
        )
    points = move(
        method.displacement,
        state.points,
        model.material_points.block,
        frames.centroid,
        unknowns,
    )
    stress = state.stress + np.einsum("nij,nj->ni", model.elasticity, unknowns[:, 3:])
    # the strain rate turns with the block, so that its kinetic energy stays what it was
    rates = rotate_tensor(end_velocity[:, 3:], turn, 2.0)
    return Motion(
        vertices=vertices,
        points=points,
        stress=rotate_tensor(stress, turn, 1.0),
        velocity=np.concatenate([end_velocity[:, :3], rates], axis=1),
        turn=turn,
        travel=travel,
    )
