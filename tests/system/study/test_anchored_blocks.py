"""Factors of safety of anchored blocks against limit equilibrium.

A block of weight W on a plane of dip a, with friction phi, and an anchor of force T at an angle b
to the plane:  F = (W cos a + T sin b) tan phi/(W sin a - T cos b).
"""

from __future__ import annotations

import math

import pytest

import clast
from clast.inputs.stages import StageTable
from scenes.anchored import JACKED, ONE_BOLT, WEIGHT, anchored, exact

REST, LATER = (
    clast.Stage(name="rest", dynamic_ratio=0.0),
    clast.Stage(name="later", dynamic_ratio=0.0),
)


@pytest.mark.parametrize(
    ("kind", "per_metre"),
    [
        ({**ONE_BOLT, "pretension": 3e5}, 1e5),
        ({"stiffness": 1e7, "pretension": 1e5}, 1e5),
        ({**ONE_BOLT, "pretension": 4.5e5, "yield_force": 9e5}, 1.5e5),
    ],
)
@pytest.mark.parametrize(
    "view", [{}, {"side": -1.0}, {"dip": 50.0, "friction": 55.0, "angle": 40.0}]
)
def test_a_jacked_anchor_pulls_by_its_pretension(tmp_path, kind, per_metre, view):
    given = {"dip": 35.0, "friction": 40.0, "angle": 20.0, **view}
    given.pop("side", None)
    case = anchored(tmp_path / "c.toml", kind, **JACKED, **view)
    found = clast.factor_of_safety(case, tolerance=0.005)
    assert found.value == pytest.approx(exact(**given, force=per_metre), rel=0.006)
    assert not found.warnings


@pytest.mark.parametrize("where", [{"stages": [REST], "stage": "rest"}, {"stages": [REST]}])
def test_a_jack_on_at_the_end_of_the_case_stays_on(tmp_path, where):
    kind = {**ONE_BOLT, "pretension": 3e5}
    found = clast.factor_of_safety(
        anchored(tmp_path / "c.toml", kind, **JACKED, **where), tolerance=0.005
    )
    assert found.value == pytest.approx(exact(35.0, 40.0, 20.0, 1e5), rel=0.006)
    assert not found.warnings


@pytest.mark.parametrize("bolt", [{}, {**JACKED, "stages": [REST, LATER], "stage": "rest"}])
def test_an_anchor_that_carries_more_without_a_limit_is_warned_of(tmp_path, bolt):
    """Locked off, it is a spring: the block hangs on it, and the factor counts on its force."""
    case = anchored(tmp_path / "c.toml", {**ONE_BOLT, "pretension": 3e5}, **bolt)
    found = clast.factor_of_safety(case, tolerance=0.01)
    (text,) = found.warnings
    assert math.isnan(found.value) and "at least" in found.sentence
    assert "yield_force" in text and "pretension_is" in text
    force = float(text.split("'A' ")[1].split(" N/m")[0])
    # without friction it has to hold the block alone
    assert force == pytest.approx(
        WEIGHT * math.sin(math.radians(35.0)) / math.cos(math.radians(20.0)), rel=0.02
    )


GROUTED = {"anchorage": "grouted", "free_length": 1.0}


@pytest.mark.parametrize("held", [{}, GROUTED])
@pytest.mark.parametrize("pretension", [0.0, 3e5])
@pytest.mark.parametrize("view", [{}, {"dip": 50.0, "friction": 55.0, "angle": 40.0}])
def test_an_anchor_that_yields_gives_no_more_than_that(tmp_path, view, pretension, held):
    """Neither warned of, nor too strong: its yield force is of one bolt, passive or locked off."""
    given = {"dip": 35.0, "friction": 40.0, "angle": 20.0, **view}
    kind = {**ONE_BOLT, "pretension": pretension, "yield_force": 3.6e5}
    found = clast.factor_of_safety(anchored(tmp_path / "c.toml", kind, **view, **held))
    assert found.low <= 1.005 * exact(**given, force=1.2e5)
    assert found.high >= 0.995 * exact(**given, force=1.2e5)
    assert found.width <= 0.01 and not found.warnings


def test_a_jack_pulls_grouted_anchors_alike(tmp_path):
    kind = {**ONE_BOLT, "pretension": 3e5, "yield_force": 9e5}
    file = anchored(tmp_path / "c.toml", kind, **JACKED, **GROUTED)
    found = clast.factor_of_safety(file, tolerance=0.005)
    assert found.value == pytest.approx(exact(35.0, 40.0, 20.0, 1e5), rel=0.006)


def test_a_push_finds_the_same_anchor(tmp_path):
    """W (sin a + k cos a) - T cos b = (W (cos a - k sin a) + T sin b) tan phi, k to the left."""
    kind = {**ONE_BOLT, "pretension": 3e5}
    case = anchored(tmp_path / "c.toml", kind, **JACKED)
    found = clast.collapse_load(case, "pga left", tolerance=0.005)
    a, b, tan = math.radians(35.0), math.radians(20.0), math.tan(math.radians(40.0))
    spare = (
        (WEIGHT * math.cos(a) + 1e5 * math.sin(b)) * tan - WEIGHT * math.sin(a) + 1e5 * math.cos(b)
    )
    assert found.value == pytest.approx(
        spare / (WEIGHT * (math.cos(a) + math.sin(a) * tan)), rel=0.006
    )


def test_jacks_lock_at_the_next_stage_or_hold(tmp_path):
    for jacks in ("lock", "hold"):
        later = StageTable(
            name="later",
            dynamic_ratio=0.0,
            jacks=jacks,
            joint={"default": {"friction_angle": 10.0}},
        ).stage()
        case = anchored(
            tmp_path / "c.toml", {**ONE_BOLT, "pretension": 6e5}, **JACKED, stages=[REST, later]
        )
        force = clast.load(case).run().bolt_history("A").force
        assert force[0] == pytest.approx(2e5)
        assert bool(force[-1] == pytest.approx(2e5)) is (jacks == "hold")
