"""Starts writers of result files and kills each of them at an arbitrary moment.

    python -m scenes.killed_writers FOLDER COUNT

A writer records frames as fast as it can.  For each of them one line is printed: its file and the
number of frames that it had finished writing for certain.
"""

from __future__ import annotations

import os
import random
import select
import signal
import sys
from pathlib import Path

from clast.model.model import Model
from clast.results import RunRecorder
from scenes.recorded_run import moved, step_result, three_blocks


def write_without_end(model: Model, path: Path, told: int) -> None:
    recorder = RunRecorder(model, output=path)
    recorder.start(moved(model, 0.0))
    number = 0
    while True:
        os.write(told, b".")
        number += 1
        result = step_result(model, 0.01 * number)
        recorder.step(result, 0.01)
        recorder.frame(result.state, result.contacts, result.response)


def killed_after(model: Model, path: Path, delay: float) -> int:
    """Start a writer, kill it ``delay`` seconds after its first frame; return its frames."""
    told, telling = os.pipe()
    writer = os.fork()
    if writer == 0:
        write_without_end(model, path, telling)
    os.close(telling)
    frames = len(os.read(told, 1))
    select.select([], [], [], delay)
    os.kill(writer, signal.SIGKILL)
    os.waitpid(writer, 0)
    while heard := os.read(told, 65536):
        frames += len(heard)
    os.close(told)
    return frames


def main(folder: str, count: str) -> None:
    delays = random.Random(1)
    model = three_blocks()
    step_result(model, 0.0)  # The kernels are loaded once, not by every writer.
    for number in range(int(count)):
        path = Path(folder) / f"{number}.vtkhdf"
        print(path, killed_after(model, path, 0.4 * delays.random() ** 2), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
