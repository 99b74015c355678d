"""Objects of scripts in the place of names, and stages, as their tables judge and write them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from inspect import signature
from typing import Any

import pytest

import clast
from clast.actions.damping import Adaptive, Kinetic, Rayleigh
from clast.contact.laws import AugmentedLagrangian, Carried, Penalty
from clast.errors import CaseError
from clast.inputs.declaring.alternatives import Choice
from clast.inputs.method import ALTERNATIVES, DAMPING
from clast.inputs.stages import StageTable, given_stages
from clast.model.stages import Stage
from clast.step.modified import Modified

KEYS: dict[str, Any] = {"step": 1e-3, "end": 0.01}


def box() -> clast.ModelBuilder:
    builder = clast.ModelBuilder()
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    builder.fixed_point((0, 0))
    return builder


@dataclass(frozen=True)
class Own(Modified):
    """A process that no case file has a name for."""


@pytest.mark.parametrize(
    ("key", "given"),
    [
        ("process", Modified()),
        ("process", Modified(passes=2)),
        ("contact_law", Penalty(normal_stiffness=2e9)),
        ("contact_law", AugmentedLagrangian(normal_stiffness=1e9, multipliers=Carried())),
        ("damping", Rayleigh(mass=2.0)),
        ("damping", Kinetic()),
    ],
)
def test_an_object_of_clast_is_written_by_its_name(key: str, given: Any):
    case = box().case(**{key: given}, **KEYS)
    again = clast.Case.from_toml(case.to_toml())
    assert getattr(again.method(), key) == given


@pytest.mark.parametrize("key", ["process", "damping"])
def test_an_object_of_a_script_is_not_written(key: str):
    given = {"process": Own(), "damping": type("Mine", (Kinetic,), {})()}[key]
    case = box().case(**{key: given}, **KEYS)
    assert getattr(case.method(), key) == given
    where = {"process": r"\[method\] process", "damping": "damping"}[key]
    with pytest.raises(CaseError, match=f"{where}: .* is an object of a script"):
        case.to_toml()


@pytest.mark.parametrize("taker", [clast.simulate, clast.ModelBuilder.case])
def test_help_shows_the_keys_that_are_taken(taker: Any):
    shown = set(signature(taker).parameters)
    case = box().case(**KEYS)
    for table in (case.time, case.method_, case.output):
        assert shown >= set(type(table).model_fields)
    assert "damping" in shown
    assert "keys" not in shown


def test_every_alternative_without_numbers_is_written_by_its_name_alone():
    choices = [Choice(key, ALTERNATIVES) for key in ALTERNATIVES.classes if key != "contact_law"]
    for choice in [*choices, DAMPING]:
        for name in choice.names:
            assert choice.written(choice.validate(name).build()) == name


def test_the_table_of_a_stage_has_the_fields_of_a_stage():
    own = {one.name: one.default for one in fields(Stage)}
    keys = {"joints" if key == "joint" else key for key in StageTable.model_fields}
    assert keys == set(own)
    for key, field in StageTable.model_fields.items():
        if key not in ("name", "joint", "release", "flow", "flow_boundary"):
            default = tuple(field.default) if isinstance(field.default, list) else field.default
            assert default == own[key], key


def test_a_stage_comes_back_from_its_table():
    stage = clast.Stage(
        name="dig",
        time=0.1,
        excavate=("high",),
        relax=0.5,
        relax_time=0.01,
        damping=Adaptive(),
        joints={"bedding": {"friction_angle": 25.0}},
    )
    assert given_stages([stage]) == (stage,)
    assert given_stages([replace(stage, damping="adaptive")]) == (stage,)
