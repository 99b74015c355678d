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


def hung(process: str, joint: float | None, other: float | None = None) -> clast.Case:
    """A block that is welded to a ceiling, and one on a floor along a joint."""
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0, normal_stiffness=joint, shear_stiffness=joint)
    builder.add_joint("bed", friction_angle=30.0, normal_stiffness=other, shear_stiffness=other)
    builder.add_weld("weld")
    welds = ["weld"] * 4
    builder.block(vertices=[(-1, 2), (3, 2), (3, 3), (-1, 3)], edge_joint=welds, fixed=True)
    hangs = [(0, 1), (1, 1), (1, 2), (0, 2)]
    builder.block(name="hangs", vertices=hangs, edge_joint=welds)
    builder.block(name="floor", vertices=[(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
    stands = [(2, 0), (3, 0), (3, 0.25), (2, 0.25)]
    builder.block(name="stands", vertices=stands, edge_joint=["bed"] * 4)
    return builder.case(step=1e-2, end=2.0, dynamic_ratio=0.0, process=process)


def automatic(case: clast.Case) -> float:
    """Return the automatic normal stiffness of a case, N/m per m."""
    return case.method(case.model()).contact_law.normal_stiffness


@pytest.mark.parametrize(("process", "most"), [("modified", 5e9), ("open-close", 2e11)])
def test_welds_are_no_softer_than_the_softest_joint(process: str, most: float):
    # half of the size of the smallest block, of 1 m by 0.25 m
    half = 0.5 * np.sqrt(0.25)
    for soft in (1e8, 1e9):
        assert automatic(hung(process, soft, 2.0 * soft)) == pytest.approx(half * soft, rel=1e-12)
        assert automatic(hung(process, 2.0 * soft, soft)) == pytest.approx(half * soft, rel=1e-12)
    assert automatic(hung(process, 1e13, 1e13)) == most
    # joints that have the springs of the law are to settle in a step
    without = automatic(hung(process, None))
    assert without < 0.01 * half * 1e9
    assert automatic(hung(process, 1e9)) == without
    assert automatic(hung(process, None, 1e9)) == without


@pytest.mark.parametrize("process", ["modified", "open-close", "convex"])
def test_a_weld_opens_less_than_a_joint_would(process: str):
    """Two corners bear the weight; without the rule it opened by 8 mm in the other processes."""
    case = hung(process, 1e9, 1e9)
    run = case.run(progress=False)
    sunk = -run.block("hangs").displacement[-1, 1]
    weight, stiffness = 2500.0 * GRAVITY, automatic(case)
    # half a block's stretch beside the springs
    assert sunk == pytest.approx(weight / (2.0 * stiffness) + weight / (4.0 * 5e9), rel=0.05)
    assert sunk < 2.1 * weight / 1e9
