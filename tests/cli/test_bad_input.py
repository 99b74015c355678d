"""Bad input ends with exit code 2 and one message that names place and remedy; nothing is written.

Every case is run with an existing result file as its output, which must stay as it is.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from typer.testing import CliRunner

from clast.casefile import templates
from clast.cli import HDF5_SIGNATURE, app

INCLINE = templates.INCLINE.replace(
    'process = "convex"', 'process = {name="modified", friction="lagged", passes=1}'
)
OLD_RESULT = HDF5_SIGNATURE + b"an older result"


def refused(folder: Path, text: str, *options: str) -> str:
    """Run a bad case; return the message after checking what every refusal has in common."""
    case, output = folder / "case.toml", folder / "out.vtkhdf"
    case.write_text(text, encoding="utf-8")
    output.write_bytes(OLD_RESULT)
    result = CliRunner().invoke(app, ["run", str(case), "-o", str(output), *options])
    assert result.exit_code == 2, result.output
    assert output.read_bytes() == OLD_RESULT
    assert sorted(path.name for path in folder.iterdir()) == ["case.toml", "out.vtkhdf"]
    assert result.stdout == ""
    message = result.stderr
    assert message.startswith(f"error: {case}")
    assert "\n  " in message, "every message offers a remedy"
    assert "Traceback" not in message
    assert "pydantic" not in message
    return message


def changed(old: str, new: str) -> str:
    assert old in INCLINE
    return INCLINE.replace(old, new)


SLIDER = "vertices = [[0,0],[10,0],[0,10],[1,9],[4,6],[4,9]]"

TEXTS = {
    "unknown key": (
        changed("young =", "youngs ="),
        ["[rock.granite] youngs", "no such key", "did you mean 'young'?"],
    ),
    "unknown table": (INCLINE + "[outputs]\n", ["outputs", "did you mean 'output'?"]),
    "key in the wrong table": (
        changed("schema = 1", "schema = 1\ncritdis = 0.01"),
        ["critdis", "belongs in the table method"],
    ),
    "missing key": (changed("step = 1e-3\n", ""), ["[time] step", "is missing", "s;"]),
    "missing table": (changed("[time]", "[times]"), ["time", "did you mean 'time'?"]),
    "missing vertex": (
        changed("loop=[4,5,6]", "loop=[4,5,7]"),
        ["[geometry] blocks 2, loop 3", "no vertex 7", "from 1 to 6"],
    ),
    "vertex number 0": (changed("[4,5,6]", "[0,5,6]"), ["blocks 2, loop 1", "no vertex 0"]),
    "too few vertices": (changed("[4,5,6]", "[4,5]"), ["block 2 'slider'", "at least 3"]),
    "self-crossing loop": (
        INCLINE + '[[block]]\nvertices=[[20,0],[21,1],[21,0],[20,1]]\nrock="granite"\n',
        ["block 3", "edge 1-2 meets edge 3-4", "(20.5, 0.5)"],
    ),
    "zero area": (
        changed(SLIDER, SLIDER.replace("[4,9]]", "[7,3]]")),
        ["block 2 'slider'", "no area"],
    ),
    "duplicate vertices": (
        changed("[4,5,6]", "[4,5,6,6]"),
        ["block 2 'slider', vertex 3 at (4, 9)", "same point as vertex 4", "remove one"],
    ),
    "overlapping blocks": (
        changed(SLIDER, SLIDER.replace("[1,9]", "[1,8]")).replace("at = [1,9]", "at = [1,8]"),
        ["block 1 'incline'", "overlaps block 2 'slider'", "depth", "near"],
    ),
    "nan": (changed("[4,9]]", "[4,nan]]"), ["[geometry] vertices 6, number 2", "finite"]),
    "inf": (changed("gravity = [0.0, -9.8]", "gravity = [0.0, -inf]"), ["gravity 2", "finite"]),
    "three coordinates": (changed("[4,9]]", "[4,9,0]]"), ["vertices 6", "3 items instead of 2"]),
    "one coordinate": (changed("[4,9]]", "[4]]"), ["vertices 6", "number 2 is missing"]),
    "negative density": (changed("2700.0", "-2700.0"), ["[rock.granite] density", "above 0"]),
    "negative modulus": (changed("50e9", "-50e9"), ["[rock.granite] young", "above 0"]),
    "modulus as a text": (changed("50e9", '"50 GPa"'), ["young", "must be a number", "Pa"]),
    "poisson too large": (changed("= 0.2", "= 0.7"), ["[rock.granite] poisson", "0.5 or less"]),
    "poisson of one half in plane strain": (
        changed("= 0.2", "= 0.5").replace('plane = "stress"', 'plane = "strain"'),
        ["rock 'granite', poisson", "plane strain", "below 0.5"],
    ),
    "unknown plane": (changed('plane = "stress"', 'plane = "strian"'), ["plane", "mean 'strain'"]),
    "friction angle in radians": (
        changed("= 20.0", "= 0.349"),
        ["joint 'default', friction_angle", "radians", "write 19.9", "allow_small_friction_angle"],
    ),
    "friction angle of a wall": (changed("= 20.0", "= 90"), ["friction_angle", "below 90"]),
    "negative cohesion": (
        changed("cohesion = 0.0", "cohesion = -1.0"),
        ["[joint.default] cohesion"],
    ),
    "measured point outside every block": (
        changed('at = [1,9]\nblock = "slider"', "at = [9,9]"),
        ["measured point 'A' at (9, 9)", "outside every block", "nearest", "move it"],
    ),
    "measured point on a common boundary": (
        changed('at = [1,9]\nblock = "slider"', "at = [1,9]"),
        ["measured point 'A' at (1, 9)", "common boundary", 'block = "incline"'],
    ),
    "unknown block": (changed('block = "slider"', 'block = "slyder"'), ["mean 'slider'"]),
    "unknown rock": (changed('rock="granite"', 'rock="granit"'), ["mean 'granite'"]),
    "step of zero": (changed("step = 1e-3", "step = 0"), ["[time] step", "above 0"]),
    "negative step": (changed("step = 1e-3", "step = -1"), ["[time] step", "above 0"]),
    "step longer than the run": (changed("step = 1e-3", "step = 3"), ["[time] step", "longer"]),
    "dynamic_ratio above 1": (
        changed("_ratio = 1.0", "_ratio = 2"),
        ["dynamic_ratio", "1 or less"],
    ),
    "unknown process": (
        changed('"modified"', '"modifide"'),
        ["[method] process", "mean 'modified'"],
    ),
    "unknown number of a process": (
        changed("passes=1", "pass=1"),
        ["process.pass", "mean 'passes'"],
    ),
    "passes of zero": (changed("passes=1", "passes=0"), ["[method] process.passes", "1 or more"]),
    "unknown friction": (changed('"lagged"', '"none"'), ["process.friction", "lagged, implicit"]),
    "negative stiffness": (
        changed("shear_stiffness=1e9", "shear_stiffness=-1"),
        ["[method] contact_law.shear_stiffness", "above 0"],
    ),
    "schema of the future": (changed("schema = 1", "schema = 2"), ["schema", "2 is not known"]),
    "no blocks": (changed("[geometry]", "[geometry_]"), ["mean 'geometry'"]),
    "no TOML": (changed("[rock.granite]", "[rock.granite"), ["line 12", "is not TOML"]),
    "cut off": (INCLINE + "[[block]]\nvertices = [", ["is not TOML"]),
    "key twice": (changed("end = 1.0", "end = 1.0\nend = 2.0"), ["line 9", "is not TOML"]),
    "empty file": ("", ["time", "is missing", "rock"]),
}


@pytest.mark.parametrize("name", TEXTS)
def test_bad_case(name, tmp_path):
    text, phrases = TEXTS[name]
    message = refused(tmp_path, text)
    for phrase in phrases:
        assert phrase in message


def test_several_faults_are_said_at_once(tmp_path):
    text = changed("young = 50e9", "youngs = 50e9").replace("step = 1e-3", "step = 0")
    message = refused(tmp_path, text)
    assert "3 things to put right" in message
    assert "[time] step" in message
    assert "[rock.granite] young: is missing" in message


def test_bad_setting(tmp_path):
    case, output = tmp_path / "case.toml", tmp_path / "out.vtkhdf"
    case.write_text(INCLINE, encoding="utf-8")
    result = CliRunner().invoke(app, ["run", str(case), "-o", str(output), "--set", "time.ende=2"])
    assert result.exit_code == 2
    assert "did you mean 'end'?" in result.stderr
    assert not output.exists()


def run_with(case: Path, output: Path) -> str:
    result = CliRunner().invoke(app, ["run", str(case), "-o", str(output)])
    assert result.exit_code == 2
    assert result.stderr.startswith("error: ")
    assert "\n  " in result.stderr
    return result.stderr


@pytest.fixture
def incline(tmp_path) -> Path:
    case = tmp_path / "incline.toml"
    case.write_text(INCLINE, encoding="utf-8")
    return case


def test_missing_file(tmp_path, incline):
    message = run_with(tmp_path / "inclne.toml", tmp_path / "out.vtkhdf")
    assert "there is no such file" in message
    assert str(incline) in message


def test_directory_for_a_case(tmp_path):
    assert "is a directory" in run_with(tmp_path, tmp_path / "out.vtkhdf")


def test_case_that_is_no_text(tmp_path):
    case = tmp_path / "case.toml"
    case.write_bytes(HDF5_SIGNATURE)
    assert "is not a text file" in run_with(case, tmp_path / "out.vtkhdf")


@pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() == 0, reason="everything is readable to root"
)
def test_unreadable_file(tmp_path, incline):
    incline.chmod(0)
    assert "cannot be read" in run_with(incline, tmp_path / "out.vtkhdf")


def test_unreadable_file_for_whoever_reads_it(tmp_path, incline, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_text", refuse)
    message = run_with(incline, tmp_path / "out.vtkhdf")
    assert "cannot be read: Permission denied" in message


def test_directory_for_output(tmp_path, incline):
    message = run_with(incline, tmp_path)
    assert "is a directory" in message
    assert "-o" in message


def test_output_in_a_directory_that_is_not(tmp_path, incline):
    assert "does not exist" in run_with(incline, tmp_path / "nowhere" / "out.vtkhdf")


def test_output_over_something_else(tmp_path, incline):
    message = run_with(incline, incline)
    assert "is no result file" in message
    assert incline.read_text(encoding="utf-8") == INCLINE


@pytest.mark.parametrize("command", ["info", "plot"])
def test_results_that_are_none(command, tmp_path, incline):
    for path in (incline, tmp_path, tmp_path / "nothing.vtkhdf"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert result.exit_code == 2, path
        assert str(path) in result.stderr
