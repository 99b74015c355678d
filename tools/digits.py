"""Whether a change leaves the digits as they were: hashes of some 200 short runs.

A change that only moves or renames things must not change one bit of any result.  So write the
digits before it, and look afterwards:

    python tools/digits.py --write              before the change: writes build/digits.json
    python tools/digits.py --against            after it: runs all again, says what differs
    python tools/digits.py --against --only incline wall-400-5ms --threads 1

Every scene (tools/digit_scenes.py) runs by the three processes and the two contact laws, by one
thread and by two, which must agree.  A run's digest is of its last state, the contacts and their
memory, and the energy ledger and the steps from beginning to end.  What a digest cannot say, by how
much two runs differ, a few numbers beside it do.  A run that stops early counts as it stopped.

The exit status is 1 where a digest differs or the threads disagree, else 0.  Digests belong to one
machine, one environment: the file is not for the repository.  A run of two threads shares work from
800 blocks on; the scenes of 1,600 blocks are for that.

Only the public names of clast are used here; where one of them changes, change `parts_of`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from digit_scenes import SCENES, Scene

import clast

KEPT = Path(__file__).resolve().parents[1] / "build" / "digits.json"
PROCESSES = ("modified", "open-close", "convex")
LAWS = ("penalty", "augmented-lagrangian")
THREADS = (1, 2)

ENERGIES = ("kinetic", "elastic", "gravity", "contact", "fixed_points", "loads")
LOSSES = ("friction", "impacts", "numerical", "unaccounted")
MEMORY = ("vertex", "block", "edge", "gap", "normal_force", "shear_force", "multiplier", "mode")
CONTACTS = ("vertex", "edge", "mode", "normal_force", "shear_force", "position_x", "normal_x")
STEPS = ("time", "step", "contacts", "penetration", "travel")


@dataclass(frozen=True)
class Key:
    """Which run of a scene."""

    scene: str
    process: str
    law: str
    threads: int

    def __str__(self) -> str:
        return f"{self.scene} / {self.process} / {self.law} / {self.threads}"


@dataclass(frozen=True, kw_only=True)
class Digits:
    """What is kept of a run."""

    digest: str
    """Of everything in ``parts``, and of how it ended."""
    ended: str
    """"finished", "stopped", "refused" (no model or method) or "crashed"."""
    words: str
    """What a run that did not finish said; not part of the digest."""
    parts: Mapping[str, str]
    """Digest of each part, to tell where a difference is."""
    numbers: Mapping[str, float]
    """Coarse numbers, to tell how large it is; not part of the digest."""
    seconds: float
    """Wall time, s."""


# --- one run -------------------------------------------------------------------------------


def hashed(*arrays: Any) -> str:
    """Return the first 16 digits of SHA-256 of arrays, integers and truth values as 64 bits."""
    digest = hashlib.sha256()
    for one in arrays:
        values = np.asarray(one)
        kind = np.float64 if values.dtype.kind == "f" else np.int64
        digest.update(str(values.shape).encode())
        digest.update(np.ascontiguousarray(values, kind).tobytes())
    return digest.hexdigest()[:16]


def parts_of(run: clast.Run) -> dict[str, str]:
    """Return the digest of each part of what a run has computed."""
    state, touching = run.state, run.contacts()
    memory = [getattr(state.memory, name) for name in (*MEMORY, "bonded")]
    return {
        "time": hashed(state.time),
        "vertices": hashed(state.vertices),
        "velocity": hashed(state.velocity),
        "stress": hashed(state.stress),
        "rotation": hashed(state.rotation),
        "points": hashed(state.points),
        "memory": hashed(*memory),
        "contacts": hashed(*(touching[name] for name in CONTACTS)),
        "energy": hashed(*(run.energy[name] for name in (*ENERGIES, *LOSSES))),
        "steps": hashed(*(run.steps[name] for name in STEPS)),
    }


def numbers_of(run: clast.Run) -> dict[str, float]:
    """Return coarse numbers of a run."""
    ledger = run.report.ledger
    moved = np.hypot(*(run.state.vertices - run.model.vertices).T)
    return {
        "steps": run.report.steps,
        "cut": run.report.cut_steps,
        "passes": run.report.passes,
        "contacts": run.report.largest_contacts,
        "time": run.state.time,
        "moved": float(moved.max()),
        "moved_mean": float(moved.mean()),
        "penetration": run.report.largest_penetration,
        "stress": float(np.abs(run.state.stress).max()),
        "normal_force": float(run.state.memory.normal_force.sum()),
        "kinetic": ledger.kinetic,
        "friction": ledger.friction,
        "numerical": ledger.numerical,
    }


def digits_of(scene: Scene, process: str, law: str) -> Digits:
    """Return what is kept of a run; never raises for what goes wrong in it."""
    start = time.perf_counter()
    run: clast.Run | None = None
    ended, words = "finished", ""
    try:
        run = scene.case(process, law).run()
    except clast.RunStopped as stopped:
        ended, words = "stopped", str(stopped)
        run = stopped.run if isinstance(stopped.run, clast.Run) else None
    except clast.ClastError as refused:
        ended, words = "refused", str(refused)
    except Exception as crash:  # whatever a change breaks is a difference to be told
        ended, words = "crashed", f"{type(crash).__name__}: {crash}"
    parts = {} if run is None else parts_of(run)
    return Digits(
        digest=hashlib.sha256(json.dumps([ended, parts]).encode()).hexdigest()[:16],
        ended=ended,
        words=words,
        parts=parts,
        numbers={} if run is None else numbers_of(run),
        seconds=time.perf_counter() - start,
    )


def work(scenes: Sequence[str]) -> None:
    """Write the digits of scenes to standard output, a line of JSON each."""
    for scene in scenes:
        for process in PROCESSES:
            for law in LAWS:
                digits = digits_of(SCENES[scene], process, law)
                tell(json.dumps([scene, process, law, asdict(digits)]))


# --- all runs ------------------------------------------------------------------------------


def made(scenes: Sequence[str], threads: int) -> Iterator[tuple[Key, Digits]]:
    """Yield the digits of scenes as they come from a process of so many threads.

    A process that dies takes the scenes after it along; their keys are then missing.
    """
    environment = {**os.environ, "NUMBA_NUM_THREADS": str(threads)}
    command = [sys.executable, __file__, "--work", "--only", *scenes]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as worker:
        assert worker.stdout is not None
        for line in worker.stdout:
            scene, process, law, kept = json.loads(line)
            yield Key(scene, process, law, threads), Digits(**kept)
    if worker.returncode:
        tell(f"the process with {threads} threads ended with status {worker.returncode}")


def gathered(scenes: Sequence[str], threads: Sequence[int]) -> dict[Key, Digits]:
    """Return the digits of scenes by numbers of threads, telling the time of each scene."""
    found: dict[Key, Digits] = {}
    runs = len(PROCESSES) * len(LAWS)
    for count in threads:
        total = 0.0
        batch: list[Digits] = []
        for key, digits in made(scenes, count):
            found[key] = digits
            batch.append(digits)
            if len(batch) == runs:
                spent = sum(one.seconds for one in batch)
                total += spent
                ends = " ".join(one.ended[:2] for one in batch)
                steps = " ".join(f"{one.numbers.get('steps', 0):g}" for one in batch)
                tell(f"{key.scene:18s} {count} threads {spent:7.2f} s   {ends}   steps {steps}")
                batch = []
        tell(f"{'all':18s} {count} threads {total:7.2f} s")
    return found


def disagreements(found: Mapping[Key, Digits]) -> Iterator[str]:
    """Say where runs by different numbers of threads differ."""
    first: dict[tuple[str, str, str], tuple[Key, Digits]] = {}
    for key, digits in found.items():
        before = first.setdefault((key.scene, key.process, key.law), (key, digits))
        if before[1].digest != digits.digest:
            yield f"{key} differs from {before[0].threads}: {difference(before[1], digits)}"


def differences(before: Mapping[Key, Digits], after: Mapping[Key, Digits]) -> Iterator[str]:
    """Say which of the digits asked for are no longer what they were."""
    new = [key for key in after if key not in before]
    if new:
        yield f"{len(new)} runs are not in the file, the first is {new[0]}"
    for key, digits in after.items():
        if key in before and before[key].digest != digits.digest:
            yield f"{key}: {difference(before[key], digits)}"


def difference(before: Digits, after: Digits) -> str:
    """Say in which parts two runs differ, and by how much."""
    said = []
    if before.ended != after.ended:
        said.append(f"{before.ended}, now {after.ended}: {(after.words or before.words)[:200]}")
    parts = [name for name, digest in after.parts.items() if before.parts.get(name) != digest]
    if before.parts and parts:
        said.append(", ".join(parts))
    for name, now in after.numbers.items():
        was = before.numbers.get(name, 0.0)
        if was != now:
            share = abs(now - was) / max(abs(was), abs(now))
            said.append(f"{name} {was:.6g} -> {now:.6g} ({share:.1e})")
    return "; ".join(said)


def missing(
    scenes: Sequence[str], threads: Sequence[int], found: Mapping[Key, Digits]
) -> Iterator[str]:
    """Say which runs gave no digits, because their process died."""
    for count in threads:
        for scene in scenes:
            wanted = [Key(scene, process, law, count) for process in PROCESSES for law in LAWS]
            gone = sum(key not in found for key in wanted)
            if gone:
                yield f"{scene}, {count} threads: {gone} of {len(wanted)} runs gave no digits"


# --- the file ------------------------------------------------------------------------------


def write(path: Path, found: Mapping[Key, Digits]) -> None:
    """Write digits as JSON: scene -> process -> law -> threads."""
    tree: dict[str, Any] = {}
    for key, digits in found.items():
        laws = tree.setdefault(key.scene, {}).setdefault(key.process, {})
        laws.setdefault(key.law, {})[str(key.threads)] = asdict(digits)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(tree, indent=1) + "\n")


def read(path: Path) -> dict[Key, Digits]:
    """Return the digits in a file."""
    return {
        Key(scene, process, law, int(threads)): Digits(**kept)
        for scene, processes in json.loads(path.read_text()).items()
        for process, laws in processes.items()
        for law, counts in laws.items()
        for threads, kept in counts.items()
    }


def tell(text: str) -> None:
    """Write a line to standard output at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main(arguments: Sequence[str] | None = None) -> int:
    """Write digits or compare with those written; return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--write", nargs="?", type=Path, const=KEPT, metavar="FILE")
    what.add_argument("--against", nargs="?", type=Path, const=KEPT, metavar="FILE")
    what.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--only", nargs="+", choices=SCENES, default=list(SCENES), metavar="SCENE")
    parser.add_argument("--threads", nargs="+", type=int, default=THREADS, metavar="N")
    asked = parser.parse_args(arguments)
    if asked.work:
        work(asked.only)
        return 0
    if asked.against and not asked.against.exists():
        parser.error(f"there is no {asked.against}: write it first, before the change, by --write")
    before = read(asked.against) if asked.against else {}
    found = gathered(asked.only, asked.threads)
    faults = [*missing(asked.only, asked.threads, found), *disagreements(found)]
    if asked.against:
        faults += differences(before, found)
        tell(f"{len(found)} runs compared with {asked.against}")
    else:
        write(asked.write or KEPT, found)
        tell(f"{len(found)} runs written to {asked.write or KEPT}")
    for fault in faults:
        tell(fault)
    tell(f"{len(faults)} differences" if faults else "no differences")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
