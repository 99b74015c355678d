"""Follows measured points: where they are and how fast they move."""

from __future__ import annotations

import numpy as np

from clast.block import polygon
from clast.model.model import Floats, Model
from clast.model.state import State


class PointTracker:
    """Follows the measured points of a model through its states."""

    def __init__(self, model: Model) -> None:
        points = model.measured_points
        total = len(model.material_points.block)
        self._rows = slice(total - len(points.block), total)
        self._start = points.at
        self._block = points.block
        # Centroids are wanted of the points' blocks only: their vertices, block after block.
        blocks, self._outline = np.unique(points.block, return_inverse=True)
        outlines = [np.arange(model.block_start[b], model.block_start[b + 1]) for b in blocks]
        self._vertices = np.concatenate([np.zeros(0, np.int64), *outlines])
        self._outline_start = np.cumsum([0, *map(len, outlines)])

    def row(self, state: State) -> tuple[float, Floats, Floats, Floats]:
        """Return time and displacement (k, 2), velocity (k, 2), rotation (k,) of the points."""
        at = state.points[self._rows]
        _, centroid, _ = polygon.moments(state.vertices[self._vertices], self._outline_start)
        velocity = point_velocity(at - centroid[self._outline], state.velocity[self._block])
        return state.time, at - self._start, velocity, state.rotation[self._block]


def point_velocity(offset: Floats, velocity: Floats) -> Floats:
    """Return the velocity (k, 2), m/s, of points at ``offset`` (k, 2) from their block's centroid.

    ``velocity`` (k, 6) is the block's (u, v, r, ex, ey, gxy): translation, spin and strain rate.
    """
    x, y = offset.T
    u, v, spin, ex, ey, gxy = velocity.T
    out = np.empty_like(offset)
    out[:, 0] = u - y * spin + x * ex + 0.5 * y * gxy
    out[:, 1] = v + x * spin + y * ey + 0.5 * x * gxy
    return out
