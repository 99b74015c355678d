"""Contributions to the equations K d = F of a step but those of the contacts.

Inertia, elasticity, stress and weight are added block by block (block/equations.py), loads and
fixed points here; contacts, which couple blocks, in :mod:`clast.linear.system`.  Blocks keep
their start area in the elastic terms, as they keep their mass: the strain energy
1/2 A sigma.C.sigma is then the same before and after a rotation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate, pairwise

import numpy as np

from clast.block import equations as block_terms
from clast.block.displacement import DisplacementFunction
from clast.block.inertia import BlockFrames
from clast.linear.system import DiagonalTerms
from clast.model.model import Floats, Ints, Model
from clast.model.state import State
from clast.step import stopping
from clast.step.integration import Scheme
from clast.step.method import Method


@dataclass(frozen=True, kw_only=True)
class PointSlices:
    """Rows of ``State.points`` by kind (see ``Model.material_points``)."""

    fixed: slice
    loaded: slice
    line_start: slice
    line_end: slice
    measured: slice


def point_slices(model: Model) -> PointSlices:
    """Return which rows of ``State.points`` belong to which kind of point."""
    return _slices(
        len(model.fixed_points.block),
        len(model.point_loads.block),
        len(model.line_loads.block),
        len(model.measured_points.block),
    )


@lru_cache(maxsize=16)
def _slices(fixed: int, loaded: int, lines: int, measured: int) -> PointSlices:
    """Return consecutive slices of these lengths; asked for several times in every step."""
    stops = [0, *accumulate((fixed, loaded, lines, lines, measured))]
    rows = [slice(start, stop) for start, stop in pairwise(stops)]
    return PointSlices(
        fixed=rows[0], loaded=rows[1], line_start=rows[2], line_end=rows[3], measured=rows[4]
    )


def load_rows(
    model: Model, frames: BlockFrames, displacement: DisplacementFunction, state: State
) -> tuple[Ints, Floats]:
    """Return block (k,) and generalised force (k, 6) of every point and line load.

    A uniform traction q along a line of length L gives L T(midpoint)^T q, exact because T is
    linear.
    """
    if not len(model.point_loads.block) and not len(model.line_loads.block):
        return model.point_loads.block, np.zeros((0, 6))
    rows = point_slices(model)
    start, end = state.points[rows.line_start], state.points[rows.line_end]
    length = np.hypot(*(end - start).T)
    block = np.concatenate([model.point_loads.block, model.line_loads.block])
    at = np.concatenate([state.points[rows.loaded], 0.5 * (start + end)])
    force = np.concatenate([model.point_loads.force, length[:, None] * model.line_loads.traction])
    basis = displacement.basis(at - frames.centroid[block])
    return block, np.einsum("kxi,kx->ki", basis, force)


def fixed_point_rows(
    model: Model,
    frames: BlockFrames,
    displacement: DisplacementFunction,
    state: State,
    time: float,
) -> tuple[Floats, Floats]:
    """Return T (k, 2, 6) at the fixed points and their distance (k, 2) from the anchor, m.

    ``time``, s, is when the anchors are looked at; the points are those of ``state``.
    """
    at = state.points[point_slices(model).fixed]
    basis = displacement.basis(at - frames.centroid[model.fixed_points.block])
    anchor = model.fixed_points.at + model.ground_motion.anchor_displacement(time)
    return basis, at - anchor


def diagonal_terms(
    model: Model,
    method: Method,
    frames: BlockFrames,
    state: State,
    drift: Floats,
    scheme: Scheme,
) -> DiagonalTerms:
    """Return everything of a step but its contacts; ``drift`` (n, 6) is h v, m."""
    end = state.time + scheme.step
    acceleration = model.gravity + model.ground_motion.body_acceleration(state.time, end)
    matrix, force, momentum = block_terms.terms(
        (frames.mass_matrix, scheme.inertia, drift),
        (model.area, model.elasticity),
        state.stress,
        model.mass,
        acceleration,
    )
    if scheme.stopped is not None:
        terms = matrix, force, momentum
        stopping.add_inertia(scheme.stopped, scheme.of_stopped, drift, terms)
    block, load = load_rows(model, frames, method.displacement, state)
    if len(block):
        np.add.at(force, block, load)
    held, stiffness = model.fixed_points.block, method.fixed_point_stiffness
    if len(held):
        basis, drift = fixed_point_rows(model, frames, method.displacement, state, end)
        np.add.at(matrix, held, stiffness * np.einsum("kxi,kxj->kij", basis, basis))
        np.add.at(force, held, -stiffness * np.einsum("kxi,kx->ki", basis, drift))
    return DiagonalTerms(diagonal=matrix, force=force, momentum=momentum, centroid=frames.centroid)
