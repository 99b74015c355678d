"""What is accepted, but seems unsound: warned of before the first step, with number and remedy."""

from __future__ import annotations

import json
from importlib import import_module

import numpy as np
import pytest
from typer.testing import CliRunner

import clast
from clast.case.templates import INCLINE, TEMPLATES
from clast.cli.commands import app
from scenes.command_line import clast_command, without_compilation

FIXED = 'geometry.blocks.1={loop=[1,2,3], name="incline", rock="granite", fixed=true}'
SPIKE = "[[20,0],[21,0],[21,1],[20.5000000001,1],[20.5,4],[20.5,1],[20,1]]"
CRACK = "[[20,0],[21,0],[21,1],[20.5000000001,1],[20.5,0.1],[20.5,1],[20,1]]"
EDGE = "[[20,0],[21,0],[21,1],[20.5,1],[20.49999999,1.00000001],[20,1]]"
FAR = [
    "geometry.vertices=[[1e15,0],[1000000000000010,0],[1e15,10],[1000000000000001,9],"
    "[1000000000000004,6],[1000000000000004,9]]",
    "fixed_point=[]",
    "measured_point=[]",
]

SERVO = "motion=[{name='press', block='slider', stress=[0,-1.0], limit_speed=0.1}]"

DOUBTS = {
    "gravity upwards": (["gravity=[0,9.8]"], ["(0, 9.8) m/s2", "gravity = [0, -9.8]"]),
    "no gravity": (["gravity=[0,0]"], ["all zero: nothing sets the blocks"]),
    "gravity in g": (["gravity=[0,-0.01]"], ["gravity is 0.01 m/s2", "-9.8"]),
    "geometry far away": (FAR, ["1e+15 m are rounded to 0.12 m", "common offset"]),
    "all blocks fixed": (
        [FIXED, "geometry.blocks.2.fixed=true"],
        ["all blocks are fixed (2)", "Remove fixed = true"],
    ),
    "load on a fixed block": (
        [FIXED, "point_load=[{at=[0,0], force=[1e5,0]}]"],
        ["1 point load(s) on fixed blocks have no effect: 'incline'"],
    ),
    "line load on a fixed block": (
        [FIXED, "line_load=[{start=[0,0], end=[1,0], traction=[1e5,0]}]"],
        ["1 line load(s) on fixed blocks"],
    ),
    "fixed point on a fixed block": ([FIXED], ["2 fixed point(s) on fixed blocks"]),
    "measured point on a fixed block": (
        [FIXED, "measured_point=[{name='B', at=[0,0]}]", "reference=[]"],
        ["1 measured point(s) on fixed blocks"],
    ),
    "load of nothing": (["point_load=[{at=[4,9], force=[0,0]}]"], ["1 point load(s) are zero"]),
    "load in MN": (["point_load=[{at=[4,9], force=[0,5]}]"], ["are 5 N/m, next to nothing"]),
    "servo in MPa": ([FIXED, SERVO], ["motion 'press' presses with 1 Pa", "1 MPa is 1e6"]),
    "servo beyond any rock": (
        [FIXED, SERVO.replace("-1.0", "-1e12")],
        ["presses with 1e+12 Pa, stronger than any rock"],
    ),
    "rock of no block": (
        ["rock.clay={young=1e9, poisson=0.3, density=2000}"],
        ["no block is made of rock 'clay'"],
    ),
    "vertices of no block": (
        ["geometry.vertices=[[0,0],[10,0],[0,10],[1,9],[4,6],[4,9],[5,5]]"],
        ["1 of 7 vertices belong to no block: 7"],
    ),
    "frames between steps": (["output.every=1e-5"], ["1e-05 s, less than a step", "1e+03 in all"]),
    "a file of gigabytes": (["time.end=1000", "time.step=1e-4", "output.every=1e-4"], ["16 GB"]),
    "shear stiffness": (
        ["method.contact_law.shear_stiffness=1e30"],
        ["shear_stiffness is 1e+30 N/m per m, 1e+21 times normal_stiffness: leave it out"],
    ),
    "normal stiffness": (
        ["method.contact_law.normal_stiffness=1e20"],
        ["1e+20 N/m per m, 2e+09 times young", '"auto"'],
    ),
    "normal stiffness too soft": (
        ["method.contact_law.normal_stiffness=1e5"],
        ["lets blocks sink into each other by some 1", "raise it"],
    ),
    "fixed points that give way": (
        ["method.fixed_point_stiffness=1e9"],
        ["fixed_point_stiffness is 1e+09", "Raise it to 5e+12"],
    ),
    "tolerance": (
        ["method.process={name='convex', tolerance=1e10}"],
        ["tolerance of the process is 1e+10", "leave it out"],
    ),
    "tolerance of the solver": (
        ["method.solver={name='pcg', tolerance=1.0}"],
        ["tolerance of the solver is 1,"],
    ),
    "critdis": (["method.critdis=1e-9"], ["critdis is 1e-09 m, very small", "raise it"]),
    "cohesion in kPa": (["joint.default.cohesion=25"], ["cohesion is 25 Pa", "25 kPa are 25000"]),
    "tensile strength in MPa": (["joint.default.tensile_strength=3"], ["tensile_strength is 3 Pa"]),
    "cohesion of steel": (["joint.default.cohesion=5e9"], ["5e+09 Pa, stronger than any rock"]),
    "friction of glue": (["joint.default.friction_angle=88"], ["a coefficient of 28.6"]),
    "modulus of soil": (["rock.granite.young=5e7"], ["young is 5e+07 Pa", "50 GPa are 50e9"]),
    "modulus of nothing": (["rock.granite.young=50e14"], ["young is 5e+15 Pa"]),
    "density in t/m3": (["rock.granite.density=2.7"], ["2.7 kg/m3", "2.7 t/m3 are 2700"]),
    "poisson below zero": (["rock.granite.poisson=-0.2"], ["poisson is -0.2", "0.1 to 0.4"]),
    "stress in MPa": (["rock.granite.initial_stress=[-2,-3,0]"], ["is at most 3 Pa"]),
    "stress that pulls": (
        ["rock.granite.initial_stress=[2e6,3e6,0]"],
        ["tension is positive", "(-2e+06, -3e+06)"],
    ),
    "stress beyond small strains": (
        ["rock.granite.initial_stress=[-5e9,0,0]"],
        ["strains block 'incline', 'slider' by 10 %"],
    ),
    "velocity in a static run": (
        ["geometry.blocks.2.velocity=[1,0,0]", "time.dynamic_ratio=0"],
        ["dynamic_ratio = 0 forgets velocities"],
    ),
    "step of a minute": (
        ["time.step=60", "time.end=600", "output.every=60"],
        ["in a step of 60 s"],
    ),
    "a spike": ([f"block=[{{rock='granite', vertices={SPIKE}}}]"], ["vertex 5, (20.5, 4)", "thin"]),
    "a crack": ([f"block=[{{rock='granite', vertices={CRACK}}}]"], ["vertex 5, (20.5, 0.1)"]),
    "a tiny edge": ([f"block=[{{rock='granite', vertices={EDGE}}}]"], ["a tiny edge at vertex 4"]),
    "a grain of sand": (
        ["block=[{rock='granite', vertices=[[20,0],[20.0001,0],[20,0.0001]]}]"],
        ["block '3' is 7.07e-05 m wide", "'incline' 7.07 m"],
    ),
    "a million seconds": (["time.end=1e6"], ["1e+09 steps of 0.001 s", "hours", "Lower time.end"]),
    "reference after the end": (["time.end=0.5"], ["[[reference]] 1 is for 1 s", "0.5 s"]),
    "record that begins late": (
        ["ground_motion={acts='body-force', time=[0.5,0.6,0.7], acceleration=[0,1,0]}"],
        ["begins at 0.5 s: until then the ground rests", "Subtract 0.5 s"],
    ),
    "record after the end": (
        ["ground_motion={acts='body-force', time=[5,6,7], acceleration=[0,1,0]}"],
        ["goes from 5 to 7 s, but the run from 0 to 1 s"],
    ),
    "record that begins early": (
        ["ground_motion={acts='body-force', time=[-1,0,7], acceleration=[0,1,0]}"],
        ["begins at -1 s, before the run"],
    ),
    "record that drifts": (
        ["ground_motion={acts='base', time=[0,0.5], acceleration=[1,1]}"],
        ["ends at 0.5 s with 0.5 m/s, which the ground keeps until 1 s"],
    ),
    "record in cm/s2": (
        ["ground_motion={acts='base', time=[0,1], acceleration=[0,300]}"],
        ["up to 300 m/s2", "0.01"],
    ),
    "record of nothing": (
        ["ground_motion={acts='base', time=[0,1], acceleration=[0,0]}"],
        ["no more than 0 m/s2"],
    ),
}


def checked(tmp_path, settings):
    """Return what ``clast check`` says of the incline with settings, on stderr and as JSON."""
    case = tmp_path / "case.toml"
    case.write_text(INCLINE, encoding="utf-8")
    options = [part for setting in settings for part in ("--set", setting)]
    if any("measured_point=[]" in setting for setting in settings):
        options += ["--set", "reference=[]"]
    shown = CliRunner().invoke(app, ["check", str(case), *options])
    assert shown.exit_code == 0, (shown.stderr, shown.exception)
    listed = CliRunner().invoke(app, ["check", str(case), "--json", *options])
    return without_compilation(shown.stderr), json.loads(listed.stdout)


@pytest.mark.parametrize("name", DOUBTS)
def test_each_warning(name, tmp_path):
    settings, phrases = DOUBTS[name]
    said, listed = checked(tmp_path, settings)
    for phrase in phrases:
        assert phrase in said
        assert any(phrase in warning for warning in listed["warnings"])
    assert len(said) < 1500


@pytest.mark.parametrize("name", TEMPLATES)
def test_there_are_no_warnings_about_the_templates(name, tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(TEMPLATES[name], encoding="utf-8")
    assert without_compilation(clast_command("check", case).stderr) == ""


def test_frames_that_nobody_asked_for_are_not_doubted(tmp_path):
    assert checked(tmp_path, ["output={}", "time.end=0.01", "reference=[]"])[0] == ""


@pytest.mark.parametrize(
    ("heading", "scale", "unit"),
    [
        ("t (s), a (g)", 1.0, "in g: give scale = 9.81"),
        ("time,acc_g", 1.0, "in g"),
        ("PEER\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 3, DT= .01 SEC", 1.0, "in g"),
        ("# t, a [g]", -1.0, "in g"),
        ("t, a (cm/s2)", 1.0, "in cm/s2: give scale = 0.01"),
        ("t, acc (Gal)", 1.0, "in cm/s2"),
        ("t [s]; a [m/s2]", 9.81, "in m/s2: give scale = 1"),
        ("t (s), a (g)", 9.81, None),
        ("t (s), a (g)", 4.9, None),
        ("t [s]; a [m/s2]", 1.0, None),
        ("t, a", 1.0, None),
    ],
)
def test_a_record_in_other_units_than_its_scale(heading, scale, unit, tmp_path):
    (tmp_path / "record.csv").write_text(f"{heading}\n0 0\n0.5 0.1\n1 0\n", encoding="utf-8")
    motion = f"ground_motion={{acts='body-force', file='record.csv', scale={scale}}}"
    said, _ = checked(tmp_path, [motion])
    assert ("heading of record.csv says" in said) == (unit is not None)
    assert unit is None or unit in said


def test_a_run_gives_its_warnings_before_its_first_step(tmp_path, monkeypatch):
    case = tmp_path / "case.toml"
    case.write_text(INCLINE, encoding="utf-8")
    monkeypatch.setattr(import_module("clast.run.launch"), "simulate", lambda *_, **__: 1 / 0)
    options = ["--set", "gravity=[0,9.8]", "-o", str(tmp_path / "out.vtkhdf")]
    result = CliRunner().invoke(app, ["run", str(case), *options])
    assert isinstance(result.exception, ZeroDivisionError)
    assert result.stderr.count("warning: gravity is (0, 9.8) m/s2") == 1


def test_a_loop_that_was_turned_round_is_said_by_check_and_run(tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(INCLINE.replace("[4,5,6]", "[4,6,5]"), encoding="utf-8")
    output = ["-o", str(tmp_path / "out.vtkhdf"), "--set", "time.end=0.002"]
    for command in (["check", str(case)], ["run", str(case), *output]):
        shown = CliRunner().invoke(app, command).stdout
        if command[0] == "check":  # a run counts its notes
            assert "1 loop runs clockwise and was reversed: block 2 'slider'" in shown
        listed = json.loads(CliRunner().invoke(app, [*command, "--json"]).stdout)
        assert any("was reversed" in note for note in listed["notes"])


ROUGH = {"law": "barton-bandis", "jrc": 8.0, "jcs": 8e7, "residual_friction_angle": 28.0}
SHAKEN = {"acts": "base", "time": [0.0, 1.0], "acceleration": [1.0, 1.0]}


def on_a_floor(fixed=True, **joint):
    """Return a builder with a block on a floor, and a default joint."""
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", **joint)
    builder.block(vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=fixed)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    return builder


@pytest.mark.parametrize(
    ("joint", "said"),
    [
        (ROUGH, False),
        ({**ROUGH, "residual_friction_angle": 5.0, "field_length": 1.0}, False),
        ({**ROUGH, "strength_reduction": 1.5}, False),
        ({"friction_angle": 30.0}, False),
        ({"cohesion": 1e4}, False),
        ({"tensile_strength": 1e4}, True),
        ({}, True),
    ],
)
def test_a_joint_is_said_to_be_frictionless_where_it_is(joint, said):
    warnings = on_a_floor(**joint).case(step=1e-3, end=0.01).examine().warnings
    assert [text for text in warnings if "frictionless" in text] == list(warnings)[: int(said)]
    assert said or not warnings


def test_a_rough_joint_carries_a_block_on_moving_supports_by_its_residual_friction():
    builder = on_a_floor(fixed=False, **ROUGH)
    builder.fixed_point(at=(4.0, -1.0))
    builder.ground_motion = SHAKEN
    case = builder.case(step=1e-2, end=1.0, dynamic_ratio=0.0, process="modified")
    (text,) = [one for one in case.examine().warnings if "on friction alone" in one]
    bound = 0.5 * np.tan(np.radians(28.0)) * 9.8 * 1e-2
    assert f"by {bound:.3g} m/s at most" in text
