"""The unbalanced force of steps: kept in stages, and found again in files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import clast
from clast.pictures.histories import histories_of

STAGES = [
    clast.Stage(name="rest", dynamic_ratio=0.0),
    clast.Stage(name="later", until="time", time=0.02),
]


def brick() -> clast.ModelBuilder:
    builder = clast.ModelBuilder(title="Brick")
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="table", vertices=[(-2, -1), (2, -1), (2, 0), (-2, 0)], fixed=True)
    builder.block(name="brick", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    return builder


@pytest.fixture(scope="module")
def staged(tmp_path_factory: pytest.TempPathFactory) -> clast.Run:
    path = tmp_path_factory.mktemp("staged") / "brick.vtkhdf"
    return clast.simulate(brick(), step=1e-3, end=0.5, output=path, stages=STAGES)


def test_each_step_of_a_stage_has_the_force_that_it_was_judged_by(staged: clast.Run):
    force = staged.steps["unbalanced"]
    assert np.isfinite(force).all() and force[0] > force[-1] >= 0.0
    ends = np.cumsum([one.steps for one in staged.report.stages])
    for stage, end in zip(staged.report.stages, ends, strict=True):
        assert force[end - 1] == stage.force_ratio
    assert staged.output is not None
    again = clast.read(staged.output)
    np.testing.assert_array_equal(again.steps["unbalanced"], force)


def test_runs_without_stages_have_none(tmp_path: Path):
    run = clast.simulate(brick(), step=1e-3, end=5e-3, output=tmp_path / "brick.vtkhdf")
    assert np.isnan(run.steps["unbalanced"]).all()
    assert all(one.title != "Unbalanced force" for one in histories_of(run))
