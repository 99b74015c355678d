"""Mass matrices M = int T^T T dm of the blocks, and their frames at the start of a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block.displacement import weighted_squares
from clast.block.polygon import moments
from clast.compute.jit import kernel
from clast.compute.mat6 import put_lines
from clast.compute.parallel import BLOCKS, shared
from clast.compute.vec6 import six, zeros
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


def block_frames(model: Model, state: State) -> BlockFrames:
    """Return the frames of all blocks.

    A block keeps the mass that it had at the start; where strain has changed its area the density
    has changed, so that weight and momentum do not drift.
    """
    area, centroid, matrix = frames_of(state.vertices, model.block_start, model.mass)
    return BlockFrames(area=area, centroid=centroid, mass_matrix=matrix)


@kernel()
def frames_of(vertices, block_start, mass):
    """Return areas (n,), m2, centroids (n, 2), m, and M = int T^T T dm (n, 6, 6), exact.

    From mass (n,), kg/m, and moments about the centroid, where int x dm = int y dm = 0 (Shi 1988).
    """
    area, centroid, second = moments(vertices, block_start)
    matrix = np.empty((len(mass), 6, 6))
    _mass_matrices(len(mass), mass, area, second, matrix)
    return area, centroid, matrix


@shared(BLOCKS)
def _mass_matrices(first, last, mass, area, second, result):
    """Write the mass matrices of blocks ``first`` to ``last`` - 1."""
    for b in range(first, last):
        density = mass[b] / area[b]
        sxx, syy, sxy = density * second[b, 0], density * second[b, 1], density * second[b, 2]
        each_way = six(mass[b], 0.0, 0.0, sxx, sxy, syy)
        put_lines(result, b, weighted_squares(each_way, zeros(), each_way))
