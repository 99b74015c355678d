"""Threads that a command is asked for: the kernels of several are compiled first."""

import os
import subprocess
import sys

from clast.case.templates import INCLINE
from clast.results import read_results

SHORT = ["--set", "time.end=0.005", "--set", "output.every=0.001"]


def test_threads_are_asked_for_and_change_nothing(tmp_path):
    """The kernels of the process that runs the case take their number from the option."""
    case = tmp_path / "incline.toml"
    case.write_text(INCLINE, "utf-8")
    found = []
    for number in ("1", str(min(2, os.cpu_count() or 1))):
        file = tmp_path / f"{number}.vtkhdf"
        command = [sys.executable, "-m", "clast", "run", str(case), *SHORT, "-q"]
        done = subprocess.run([*command, "--threads", number, "-o", str(file)], check=False)
        assert done.returncode == 0
        found.append(read_results(file).energy)
    for name, values in found[0].items():
        assert (values == found[-1][name]).all()
