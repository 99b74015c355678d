"""The paper's process on a wall and a heap: to the end, or stopped with its results kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from clast.block import polygon
from clast.case.case_file import Case
from clast.errors import RunStopped
from clast.results import Run
from scenes.brick_wall import listed_wall
from scenes.places import CASES

WALL = listed_wall(10, 10)
"""Bricks of 1 m x 0.5 m in running bond."""
HEAP = CASES / "heap.toml"


def run(case: Path | str, process: str, integrator: str, stiffness: str, *settings: str) -> Run:
    """Run a case, in a file or as text, with the process, scheme and stiffness given."""
    return Case.from_toml(
        case,
        [
            f"method.process={process}",
            f'method.integrator="{integrator}"',
            f'method.contact_law={{name="penalty", normal_stiffness={stiffness}}}',
            *settings,
        ],
    ).run()


def area_error(done: Run) -> float:
    """Return the largest relative change of a block's area."""
    area = polygon.moments(done.state.vertices, done.model.block_start)[0]
    return float(np.abs(area / done.model.area - 1.0).max())


@pytest.mark.parametrize("integrator", ["constant-acceleration", "backward-euler"])
def test_brick_wall_runs_to_the_end(integrator: str) -> None:
    # p h2/m = 4; at twice that, beyond the limit of 6, round-off decides what becomes of the wall
    done = run(WALL, '{name="modified", passes=6}', integrator, "5e8", "time.end=0.2")
    assert done.report.finished
    assert area_error(done) < 1e-3
    assert np.isfinite(done.state.vertices).all() and np.isfinite(done.state.stress).all()
    # constant acceleration keeps the wall ringing and creeping: 2.3 mm here, none with convex
    assert np.abs(done.state.vertices - done.model.vertices).max() < 0.01


@pytest.mark.parametrize("integrator", ["constant-acceleration", "backward-euler"])
def test_heap_of_64_falling_squares_runs_to_the_end(integrator: str) -> None:
    settings = ("time.end=1.2", "time.step=2e-3", "time.max_displacement=0.02")
    done = run(HEAP, '{name="modified", passes=6}', integrator, "5e8", *settings)
    assert done.report.finished
    assert done.report.largest_contacts > 60
    assert area_error(done) < 1e-3
    assert np.isfinite(done.state.vertices).all() and np.isfinite(done.state.stress).all()


def test_one_pass_that_cannot_says_so_and_keeps_what_it_has() -> None:
    with pytest.raises(RunStopped) as stopped:
        run(WALL, '"modified"', "constant-acceleration", "2e10", "time.end=0.5")
    kept = stopped.value.run
    assert isinstance(kept, Run)
    assert 0.0 < kept.state.time < 0.5
    assert not kept.report.finished
    assert "p h2/m" in " ".join(kept.report.warnings)
    assert "normal_stiffness" in str(stopped.value)
    assert np.isfinite(kept.state.vertices).all()
