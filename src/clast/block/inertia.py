"""Where the blocks are at the start of a step: centroids, moments, mass matrices."""

from __future__ import annotations

from dataclasses import dataclass

from clast.block import polygon
from clast.block.displacement import DisplacementFunction
from clast.model.model import Floats, Model
from clast.model.state import State


@dataclass(frozen=True, kw_only=True)
class BlockFrames:
    """Geometry and inertia of the blocks at the start of a step."""

    area: Floats
    """Area now, m2, shape (n,)."""
    centroid: Floats
    """Centroid, m, shape (n, 2)."""
    mass_matrix: Floats
    """M = int T^T T dm, shape (n, 6, 6)."""


def block_frames(model: Model, displacement: DisplacementFunction, state: State) -> BlockFrames:
    """Return the frames of all blocks.

    A block keeps the mass that it had at the start; where strain has changed its area the density
    has changed, so that weight and momentum do not drift.
    """
    area, centroid, second = polygon.moments(state.vertices, model.block_start)
    density = model.mass / area
    matrix = displacement.mass_matrix(model.mass, density[:, None] * second)
    return BlockFrames(area=area, centroid=centroid, mass_matrix=matrix)
