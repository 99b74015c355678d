"""Walls, columns and arches: corners coincide, and every joint is held at both its ends."""

import numpy as np
import pytest
import shapely

from clast.errors import StepRejected
from clast.step.convex import Convex
from clast.step.modified import Modified
from systems import REACH, box, bricks, centroids, march, method, system, touches_of, voussoirs

NOISE = (0.0, 1e-9, 1e-6)


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


@pytest.mark.parametrize("noise", NOISE)
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_joint_is_held_at_both_ends(name, noise):
    """Whatever round-off or settling does to the corners, up to a micrometre either way."""
    outlines = SYSTEMS[name]
    faces = list(faces_in_common(outlines))
    assert len(faces) >= len(outlines) - 1
    for seed in range(3):
        rng = np.random.default_rng(seed)
        moved = [
            one + rng.uniform(-noise, noise, one.shape) + rng.uniform(-noise, noise, 2)
            for one in outlines
        ]
        touches = touches_of(moved)
        for i, j, *ends in faces:
            for end in ends:
                assert held(moved, i, j, end, touches)


@pytest.mark.parametrize("squeeze", [1e-6, 1e-4])
def test_joints_that_penetrate_are_closed_at_both_ends(squeeze):
    """All blocks grow a little about their centres: every contact of a face penetrates."""
    for outlines in SYSTEMS.values():
        faces = list(faces_in_common(outlines))
        grown = [one + squeeze * (one - one.mean(axis=0)) for one in outlines]
        closed = [one for one in touches_of(grown) if one.gap < 0.0]
        for i, j, *ends in faces:
            for end in ends:
                assert held(grown, i, j, end, closed)


def test_corners_that_meet_point_to_point_hold_nothing():
    """Diagonal neighbours of a column wall do not press on each other."""
    outlines = columns(2, 2)
    sunk = [one - [0.0, 1e-4 * (k % 2)] for k, one in enumerate(outlines)]
    diagonal = [
        one
        for one in touches_of(sunk)
        if {one.vertex[0], one.edge[0]} in ({0, 3}, {1, 2}) and one.gap < -1e-12
    ]
    assert diagonal == []


# --- an arch under its own weight ----------------------------------------------------------


def crown_drop(outlines, noise, how, step=1e-3, end=0.3):
    """Return how far the keystone of an arch falls, m, and how far any block moves."""
    rng = np.random.default_rng(4)
    moved = [one + rng.uniform(-noise, noise, one.shape) for one in outlines]
    last = len(outlines) - 1
    model = system(moved, fixed=[0, last], friction_angle=40.0)
    results = march(model, how, step, end)
    moves = centroids(model, results[-1].state) - centroids(model, results[0].state)
    return -moves[last // 2, 1], np.abs(moves).max()


@pytest.mark.parametrize("process", [Modified(passes=4), Convex()], ids=["modified", "convex"])
@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-7])
def test_arch_does_not_fall_through_itself(noise, process):
    """Springs of 1e8 N/m give way by some tenths of a millimetre at each of ten joints."""
    try:
        drop, largest = crown_drop(voussoirs(11), noise, method(process=process))
    except StepRejected as rejected:  # the reason is the message
        pytest.fail(str(rejected))
    assert 0.0 < drop < 4e-3
    assert largest < 4e-3
