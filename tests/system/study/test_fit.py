"""Back-analysis of a shear stiffness and a friction angle from displacements with noise.

A block of weight W on a plane is held by a bar of stiffness b and pushed by a force P that grows.
It moves by u = P/(k A + b) while its joint holds, and by u = (P - W tan phi)/b when that slides.
"""

from __future__ import annotations

import csv
import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.study.fitting.fit import go_on
from clast.study.fitting.fit_report import write_fit
from clast.study.fitting.observations import read_observations
from clast.study.folder import StudyFolder
from clast.study.study_api import HowMade
from scenes.command_line import clast_command

WEIGHT, BAR, PUSH = 2600.0 * 9.81, 1e7, 4e4
STIFFNESS, FRICTION, NOISE = 1e8, 30.0, 2e-5
TIMES = np.linspace(0.1, 1.0, 10)
RANGES = {
    "joint.base.shear_stiffness": "uniform(1e7, 1e9)",
    "joint.base.friction_angle": "uniform(15, 45)",
}


@pytest.fixture
def case(tmp_path: Path) -> Path:
    builder = clast.ModelBuilder(title="Pushed block", gravity=(0.0, -9.81))
    builder.add_rock("rock", young=50e9, poisson=0.0, density=2600.0)
    builder.add_joint("default", friction_angle=0.0)
    given = {"normal_stiffness": 1e10, "shear_stiffness": 3e8, "friction_angle": 20.0}
    builder.add_joint("base", **given)
    builder.block(name="ground", vertices=[(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
    builder.block(name="post", vertices=[(2.5, 0), (3, 0), (3, 1), (2.5, 1)], fixed=True)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    builder.block(name="block", vertices=corners, edge_joint=["base", "", "", ""])
    builder.add_bolt_kind("bar", stiffness=BAR, compression=True)
    builder.bolt((1.0, 0.01), (2.5, 0.01), kind="bar", name="bar")
    table = builder.add_amplitude("ramp", [0.0, 1.0], [0.0, 1.0])
    builder.point_load((0.0, 0.01), (PUSH, 0.0), block="block", amplitude=table)
    builder.measured_point("A", (0.5, 0.01), block="block")
    path = tmp_path / "pushed.toml"
    path.write_text(builder.to_toml(step=0.05, end=1.0, dynamic_ratio=0.0))
    return path


def exact(stiffness: float, friction: float) -> np.ndarray:
    """Return the displacements at TIMES, m."""
    push = PUSH * TIMES
    sliding = (push - WEIGHT * np.tan(np.radians(friction))) / BAR
    return np.maximum(push / (stiffness + BAR), sliding)


def written(path: Path, x: np.ndarray, sd: str = "") -> Path:
    with path.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["point", "time", "x", "y", "sd"])
        out.writerows(["A", t, value, "", sd] for t, value in zip(TIMES, x, strict=True))
    return path


@pytest.mark.parametrize("sd", ["", str(NOISE)], ids=["noise unknown", "noise known"])
def test_the_truth_is_within_the_intervals(case, tmp_path, sd):
    noise = np.random.default_rng(4).normal(0.0, NOISE, len(TIMES))
    table = written(tmp_path / "moved.csv", exact(STIFFNESS, FRICTION) + noise, sd)
    with ThreadPoolExecutor(1) as one:
        found = clast.fit(case, table, RANGES, executor=one)
    assert not found.remark
    for value, truth, low, high in zip(
        found.value, (STIFFNESS, FRICTION), found.low, found.high, strict=True
    ):
        assert low < truth < high
        assert value == pytest.approx(truth, rel=0.15)
    assert found.high[1] - found.low[1] < 1.0
    assert np.abs(found.predicted - found.observed).max() < 4.0 * NOISE


def test_what_observations_do_not_tell_apart_is_said(case, tmp_path):
    table = written(tmp_path / "moved.csv", exact(STIFFNESS, 80.0))
    with ThreadPoolExecutor(1) as one:
        found = clast.fit(
            case, table, {**RANGES, "joint.base.friction_angle": "uniform(60, 80)"}, executor=one
        )
    assert "do not tell" in found.remark


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("", "lacks the columns"),
        ("point,z\nA,1", "a column 'z'"),
        ("point;x;y\nA;1;2", "semicolons"),
        ("point,x,x\nA,1,2", "the column 'x' twice"),
        ("point,x\nA,1e300", "not a valid x"),
        ("point,x\nB,1", "no measured point 'B'"),
        ("point,x\nA,one", "'one' is not a valid x"),
        ("point,x\nA,nan", "'nan' is not a valid x"),
        ("point,x\n", "no observation"),
        ("point,time,x\nA,-1,1", "before the start"),
        ("point,x,sd\nA,1,0", "no positive sd"),
        ("point,x,sd\nA,1,1\nA,2,", "some rows only"),
        ("x,y\n1,2", "lacks the columns"),
    ],
)
def test_tables_that_are_none_are_refused(tmp_path, text, what):
    (tmp_path / "moved.csv").write_text(text)
    with pytest.raises(CaseError, match=what) as refused:
        read_observations(tmp_path / "moved.csv", ["A"])
    assert "moved.csv" in refused.value.where


def test_a_table_of_a_spreadsheet_is_read(tmp_path):
    """It has a byte order mark, and lines of its own."""
    (tmp_path / "moved.csv").write_bytes("\ufeffpoint,x\r\nA,0.25\r\n".encode())
    (found,) = read_observations(tmp_path / "moved.csv", ["A"])
    assert (found.point, found.part, found.value) == ("A", 0, 0.25)


def test_back_analyses_that_cannot_be_made_are_refused(case, tmp_path):
    table = written(tmp_path / "moved.csv", exact(STIFFNESS, FRICTION))
    for vary, what in [
        ({}, "no parameter varies"),
        ({"joint.base.cohesion": [1.0, 2.0]}, "no range"),
        ({"joint.base.friction_angle": "uniform(91, 95)"}, "friction_angle"),
        ({"joint.base.friction_angle": "uniform(60, 119.9)"}, "cannot continue"),
        ({"joint.base.friction": "uniform(1, 2)"}, "friction"),
        ({f"rock.rock.{k}": "uniform(0, 1)" for k in range(11)}, "do not determine"),
    ]:
        with ThreadPoolExecutor(1) as one, pytest.raises(CaseError, match=what):
            clast.fit(case, table, vary, executor=one)
    late = written(tmp_path / "late.csv", np.append(exact(STIFFNESS, FRICTION)[:-1], 1.0))
    late.write_text(late.read_text().replace("A,1.0,", "A,1.5,"))
    with (
        ThreadPoolExecutor(1) as one,
        pytest.raises(CaseError, match=r"ends at 1 s, before 1\.5 s"),
    ):
        clast.fit(case, late, RANGES, executor=one)
    for how, what in [
        ({"method": "es"}, "no method 'es'"),
        ({"members": 3}, "not a valid number of members"),
        ({"rounds": 0}, "not a valid number of rounds"),
        ({"seed": -1}, "not a valid seed"),
        ({"method": "es-mda"}, "are missing"),
    ]:
        with pytest.raises(CaseError, match=what):
            clast.fit(case, table, RANGES, how=clast.FitSettings(**how), workers=1)


@pytest.mark.parametrize("truth", [(1e8, 30.0), (2e7, 44.0), (9e8, 16.0), (4e8, 27.0)])
def test_the_block_moves_as_its_formula_says(case, truth):
    """So that tests/study/test_coverage.py may take the formula in place of runs.

    The formula has a rigid block and a base that slides all at once: clast's is compressed, by up
    to PUSH/E = 0.04 NOISE, and begins to slide at one end, which is 0.22 NOISE in the step between.
    """
    settings = [f"{path}={value}" for path, value in zip(RANGES, truth, strict=True)]
    history = clast.Case.from_toml(case, settings).run(warn=lambda _text: None).history("A")
    x = np.interp(TIMES, history.time, history.displacement[:, 0])
    assert x == pytest.approx(exact(*truth), abs=0.25 * NOISE)


ENSEMBLE = {
    "joint.base.shear_stiffness": "lognormal(2e8, 1.5e8)",
    "joint.base.friction_angle": "normal(28, 5, low=10, high=50)",
}
HOW = {
    "least-squares": (RANGES, clast.FitSettings(), 5),
    "es-mda": (ENSEMBLE, clast.FitSettings(method="es-mda", members=24, rounds=3), 3),
}


@pytest.mark.parametrize("method", list(HOW))
def test_a_back_analysis_that_is_interrupted_goes_on_where_it_was(case, tmp_path, method):
    noise = np.random.default_rng(4).normal(0.0, NOISE, len(TIMES))
    table = written(tmp_path / "moved.csv", exact(STIFFNESS, FRICTION) + noise, str(NOISE))
    vary, how, batches = HOW[method]
    told = []

    def interrupted(runs: int, error: float) -> None:
        told.append(runs)
        if len(told) == batches:
            raise KeyboardInterrupt

    with ThreadPoolExecutor(1) as one:
        whole = clast.fit(case, table, vary, how=how, executor=one, folder=tmp_path / "whole")
        with pytest.raises(KeyboardInterrupt):
            part = tmp_path / "part"
            clast.fit(case, table, vary, how=how, executor=one, folder=part, watch=interrupted)
        kept = {file: file.stat().st_mtime_ns for file in part.rglob("result.json")}
        assert 0 < len(kept) == told[-1] < whole.runs
        # a result that was lost, and one that is half written
        first, second, *_ = sorted(kept)
        first.unlink()
        second.write_text("{")
        del kept[first], kept[second]
        go_on(StudyFolder.opened(part), HowMade(executor=one))
    assert kept == {file: file.stat().st_mtime_ns for file in kept}
    for name in ("results.csv", "fit.json", "best.toml"):
        assert (part / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert whole.runs == len(list(part.rglob("result.json")))
    for truth, low, value, high in zip(
        (STIFFNESS, FRICTION), whole.low, whole.value, whole.high, strict=True
    ):
        assert low < truth < high
        assert value == pytest.approx(truth, rel=0.15)
    best = clast.load(tmp_path / "whole/best.toml").model()
    assert best.joint_table.joints[-1].friction_angle == pytest.approx(whole.value[1])


def results_in(folder: Path) -> int:
    """Return how many runs of a study have written their result; 0 where there is no folder."""
    return len(list(folder.glob("runs/*/[0-9]*/result.json")))


@pytest.mark.slow
def test_a_back_analysis_that_is_killed_ends_with_the_same_table(case, tmp_path):
    """Three times, each when a number of further runs that is drawn have their result."""
    written(tmp_path / "moved.csv", exact(STIFFNESS, FRICTION), str(NOISE))
    words = [sys.executable, "-m", "clast", "study"]
    command = [*words, "fit", case.name, "--observe", "moved.csv", "-q", "--workers", "2"]
    for path, given in RANGES.items():
        command += ["--vary", f"{path}={given}"]
    subprocess.run([*command, "-o", "whole"], cwd=tmp_path, check=True)
    first, part, order, before = [*command, "-o", "part"], tmp_path / "part", random.Random(5), []
    total = results_in(tmp_path / "whole")
    for _ in range(3):
        driver = subprocess.Popen(first, cwd=tmp_path, start_new_session=True)
        goal = results_in(part) + order.randint(1, total // 5)
        while results_in(part) < goal and driver.poll() is None:
            time.sleep(0.02)
        assert driver.poll() is None, "it had ended before it was killed"
        os.killpg(driver.pid, signal.SIGKILL)
        driver.wait()
        before.append(results_in(part))
        first = [*words, "resume", "part", "-q", "--workers", "2"]
    assert before == sorted(set(before)) and before[-1] < total
    subprocess.run(first, cwd=tmp_path, check=True)
    for name in ("results.csv", "fit.json"):
        assert (tmp_path / "part" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_a_report_has_intervals_differences_and_correlation(case, tmp_path):
    table = written(tmp_path / "moved.csv", exact(STIFFNESS, FRICTION), str(NOISE))
    with ThreadPoolExecutor(1) as one:
        found = clast.fit(case, table, RANGES, executor=one, folder=tmp_path / "out")
    report = write_fit(StudyFolder.opened(tmp_path / "out"), found).read_text(encoding="utf-8")
    for name, value, low, high in zip(
        found.parameter, found.value, found.low, found.high, strict=True
    ):
        unit = {"joint.base.shear_stiffness": " Pa/m", "joint.base.friction_angle": "°"}[name]
        assert f"{name} = {value:.5g}{unit} (95 %: {low:.5g} to {high:.5g})" in report
    assert report.count("data:image/png") == 3
    assert f"<td>{found.correlation[0, 1]:.5g}</td>" in report
    assert report.count('<td class="text">A</td>') == len(TIMES)


def test_a_search_is_neither_collected_nor_an_array(case, tmp_path):
    table = written(tmp_path / "moved.csv", exact(STIFFNESS, FRICTION))
    with ThreadPoolExecutor(1) as one:
        clast.fit(case, table, RANGES, executor=one, folder=tmp_path / "out")
    for words, what in [
        (["collect", str(tmp_path / "out")], "study resume"),
        (["resume", str(tmp_path / "out"), "--array", "1/2"], "cannot be split into an array"),
    ]:
        done = clast_command("study", *words)
        assert done.exit_code == 2 and what in done.output


def test_a_measurement_may_be_repeated(case, tmp_path):
    """Two readings at each time, one above and one below the truth by as much."""
    table = tmp_path / "moved.csv"
    rows = [
        f"A,{t},{x + way},"
        for t, x in zip(TIMES, exact(STIFFNESS, FRICTION), strict=True)
        for way in (1e-5, -1e-5)
    ]
    table.write_text("\n".join(["point,time,x,y", *rows]))
    with ThreadPoolExecutor(1) as one:
        found = clast.fit(case, table, RANGES, executor=one)
    assert found.value == pytest.approx([STIFFNESS, FRICTION], rel=0.01)
    assert len(found.observed) == 2 * len(TIMES)
