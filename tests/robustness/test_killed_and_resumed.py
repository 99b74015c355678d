"""Runs that are killed at arbitrary moments lose nothing before their checkpoint."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import clast
from clast.case.templates import TEMPLATES
from clast.results.checkpoints.checkpoint_files import checkpoint_path
from scenes.restarts import differences

KILLS = 8
"""``python -m scenes.killed_runs FOLDER 50 SEED`` makes as many as one likes."""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="runs are killed by POSIX signals")
def test_killed_runs_go_on_and_end_with_the_same_bits(tmp_path: Path):
    done = subprocess.run(
        [sys.executable, "-m", "scenes.killed_runs", str(tmp_path), str(KILLS), "1"],
        cwd=Path(__file__).parents[1],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["lost"] == []
    assert found["kills"] == KILLS
    assert found["ended"] >= 1


KILLED = """
import os, signal, sys
from pathlib import Path
import clast
from clast.results.checkpoints.checkpoint_files import checkpoint_path

def watch(at):
    if checkpoint_path(Path(sys.argv[2])).exists() and at.steps >= 12:
        os.kill(os.getpid(), signal.SIGKILL)

clast.Case.from_toml(sys.argv[1]).run(output=sys.argv[2], progress=watch)
"""
"""A run that is killed while the foundation settles, with a checkpoint behind it."""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="runs are killed by POSIX signals")
@pytest.mark.parametrize("law", ["penalty", "augmented-lagrangian"])
@pytest.mark.parametrize("process", ["open-close", "modified"])
def test_a_settling_wall_goes_on_to_the_bit_after_a_kill(tmp_path: Path, process: str, law: str):
    settings = [
        "time.end=0.2",
        "amplitude.settlement.time=[0.0, 0.05, 2.0]",
        "output.every=0.025",
        "output.checkpoint_every=1e-9",
        f"method.process={process}",
        f"method.contact_law={law}",
    ]
    case = clast.Case.from_text(TEMPLATES["settling-wall"], "wall", settings)
    text, whole, part = (tmp_path / name for name in ("wall.toml", "whole.vtkhdf", "part.vtkhdf"))
    text.write_text(case.to_toml(), "utf-8")
    clast.Case.from_toml(text).run(output=whole)
    done = subprocess.run(
        [sys.executable, "-c", KILLED, text, part], cwd=Path(__file__).parents[1], check=False
    )
    assert done.returncode == -signal.SIGKILL
    run = clast.resume(checkpoint_path(part))
    assert run.report.finished and run.block("soft").displacement[-1, 1] < -1e-3
    assert differences(whole, part) == []
