"""What a run warns of reaches whoever started it, each warning once."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

import clast
from scenes.command_line import clast_command

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
