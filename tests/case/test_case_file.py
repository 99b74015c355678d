"""The case file: what it becomes, round trips, settings, choices by name."""

from __future__ import annotations

import json
from dataclasses import dataclass

import pytest

from clast.case.case_file import Case, json_schema
from clast.case.templates import INCLINE, TEMPLATES
from clast.contact.laws import Carried
from clast.errors import CaseError
from clast.inputs.declaring import text as case_text
from clast.inputs.declaring.alternatives import Alternatives, Choice, class_at
from clast.inputs.method import ALTERNATIVES, PROCESSES
from clast.step.convex import Convex


def test_the_incline_is_the_papers():
    case = Case.from_toml(INCLINE)
    model, method, schedule = case.model(), case.method(), case.schedule()
    assert model.block_name == ("incline", "slider")
    assert model.area.tolist() == [50.0, 4.5]
    assert model.fixed_points.at.tolist() == [[0.0, 0.0], [10.0, 0.0]]
    assert model.joint_table.joints[0].friction_angle == 20.0
    assert method.process == Convex()
    assert method.contact_law.normal_stiffness == 1e9
    assert (method.critdis, method.max_displacement) == (0.005, 0.01)
    assert method.fixed_point_stiffness == 100 * 50e9
    assert (schedule.step, schedule.end, schedule.every) == (1e-3, 1.0, 0.01)


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_case_survives_being_written_and_read(name):
    case = Case.from_toml(TEMPLATES[name])
    again = Case.from_toml(case.to_toml())
    assert again.model_dump() == case.model_dump()
    assert again.to_toml() == case.to_toml()


def test_the_text_of_a_case_is_the_files_own_until_values_are_set():
    assert Case.from_toml(INCLINE).text == INCLINE
    changed = Case.from_toml(INCLINE, ["time.end=2"]).text
    assert "end = 2" in changed
    assert Case.from_toml(changed).time.end == 2.0


def test_defaults_follow_from_the_blocks():
    case = Case.from_toml(INCLINE, ["method={}", "output={}"])
    text = case.to_toml().replace("max_displacement = 0.01\n", "")
    case = Case.from_toml(text)
    method = case.method()
    assert method.max_displacement == pytest.approx(0.05 * 4.5**0.5)
    assert method.critdis == pytest.approx(0.005 * 4.5**0.5)
    assert method.process == Convex()
    assert case.schedule().every == pytest.approx(0.01)


def test_blocks_by_coordinates_join_those_by_numbers():
    lid = """
[[block]]
name = "lid"
rock = "granite"
vertices = [[20,0],[21,0],[20,1]]
fixed = true
"""
    model = Case.from_toml(INCLINE + lid).model()
    assert model.block_name == ("incline", "slider", "lid")
    assert model.fixed.tolist() == [False, False, True]


def test_loads_and_joints_reach_the_model():
    extra = """
[[point_load]]
at = [4, 9]
force = [1.0, 2.0]
[[line_load]]
start = [4, 6]
end = [4, 9]
traction = [-5.0, 0.0]
"""
    settings = ["joint.glue.cohesion=1e5", 'joint.glue.between=[["slider", "incline"]]']
    model = Case.from_toml(INCLINE + extra, settings).model()
    assert model.point_loads.force.tolist() == [[1.0, 2.0]]
    assert model.line_loads.traction.tolist() == [[-5.0, 0.0]]
    assert model.line_loads.block.tolist() == [1]
    assert model.joint_table.block_pair.tolist() == [[0, 1]]
    assert model.joint_table.joints[1].cohesion == 1e5


@pytest.mark.parametrize(
    ("setting", "found"),
    [
        ("time.end=2", lambda case: case.time.end == 2.0),
        ("title=hello", lambda case: case.title == "hello"),
        ('title="a = b"', lambda case: case.title == "a = b"),
        ("joint.default.friction_angle=35", lambda c: c.joint["default"].friction_angle == 35.0),
        ("geometry.blocks.2.fixed=true", lambda case: case.geometry.blocks[1].fixed),
        ("fixed_point.2.at=[0, 10]", lambda case: case.fixed_point[1].at == (0.0, 10.0)),
        ("method.rotation=exact", lambda case: case.method_.rotation.name == "exact"),
        ("method.solver.name=pcg", lambda case: case.method_.solver.name == "pcg"),
        ("method.process.iterations=30", lambda case: case.method().process.iterations == 30),
    ],
)
def test_settings(setting, found):
    assert found(Case.from_toml(INCLINE, [setting]))


@pytest.mark.parametrize(
    ("setting", "phrase"),
    [
        ("time.end", "sets no value"),
        ("fixed_point.3.at=[0,0]", "entries 1 to 2"),
        ("time.end.x=1", "single value"),
    ],
)
def test_settings_that_cannot_be(setting, phrase):
    with pytest.raises(CaseError, match=phrase):
        Case.from_toml(INCLINE, [setting])


def test_choices_nest():
    law = "method.contact_law"
    settings = [f"{law}=augmented-lagrangian", f"{law}.multipliers=carried"]
    case = Case.from_toml(INCLINE, settings)
    assert case.method().contact_law.multipliers == Carried()


@pytest.mark.parametrize(
    ("key", "name"), [(key, name) for key, names in ALTERNATIVES.classes.items() for name in names]
)
def test_every_alternative_can_be_built_by_its_name(key, name):
    built = Choice(key, ALTERNATIVES).validate(name).build()
    assert isinstance(built, class_at(ALTERNATIVES.classes[key][name]))


@dataclass(frozen=True)
class Springs:
    """A law that nobody ships."""

    stiffness: float
    """Stiffness of the spring, N/m per m."""
    loops: int = 2


def test_a_new_alternative_takes_its_dataclass_and_one_line():
    registry = Alternatives(classes={"law": {"springs": f"{__name__}:Springs"}}, limits={})
    choice = Choice("law", registry)
    built = choice.validate({"name": "springs", "stiffness": 3.0}).build()
    assert (type(built).__name__, built.stiffness, built.loops) == ("Springs", 3.0, 2)


def test_the_schema_is_one_and_names_every_table():
    schema = json_schema()
    assert schema["$schema"].endswith("2020-12/schema")
    assert set(schema["required"]) == {"time", "rock"}
    assert {"schema", "method", "geometry", "block"} <= set(schema["properties"])
    assert schema["additionalProperties"] is False
    process = schema["$defs"]["MethodTable"]["properties"]["process"]
    names, modified, *_ = process["anyOf"]
    assert names["enum"] == list(PROCESSES)
    assert modified["properties"]["passes"]["minimum"] == 1
    assert modified["properties"]["passes"]["description"]
    json.dumps(schema)


def test_every_key_of_the_format_says_what_it_means():
    def undescribed(table, path):
        for key, value in table.get("properties", {}).items():
            if not ({"description", "const"} & set(value)):
                yield f"{path}.{key}"

    schema = json_schema()
    tables = {"case": schema, **schema["$defs"]}
    assert [key for path, table in tables.items() for key in undescribed(table, path)] == []


def test_writing_keeps_every_digit_and_odd_keys():
    content = {"a": 0.1, "b": [1e-17, -3.0], "c": {"odd key": 'x"y\n'}, "d": [{"e": True}]}
    assert case_text.parse(case_text.to_toml(content), "x") == content


@pytest.mark.parametrize(
    "make",
    [lambda keys: Case(**keys), Case.model_validate, lambda keys: Case.validated(keys, "case")],
)
def test_a_case_made_in_python_is_refused_in_clasts_own_words(make):
    with pytest.raises(CaseError) as refused:
        make({"time": {"step": -1.0, "end": 1.0}, "rok": {}})
    told = str(refused.value)
    assert told.startswith("case: 3 things to put right")
    for words in (
        "[time] step: must be above 0, not -1",
        "rock: is missing",
        "did you mean 'rock'?",
    ):
        assert words in told
    with pytest.raises(CaseError, match="must be a table, not 5"):
        Case.model_validate(5)
