"""Runs in stages go on from any moment, and from the end of any stage with other numbers."""

from __future__ import annotations

from pathlib import Path

import pytest

import clast
from clast.errors import CaseError
from clast.results import Run, read_results
from clast.results.checkpoints.checkpoint_files import checkpoint_path, read_checkpoint
from scenes.command_line import clast_command, good
from scenes.restarts import differences, pressed_at
from scenes.shaken import shaken

pytest.importorskip("clast.model.stages")

STAGES = """
[[stage]]
name = "gravity"
dynamic_ratio = 0.0
until = "time"
time = 0.03
reset_displacement = true

[[stage]]
name = "push"
loads = ["ramp"]
until = "time"
time = 0.04

[[stage]]
name = "earth/quake"
joint = {default = {friction_angle = 10}}
ground_motion = true
until = "time"
time = 0.05
step = 1e-3
"""


@pytest.fixture(scope="module")
def case_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shaken bricks as a case in three stages."""
    law = {"name": "penalty", "normal_stiffness": 2e7}
    text = shaken().to_toml(step=2e-3, end=1.0, every=9e-3, process="modified", contact_law=law)
    path = tmp_path_factory.mktemp("stages") / "dig.toml"
    path.write_text(text + STAGES, "utf-8")
    return path


@pytest.fixture(scope="module")
def whole(case_file: Path) -> Run:
    """The run in one go."""
    return clast.load(case_file).run(output=case_file.with_name("whole.vtkhdf"))


def test_every_stage_leaves_a_checkpoint(whole: Run):
    names = ["gravity", "push", "earth/quake"]
    for name, end in zip(names, (0.03, 0.07, 0.12), strict=True):
        held = read_checkpoint(checkpoint_path(whole.output, name), {})
        assert held.stage == name
        assert held.time == pytest.approx(end)
    assert read_checkpoint(checkpoint_path(whole.output), {}).finished


@pytest.mark.one_in(4)
@pytest.mark.parametrize("steps", [7, 15, 16, 30, 35, 36, 80])
def test_a_run_goes_on_in_whatever_stage_it_was(
    case_file: Path, whole: Run, tmp_path: Path, steps: int
):
    part = clast.load(case_file).run(output=tmp_path / "a.vtkhdf", progress=pressed_at(steps))
    rest = clast.resume(part.checkpoint)
    assert rest.report.steps == whole.report.steps
    assert differences(whole.output, rest.output) == []


def test_a_run_goes_on_from_the_end_of_a_stage(case_file: Path, whole: Run, tmp_path: Path):
    run = clast.load(case_file).run(output=tmp_path / "a.vtkhdf")
    for name in ("push", "gravity"):
        clast.resume(checkpoint_path(run.output, name))
        assert differences(whole.output, run.output) == []


def test_a_stage_is_run_again_with_other_numbers(case_file: Path, whole: Run, tmp_path: Path):
    loaded = clast.load(case_file)
    run = loaded.run(output=tmp_path / "a.vtkhdf")
    weaker = ["stage.3.joint.default.friction_angle=3", "stage.3.time=0.06"]
    once = clast.Case.from_toml(case_file, weaker).run(output=tmp_path / "once.vtkhdf")
    # in a file of its own, which leaves that of the run as it is
    other = tmp_path / "other.vtkhdf"
    clast.resume(run.checkpoint, weaker, stage="earth/quake", output=other)
    assert differences(once.output, other) == []
    assert differences(whole.output, run.output) == []
    assert read_results(other).times[-1] == pytest.approx(0.13)
    # in the file of the run, by the command; the stages before can still be gone back to
    options = [word for setting in weaker for word in ("--set", setting)]
    good("resume", checkpoint_path(run.output, "push"), "--stage", "earth/quake", *options)
    assert differences(once.output, run.output) == []
    clast.resume(run.checkpoint, stage="push")
    assert differences(once.output, run.output) == []


def test_what_the_stages_before_did_not_know_is_said(case_file: Path, tmp_path: Path):
    run = clast.load(case_file).run(output=tmp_path / "a.vtkhdf")
    again = clast.resume(run.checkpoint, ["joint.default.cohesion=5"], stage="earth/quake")
    (text,) = (text for text in again.report.warnings if "were run with other numbers" in text)
    assert "the stages until 'push' were run with other numbers of model.joint_table" in text


def test_what_a_stage_cannot_be_run_again_with(case_file: Path, tmp_path: Path):
    run = clast.load(case_file).run(output=tmp_path / "a.vtkhdf", progress=pressed_at(38))
    before = run.output.read_bytes()

    def refused(words: str, stage: str, *settings: str) -> None:
        options = [word for setting in settings for word in ("--set", setting)]
        result = clast_command("resume", run.checkpoint, "--stage", stage, *options)
        assert result.exit_code == 2, result.output
        assert words in " ".join(result.stderr.split()), result.stderr

    refused("the run has no stage 'pusch' did you mean 'push'?", "pusch")
    refused("'gravity' is the first stage: there is none before it", "gravity")
    refused("change stage 'gravity', which has already finished", "push", "stage.1.time=0.02")
    refused("has other blocks or points", "push", "block.2.fixed=true")
    point = "measured_point=[{name='a', at=[0.1, 0.1]}]"
    refused("has other blocks or points", "push", point)
    refused("add or remove loads, supports", "push", "fixed_point=[{at=[0.1, 0.2]}]")
    checkpoint_path(run.output, "gravity").unlink()
    refused("there is no checkpoint of the end of stage 'gravity'", "push")
    assert run.output.read_bytes() == before


def test_a_run_without_stages_has_none_to_run_again(tmp_path: Path):
    law = {"name": "penalty", "normal_stiffness": 2e7}
    case = shaken().case(step=2e-3, end=0.02, process="modified", contact_law=law)
    run = case.run(output=tmp_path / "a.vtkhdf", progress=pressed_at(3))
    with pytest.raises(CaseError, match="the run has no stage 'push'"):
        clast.resume(run.checkpoint, stage="push")
