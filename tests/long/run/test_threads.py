"""Threads share the work of large systems and change nothing, to the last bit.

Loops are compiled for threads only in a process that has more than one, so the same runs are made
here, by one thread, and in a process of two.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from hashlib import sha256
from typing import Any

import numpy as np
import pytest

import clast
from benchmarks.scenes import slope_of
from clast.compute.jit import BY_THREADS
from clast.compute.parallel import BLOCKS, CONTACTS
from clast.model.model import Model
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from scenes.places import ROOT, TESTS
from scenes.systems import box, by_convex, courses_of_bricks, heap, wall

YOUNG = 5e9

ROUGH = {
    "law": "barton-bandis",
    "jrc": 8.0,
    "jcs": 50e6,
    "residual_friction_angle": 27.0,
    "sample_length": 0.5,
}
WORN = {
    "friction_angle": 30.0,
    "residual_friction_angle": 20.0,
    "slip_weakening": 1e-4,
    "cohesion": 1e4,
    "residual_cohesion": 0.0,
    "dilation_angle": 5.0,
    "kinetic_friction_angle": 18.0,
    "critical_speed": 0.01,
}
"""Keys of joints whose strength depends on sliding."""


def worn_wall(joint: dict[str, Any]) -> Model:
    """Return a wall of 1,000 bricks along such joints, pushed aside by its weight."""
    builder = clast.ModelBuilder(gravity=(6.0, -9.8))
    builder.add_rock("rock", young=YOUNG, poisson=0.2, density=2600.0)
    builder.add_joint("default", **joint)
    bricks = courses_of_bricks(25, 40, bonded=True)
    for number, outline in enumerate([box(-1.0, -1.0, 42.0, 1.0), *bricks]):
        builder.block(name=f"{number}", vertices=outline, fixed=number == 0)
    return builder.build()


SCENES: dict[str, tuple[Callable[[], Model], float, float, int]] = {
    "wall": (lambda: wall(25, 40), YOUNG, 5e-3, 4),
    "stiff slope": (lambda: slope_of(1000), 50.0 * YOUNG, 1e-3, 2),
    "heap": (lambda: heap(900, 30), YOUNG, 5e-3, 160),
    "rough joints": (lambda: worn_wall(ROUGH), YOUNG, 2e-3, 6),
    "worn joints": (lambda: worn_wall(WORN), YOUNG, 2e-3, 6),
}
"""Model, normal stiffness in N/m per m, step in s, number of steps."""


def digits(name: str) -> dict[str, str]:
    """Return hashes of what a run leaves, by what they are of, and its number of contacts."""
    build, stiffness, step, steps = SCENES[name]
    method = replace(by_convex(stiffness), max_displacement=0.1)
    end = step * steps
    run = simulate(build(), method, Schedule(step=step, end=end, every=end))
    kept = {**vars(run.state), **vars(run.state.memory), **run.energy, **run.contacts()}
    hashes = {
        name: sha256(np.ascontiguousarray(values).tobytes()).hexdigest()
        for name, values in kept.items()
        if isinstance(values, np.ndarray)
    }
    return {**hashes, "blocks": run.model.block_count, "contacts": run.report.largest_contacts}


def threads_used() -> list[int]:
    """Return by how many threads a small run works, and a large one."""
    from clast.compute.parallel import numba

    seen: list[int] = []
    for model in (wall(3, 3), wall(25, 40)):
        schedule = Schedule(step=1e-3, end=1e-3, every=1e-3)
        simulate(
            model, by_convex(YOUNG), schedule, watch=lambda _: seen.append(numba.get_num_threads())
        )
    return [*seen, numba.get_num_threads()]


@pytest.fixture(scope="module")
def by_two():
    """What a process of two threads finds."""
    if BY_THREADS:
        pytest.skip("this process has several threads itself")
    done = subprocess.run(
        [sys.executable, __file__],
        env={**os.environ, "NUMBA_NUM_THREADS": "2", "PYTHONPATH": f"{ROOT}{os.pathsep}{TESTS}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_same_bits_by_one_thread_and_by_two(name, by_two):
    one = digits(name)
    assert one["blocks"] >= BLOCKS.many
    assert one["contacts"] >= (100 if name == "heap" else CONTACTS.many)
    assert len(one) > 20
    assert by_two[name] == one


@pytest.mark.slow
def test_few_blocks_are_left_to_one_thread(by_two):
    """Calling others for what takes microseconds would make a small run slower."""
    assert by_two["threads"] == [1, 2, 2]


if __name__ == "__main__":
    print(json.dumps({"threads": threads_used(), **{name: digits(name) for name in SCENES}}))
