"""Walls, columns and arches: corners coincide, and every joint is held at both its ends."""

import numpy as np
import pytest

from clast.contact.corner_rules import Bisector, EntranceLines
from clast.errors import StepRejected
from clast.step.convex import Convex
from clast.step.modified import Modified
from scenes.joints import SYSTEMS, columns, crown_drop, faces_in_common, held
from scenes.systems import (
    method,
    touches_of,
    voussoirs,
)


@pytest.mark.parametrize("rule", [Bisector(), EntranceLines()], ids=["bisector", "shi"])
@pytest.mark.parametrize("noise", (0.0, 1e-9, 1e-6))
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_joint_is_held_at_both_ends(name, noise, rule):
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
        touches = touches_of(moved, rule=rule)
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


@pytest.mark.slow
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
