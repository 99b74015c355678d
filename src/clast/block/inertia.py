"""Mass matrices M = int T^T T dm of the blocks, and their frames at the start of a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.block import polygon
from clast.block.displacement import weighted_squares
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
    area, centroid, second = polygon.moments(state.vertices, model.block_start)
    density = model.mass / area
    matrix = mass_matrices(model.mass, density[:, None] * second)
    return BlockFrames(area=area, centroid=centroid, mass_matrix=matrix)


@kernel()
def mass_matrices(mass, moments):
    """Return M = int T^T T dm (n, 6, 6), exact, from mass (n,), kg/m, and moments (n, 3), kg m2/m.

    ``moments`` are int x2, int y2 and int xy dm about the centroid, where int x dm = int y dm = 0
    (Shi 1988).
    """
    result = np.empty((len(mass), 6, 6))
    _mass_matrices(len(mass), mass, moments, result)
    return result


@shared(BLOCKS)
def _mass_matrices(first, last, mass, moments, result):
    """Write the mass matrices of blocks ``first`` to ``last`` - 1."""
    for b in range(first, last):
        sxx, syy, sxy = moments[b, 0], moments[b, 1], moments[b, 2]
        each_way = six(mass[b], 0.0, 0.0, sxx, sxy, syy)
        put_lines(result, b, weighted_squares(each_way, zeros(), each_way))
