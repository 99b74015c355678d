"""Units of parameters: those that the case file has for the keys that they set."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from clast.case.case_file import json_schema
from clast.inputs.declaring.field_docs import UNIT
from clast.study.variables.parameters import Keys, ParameterPlaces

Schema = Mapping[str, Any]
PLAIN = {"-": "", "degrees": "°"}
"""Unit of the case file -> how figures and tables of numbers write it."""
FORCE, SPACING = "N per metre of thickness", "out_of_plane_spacing"
"""Unit of forces of bolts, and the key with which they are of one bolt."""


def units_of(places: ParameterPlaces) -> dict[str, str]:
    """Return the units of parameters by name; "" of factors, and where keys have none or several.

    They are read from the meanings of keys, of which the JSON Schema consists.
    """
    schema = json_schema()
    found: dict[str, str] = {}
    for one, own in zip(places.parameters, places.places, strict=True):
        units = {_unit_in(places.content, keys, unit_of_key(schema, keys)) for keys in own}
        found[one.name] = units.pop() if len(units) == 1 and not one.multiplies else ""
    return found


def unit_of_key(schema: Schema, keys: Keys) -> str:
    """Return the unit of a key of the case file by its JSON Schema; "" where it has none."""
    nodes = list(_alternatives(schema, schema))
    named: list[Schema] = []
    for key in keys:
        inner = [node for one in nodes for node in _inside(one, key)]
        # an entry of a vector has the unit of the vector
        named = inner if isinstance(key, str) else named
        nodes = [node for one in inner for node in _alternatives(one, schema)]
    units = (UNIT.search(" ".join(one.get("description", "").split())) for one in named)
    unit = next((one[1] for one in units if one), "")
    return PLAIN.get(unit, unit)


def _unit_in(content: Mapping[str, Any], keys: Keys, unit: str) -> str:
    """Return the unit of a key in a case: forces of bolts at a distance are of one of them."""
    is_of_one = keys[0] == "bolt_kind" and SPACING in content["bolt_kind"][keys[1]]
    return "N" if is_of_one and unit == FORCE else unit


def _inside(node: Schema, key: str | int) -> Iterator[Schema]:
    """Give what a node has at a key of a table, or at a position of a list."""
    if isinstance(key, int):
        inner = [node.get("items"), *node.get("prefixItems", ())[key : key + 1]]
    else:
        inner = [node.get("properties", {}).get(key), node.get("additionalProperties")]
    yield from (one for one in inner if isinstance(one, Mapping))


def _alternatives(node: Schema, schema: Schema) -> Iterator[Schema]:
    """Give a node, and all that it refers to or is a choice of."""
    yield node
    inner: list[Schema] = []
    if "$ref" in node:
        inner.append(schema["$defs"][node["$ref"].rpartition("/")[2]])
    for word in ("anyOf", "allOf", "oneOf"):
        inner += node.get(word, ())
    for one in inner:
        yield from _alternatives(one, schema)


def with_units(names: Iterable[str], units: Mapping[str, str]) -> list[str]:
    """Return names of parameters with their units, "joint.plane.cohesion, Pa"."""
    return [f"{name}, {units[name]}" if units.get(name) else name for name in names]
