"""Whole runs of joints that wear: resumed and in stages; and motions to the last digit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast
from clast.case.api import ModelBuilder

LAWS: dict[str, dict[str, Any]] = {
    "weakening": {
        "friction_angle": 40.0,
        "residual_friction_angle": 25.0,
        "cohesion": 2e5,
        "residual_cohesion": 0.0,
        "slip_weakening": 4e-3,
    },
    "dilation": {"friction_angle": 35.0, "dilation_angle": 10.0, "dilation_until": 3e-3},
    "kinetic": {
        "friction_angle": 35.0,
        "kinetic_friction_angle": 20.0,
        "critical_speed": 0.1,
    },
    "rough": {
        "law": "barton-bandis",
        "jrc": 12.0,
        "jcs": 80e6,
        "residual_friction_angle": 27.0,
        "sample_length": 0.3,
    },
}
STRESS, LENGTH, SPEED = 1e6, 0.3, 0.05


def box(law: str, title: str = "box") -> ModelBuilder:
    """Return a shear box whose upper half is pressed and drawn to the right."""
    builder = ModelBuilder(title=title, gravity=(0.0, 0.0))
    builder.add_rock("rock", young=3e10, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0)
    builder.add_joint("seam", between=[("low", "high")], **LAWS[law])
    low = [(-0.05, -0.1), (0.4, -0.1), (0.4, 0.0), (-0.05, 0.0)]
    builder.block(name="low", vertices=low, fixed=True)
    high = [(0.0, 0.0), (LENGTH, 0.0), (LENGTH, 0.1), (0.0, 0.1)]
    builder.block(name="high", vertices=high)
    builder.motion(
        name="box",
        block="high",
        x=SPEED,
        rotation=0.0,
        stress=(0.0, -STRESS),
        limit_speed=10.0,
        ease=0.02,
    )
    return builder


STAGES = ({"name": "first", "until": "time", "time": 0.08}, {"name": "second", "until": "time"})


def run_of(law: str, *stages: dict[str, Any]) -> clast.Run:
    made = [clast.Stage(**one) for one in stages]
    return clast.simulate(box(law).build(), step=1e-3, end=0.16, stages=made)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.one_in(3)
def test_joints_keep_their_wear_over_a_stage(law: str):
    whole = run_of(law).reaction("box")
    parts = run_of(law, STAGES[0], {**STAGES[1], "time": 0.08}).reaction("box")
    assert parts.time[-1] == pytest.approx(whole.time[-1])
    # another state of the joint would change the force by tens of per cent
    assert np.abs(parts.force[-1] - whole.force[-1]).max() < 1e-3 * STRESS * LENGTH
    assert np.abs(parts.force[100] - whole.force[100]).max() < 1e-3 * STRESS * LENGTH


def test_a_worn_joint_has_its_residual_strength():
    run = run_of("weakening")
    force = run.reaction("box").force
    ratio = np.abs(force[:, 0] / np.where(force[:, 1] == 0.0, np.inf, force[:, 1]))
    # slip of 7 mm: past the 4 mm that wear the joint
    assert ratio[-1] == pytest.approx(np.tan(np.radians(25.0)), rel=2e-3)
    peak = np.tan(np.radians(40.0)) + 2e5 / STRESS
    assert 0.9 * peak < ratio[5:].max() < 1.001 * peak
    assert [event.kind for event in run.events] == ["joint at residual"]


DIPS = (30.0, -37.5, 200.0)


@pytest.mark.parametrize("process", ["convex", "open-close"])
@pytest.mark.parametrize("dip", DIPS)
def test_a_block_is_drawn_along_a_dipping_plane(dip: float, process: str):
    """The way is v (t - e/2) along the dip, the pull mu N + W sin(dip) at constant speed."""
    turn = np.radians(dip)
    along, up = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])

    def placed(*points: tuple[float, float]) -> list[tuple[float, float]]:
        return [tuple((x * along + y * up).tolist()) for x, y in points]

    gravity = -9.8 * (np.cos(np.radians(20.0)) * up + np.sin(np.radians(20.0)) * along)
    builder = ModelBuilder(gravity=tuple(gravity.tolist()))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    floor = placed((-1.0, -1.0), (6.0, -1.0), (6.0, 0.0), (-1.0, 0.0))
    builder.block(name="floor", vertices=floor, fixed=True)
    builder.block(name="box", vertices=placed((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)))
    speed, ease, end = 0.4, 0.1, 0.3
    builder.motion(
        name="winch", block="box", ease=ease, **dict(zip("xy", speed * along, strict=True))
    )
    run = clast.simulate(builder.build(), step=1e-3, end=end, process=process)
    centre = run.vertices(-1)[4:].mean(axis=0) - run.vertices(0)[4:].mean(axis=0)
    assert np.abs(centre - speed * (end - 0.5 * ease) * along).max() < 1e-12 * 6.0
    pull, floor_force = run.reaction("winch").force[-1], run.reaction("fixed blocks").force[-1]
    weight = 5000.0 * gravity
    # both bear the weight together; what the floor bears is on its cone of friction
    assert np.abs(pull + floor_force + weight).max() < 1e-6 * 5e4
    if floor_force @ up > 1.0:
        ratio = -(floor_force @ along) / (floor_force @ up)
        assert ratio == pytest.approx(np.tan(np.radians(30.0)), rel=1e-6)


@pytest.mark.parametrize("process", ["convex", "open-close"])
def test_a_fixed_point_goes_in_an_inclined_direction(process: str):
    builder = ModelBuilder(gravity=(0.0, -9.8))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="beam", vertices=[(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)])
    builder.fixed_point((0.0, 0.0))
    builder.fixed_point((4.0, 0.0))
    ways = {"left": (0.0, 0.0), "right": (4.0, 0.0)}
    for name, at in ways.items():
        builder.motion(name=name, fixed_point=at, x=0.03, y=-0.07, ease=0.1)
    run = clast.simulate(builder.build(), step=2e-3, end=1.0, damping="adaptive", process=process)
    # springs hold the points: they lag by what the weight and its changes compress them
    for corner, at in zip(run.vertices(-1)[:2], ways.values(), strict=True):
        assert np.abs(corner - at - 0.95 * np.array([0.03, -0.07])).max() < 1e-10
