"""Stages on the command line: the table of a run, its JSON, pictures and exports of a stage."""

import json
from pathlib import Path

import pytest

from clast.run.progress import status_text
from clast.run.schedule import Progress
from scenes.command_line import clast_command, good

CASE = """
schema = 1
title = "A box is pushed"
[time]
step = 2e-3
end = 0.1
[rock.rock]
young = 5e9
poisson = 0.2
density = 2500.0
[joint.default]
friction_angle = 20.0
[[block]]
name = "floor"
vertices = [[-2, -1], [4, -1], [4, 0], [-2, 0]]
fixed = true
[[block]]
name = "box"
vertices = [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]
[[point_load]]
at = [0, 0.1]
force = [1e4, 0]
block = "box"
name = "push"
[[measured_point]]
name = "A"
at = [1, 0.5]
[[stage]]
name = "rest"
dynamic_ratio = 0.0
reset_displacement = true
[[stage]]
name = "push"
loads = ["push"]
"""


@pytest.fixture
def pushed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("pushed.toml").write_text(CASE, encoding="utf-8")
    return "pushed.toml"


def test_a_run_shows_its_stages_and_says_what_moves(pushed: str):
    result = clast_command("run", pushed)
    assert result.exit_code == 0
    assert "equilibrium" in result.stdout and "moving" in result.stdout
    assert "stages" in result.stdout and "largest mover" in result.stdout
    assert "stage 'push' ended at its limit" in result.stderr.replace("\n", " ")
    printed = good("info", "pushed.vtkhdf")
    assert "rest, push" in printed and "largest mover" in printed


def test_a_check_counts_the_steps_of_all_stages(pushed: str):
    content = json.loads(good("check", pushed, "--json"))
    assert content["stages"] == ["rest", "push"]
    assert content["steps"] == 100
    assert "rest, push" in good("check", pushed)


def test_stages_for_a_program(pushed: str):
    content = json.loads(good("run", pushed, "--json"))
    rest, push = content["stages"]
    assert (rest["name"], rest["outcome"]) == ("rest", "equilibrium")
    assert (push["outcome"], push["mover"]["block"]) == ("moving", "box")
    assert push["end"] == pytest.approx(rest["end"] + 0.1)
    assert push["mover"]["speed"] > 0.1
    assert {"time", "stage", "kind", "what", "text", "block", "mass"} == set(content["events"][0])
    content = json.loads(good("info", "pushed.vtkhdf", "--json"))
    assert content["stages"] == ["rest", "push"]
    assert content["report"]["stages"][0]["name"] == "rest"


@pytest.mark.slow
def test_a_picture_and_an_export_of_a_stage(pushed: str):
    pytest.importorskip("matplotlib")
    good("run", pushed)
    good("plot", "pushed.vtkhdf", "--stage", "rest")
    assert Path("pushed.png").stat().st_size > 1000
    good("export", "pushed.vtkhdf", "--to", "vtu", "--stage", "rest")
    assert Path("pushed.vtu").exists()
    for option in ("--frame=1", "--time=0.05"):
        result = clast_command("plot", "pushed.vtkhdf", "--stage", "rest", option)
        assert result.exit_code == 2
        assert "leave one of them out" in result.stderr
    result = clast_command("plot", "pushed.vtkhdf", "--stage", "pusch")
    assert result.exit_code == 2
    assert "did you mean 'push'?" in result.stderr


def test_the_line_says_how_far_from_equilibrium_a_stage_is():
    progress = Progress(
        time=2.0,
        end=5.0,
        step=1e-3,
        steps=10,
        contacts=7,
        penetration=0.0,
        stage="gravity",
        start=1.0,
        force_ratio=0.0123,
        speed=4.5e-3,
    )
    text = status_text(progress, speed=1.0)
    assert text.startswith("gravity  t 2 of 5 s")
    assert "unbalanced 1.2e-02" in text
    assert "fastest 4.5e-03 m/s" in text
