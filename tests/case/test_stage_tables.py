"""[[stage]]: what is read, and what is written back."""

import dataclasses
from pathlib import Path

import pytest

import clast
from clast.actions.damping import Adaptive, Kinetic, Rayleigh, Undamped
from clast.case.case_file import Case
from clast.errors import CaseError

CASE = """
schema = 1
title = "Stages"
[time]
step = 1e-3
end = 2.0
[rock.rock]
young = 5e9
poisson = 0.2
density = 2500.0
[joint.default]
friction_angle = 30.0
[joint.bedding]
friction_angle = 35.0
between = [["floor", "box"]]
[[block]]
name = "floor"
vertices = [[-2, -1], [2, -1], [2, 0], [-2, 0]]
fixed = true
[[block]]
name = "box"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[amplitude.rise]
time = [0, 1]
value = [0, 1]
[[pressure]]
start = [0, 1]
end = [1, 1]
value = 1e3
name = "pool"
"""


def sane(stages: str) -> Case:
    """Return the case with stages, looked at as its run looks at it."""
    case = Case.from_toml(CASE + stages)
    case.examine()
    return case


def test_stages_are_read_in_their_order():
    case = sane(
        """
[[stage]]
name = "gravity"
dynamic_ratio = 0.0
reset_displacement = true
[[stage]]
name = "water"
loads = ["pool", "rise"]
joint = {bedding = {friction_angle = 25, cohesion = 1e3}}
until = "time"
time = 5.0
step = 2e-3
every = 0.5
"""
    )
    schedule = case.schedule()
    assert schedule.latest == 7.0
    assert schedule.every == pytest.approx(0.07)
    gravity, water = schedule.stages
    assert (gravity.until, gravity.time, gravity.dynamic_ratio) == ("equilibrium", None, 0.0)
    assert gravity.reset_displacement and (gravity.force_ratio, gravity.hold) == (1e-4, 20)
    assert (water.until, water.time, water.step, water.every) == ("time", 5.0, 2e-3, 0.5)
    assert water.loads == ("pool", "rise")
    assert water.joints == {"bedding": {"friction_angle": 25.0, "cohesion": 1e3}}


@pytest.mark.parametrize(
    ("written", "damping"),
    [
        ('"adaptive"', Adaptive()),
        ('{name = "adaptive", ratio = 0.5}', Adaptive(ratio=0.5)),
        ("{mass = 2.0, stiffness = 1e-5}", Rayleigh(mass=2.0, stiffness=1e-5)),
        ('{name = "rayleigh", stiffness = 1e-5}', Rayleigh(stiffness=1e-5)),
        ('"kinetic"', Kinetic()),
        ('"none"', Undamped()),
    ],
)
def test_a_damping_is_a_name_or_a_table(written: str, damping: object):
    case = sane(f'\n[[stage]]\nname = "rest"\ndamping = {written}\n')
    assert case.schedule().stages[0].damping == damping
    assert Case.from_toml(case.to_toml()).schedule().stages[0].damping == damping


class OwnDamping(Kinetic):
    """A damping that no case file has a name for."""


def test_a_script_writes_its_stages_and_names_back(tmp_path: Path):
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], name="box")
    builder.fixed_point((0, 0))
    builder.fixed_point((1, 0))
    builder.add_amplitude("rise", time=[0, 1], value=[0, 1])
    builder.point_load((0, 1), (1e3, 0), name="push", amplitude="rise")
    builder.line_load((0, 1), (1, 1), (0, -1e3), name="bank")
    builder.pressure((0, 1), (1, 1), 1e3, name="pool")
    stages = (
        clast.Stage(name="gravity", dynamic_ratio=0.0, hold=7, damping=Adaptive(ratio=0.5)),
        clast.Stage(
            name="loads",
            until="time",
            time=0.2,
            loads=("push", "pool"),
            joints={"default": {"friction_angle": 25.0}},
            step=2e-3,
            damping=Kinetic(),
        ),
    )
    text = builder.to_toml(step=1e-3, end=0.5, stages=stages)
    case = Case.from_toml(text)
    assert case.schedule().stages == stages
    assert case.model().point_loads.name == ("push",)
    assert case.model().line_loads.name == ("bank",)
    assert set(case.model().pressures.name) == {"pool"}
    with pytest.raises(CaseError, match="object of a script"):
        builder.to_toml(stages=[dataclasses.replace(stages[0], damping=OwnDamping())])
