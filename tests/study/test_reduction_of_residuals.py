"""Strength reduction divides residual strengths as it divides those at the peak."""

import math

import pytest

from clast.study.collapsing.reduction import divide


def test_both_friction_angles_are_divided_by_their_tangents():
    found = divide({"friction_angle": 40.0, "residual_friction_angle": 30.0}, 1.5)
    for key, angle in (("friction_angle", 40.0), ("residual_friction_angle", 30.0)):
        assert math.tan(math.radians(found[key])) == pytest.approx(
            math.tan(math.radians(angle)) / 1.5
        )


def test_the_residual_stays_below_the_peak():
    for factor in (0.5, 1.0, 3.0):
        found = divide({"friction_angle": 34.0, "residual_friction_angle": 33.5}, factor)
        assert found["residual_friction_angle"] < found["friction_angle"]


def test_kinetic_friction_is_divided_and_dilation_stays():
    found = divide(
        {"friction_angle": 35.0, "kinetic_friction_angle": 25.0, "dilation_angle": 6.0}, 1.4
    )
    tangent = math.tan(math.radians(found["kinetic_friction_angle"]))
    assert tangent == pytest.approx(math.tan(math.radians(25.0)) / 1.4)
    assert found["dilation_angle"] == 6.0


def test_dilation_is_not_above_what_friction_is_left():
    found = divide({"friction_angle": 20.0, "dilation_angle": 12.0}, 2.0)
    assert found["dilation_angle"] == found["friction_angle"] < 12.0


def test_of_a_rough_joint_the_mobilised_friction_is_divide():
    table = {"residual_friction_angle": 28.0, "strength_reduction": 1.2}
    assert divide(table, 1.5) == {
        "residual_friction_angle": 28.0,
        "strength_reduction": pytest.approx(1.8),
    }
