"""A run that is killed at arbitrary moments, and goes on from its checkpoint after each kill.

    python -m scenes.killed_runs FOLDER KILLS SEED

Runs write checkpoints as fast as they can.  After each kill it is checked that the result file is
readable to the last frame that was written for certain, and that nothing before the checkpoint is
lost; a run that comes to its end is compared with one that was never killed, and begun again.
Prints one line of JSON: how many kills there were, and when.
"""

from __future__ import annotations

import json
import os
import random
import select
import shutil
import signal
import sys
from dataclasses import dataclass, field
from pathlib import Path

import clast
from clast.results import read_results
from clast.results.checkpoints.checkpoint_files import checkpoint_path, read_checkpoint
from clast.results.output import hidden
from scenes.restarts import differences
from scenes.shaken import shaken_case

EVERY = 1e-9
"""Wall time between checkpoints, s: after every step."""


@dataclass
class Kills:
    """What the kills came to."""

    kills: int = 0
    in_checkpoint: int = 0
    """Kills that cut off the writing of a checkpoint."""
    before_checkpoint: int = 0
    """Kills before the first checkpoint: the run was begun again."""
    ended: int = 0
    """Runs that reached their end, each the same as one that was never killed."""
    lost: list[str] = field(default_factory=list)
    """What was lost, or could not be read."""


def run_on(case: clast.Case, output: Path, told: int) -> None:
    """Begin a run, or go on from its checkpoint; tell of every step."""

    def watch(at: object) -> None:
        os.write(told, b".")

    checkpoint = checkpoint_path(output)
    if checkpoint.exists():
        clast.resume(checkpoint, progress=watch)
    else:
        case.run(output=output, progress=watch)


def killed_after(case: clast.Case, output: Path, delay: float) -> bool:
    """Have a process go on, and kill it ``delay`` s after its first step; False if it ended."""
    told, telling = os.pipe()
    process = os.fork()
    if process == 0:
        os.close(told)
        status = 1
        try:
            run_on(case, output, telling)
            status = 0
        finally:
            os._exit(status)
    os.close(telling)
    os.read(told, 1)
    select.select([], [], [], delay)
    os.kill(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    os.close(told)
    if os.WIFEXITED(status) and os.WEXITSTATUS(status):
        raise RuntimeError("a run failed that was not killed")
    return os.WIFSIGNALED(status)


def look(output: Path, before: int, found: Kills) -> int:
    """Read what a kill has left; return the frames that must be there after the next."""
    checkpoint = checkpoint_path(output)
    found.in_checkpoint += hidden(checkpoint).exists()
    if not checkpoint.exists():
        found.before_checkpoint += 1
        return before
    held = read_checkpoint(checkpoint, {})
    results = read_results(output)
    frames = len(results.times)
    if frames < held.recorded.frames or held.recorded.frames < before:
        found.lost.append(f"{frames} frames, {held.recorded.frames} at the checkpoint, {before}")
    for frame in range(frames):
        results.vertices(frame)
        results.contacts(frame)
    if len(results.energy["time"]) < int(held.recorded.frame["instants"][0]):
        found.lost.append("energies")
    return held.recorded.frames


def main(folder: str, kills: str, seed: str) -> None:
    chance, found = random.Random(int(seed)), Kills()
    text = shaken_case("modified", "penalty").to_toml()
    case = clast.Case.from_text(text, "case", [f"output.checkpoint_every={EVERY}"])
    whole, part = Path(folder) / "whole.vtkhdf", Path(folder) / "part.vtkhdf"
    took = case.run(output=whole).report.wall_seconds
    shutil.copy(checkpoint_path(whole), Path(folder) / "whole.h5")
    frames = 0
    while found.kills < int(kills):
        if killed_after(case, part, 0.6 * took * chance.random()):
            found.kills += 1
            frames = look(part, frames, found)
            continue
        found.ended += 1
        found.lost += differences(whole, part)
        frames = 0
        part.unlink()
        checkpoint_path(part).unlink()
    run_on(case, part, os.open(os.devnull, os.O_WRONLY))
    found.ended += 1
    found.lost += differences(whole, part)
    print(json.dumps(vars(found)))


if __name__ == "__main__":
    main(*sys.argv[1:])
