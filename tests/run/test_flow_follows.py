"""Flow in joints whose apertures are those of the equilibrium that it presses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clast
from clast.model.flow.apertures import at_start, hydraulic, of_blocks
from clast.run.flow_warnings import flow_warnings
from clast.verification.problems.water.flow_follows import (
    FLOW,
    STIFFNESS,
    at_rest,
    model_of,
    through,
    water_of,
)
from scenes.restarts import pressed_at
from scenes.two_lakes import lakes, rock

pytestmark = pytest.mark.filterwarnings("ignore::clast.RunWarning")


@pytest.fixture(scope="module")
def followed() -> clast.Run:
    return at_rest(model_of(50))


def test_flow_that_does_not_follow_is_that_of_apertures_at_the_start(followed):
    still = at_rest(replace(model_of(50), flow=replace(model_of(50).flow, coupling="none")))
    assert through(still) > 10.0 * FLOW > 9.0 * through(followed)


def test_the_end_tells_how_well_flow_and_apertures_agree(followed):
    (event,) = [one for one in followed.report.events if one.kind == "flow agrees"]
    water = water_of(followed)
    assert event.text.endswith(f"after {water.passes + 1} equilibria")
    assert 0.0 < water.left < 1e-4
    assert f"{water.left:.2g}" in event.text


def test_apertures_that_change_too_much_from_one_channel_to_the_next_are_told_once(followed):
    water, state = water_of(followed), followed.state
    for share, many in ((0.6, 0), (0.4, 1)):
        narrow = np.isin(water.network.block.max(axis=1), (20, 30))[:, None]
        aperture = np.where(narrow, share * water.aperture, water.aperture)
        other = replace(state, actions=(replace(water, aperture=aperture),))
        told = [one for one in flow_warnings(followed.model, other) if "times as wide" in one]
        assert len(told) == many
    # that of the 30th column, where the joint falls off more
    assert told[0].startswith("flow: at (5.8, 0) a joint is 2.5")
    assert "shorter blocks" in told[0]


def test_steps_that_take_many_linear_systems_are_told(followed):
    water, state = water_of(followed), followed.state
    slow = replace(state, actions=(replace(water, hardest=140),))
    assert [one for one in flow_warnings(followed.model, slow) if "took 140 linear systems" in one]
    assert not list(flow_warnings(followed.model, state))


def test_apertures_are_those_of_the_forces_of_contacts(followed):
    """E = a0 - N/(k_n L), with N of the contacts on the length of joint that each stands for."""
    water, memory = water_of(followed), followed.state.memory
    pressure = water.solved.pressure[water.network.node].mean(axis=1)
    width = water.network.length
    block = water.network.block.max(axis=1)
    for column in block.tolist():
        mine = (followed.model.vertex_block[memory.vertex] == column) | (memory.block == column)
        closed = memory.normal_force[mine & (memory.normal_force > 0.0)].sum()
        row = int(np.flatnonzero(block == column)[0])
        aperture = model_of(50).joint_table.joints[1].aperture_without_stress
        expected = aperture - closed / (STIFFNESS * width[row])
        assert water.aperture[row] == pytest.approx(expected, rel=1e-3), pressure[row]


@pytest.mark.parametrize(
    ("given", "steps", "same"),
    [
        ({"angle": 37.0}, {}, 1e-6),
        ({"mirrored": True}, {}, 1e-9),
        ({"order": np.random.default_rng(3).permutation(50)}, {}, 1e-9),
        ({}, {"step": 0.03}, 1e-6),
    ],
    ids=["turned", "mirrored", "renumbered", "stepped otherwise"],
)
def test_the_flow_is_the_same(followed, given, steps, same):
    assert through(at_rest(model_of(50, **given), **steps)) == pytest.approx(
        through(followed), rel=same
    )


JOINT = "cohesion = 1e6\ntensile_strength = 1e6\nnormal_stiffness = 2e9\nshear_stiffness = 1e9\n"
STAGES = """
[in_situ]
vertical = "overburden"
k0 = 0.8
[[stage]]
name = "before"
[[stage]]
name = "dug"
excavate = ["tunnel"]
"""


def staged() -> clast.Case:
    text = rock(end=1.0, joint=JOINT) + lakes(9.0, 'coupling = "steady"') + STAGES
    return clast.Case.from_text(text, "case")


def test_flow_follows_each_stage_and_goes_on_from_a_checkpoint(tmp_path):
    run = staged().run(output=tmp_path / "run.vtkhdf")
    told = [one for one in run.report.events if one.kind == "flow agrees"]
    assert [one.stage for one in told] == ["before", "dug"]
    water, model = water_of(run), run.model
    assert 0.0 < water.left < 1e-4
    found = hydraulic(model, water.network, of_blocks(model, water.network, run.state.vertices))
    assert found == pytest.approx(water.aperture, rel=1e-4)
    start = hydraulic(model, water.network, at_start(model, water.network))
    assert np.abs(found / start - 1.0).max() > 0.05
    steps = run.report.stages[0].steps + 9  # between two equilibria of the second stage
    part = staged().run(output=tmp_path / "part.vtkhdf", progress=pressed_at(steps))
    again = clast.resume(part.checkpoint)
    np.testing.assert_array_equal(again.state.vertices, run.state.vertices)
    np.testing.assert_array_equal(again.flow().rows, run.flow().rows)


def test_a_flow_without_an_equilibrium_to_follow_is_refused():
    with pytest.raises(clast.ModelError, match=r"follows equilibria.*none"):
        at_rest(model_of(4), dynamic_ratio=1.0)
