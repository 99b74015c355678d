"""A push on all blocks that lasts: a share of their weight, in the case file and in a script."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.errors import ModelError


def builder(**given: object) -> clast.ModelBuilder:
    made = clast.ModelBuilder(**given)  # type: ignore[arg-type]
    made.add_rock("rock", young=1e10, poisson=0.2, density=2500.0)
    made.add_joint("default", friction_angle=30.0)
    made.block(name="base", vertices=[(0, 0), (4, 0), (4, 1), (0, 1)], fixed=True)
    made.block(name="block", vertices=[(1, 1), (2, 1), (2, 2), (1, 2)])
    return made


def test_it_is_a_share_of_gravity_and_goes_through_the_case_file(tmp_path):
    made = builder(gravity=(0.0, -10.0), seismic_coefficient=(0.1, -0.05))
    np.testing.assert_allclose(made.build().gravity, [1.0, -10.5], rtol=1e-15)
    path = tmp_path / "pushed.toml"
    path.write_text(made.to_toml(step=1e-3, end=1.0))
    assert "seismic_coefficient = [0.1, -0.05]" in path.read_text()
    again = clast.load(path)
    np.testing.assert_array_equal(again.model().gravity, made.build().gravity)
    assert "seismic" not in builder().to_toml(step=1e-3, end=1.0)


def test_water_keeps_its_level():
    made = builder(seismic_coefficient=(0.2, 0.0))
    made.water(1.5)
    (pushed,) = made.build().water
    assert pushed.weight == pytest.approx(9.8e3)
    made = builder(gravity=(2.0, -9.6))
    made.water(1.5)
    with pytest.raises(ModelError, match="a water level needs gravity") as refused:
        made.build()
    assert "seismic_coefficient" in refused.value.remedy


@pytest.mark.parametrize("wrong", [(0.1,), 0.1, ("a", 0.0), (float("nan"), 0.0), (1e13, 0.0)])
def test_wrong_ones_are_refused(wrong):
    with pytest.raises(ModelError, match="seismic_coefficient"):
        builder(seismic_coefficient=wrong).build()


def test_it_needs_gravity():
    with pytest.raises(ModelError, match="no gravity"):
        builder(gravity=(0.0, 0.0), seismic_coefficient=(0.1, 0.0)).build()
