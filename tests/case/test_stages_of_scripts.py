"""Stages, dampings and excavated blocks as a script gives them: names work, nonsense is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast
from clast.actions.damping import Adaptive, Rayleigh
from clast.errors import CaseError, ModelError
from clast.inputs.stages import given_stages
from clast.run.excavation import excavated
from scenes.shaken import shaken

KEYS: dict[str, Any] = {"step": 2e-3, "end": 0.01, "process": "modified"}


@pytest.mark.parametrize(
    ("damping", "kind"),
    [
        ("adaptive", Adaptive()),
        ({"name": "adaptive", "ratio": 0.5}, Adaptive(ratio=0.5)),
        ({"mass": 2.0}, Rayleigh(mass=2.0)),
        (Adaptive(ratio=0.4), Adaptive(ratio=0.4)),
        (None, None),
    ],
)
def test_damping_by_name_table_or_object(damping: Any, kind: Any):
    (stage,) = given_stages([clast.Stage(name="a", damping=damping)])
    assert stage.damping == kind


def test_a_script_and_its_case_damp_alike():
    stages = [
        clast.Stage(name="rest", until="time", time=6e-3, damping="adaptive", ground_motion=True)
    ]
    case = shaken().case(stages=stages, **KEYS)
    assert case.stage[0].stage().damping == Adaptive()
    runs = [clast.simulate(shaken(), stages=stages, **KEYS), case.run()]
    schedule = clast.Schedule(step=2e-3, end=0.01, every=2e-3, stages=tuple(stages))
    method = case.method()
    runs.append(clast.simulate(shaken(), method, schedule))
    for run in runs:
        assert run.stages[0].outcome == "time over"
        assert run.state.ledger.damping == runs[0].state.ledger.damping > 0.0
    assert "adaptive" in shaken().to_toml(stages=stages, **KEYS)


@pytest.mark.parametrize(
    "damping", ["adaptiv", {"name": "adaptive", "rato": 1}, 7, object(), Adaptive]
)
def test_a_damping_that_is_none(damping: Any):
    for give in (
        lambda stages: clast.simulate(shaken(), stages=stages, **KEYS),
        lambda stages: shaken().case(stages=stages, **KEYS),
    ):
        with pytest.raises(CaseError, match="stage 'dig', damping"):
            give([clast.Stage(name="dig", damping=damping)])


@pytest.mark.parametrize("stages", ["x", ["rest"], [{"name": "a"}], 5, [clast.Stage]])
def test_what_are_no_stages(stages: Any):
    for give in (
        lambda: clast.simulate(shaken(), stages=stages, **KEYS),
        lambda: shaken().case(stages=stages, **KEYS),
    ):
        with pytest.raises(CaseError, match=r"(?s)stages: .* is not a stage.*clast\.Stage"):
            give()


def test_one_stage_needs_no_list():
    stage = clast.Stage(name="rest", until="time", time=2e-3)
    assert given_stages(stage) == (stage,)


@pytest.mark.parametrize("blocks", [["q"], "q", [1.5], [[1]], [True, False], 3, [99], [-1]])
def test_what_are_no_blocks(blocks: Any):
    model = shaken().build()
    run = clast.simulate(model, **KEYS)
    method = shaken().case(**KEYS).method()
    with pytest.raises(ModelError, match=r"blocks: (.* are not block numbers|there is no block)"):
        excavated(model, method, run.state, blocks)
    left, _ = excavated(model, method, run.state, [1, 2])
    np.testing.assert_array_equal(np.flatnonzero(left.absent), [1, 2])
    named, _ = excavated(model, method, run.state, model.blocks_called(["0-0"]))
    assert int(named.absent.sum()) == 1
