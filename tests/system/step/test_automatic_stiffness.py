"""Automatic contact stiffness: what the process bears with its step, masses and contacts."""

import numpy as np
import pytest

import clast
from clast.model.state import initial_state
from clast.step.modified import STABILITY_LIMIT, stability_number

GRAVITY = 9.8


def brick(step: float, **keys) -> clast.Case:
    """A brick at 1 m/s on a floor with friction of 30 degrees."""
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (4, -1), (4, 0), (-1, 0)], fixed=True)
    corners = [(0, 0), (1, 0), (1, 0.5), (0, 0.5)]
    builder.block(name="brick", vertices=corners, velocity=(1.0, 0.0, 0.0))
    return builder.case(step=step, end=0.1, **keys)


@pytest.mark.parametrize("step", [2e-4, 1e-3, 4e-3])
@pytest.mark.parametrize("process", ["open-close", "modified"])
def test_a_brick_slides_by_its_friction_at_any_step(process: str, step: float):
    """v = v0 - g tan(phi) t; with 40 E the open-close process threw it back at -0.28 m/s."""
    run = brick(step, process=process).run(progress=False)
    right = 1.0 - GRAVITY * np.tan(np.radians(30.0)) * 0.1
    # friction begins within a step or two
    assert run.state.velocity[1, 0] == pytest.approx(right, abs=0.01 + 2.0 * GRAVITY * 0.58 * step)
    assert not [text for text in run.report.warnings if "p h2/m" in text]
    assert run.report.ledger.numerical < 0.05 * 1250.0


@pytest.mark.parametrize("process", ["open-close", "modified"])
def test_many_contacts_of_one_block_make_it_softer(process: str):
    """A light plate between forty posts has forty contacts: p h2/m is at its limit, not above."""
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="floor", vertices=[(-1, -1), (41, -1), (41, 0), (-1, 0)], fixed=True)
    builder.block(name="plate", vertices=[(0, 0), (40, 0), (40, 0.1), (0, 0.1)])
    for k in range(20):
        corners = [(2 * k, 0.1), (2 * k + 1, 0.1), (2 * k + 1, 9.1), (2 * k, 9.1)]
        builder.block(vertices=corners)
    case = builder.case(step=2e-3, end=1e-2, process=process)
    model = case.model()
    number = stability_number(model, case.method(model), initial_state(model), 2e-3)
    assert number <= STABILITY_LIMIT * (1.0 + 1e-9)


def test_the_longest_step_of_all_stages_counts():
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.block(name="brick", vertices=[(0, 0), (1, 0), (1, 0.5), (0, 0.5)])
    found = {}
    for steps in ((None, None), (None, 4e-3), (5e-4, 4e-3)):
        stages = [clast.Stage(name=f"s{k}", time=0.1, step=step) for k, step in enumerate(steps)]
        case = builder.case(step=1e-3, process="open-close", stages=stages)
        found[steps] = case.method(case.model()).contact_law.normal_stiffness
    assert found[None, 4e-3] == pytest.approx(found[None, None] / 16.0)
    assert found[5e-4, 4e-3] == found[None, 4e-3]


@pytest.mark.parametrize("process", ["open-close", "modified"])
def test_a_given_stiffness_that_is_too_high_is_warned_of(process: str):
    law = {"name": "penalty", "normal_stiffness": 1e11}
    case = brick(1e-3, process=process, contact_law=law)
    assert [text for text in case.examine().warnings if "p h2/m" in text]
