"""A run with a live page, started as a user does, to be killed."""

import subprocess
import sys
from contextlib import contextmanager

from clast.case.templates import TEMPLATES


@contextmanager
def live_command(folder):
    """Yield the process of a long ``clast run --live`` in a folder, and the address of its page."""
    (folder / "block.toml").write_text(TEMPLATES["incline"], encoding="utf-8")
    keys = ["--set", "time.end=1000", "--set", "output.every=0.1"]
    run = subprocess.Popen(
        [sys.executable, "-m", "clast", "run", "block.toml", *keys, "--live"],
        cwd=folder,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield run, next(line for line in run.stderr if "live: " in line).split("live: ")[1].strip()
    finally:
        run.kill()
        run.wait()  # its page, which has the same pipe, stays while a browser looks
