"""Runs that are killed at arbitrary moments lose nothing before their checkpoint."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

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
