"""[[water]] in case files and scripts: what is warned of, said, and written back."""

from pathlib import Path

import numpy as np
import pytest

import clast
from clast.errors import ModelError

CASE = """
schema = 1
gravity = [0.0, -9.81]
time = {step = 1e-3, end = 0.1}
rock = {stone = {young = 1e9, poisson = 0.2, density = 2500}}
joint = {default = {friction_angle = 30}, bed = {friction_angle = 20, between = [["base", "wall"]]}}
amplitude = {ramp = {time = [0, 1, 2], value = [0, 1, 1]}, wild = {time = [0, 1], value = [0, 2]}}
[[block]]
name = "base"
vertices = [[0, -1], [4, -1], [4, 0], [0, 0]]
fixed = true
[[block]]
name = "wall"
vertices = [[0, 0], [1, 0], [1, 2], [0, 2]]
[[water]]
level = 1.5
"""


def script(**keys: object) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint("bed", friction_angle=20.0, between=[("base", "wall")])
    builder.block(name="base", vertices=[(0, -1), (4, -1), (4, 0), (0, 0)], fixed=True)
    builder.block(name="wall", vertices=[(0, 0), (1, 0), (1, 2), (0, 2)])
    builder.water(**{"level": 1.5, **keys})  # type: ignore[arg-type]
    return builder


def test_what_is_wetted_is_said():
    """Faces of the wall to 1.5 m, those of the base, and the bed of 1 m."""
    (note,) = clast.Case.from_toml(CASE).model().notes
    assert "water 1 wets 12 m of outer faces" in note  # 3 of the wall, 9 of the base
    assert "1 m of joints, which it presses apart with 14715 N/m in all" in note
    assert "up to 2.452e+04 Pa" in note


WARNED = {
    "nothing to press on": (
        ["water.1.level=-0.5", "water.1.acts_on=faces", "block.2.fixed=true"],
        "water 1 has no effect: all blocks that it touches are fixed",
    ),
    "factor of zero": (["water.1.amplitude=0.0"], "water 1 has no effect: its amplitude is zero"),
    "odd density": (["water.1.density=800"], "water 1 has a density of 800 kg/m3"),
}


@pytest.mark.parametrize("name", WARNED)
def test_what_is_odd_is_warned_of(name: str):
    settings, said = WARNED[name]
    warnings = clast.Case.from_toml(CASE, settings).examine().warnings
    assert any(said in text for text in warnings), warnings


def test_a_model_at_depth_under_water_is_not_warned_of():
    case = clast.Case.from_toml(CASE, ["water.1.level=7"])
    assert not any("water" in text for text in case.examine().warnings)
    (note,) = case.model().notes
    assert "its level is 5 m above the highest block" in note


def test_sound_water_is_not_warned_of():
    settings = ["water.1.amplitude=ramp", "amplitude.wild=" + "{time=[0, 1], value=[0, 1]}"]
    warnings = clast.Case.from_toml(CASE, settings).examine().warnings
    assert not any("water" in text for text in warnings)
    assert not any("'ramp'" in text for text in warnings)
    assert any("no load has the amplitude 'wild'" in text for text in warnings)


def test_two_waters_in_one_joint_are_warned_of():
    builder = script(acts_on="joints")
    builder.water(1.0, acts_on="joints")
    warnings = builder.case(end=0.1).examine().warnings
    assert any("waters 1 and 2 are both in 1 joints" in text for text in warnings)


def test_a_line_may_stand_in_a_file(tmp_path: Path):
    (tmp_path / "line.csv").write_text("x,y\n-1,1.5\n0.5,1.0\n3,0.2\n", encoding="utf-8")
    text = CASE.replace("level = 1.5", 'line = {file = "line.csv"}')
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    model = clast.load(tmp_path / "case.toml").model()
    points = [(-1.0, 1.5), (0.5, 1.0), (3.0, 0.2)]
    np.testing.assert_array_equal(model.water[0].surface + model.origin, points)
    back = clast.Case.from_toml(
        CASE.replace("level = 1.5", f"line = {list(map(list, points[::-1]))}")
    )
    np.testing.assert_array_equal(back.model().water[0].surface, model.water[0].surface)


def test_a_file_without_columns_is_refused(tmp_path: Path):
    (tmp_path / "line.csv").write_text("a,b\n0,1\n", encoding="utf-8")
    text = CASE.replace("level = 1.5", 'line = {file = "line.csv"}')
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ModelError, match="has no column x"):
        clast.load(tmp_path / "case.toml").model()


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"name": "pool", "acts_on": "joints", "density": 1025.0, "wetted": "closed"},
        {"level": None, "line": [(0.0, 1.5), (2.0, 0.5)], "amplitude": 0.5},
        {"joints": ["bed"], "drained_at": [(0.5, 0.0)], "amplitude": "ramp"},
    ],
)
def test_a_script_writes_its_water_as_a_case_file(keys: dict[str, object]):
    builder = script(**keys)
    builder.add_amplitude("ramp", [0.0, 1.0], [0.0, 1.0])
    one = builder.build().water
    other = clast.Case.from_toml(builder.to_toml(end=0.1)).model().water
    assert len(one) == len(other) == 1
    for first, second in ((one[0], other[0]), (one[0].joints, other[0].joints)):
        for key, value in vars(first).items():
            if isinstance(value, np.ndarray):
                np.testing.assert_array_equal(value, vars(second)[key])
            elif isinstance(value, str | float):
                assert value == vars(second)[key]


def test_joints_are_chosen_by_what_lies_along_them():
    """By pair, by edge, by rock and by default, as contacts have them."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.add_rock("chalk", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint("pair", between=[("1", "2")])
    builder.add_joint("edge")
    builder.add_joint("rocks", between_rocks=[("stone", "chalk")])
    for k, rock in enumerate(("stone", "stone", "stone", "chalk", "chalk")):
        corners = [(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)]
        names = ["", "edge", "", ""] if k == 1 else None
        builder.block(name=str(k + 1), vertices=corners, rock=rock, edge_joint=names)
    for name, at in (("pair", 1.0), ("edge", 2.0), ("rocks", 3.0), ("default", 4.0)):
        builder.water(5.0, name=name, acts_on="joints", joints=[name])
        model = builder.build()
        edges = model.water[-1].joints.edge
        assert len(edges) == 1
        assert model.vertices[edges[0, 0], 0] + model.origin[0] == at
