"""The report of an undecided trial has its two curves, and its run is kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import clast
from clast.results import read_results
from clast.study.collapsing import trial
from clast.study.collapsing.collapse_report import write_collapse
from clast.study.collapsing.reduction import reduction
from clast.study.folder import RUN_FILE, StudyFolder


@pytest.fixture
def column(tmp_path: Path) -> Path:
    """A block on a base, that slides at tan(30 degrees) = F tan(phi)."""
    builder = clast.ModelBuilder(gravity=(-9.81 * 0.5, -9.81 * np.sqrt(0.75)))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2600.0)
    builder.add_joint("default", friction_angle=35.0)
    builder.block(name="base", vertices=[(-3, -1), (3, -1), (3, 0), (-3, 0)], fixed=True)
    builder.block(name="block", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    path = tmp_path / "case.toml"
    path.write_text(builder.to_toml(step=0.005, end=1.0))
    return path


def test_an_undecided_trial_keeps_its_run_and_draws_its_curves(
    column: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged = trial._judged

    def doubted(start, run, factor, parts):  # type: ignore[no-untyped-def]
        found = judged(start, run, factor, parts)
        limit = np.tan(np.radians(35.0)) / np.tan(np.radians(30.0))
        if abs(factor / limit - 1.0) > 0.04:
            return found
        return trial.replace(found, verdict=trial.UNDECIDED, reason="nothing is known of it")

    monkeypatch.setattr(trial, "_judged", doubted)
    found = clast.factor_of_safety(column, folder=tmp_path / "out", tolerance=0.01)
    assert found.undecided and not found.is_settled
    folder = StudyFolder.opened(tmp_path / "out")
    text = write_collapse(folder, found).read_text(encoding="utf-8")
    assert (tmp_path / "out" / "report.html").exists()
    for factor in found.undecided:
        number = next(k for k, one in enumerate(found.trials, 1) if one.factor == factor)
        assert found.trials[number - 1].longer
        assert f"Trial {number}, F = {factor:.6g}: undecided" in text
        assert (tmp_path / "out" / "figures" / f"undecided-{number}.png").stat().st_size > 5000
        steps = read_results(folder.place(number) / RUN_FILE).steps
        assert len(steps["travel"]) >= found.trials[number - 1].steps > 0
    assert "nothing is known of it" in text


def test_a_trial_is_repeated_by_its_case(column: Path, tmp_path: Path) -> None:
    found = clast.factor_of_safety(column, folder=tmp_path / "out", tolerance=0.02)
    folder = StudyFolder.opened(tmp_path / "out")
    median = 3.5  # m2: the block has 1, the base 6
    for number in (1, len(found.trials)):
        case = clast.Case.from_toml(folder.place(number) / "case.toml")
        assert case.time.max_displacement == pytest.approx(1e-3 * np.sqrt(median))
        run = case.run()
        outcome = {"stands": "equilibrium", "fails": "fails"}[found.trials[number - 1].verdict]
        assert run.stages[-1].outcome == outcome
        assert run.stages[-1].steps == found.trials[number - 1].steps


def test_a_smaller_step_of_the_case_is_kept(column: Path) -> None:
    case = clast.Case.from_toml(column, ["time.max_displacement=2e-5"])
    start = trial.settle_standing(case, reduction("strength"))
    assert start.content["time"]["max_displacement"] == 2e-5
