"""Rockfall by two workers, one of them a thread of the driver, that is killed."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from clast.case.templates import TEMPLATES
from scenes.edited import children, until

CASE = TEMPLATES["rockfall"].replace("rocks = 200", "rocks = 3000")
COMMAND = [sys.executable, "-m", "clast", "rockfall", "rocks.toml"]
TABLES = ("paths", "blows", "stations", "barriers")


def tables(folder):
    return [(folder / f"{name}.csv").read_bytes() for name in TABLES]


def workers(process):
    commands = {one: Path(f"/proc/{one}/cmdline").read_text() for one in children(process)}
    return [one for one, command in commands.items() if "spawn_main" in command]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    (folder / "rocks.toml").write_text(CASE, "utf-8")
    subprocess.run([*COMMAND, "-o", "one", "--workers", "1"], cwd=folder, check=True)
    return tables(folder / "one")


@pytest.mark.parametrize("who", ["driver", "worker"])
def test_a_killed_rockfall_leaves_no_process_and_goes_on(whole, tmp_path, who):
    assert "rocks = 3000" in CASE
    (tmp_path / "rocks.toml").write_text(CASE, "utf-8")
    command = [*COMMAND, "-o", "killed", "--workers", "2"]
    with subprocess.Popen(command, cwd=tmp_path) as driver:
        until(lambda: len([*tmp_path.glob("killed/runs/*/*/paths.npz")]) > 3)
        there = workers(driver.pid)
        assert len(there) == 1
        os.kill(driver.pid if who == "driver" else there[0], signal.SIGKILL)
        assert driver.wait(120.0) == (-signal.SIGKILL if who == "driver" else 0)
    until(lambda: not any(Path(f"/proc/{one}").exists() for one in there), 20.0)
    if who == "driver":
        subprocess.run(command, cwd=tmp_path, check=True)
    assert tables(tmp_path / "killed") == whole
