"""Walls, columns and arches, the faces that their blocks share, and what holds these."""

import numpy as np
import shapely

from scenes.systems import REACH, box, bricks, centroids, march, system, voussoirs


def columns(count, height):
    """Return aligned columns of 1 m boxes: four corners meet at every point."""
    return [box(x, y) for x in range(count) for y in range(height)]


SYSTEMS = {
    "wall": bricks(5, 6),
    "third bond": bricks(4, 5, bond=1.0 / 3.0),
    "columns": columns(4, 5),
    "arch": voussoirs(11),
    "flat arch": voussoirs(11, 8.0, 8.4),
}


def faces_in_common(outlines):
    """Yield (i, j, one end, other end) of every face that two undisturbed outlines share."""
    solids = shapely.polygons([np.round(one, 12) for one in outlines])
    for i, one in enumerate(solids):
        for j in range(i + 1, len(solids)):
            face = one.buffer(1e-9).intersection(solids[j].buffer(1e-9))
            if face.is_empty or face.length < 0.1:
                continue
            corners = np.array(face.minimum_rotated_rectangle.exterior.coords)
            sides = corners[:4] - corners[1:5]
            short = int(np.argmin(np.hypot(*sides.T)))
            ends = corners[[short, (short + 2) % 4]] - 0.5 * sides[[short, (short + 2) % 4]]
            yield i, j, *ends


def held(outlines, i, j, at, touches):
    """Return whether some contact of blocks i and j acts within critdis of a point."""
    return any(
        {one.vertex[0], one.edge[0]} == {i, j}
        and np.hypot(*(outlines[one.vertex[0]][one.vertex[1]] - at)) <= REACH.critdis
        for one in touches
    )


def crown_drop(outlines, noise, how, step=1e-3, end=0.3):
    """Return how far the keystone of an arch falls, m, and how far any block moves."""
    rng = np.random.default_rng(4)
    moved = [one + rng.uniform(-noise, noise, one.shape) for one in outlines]
    last = len(outlines) - 1
    model = system(moved, fixed=[0, last], friction_angle=40.0)
    results = march(model, how, step, end)
    moves = centroids(model, results[-1].state) - centroids(model, results[0].state)
    return -moves[last // 2, 1], np.abs(moves).max()
