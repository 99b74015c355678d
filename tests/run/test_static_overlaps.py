"""Static steps that turn blocks, or carry corners past edges, leave none inside another."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.run.overlap import unseen_overlaps
from scenes.systems import turned


def two_wedges(
    held: float, friction: float, face: float, turn: float = 0.0, mirrored: bool = False
) -> clast.ModelBuilder:
    """Return a wedge that 0.1 MN/m presses between a wall and a wedge which ``held``, N/m, holds.

    ``face`` is the angle of the face between the two, degrees.  The floor goes on for 0.3 m beyond
    the lower wedge; the upper one turns about its tip as the lower one is pushed out.
    """
    height = 1.2 * np.tan(np.radians(face))
    flip = np.array([-1.0 if mirrored else 1.0, 1.0])

    def place(*corners: tuple[float, float]) -> np.ndarray:
        found = turned(np.array(corners) * flip, turn)
        return found[::-1] if mirrored else found

    top = height + 0.3
    builder = clast.ModelBuilder(gravity=tuple(place((0.0, -9.8))[0]))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=friction)
    floor = (-0.3, -1.0), (3.0, -1.0), (3.0, 0.0), (-0.3, 0.0)
    builder.block(name="floor", vertices=place(*floor), fixed=True)
    wall = (1.2, 0.0), (2.2, 0.0), (2.2, 3.0 * height), (1.2, 3.0 * height)
    builder.block(name="wall", vertices=place(*wall), fixed=True)
    builder.block(name="lower", vertices=place((0.0, 0.0), (1.2, 0.0), (0.0, height)))
    builder.block(name="upper", vertices=place((1.2, 0.0), (1.2, top), (0.0, top), (0.0, height)))
    start, end = place((0.0, top))[0], place((1.2, top))[0]
    builder.line_load(start, end, tuple(place((0.0, -1e5 / 1.2))[0]))
    builder.point_load(place((0.0, height / 3.0))[0], tuple(place((held, 0.0))[0]), "lower")
    return builder


@pytest.mark.parametrize(
    ("held", "friction", "face", "turn", "mirrored"),
    [
        (14062.5, 12.0, 45.0, 0.0, False),
        (14062.5, 12.0, 45.0, 0.6, True),
        (19914.0, 5.0, 35.0, 0.0, False),
        (10723.0, 20.0, 60.0, 0.0, False),
    ],
)
def test_wedges_that_slid_are_not_inside_each_other(held, friction, face, turn, mirrored):
    """They moved by 0.2 to 0.3 m to an equilibrium in which one was 1 to 2 mm inside the other."""
    stages = (clast.Stage(name="slide", dynamic_ratio=0.0),)
    builder = two_wedges(held, friction, face, turn, mirrored)
    case = builder.case(stages=stages, step=1e-2, end=1.0)
    run = case.run(progress=False)
    assert [one.outcome for one in run.report.stages] == ["equilibrium"]
    moved = np.hypot(*(run.final.vertices - run.model.vertices).T).max()
    assert 0.15 < moved < 0.5
    method = case.method(run.model)
    assert unseen_overlaps(run.model, run.final, method.critdis) == []
    # no contact is deeper than its force presses it
    memory = run.final.memory
    stiffness = method.contact_law.normal_stiffness
    assert memory.gap == pytest.approx(-memory.normal_force / stiffness, abs=2e-5)
