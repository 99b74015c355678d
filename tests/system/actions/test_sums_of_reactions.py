"""Reactions, weights and loads of the templates with motions add up to mass times acceleration."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast
from clast.case.templates import TEMPLATES
from clast.results import Run

EACH_STEP = "output.every=1e-6"
MOVING: dict[str, list[str]] = {
    "settling-wall": [
        "time.end=0.12",
        "amplitude.settlement.time=[0.0, 0.02, 2.0]",
        "motion.1.ease=0.02",
    ],
    "spreading-arch": [
        "time.end=0.12",
        "amplitude.spread.time=[0.0, 0.02, 2.4]",
        "motion.1.ease=0.02",
    ],
    "shear-box": ["time.end=0.06", "amplitude.way.time=[0.0, 0.02, 1.2]"],
}
"""Settings by which the supports of a template move before its end."""
MOVED = {
    "settling-wall": "soft",
    "spreading-arch": "right abutment",
    "shear-box": "upper half",
}
"""Block whose motion is prescribed."""
PROCESSES = {
    "convex": ['method.process="convex"', 'method.contact_law="penalty"'],
    "open-close": ['method.process="open-close"', 'method.contact_law="augmented-lagrangian"'],
    # one pass throws what the servo of the shear box presses
    "modified": ['method.process={name="modified", passes=8}'],
}


def course(name: str, settings: list[str]) -> tuple[Run, Any, Any, Any]:
    """Return a run of a template, its steps (k,), reactions and weight (k, 2), N/m, and momenta.

    Momenta (k, 2), N s/m, are of the free blocks at the end of each step.
    """
    case = clast.Case.from_text(TEMPLATES[name], name, [*MOVING[name], *settings, EACH_STEP])
    run = case.run()
    fixed, moved = run.reaction("fixed blocks"), run.reaction(run.reaction_name[1])
    free = ~run.model.fixed
    mass = run.model.mass[free, None]
    borne = fixed.force + moved.force + (mass * run.model.gravity).sum(axis=0)
    momenta = [
        (mass * run.field("velocity", k)[free, :2]).sum(axis=0) for k in range(len(run.times))
    ]
    # a convex static run takes several steps at one instant, of which the last is in balance
    last = np.searchsorted(fixed.time, run.times, side="right") - 1
    assert fixed.time[last] == pytest.approx(run.times, abs=0.0)
    return run, np.diff(run.times), borne[last[1:]], np.array(momenta)


@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.parametrize("name", MOVING)
def test_what_moves_is_driven_by_the_sum_of_all_forces(name: str, process: str):
    run, steps, borne, momenta = course(name, [*PROCESSES[process], "time.dynamic_ratio=1"])
    acting = np.abs(run.reaction("fixed blocks").force).max()
    driven = np.diff(momenta, axis=0) / steps[:, None]
    assert np.abs(driven[2:]).max() > 1e-6 * acting
    assert np.abs(borne - driven).max() < 1e-9 * acting
    moved = run.block(MOVED[name])
    assert np.abs(moved.displacement[-1]).max() > 1e-4


@pytest.mark.parametrize("process", PROCESSES)
def test_a_static_step_starts_from_rest(process: str):
    run, steps, borne, momenta = course("settling-wall", PROCESSES[process])
    acting = np.abs(run.reaction("fixed blocks").force).max()
    # a convex run is in balance where time goes on, the others are driven from rest in each step
    driven = 0.0 if process == "convex" else momenta[1:] / steps[:, None]
    # the last step is cut where time ends, but not the inertia of its blocks
    assert np.abs(borne - driven)[:-1].max() < 1e-9 * acting
    measured = run.reaction("firm part").force
    assert measured == pytest.approx(run.reaction("fixed blocks").force, abs=1e-12 * acting)
