"""A run that is interrupted and goes on in another process leaves the bits of one in one go."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import clast
from clast.compute.jit import BY_THREADS
from clast.results import read_results
from clast.results.checkpoints.checkpoint_files import checkpoint_path, read_checkpoint
from clast.results.checkpoints.encode import classes_near
from scenes.own_state import Closer
from scenes.places import TESTS
from scenes.restarts import differences, pressed_at, run_with_closer, same
from scenes.shaken import LAWS, PROCESSES, STEPS, shaken_case

STOPPED_AT = 37
NAMES = [f"{process} {law}" for process in PROCESSES for law in LAWS]


def resumed(paths: list[Path], threads: str) -> None:
    """Go on from checkpoints in a process of its own."""
    path = os.pathsep.join([str(TESTS), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-m", "scenes.restarts", *map(str, paths)],
        env={**os.environ, "NUMBA_NUM_THREADS": threads, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Result files of whole runs, and of runs that were interrupted, with their checkpoints."""
    folder = tmp_path_factory.mktemp("restarts")
    for name in NAMES:
        case = folder / f"{name}.toml"
        case.write_text(shaken_case(*name.split()).to_toml(), "utf-8")
        settings = ["output.checkpoint_every=1e6"]
        clast.Case.from_toml(case, settings).run(output=folder / f"{name} whole.vtkhdf")
        part = clast.Case.from_toml(case, settings).run(
            output=folder / f"{name}.vtkhdf", progress=pressed_at(STOPPED_AT)
        )
        assert part.report.steps == STOPPED_AT
        assert part.checkpoint == checkpoint_path(folder / f"{name}.vtkhdf")
    run_with_closer(folder / "closer whole.vtkhdf")
    run_with_closer(folder / "closer.vtkhdf", pressed_at(STOPPED_AT))
    return folder


def again(folder: Path, tmp_path: Path) -> Path:
    """Return a copy of the interrupted runs, moved to another folder."""
    shutil.copytree(folder, tmp_path / "moved")
    return tmp_path / "moved"


def check_equal(folder: Path, name: str) -> None:
    """Compare the files and the last checkpoints of a whole run and a resumed one."""
    whole, rest = folder / f"{name} whole.vtkhdf", folder / f"{name}.vtkhdf"
    assert differences(whole, rest) == []
    assert len(read_results(rest).steps["time"]) >= STEPS
    known = classes_near([Closer("falls", 0.0)])
    ends = [read_checkpoint(checkpoint_path(path), known).run for path in (whole, rest)]
    assert same(*ends)
    assert len(ends[0].state.memory) > 10


def test_runs_go_on_in_another_process_to_the_same_bits(folder: Path, tmp_path: Path):
    moved = again(folder, tmp_path)
    names = [*NAMES, "closer"]
    resumed([checkpoint_path(moved / f"{name}.vtkhdf") for name in names], "1")
    for name in names:
        check_equal(moved, name)


@pytest.mark.slow
@pytest.mark.skipif(BY_THREADS, reason="this process has several threads itself")
def test_two_threads_go_on_to_the_same_bits(folder: Path, tmp_path: Path):
    moved = again(folder, tmp_path)
    resumed([checkpoint_path(moved / f"{name}.vtkhdf") for name in NAMES], "2")
    for name in NAMES:
        check_equal(moved, name)


def test_a_run_may_be_interrupted_time_and_again(tmp_path: Path):
    case = shaken_case("modified", "penalty")
    case.run(output=tmp_path / "whole.vtkhdf")
    part = case.run(output=tmp_path / "part.vtkhdf", progress=pressed_at(1))
    for step in (2, 15, 16, 50, 59):
        part = clast.resume(part.checkpoint, progress=pressed_at(step), model=case.model())
        assert part.report.steps == step
    rest = clast.resume(part.checkpoint)
    assert rest.report.finished
    assert differences(tmp_path / "whole.vtkhdf", tmp_path / "part.vtkhdf") == []


def test_a_later_end_makes_the_run_longer(tmp_path: Path):
    case = tmp_path / "a.toml"
    case.write_text(shaken_case("modified", "penalty").to_toml(), "utf-8")
    # with a step of 2^-9 s the last one, to the end, is no shorter by rounding
    ends = ["output.checkpoint_every=5", "time.step=0.001953125", "time.end=0.1171875"]
    clast.Case.from_toml(case, [*ends, "time.end=0.15625"]).run(output=tmp_path / "long.vtkhdf")
    short = clast.Case.from_toml(case, ends).run(output=tmp_path / "short.vtkhdf")
    assert short.report.finished
    longer = clast.resume(short.checkpoint, ["time.end=0.15625"])
    assert longer.state.time == 0.15625
    assert longer.report.steps == 80
    assert differences(tmp_path / "long.vtkhdf", tmp_path / "short.vtkhdf") == []
