"""Strength reduction divides residual strengths as it divides those at the peak."""

import math

import pytest

from clast.study.collapsing.reduction import divided


def test_both_friction_angles_are_divided_by_their_tangents():
    found = divided({"friction_angle": 40.0, "residual_friction_angle": 30.0}, 1.5)
    for key, angle in (("friction_angle", 40.0), ("residual_friction_angle", 30.0)):
        assert math.tan(math.radians(found[key])) == pytest.approx(
            math.tan(math.radians(angle)) / 1.5
        )


def test_the_residual_stays_below_the_peak():
    for factor in (0.5, 1.0, 3.0):
        found = divided({"friction_angle": 34.0, "residual_friction_angle": 33.5}, factor)
        assert found["residual_friction_angle"] < found["friction_angle"]
