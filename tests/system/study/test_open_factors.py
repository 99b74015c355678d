"""Factors of safety whose bracket has an open end: no value, and the reason."""

from __future__ import annotations

import csv
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import clast
from clast.study import statistics
from clast.study.folder import StudyFolder
from clast.study.study_api import HowMade
from clast.study.study_report import write_report

HERE = HowMade(array=(1, 1))
REASON = "factor of safety at least 807.794: no failure was found up to there"


def on_a_slope(path: Path, angle: float) -> Path:
    """Write a block on a plane, which no strength makes slide where it is level."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    builder = clast.ModelBuilder(gravity=(9.81 * s, -9.81 * c))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=True)
    builder.block(name="block", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.measured_point("A", (1, 1), block="block")
    path.write_text(builder.to_toml(step=2e-3, end=0.004))
    return path


def study(path: Path, **changes) -> clast.Study:
    """Return three runs: friction of 20, 30 and 40 degrees."""
    vary = {"joint.default.friction_angle": [20.0, 30.0, 40.0]}
    measure = {"F": "factor_of_safety()", "u": "displacement(A)"}
    return clast.Study(path, **{"vary": vary, "measure": measure, **changes})


def test_a_factor_without_a_failure_has_no_value(tmp_path):
    found = clast.factor_of_safety(on_a_slope(tmp_path / "c.toml", 0.0))
    assert math.isnan(found.value) and found.low > 800.0 and math.isinf(found.high)
    assert found.sentence == REASON
    assert found.as_dict()["value"] is None and not found.is_settled


@pytest.mark.parametrize(("fail", "fails"), [("F < 1.2", False), ("F > 1.2", True), ("", None)])
def test_a_sweep_says_the_reason_and_keeps_its_other_measures(tmp_path, fail, fails):
    """A run fails or not where both ends of the bracket agree on it."""
    table = study(on_a_slope(tmp_path / "c.toml", 0.0), fail=fail).run(tmp_path / "s", how=HERE)
    assert table["F"] == [None] * 3 and table["reason"] == [REASON] * 3
    assert table["status"] == ["done"] * 3 and np.isfinite(table["u"]).all()
    assert table.get("fails", [None] * 3) == [fails] * 3
    there = StudyFolder.opened(tmp_path / "s")
    columns = statistics.columns_of(there)
    assert columns.remarks == {REASON: 3}
    assert columns.gaps[-1] == f"3 of 3 runs: {REASON}"
    assert REASON in write_report(there).read_text("utf-8")


def test_a_run_of_which_the_ends_disagree_has_no_result(tmp_path):
    one = study(on_a_slope(tmp_path / "c.toml", 0.0), fail="F > 1000")
    table = one.run(tmp_path / "s", how=HERE)
    assert table["status"] == ["no result"] * 3 and table["reason"] == [REASON] * 3


def test_closed_brackets_are_as_before_beside_open_ones(tmp_path):
    """Measures made of a factor have none either; the least factor is that of the worst run."""
    one = study(
        on_a_slope(tmp_path / "c.toml", 5.0),
        vary={"gravity.1": [9.81 * math.sin(math.radians(a)) for a in (5.0, 0.0)]},
        measure={"F": "factor_of_safety()", "margin": "F - 1", "large": "F > 2"},
    )
    table = one.run(tmp_path / "s", how=HERE)
    exact = math.tan(math.radians(30.0)) / math.tan(math.radians(5.0))
    assert table["F"] == [pytest.approx(exact, rel=0.01), None]
    assert table["margin"] == [table["F"][0] - 1.0, None] and table["large"] == [True, True]
    assert table["reason"] == ["", REASON]
    assert statistics.worst(statistics.columns_of(StudyFolder.opened(tmp_path / "s"))) == [1]


def test_the_command_line_says_so(tmp_path):
    on_a_slope(tmp_path / "c.toml", 0.0)
    words = [sys.executable, "-m", "clast", "study"]
    vary = ["--vary", "joint.default.friction_angle=[30]", "--measure", "F=factor_of_safety()"]
    made = [*words, "sweep", "c.toml", *vary, "-o", "s", "--workers", "1"]
    for more, is_there in (([], REASON), (["--json"], REASON)):
        said = subprocess.run(
            [*made, *more], cwd=tmp_path, capture_output=True, text=True, check=True
        ).stdout
        assert is_there in " ".join(said.split())
    assert json.loads(said)["reasons"] == {REASON: 1} and json.loads(said)["measures"]["F"] is None
    with (tmp_path / "s/results.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (row["F"], row["reason"]) == ("", REASON)
    fos = subprocess.run(
        [*words, "fos", "c.toml", "-o", "f", "--json"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert json.loads(fos.stdout)["value"] is None
    assert fos.returncode == 1 and REASON in fos.stderr
