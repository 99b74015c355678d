"""Places that fail, where runs are cut into blocks of their own."""

from __future__ import annotations

import numpy as np

import clast
from clast.study.folder import StudyFolder
from clast.study.study_api import HowMade
from clast.study.study_report import share_of_places, write_report

SLOPE = """
schema = 1
title = "Slope over a plane"
gravity = [0.0, -9.81]
[time]
step = 5e-3
end = 1.0
[rock.rock]
young = 10e9
poisson = 0.2
density = 2600.0
[joint.default]
friction_angle = 36.0
[domain]
boundary = [[100,0],[120,0],[120,4],[114,4],[108,16],[100,16]]
rock = "rock"
fixed_sides = ["bottom", "left", "right"]
[[joint_set]]
name = "plane"
angle = -40.0
spacing = 100.0
origin = [113.0, 6.0]
[[stage]]
name = "rest"
dynamic_ratio = 0.0
"""


def test_a_place_fails_in_the_runs_whose_wedge_it_lies_in(tmp_path):
    (tmp_path / "slope.toml").write_text(SLOPE)
    dips = (34.0, 40.0, 46.0)
    study = clast.Study(
        tmp_path / "slope.toml", vary={"joint_set.1.angle": [-one for one in dips]}, fail="fails()"
    )
    study.run(tmp_path / "out", how=HowMade(array=(1, 1)))
    folder = StudyFolder.opened(tmp_path / "out")
    places = share_of_places(folder)
    assert places is not None
    x, y = np.meshgrid(places.x, places.y)
    # a wedge slides on a plane steeper than its friction angle
    tangents = np.tan(np.radians(dips[1:]))
    wanted = sum((x < 113.0) & (y - 6.0 > (113.0 - x) * one) for one in tangents) / 3.0
    rock = np.isfinite(places.share)
    assert np.array_equal(rock, (y < 4.0) | ((y < 16.0) & (y - 4.0 < (114.0 - x) * 2.0)))
    assert np.array_equal(places.share[rock], wanted[rock])
    assert set(np.unique(places.share[rock])) == {0.0, 1.0 / 3.0, 2.0 / 3.0}
    write_report(folder)
    assert (tmp_path / "out" / "figures" / "failing-blocks.png").exists()
