"""Runs in other processes, started before and after a run in this one, by one thread and by two.

Each scene is a script of its own with a limit of time: what is looked for is a process that hangs.
"""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
from pathlib import Path

import pytest

from scenes.places import TESTS

LIMIT = 400.0
"""Time after which a script hangs, s: one that finds no kernel on disk compiles for some 100."""

SCRIPT = """
import concurrent.futures, multiprocessing, sys
import clast
from clast.case.templates import INCLINE
from clast.run.schedule import Schedule
from clast.run.simulate import simulate


def run(end):
    return clast.Case.from_toml(INCLINE, [f"time.end={end}"]).run().report.steps


def shared(steps):
    "Work that threads share: a system of more than 800 blocks."
    from scenes.systems import by_convex, wall
    schedule = Schedule(step=1e-3, end=1e-3 * steps, every=1.0)
    return simulate(wall(25, 40), by_convex(5e9), schedule).state.vertices.tobytes()


def by_pool(context, task, given):
    with context.Pool(2) as pool:
        return pool.map(task, given)


def by_executor(context, task, given):
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as executor:
        return list(executor.map(task, given))


if __name__ == "__main__":
    method, way = sys.argv[1:]
    context, start = multiprocessing.get_context(method), {"pool": by_pool, "executor": by_executor}
    ends = [0.002, 0.003]
    if method == "fork":
        assert start[way](context, run, ends) == [2, 3], "before a run"
    here = shared(2)
    if method == "fork":
        assert start[way](context, run, ends) == [2, 3], "after a run"
    assert start[way](context, shared, [2]) == [here], "of many blocks"
    assert shared(2) == here, "the parent goes on"
    print("done")
"""


def finish(script: str, *arguments: str, threads: int, folder: Path) -> str:
    """Run a script in a process of its own; return what it printed."""
    file = folder / "script.py"
    file.write_text(script, encoding="utf-8")
    here = str(TESTS)
    done = subprocess.run(
        [sys.executable, str(file), *arguments],
        env={**os.environ, "NUMBA_NUM_THREADS": str(threads), "PYTHONPATH": here},
        capture_output=True,
        text=True,
        check=False,
        timeout=LIMIT,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="needs fork")
@pytest.mark.parametrize(("way", "threads"), [("pool", 1), ("executor", 2)])
def test_forked_processes_run_before_and_after(tmp_path, way, threads):
    assert finish(SCRIPT, "fork", way, threads=threads, folder=tmp_path) == "done\n"


@pytest.mark.slow
def test_processes_of_their_own_run_after_a_run(tmp_path):
    assert finish(SCRIPT, "spawn", "executor", threads=2, folder=tmp_path) == "done\n"
