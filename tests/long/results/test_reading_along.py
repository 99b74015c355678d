"""Results are read while their run writes them: every time, and without a change to the file."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from clast.results import locks, read_results, summary
from scenes.places import TESTS
from scenes.recorded_run import moved, record, three_blocks

WRITER = """
import sys
sys.path.insert(0, sys.argv[2])
from scenes.recorded_run import moved, step_result, three_blocks
from clast.results import RunRecorder
model = three_blocks()
recorder = RunRecorder(model, output=sys.argv[1])
recorder.start(moved(model, 0.0))
for number in range(1, 100_000):
    result = step_result(model, 0.01 * number)
    recorder.step(result, 0.01)
    recorder.frame(result.state, result.contacts, result.response)
"""
READINGS = 30


@pytest.mark.skipif(os.name != "posix", reason="needs the locks of POSIX systems")
def test_a_file_is_read_at_any_moment_while_it_is_written(tmp_path: Path):
    path, model = tmp_path / "out.vtkhdf", three_blocks()
    command = [sys.executable, "-c", WRITER, str(path), str(TESTS)]
    writer = subprocess.Popen(command)
    try:
        give_up = time.monotonic() + 60.0
        while not path.exists() and time.monotonic() < give_up:
            time.sleep(0.01)
        seen = []
        for _ in range(READINGS):
            results = read_results(path)
            summary(results)
            state = moved(model, results.times[-1])
            np.testing.assert_allclose(results.vertices(-1), state.vertices, atol=1e-12)
            seen.append(len(results.times))
        assert writer.poll() is None
    finally:
        writer.kill()
        writer.wait()
    assert seen == sorted(seen)
    assert len(set(seen)) > READINGS // 4, "the writer went on"


@pytest.mark.skipif(os.name != "posix", reason="needs the locks of POSIX systems")
def test_a_reader_that_never_ends_does_not_hold_up_a_run(tmp_path: Path):
    path = record(three_blocks(), tmp_path / "out.vtkhdf").run.output
    with path.open("r+b", buffering=0) as run, path.open("rb", buffering=0) as reader:
        with locks.reading(reader):
            start = time.monotonic()
            with locks.changing(run, patience=0.05):
                waited = time.monotonic() - start
        assert 0.04 < waited < 5.0
        with locks.changing(run), path.open("rb", buffering=0) as other, locks.reading(other):
            assert time.monotonic() - start > waited
