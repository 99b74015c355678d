"""What a run warns of reaches whoever started it, each warning once."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

import clast
from scenes.command_line import clast_command
from scenes.restarts import pressed_at

FALLS = """
schema = 1
time = {step = 1e-3, end = 6e-3}
rock.r = {young = 1e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
method = {name}
[[block]]
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[block]]
vertices = [[0, 1], [1, 1], [1, 2], [0, 2]]
initial_stress = [0.0, -1e6, 0.0]
"""
"""Blocks that fall, which is said before, with a stress that goes, which is said after."""


def case() -> clast.Case:
    return clast.Case.from_text(FALLS.replace("{name}", "{}"), "falls.toml")


def run_warnings(caught: list[warnings.WarningMessage]) -> list[str]:
    return [str(one.message) for one in caught if issubclass(one.category, clast.RunWarning)]


def test_a_case_warns_a_script(tmp_path: Path):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = case().run()
    assert run_warnings(caught) == list(run.report.warnings)
    assert len(set(run.report.warnings)) == len(run.report.warnings) >= 2
    assert {one.filename for one in caught} == {__file__}
    assert len(case().foreseen(run.model, case().method())) < len(run.report.warnings)


def test_a_model_warns_a_script():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = clast.simulate(case().model(), end=6e-3, step=1e-3)
    assert run_warnings(caught) == list(run.report.warnings) != []
    assert {one.filename for one in caught} == {__file__}


def test_a_run_that_goes_on_warns_a_script(tmp_path: Path):
    told: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("error", clast.RunWarning)  # none: a function is told
        part = case().run(output=tmp_path / "a.vtkhdf", progress=pressed_at(3), warn=told.append)
    assert told == list(part.report.warnings)
    with pytest.warns(clast.RunWarning) as caught:
        rest = clast.resume(part.checkpoint)
    assert run_warnings(list(caught)) == list(rest.report.warnings) != []


def test_a_run_that_stops_warns_too():
    stops = clast.Case.from_text(
        FALLS.replace("{name}", "{}"), "falls", ["time.max_displacement=1e-9", "time.step=1e-3"]
    )
    told: list[str] = []
    with pytest.raises(clast.RunStopped) as stopped:
        stops.run(warn=told.append)
    assert told == list(stopped.value.run.report.warnings) != []


def test_python_can_turn_them_into_errors():
    with warnings.catch_warnings():
        warnings.simplefilter("error", clast.RunWarning)
        with pytest.raises(clast.RunWarning, match="nothing is fixed"):
            case().run()


@pytest.mark.parametrize("command", ["run", "compare"])
def test_the_command_line_says_each_once(tmp_path: Path, command: str):
    file = tmp_path / "falls.toml"
    file.write_text(case().text)
    where = ["-o", tmp_path / "out"] if command == "compare" else ["-o", tmp_path / "a.vtkhdf"]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = clast_command(command, file, *where)
    assert result.exit_code == 0, result.output
    assert run_warnings(caught) == []
    if command == "run":
        assert result.stderr.count("nothing is fixed") == 1
        lines = [line for line in result.stderr.splitlines() if line.startswith("warning: ")]
        assert len(set(lines)) == len(lines) >= 2
