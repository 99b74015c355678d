"""Limit analysis by linear programming against closed forms, turned, mirrored and scaled."""

import numpy as np
import pytest

from clast.inputs.builder import InputBuilder
from clast.verification.limit_analysis import (
    GROUND,
    RigidBlocks,
    RigidJoint,
    add_voussoirs,
    joint_ends,
    largest_factor,
    least,
    reserve,
    voussoirs_between,
)


def block_on_ground(width, height, friction_angle, turned=0.0, mirrored=False):
    """Return a rectangle on a joint, and the way to turn vectors along with it."""
    cosine, sine = np.cos(turned), np.sin(turned)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    if mirrored:
        turn = turn @ np.diag([-1.0, 1.0])
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]]) @ turn.T
    joint = RigidJoint(
        blocks=(0, GROUND),
        ends=(corners[0], corners[1]),
        normal=turn @ [0.0, 1.0],
        friction_angle=friction_angle,
    )
    corners = corners[::-1] if mirrored else corners
    return RigidBlocks(corners=[corners], joints=[joint]), turn


@pytest.mark.parametrize("turned", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("angle", [20.0, 45.0])
def test_a_block_slides_or_tips(turned, mirrored, angle):
    width, height = 1.0, 2.0
    blocks, turn = block_on_ground(width, height, angle, turned, mirrored)
    weight, push = (blocks.body_force(turn @ way) for way in ([0.0, -3.0], [3.0, 0.0]))
    exact = min(np.tan(np.radians(angle)), width / height)
    assert largest_factor(blocks, weight, push) == pytest.approx(exact, rel=1e-9)


def test_a_force_away_from_the_centroid_tips_earlier():
    blocks, _ = block_on_ground(1.0, 2.0, 60.0)
    weight = blocks.body_force((0.0, -5.0))
    force = blocks.force_at(0, np.array([0.0, 2.0]), np.array([1.0, 0.0]))
    assert largest_factor(blocks, weight, force) == pytest.approx(5.0 * 2.0 * 0.5 / 2.0, rel=1e-9)


def test_the_least_and_the_largest_end_force_of_a_joint():
    blocks, _ = block_on_ground(1.0, 2.0, 30.0)
    weight = blocks.body_force((0.0, -5.0))
    assert least(blocks, weight, np.array([1.0, 1.0, 0.0])) == pytest.approx(10.0)
    assert reserve(blocks, weight) == pytest.approx(5.0)


def test_arches_of_other_sizes_have_the_same_limits():
    shares = []
    for radius in (0.5, 5.0, 50.0):
        blocks = voussoirs_between(*joint_ends(radius, 0.15, 157.5, 7), 60.0)
        weight, push = blocks.body_force((0.0, -1.0)), blocks.body_force((1.0, 0.0))
        shares.append(largest_factor(blocks, weight, push))
    assert shares == pytest.approx([0.3736] * 3, abs=2e-4)  # Oppenheim (1992): 0.37


def test_voussoirs_of_a_model_are_those_of_limit_analysis():
    ends = joint_ends(4.0, 0.2, 140.0, 9)
    builder = InputBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2400.0)
    middles = add_voussoirs(builder, *ends)
    model = builder.build()
    assert model.block_name == tuple(middles) == tuple("123456789")
    corners = np.concatenate(voussoirs_between(*ends, 30.0).corners)
    assert np.array_equal(model.vertices, corners)
    # from right to left, on a circle about the origin
    assert list(middles.values()) == sorted(middles.values(), key=lambda at: -at[0])
    away = np.hypot(*np.array(list(middles.values())).T)
    assert away == pytest.approx(4.0 * np.cos(np.radians(140.0 / 18)), rel=1e-12)
