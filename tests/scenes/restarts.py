"""Runs that are interrupted, and go on in another process.

    python -m scenes.restarts CHECKPOINT ...

goes on from each checkpoint; those of runs with an action of a script are given their model again.
"""

from __future__ import annotations

import dataclasses
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

import clast
from clast.model.model import Model
from clast.results import Run
from clast.results.open_file import ask
from scenes.own_state import Closer
from scenes.shaken import STEP, STEPS, shaken

TIMED = ("wall_seconds", "report/json")
"""What of a result file tells of wall time."""


def pressed_at(step: int) -> Callable[[Any], None]:
    """Return what interrupts a run after a step."""

    def watch(at: Any) -> None:
        if at.steps == step:
            signal.raise_signal(signal.SIGINT)

    return watch


def with_closer() -> Model:
    """Return the shaken bricks with an action of a script."""
    builder = shaken()
    builder.actions.append(Closer("falls", 2e3))
    return builder.build()


def run_with_closer(output: Path, progress: bool | Callable[[Any], None] = False) -> Run:
    """Return a run of bricks with the action of a script."""
    return clast.simulate(
        with_closer(),
        step=STEP,
        end=STEPS * STEP,
        every=7.5 * STEP,
        output=output,
        progress=progress,
        checkpoint_every=1e6,
    )


def content(path: Path) -> dict[str, Any]:
    """Return all datasets and attributes of a result file but for those of wall time, as bytes."""

    def read(file: Any) -> dict[str, Any]:
        found: dict[str, Any] = {}

        def visit(name: str, thing: Any) -> None:
            if isinstance(thing, h5py.Dataset):
                values = thing[()]
                found[name] = (
                    values
                    if isinstance(values, bytes)
                    else (
                        values.dtype.str,
                        values.shape,
                        values.tolist() if values.dtype.hasobject else values.tobytes(),
                    )
                )
            for key, value in thing.attrs.items():
                found[f"{name} {key}"] = np.asarray(value).tolist()

        file.visititems(visit)
        return found

    everything = ask(path, read)
    return {key: value for key, value in everything.items() if not key.endswith(TIMED)}


def differences(one: Path, other: Path) -> list[str]:
    """Return the names of what differs in two result files."""
    first, second = content(one), content(other)
    return sorted(key for key in {*first, *second} if first.get(key) != second.get(key))


def same(one: object, other: object) -> bool:
    """Return whether two records hold the same bits, wall times apart."""
    if dataclasses.is_dataclass(one):
        names = [entry.name for entry in dataclasses.fields(one) if entry.name != "seconds"]
        pairs = ((getattr(one, name), getattr(other, name)) for name in names)
        return type(one) is type(other) and all(same(*pair) for pair in pairs)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, np.ndarray):
        return (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    return bool(one == other)


def main(*paths: str) -> None:
    for path in paths:
        model = with_closer() if "closer" in Path(path).name else None
        run = clast.resume(path, model=model)
        assert run.report.finished


if __name__ == "__main__":
    main(*sys.argv[1:])
