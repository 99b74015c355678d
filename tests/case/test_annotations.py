"""``x-clast`` of the JSON Schema: unit, geometry, names, conditions, from the declarations."""

from collections.abc import Iterator
from typing import Any

import pytest

from clast.case.case_file import Case, json_schema
from clast.errors import CaseError
from clast.inputs.declaring.alternatives import class_at
from clast.inputs.declaring.annotations import MARK, without_null
from clast.inputs.declaring.field_docs import UNITS
from clast.inputs.declaring.table import Table
from clast.inputs.joint_sets import MODELS, JointSetTable

FREE = {"name", "title", "file", "layer", "layers", "unit", "select", "set", "source", "baseline"}
"""Last words of keys whose text is no name of a table."""
VARIED = {"SourceTable", "Surface"}
"""Tables whose numbers may be texts: distributions."""
INSIDE = ("anyOf", "items", "prefixItems", "additionalProperties")


def kinds_in(schema: Any) -> Iterator[str]:
    """Give the types of the values of a property, without those of tables inside."""
    if isinstance(schema, list):
        for one in schema:
            yield from kinds_in(one)
    elif isinstance(schema, dict) and "properties" not in schema:
        if not {"enum", "const"} & schema.keys():
            yield str(schema.get("type"))
        for key in INSIDE:
            yield from kinds_in(schema.get(key))


def properties(schema: Any, title: str = "") -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Give table, key and schema of every property."""
    if isinstance(schema, list):
        for one in schema:
            yield from properties(one)
    elif isinstance(schema, dict):
        if isinstance(schema.get("properties"), dict):
            for key, one in schema["properties"].items():
                yield str(schema.get("title")), key, one
        for one in schema.values():
            yield from properties(one)


@pytest.fixture(scope="module")
def every():
    return list(properties(json_schema()))


def test_every_number_has_a_unit_or_is_said_to_have_none(every):
    numbers = [one for one in every if {"number", "integer"} & set(kinds_in(one[2]))]
    assert len(numbers) > 200
    assert not [one[:2] for one in numbers if one[2][MARK].get("unit") not in UNITS]


def test_every_name_refers_to_a_table(every):
    texts = [(t, k, one) for t, k, one in every if "string" in kinds_in(one) and t not in VARIED]
    without = {key for _, key, one in texts if "refers_to" not in one[MARK]}
    assert {key.rsplit("_", 1)[-1] for key in without} <= FREE
    named = {key: one[MARK]["refers_to"] for _, key, one in every if "refers_to" in one[MARK]}
    tables = set(json_schema()["properties"])
    assert all(set(names) <= tables for names in named.values())
    assert named["kind"] == ["bolt_kind"]
    assert named["blocks"] == ["block"]
    assert named["excavate"] == ["opening", "block"]
    assert "force" not in named


def test_geometry_and_conditions_are_those_of_the_declarations():
    tables = json_schema()["$defs"]
    opening = tables["OpeningTable"]["properties"]
    assert opening["center"][MARK]["geometry"] == "point"
    assert opening["center"][MARK]["when"] == {"shape": ["circle", "horseshoe"]}
    assert tables["TraceTable"]["properties"]["points"][MARK]["geometry"] == "polyline"
    assert tables["DomainTable"]["properties"]["boundary"][MARK]["geometry"] == "polygon"
    assert "geometry" not in tables["Reference"]["properties"]["displacement"][MARK]
    assert tables["Water"][MARK] == {"one_of": [["level", "line"]]}
    assert tables["Rock"]["properties"]["young"][MARK]["level"] == "basic"
    jrc = tables["Joint"]["properties"]["jrc"][MARK]
    assert jrc["when"] == {"law": ["barton-bandis"], "hydraulic_law": ["barton"]}
    assert (jrc["level"], jrc["typical"]) == ("basic", [1.0, 20.0])
    assert tables["DomainTable"]["properties"]["depth"][MARK]["when"] == {"profile": ["*"]}
    assert tables["DomainTable"]["properties"]["tolerance"][MARK]["level"] == "rare"


def test_conditions_name_keys_and_values_that_there_are():
    count = 0
    for table in json_schema()["$defs"].values():
        keys = table.get("properties", {})
        for one in keys.values():
            for by, values in one.get(MARK, {}).get("when", {}).items():
                count += 1
                choices = str(keys[by])
                assert set(values) == {"*"} or all(f"'{value}'" in choices for value in values)
        assert {key for keys in table.get(MARK, {}).get("one_of", ()) for key in keys} <= set(keys)
    declared = [one for one in every_table(Table) if one.__module__.startswith("clast.inputs")]
    for table in declared:
        said = {*table.BASIC, *table.RARE, *table.TYPICAL, *table.WHEN}
        said |= {key for of in table.WHEN.values() for keys in of.values() for key in keys}
        assert said <= set(table.model_fields), table
    assert count > 60


def every_table(table):
    """Give all tables that are declared."""
    for one in table.__subclasses__():
        yield one
        yield from every_table(one)


def test_a_set_goes_with_the_keys_that_its_model_takes():
    for name, keys in JointSetTable.WHEN["model"].items():
        takes = class_at(MODELS[name]).takes
        direction = {"dip_direction", "spacing_is"} if "dip" in takes else set()
        assert {*keys, *direction, "spacing"} == takes


@pytest.mark.parametrize("keys", [(), ("level", "line")])
def test_a_group_that_the_schema_names_is_one_that_cases_are_checked_for(keys):
    values = {"level": "1.0", "line": "[[0, 0], [1, 1]]"}
    text = "[[water]]\n" + "".join(f"{key} = {values[key]}\n" for key in keys)
    head = (
        "time = {step = 1e-3, end = 1.0}\nrock.a = {young = 1e9, poisson = 0.2, density = 2.5e3}\n"
    )
    with pytest.raises(CaseError) as caught:
        Case.from_text(head + text, "x")
    assert caught.value.faults[0].place == ("water", 0)
    assert "level" in caught.value.what


def test_no_value_is_null():
    assert "'null'" not in str(json_schema())
    kept = without_null({"anyOf": [{"type": "number"}, {"type": "null"}], "default": None, "a": 1})
    assert kept == {"type": "number", "a": 1}
    assert without_null({"default": None}) == {"default": None}


def test_a_size_or_direction_begins_at_a_place_of_its_table(every):
    extents = {(t, k): one[MARK]["from"] for t, k, one in every if "from" in one[MARK]}
    known = {(table, key): one[MARK].get("geometry") for table, key, one in every}
    assert {known[table, begins] for (table, _), begins in extents.items()} == {"point", "polygon"}
    assert extents["OpeningTable", "radius"] == "center"
    assert known["OpeningTable", "radius"] == "radius"
    assert known["Water", "level"] == "level"
