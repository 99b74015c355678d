"""A joint that is open at the start holds nothing; one that is closed to rounding is bonded."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

import clast
from clast.contact.candidates import SearchDistance
from clast.contact.joints.bonds import ROUNDED_GAP
from clast.model.joints import WELD_STRENGTH
from clast.model.state import initial_state
from clast.run.start_in_situ import in_equilibrium
from scenes.systems import box, contacts_of, turned

STRENGTHS: dict[str, dict[str, float]] = {
    "none": {},
    "both": {"cohesion": 1e5, "tensile_strength": 1e5},
    "cohesion": {"cohesion": 1e5},
    "tension": {"tensile_strength": 1e5},
    "weld": {"cohesion": WELD_STRENGTH, "tensile_strength": WELD_STRENGTH},
    "stiff": {"cohesion": 1e5, "tensile_strength": 1e5, "normal_stiffness": 1e10},
}
BESIDE = {
    "ceiling": lambda gap: box(-1.0, 1.0 + gap, 3.0, 1.0),
    "wall": lambda gap: box(1.0 + gap, -1.0, 1.0, 3.0),
    "corner": lambda gap: box(1.0 + 0.7 * gap, 1.0 + 0.7 * gap),
    "wedge": lambda gap: np.array([(-1, 1.0), (2, 1.0 + 3.0 * gap), (2, 3), (-1, 3)], float),
}
GAPS = [2e-4, 1e-3, 4e-3]


def beside(
    gap: float, shape: str = "ceiling", *, angle: float = 0.0, away: float = 0.0, **keys: Any
) -> clast.ModelBuilder:
    """Return a block of 1 m and a fixed one beside it, turned by ``angle``, degrees."""
    number, weight = keys.get("blocks", 1), keys.get("weight", 9.81)
    turn = np.radians(angle)
    down = turned(np.array([(0.0, -weight)]), turn)[0]
    builder = clast.ModelBuilder(gravity=tuple(down))
    builder.add_rock("rock", young=2e10, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0, **STRENGTHS[keys.get("strength", "both")])
    shift = (away, -away)
    fixed = turned(BESIDE[shape](gap), turn, shift)
    builder.block(name="fixed", vertices=fixed, fixed=True)
    for k in range(number):
        builder.block(name=f"block {k}", vertices=turned(box(0.0, -k), turn, shift))
    return builder


def static(builder: clast.ModelBuilder, **keys: Any) -> clast.Run:
    """Return the run of a static stage."""
    stages = (clast.Stage(name="rest", dynamic_ratio=0.0),)
    return builder.case(stages=stages, step=1e-2, end=1.0, **keys).run(progress=False)


CASES = [
    ("ceiling", 2e-4, "both", {}),
    ("ceiling", 4e-3, "tension", {"angle": 25.0, "blocks": 2}),
    ("wall", 2e-4, "cohesion", {"away": 1e5}),
    ("wall", 1e-3, "stiff", {"blocks": 3}),
    ("corner", 1e-3, "both", {"angle": 60.0}),
    ("ceiling", 1e-3, "weld", {}),
]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("shape", "gap", "strength", "keys"), CASES)
def test_nothing_holds_a_block_across_a_gap(
    shape: str, gap: float, strength: str, keys: dict[str, Any]
):
    run = static(beside(gap, shape, strength=strength, **keys))
    assert [one.outcome for one in run.report.stages] == ["fails"]


@pytest.mark.parametrize("process", ["convex", "open-close", "modified"])
@pytest.mark.parametrize(("shape", "gap"), list(itertools.product(BESIDE, GAPS)))
def test_blocks_without_weight_stay_where_they_are(process: str, shape: str, gap: float):
    builder = beside(gap, shape, weight=0.0, blocks=2, away=1e4)
    case = builder.case(step=2e-3, end=0.02, process=process)
    run = case.run(progress=False)
    assert np.abs(run.final.velocity).max() == 0.0
    # whatever critdis
    far = builder.case(step=2e-3, end=0.02, process=process, critdis=0.04).run(progress=False)
    assert np.abs(far.final.velocity).max() == 0.0


@pytest.mark.slow
@pytest.mark.parametrize(("angle", "away"), [(0.0, 0.0), (33.0, 1e5), (131.0, -3e5)])
@pytest.mark.parametrize("shape", ["ceiling", "wall"])
def test_a_block_hangs_on_a_closed_joint(shape: str, angle: float, away: float):
    """Coordinates with five decimals, turned, far away: no gap but that of their rounding."""
    builder = beside(2e-6, shape, angle=angle, away=away, blocks=2)
    run = static(builder)
    assert [one.outcome for one in run.report.stages] == ["equilibrium"]
    memory = run.final.memory
    own = run.model.vertex_block[memory.vertex]
    rows = (own == 0) | (memory.block == 0)
    assert memory.bonded[rows].all()
    if shape == "ceiling":
        assert -memory.normal_force[rows].sum() == pytest.approx(2 * 2500.0 * 9.81, rel=1e-6)


def test_bonds_end_where_a_wedge_opens():
    """The joint is closed at its left end alone, and that end stands for a length that is open."""
    builder = beside(1e-3, "wedge", weight=0.0)
    contacts = contacts_of(builder.build())
    assert len(contacts) > 10
    assert not contacts.bonded[contacts.length > 0.0].any()


@pytest.mark.parametrize(("share", "bonded"), [(0.9, True), (1.1, False)])
def test_what_is_closed_follows_the_size_of_the_smaller_block(share: float, bonded: bool):
    for size in (0.01, 1.0, 100.0):
        builder = clast.ModelBuilder()
        builder.add_rock("rock", young=2e10, poisson=0.2, density=2500.0)
        builder.add_joint("default", friction_angle=30.0, cohesion=1e5)
        gap = share * ROUNDED_GAP * size
        builder.block(vertices=box(-5 * size, size + gap, 10 * size, 10 * size), fixed=True)
        builder.block(vertices=box(0.0, 0.0, size, size))
        reach = SearchDistance(front=0.01 * size, depth=0.01 * size, critdis=0.01 * size)
        contacts = contacts_of(builder.build(), reach=reach)
        assert (contacts.bonded[contacts.length > 0.0] == bonded).all()


def test_a_sliding_face_takes_no_bond_across_a_step():
    """A slab slides with its cohesion beyond the end of its base; the next is 1 mm lower."""
    ended = []
    for following in (False, True):
        builder = clast.ModelBuilder(gravity=(0.0, 0.0))
        builder.add_rock("rock", young=2e10, poisson=0.0, density=2500.0)
        builder.add_joint("default", friction_angle=30.0, cohesion=1e3, tensile_strength=1e3)
        builder.block(vertices=box(-1.0, -1.0, 2.02, 1.0), fixed=True)
        if following:
            builder.block(vertices=box(1.02, -1.001, 3.0, 1.0), fixed=True)
        builder.block(name="slab", vertices=box(0.0, 0.0, 1.0, 0.2), velocity=(1.0, 0.0, 0.0))
        builder.measured_point("tip", (1.0, 0.2), block="slab")
        run = clast.simulate(builder.build(), step=1e-3, end=0.05, max_displacement=0.005)
        ended.append(run.history("tip").displacement[-1])
    assert ended[0][0] > 0.03
    assert ended[1] == pytest.approx(ended[0], abs=1e-12)


@pytest.mark.parametrize(("gap", "presses"), [(0.0, True), (2e-4, False)])
def test_in_situ_stress_does_not_press_across_a_gap(gap: float, presses: bool):
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=2e10, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.in_situ = clast.InSituStress(stress=(-1e6, -1e6, 0.0))
    for left, fixed in ((-1.0, True), (gap, False), (1.0 + 2.0 * gap, True)):
        builder.block(vertices=box(left, 0.0), fixed=fixed)
    builder.fixed_point(at=(0.5, 0.5))
    model = builder.build()
    method = builder.case(step=1e-3, end=1.0).method(model)
    state, _ = in_equilibrium(model, method, initial_state(model), 1e-3)
    assert bool((state.memory.normal_force > 0.0).any()) == presses


def test_a_joint_that_is_a_little_open_is_warned_of():
    for gap, said in ((0.0, False), (2e-4, True), (4e-3, False)):
        warnings = beside(gap).case(step=1e-3, end=1.0).examine().warnings
        found = [text for text in warnings if "across an open joint" in text]
        assert bool(found) == said
        if said:
            assert "'fixed'" in found[0]
            assert "0.0002 m apart" in found[0]
            assert "[repair] tolerance = 0.0003" in found[0]
    weak = beside(2e-4, strength="none")
    assert not [one for one in weak.case(step=1, end=1).examine().warnings if "open joint" in one]
