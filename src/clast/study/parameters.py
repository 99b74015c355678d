"""Parameters of a study: keys of a case by their paths, and their values in a run.

    joint.bedding.friction_angle      joint.*.cohesion      water.1.level      bolt.A.pretension

A path is that of ``--set``.  Entries of lists are called by their number, from 1, or by their name;
``*`` stands for all.  Keys with dots are put in quotes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from clast.case.case_file import Case, json_schema
from clast.errors import CaseError, shortened
from clast.inputs.declaring import text as case_text
from clast.inputs.declaring.field_docs import UNIT
from clast.model.distributions import Discrete, Distribution, Value, Values
from clast.spelling import advice
from clast.study.distributions import Times

PART = re.compile(r'\s*(?:"([^"]*)"|([^."\s,=]+))\s*(\.|$)')
"""A key of a path, and the rest after it."""
NAMED_TABLES = ("rock", "joint", "bolt_kind", "amplitude")
"""Tables whose keys are names: one that is not there would be another rock or joint."""

Keys = tuple[str | int, ...]
"""Where a value is: keys of tables, positions in lists from 0."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter that varies from run to run."""

    name: str
    paths: tuple[str, ...]
    distribution: Distribution
    """Also the list of its values, or a factor of the value in the case."""

    @property
    def drawn(self) -> Distribution:
        """Its distribution: that of a factor where it is one."""
        one = self.distribution
        return one.factor if isinstance(one, Times) else one

    @property
    def multiplies(self) -> bool:
        """Whether it is a factor of the value in the case."""
        return isinstance(self.distribution, Times)


def keys_of(path: str) -> tuple[str, ...]:
    """Return the keys of a path; raises CaseError for an invalid one."""
    keys: list[str] = []
    at = 0
    while True:
        match = PART.match(path, at)
        if match is None:
            raise CaseError(
                f"'{shortened(path)}' is not a path of a key",
                where="vary",
                remedy="write it as table.key, e.g. joint.bedding.friction_angle",
            )
        keys.append(match[1] if match[1] is not None else match[2])
        at = match.end()
        if not match[3]:
            return tuple(keys)


def places(content: Mapping[str, Any], path: str) -> list[Keys]:
    """Return where a path leads to in a case; raises CaseError where that is nowhere."""
    places = list(_walk(content, keys_of(path), (), path))
    if not places:
        what = f"'{shortened(path)}' is not a key of the case"
        raise CaseError(what, where="vary", remedy="check its name")
    return places


def _walk(here: Any, keys: Sequence[str], behind: Keys, path: str) -> Iterator[Keys]:
    """Give where the keys lead to from a table or a list that ``behind`` has led to."""
    key, rest = keys[0], keys[1:]
    if isinstance(here, Mapping):
        chosen: list[Any] = list(here) if key == "*" else [key]
        # the next key is the name of a rock, a joint or the like
        is_name = len(behind) == 1 and behind[0] in NAMED_TABLES
        if key != "*" and key not in here and (rest or not behind or is_name):
            _check_default(here, key, rest, behind, path)
    elif isinstance(here, list):
        chosen = list(range(len(here))) if key == "*" else [_position(here, key, behind, path)]
    else:
        raise CaseError(
            f"'{_written(behind)}' is a single value",
            where=f"vary {shortened(path)}",
            remedy=f"vary {_written(behind)} itself",
        )
    for one in chosen:
        if not rest:
            yield (*behind, one)
        else:
            inner = here[one] if isinstance(here, list) else here.get(one, {})
            if key == "*" and not isinstance(inner, Mapping | list):
                continue
            yield from _walk(inner, rest, (*behind, one), path)


def _check_default(
    here: Mapping[str, Any], key: str, rest: Sequence[str], behind: Keys, path: str
) -> None:
    """Raise CaseError for a key that a case neither gives nor has by default.

    A table that a case lacks is another case: one key of it, a seed say, would not make it whole.
    """
    from clast.case.case_file import Case

    tables = {one.alias or name: one for name, one in Case.model_fields.items()}
    what, remedy = f"'{_written((*behind, key))}'", "give it in the case: a study varies it there"
    if not behind and key in tables:
        default = tables[key].get_default(call_default_factory=True)
        if not rest or isinstance(default, BaseModel | str):
            return
        # as a case file writes it, by the value that it has where it is left out
        kinds: dict[type, str] = {tuple: f"'{key}'", list: f"[[{key}]]", dict: f"[{key}.NAME]"}
        what = kinds.get(type(default), f"[{key}]")
    elif here:
        remedy = advice(key, [str(one) for one in here], kind="key")
    raise CaseError(f"the case has no {what}", where=f"vary {shortened(path)}", remedy=remedy)


def _position(here: Sequence[Any], key: str, behind: Keys, path: str) -> int:
    """Return the position of an entry of a list that is called by its number or its name."""
    names = [one.get("name") if isinstance(one, Mapping) else None for one in here]
    if key in names:
        return names.index(key)
    if re.fullmatch("[0-9]{1,9}", key) and 1 <= int(key) <= len(here):
        return int(key) - 1
    called = [str(one) for one in names if one is not None]
    remedy = f"give a number from 1 to {len(here)}"
    if called:
        remedy += f", or a name: {advice(key, called, kind='name')}"
    raise CaseError(
        f"'{_written(behind)}' has no entry '{shortened(key)}'",
        where=f"vary {shortened(path)}",
        remedy=remedy,
    )


def value_at(content: Mapping[str, Any], keys: Keys) -> Any:
    """Return the value at a place of a case; None where there is none."""
    here: Any = content
    for key in keys:
        if isinstance(here, list):
            here = here[int(key)]
        else:
            here = here.get(key) if isinstance(here, Mapping) else None
    return here


def _with_value(here: Any, keys: Keys, value: Any) -> Any:
    """Return a case, or a part of it, with another value at a place; all else is shared."""
    if not keys:
        return value
    copied = list(here) if isinstance(here, list) else dict(here or {})
    first: Any = keys[0]
    inner = copied[first] if isinstance(copied, list) else copied.get(first)
    if isinstance(inner, str) and len(keys) > 1:
        inner = {"name": inner}  # a choice that is given by its name alone gets numbers too
    copied[first] = _with_value(inner, keys[1:], value)
    return copied


@dataclass(frozen=True, kw_only=True)
class ParameterPlaces:
    """The places of all parameters in a case."""

    content: Mapping[str, Any]
    """The case as its file has it."""
    parameters: tuple[Parameter, ...]
    places: tuple[tuple[Keys, ...], ...]
    """Where each of them is set."""

    @classmethod
    def of(cls, content: Mapping[str, Any], parameters: Sequence[Parameter]) -> ParameterPlaces:
        """Return them; raises CaseError for paths that lead nowhere, or twice to one key."""
        all_places: list[tuple[Keys, ...]] = []
        taken: dict[Keys, str] = {}
        for one in parameters:
            all_places.append(tuple(keys for path in one.paths for keys in places(content, path)))
            for keys in all_places[-1]:
                if keys in taken:
                    raise CaseError(
                        f"'{_written(keys)}' is varied twice: {taken[keys]}, {one.name}",
                        where="vary",
                        remedy="let only one parameter set it",
                    )
                taken[keys] = one.name
                if one.multiplies:
                    _check_factor(content, keys, one)
        return cls(content=content, parameters=tuple(parameters), places=tuple(all_places))

    def case(self, values: Sequence[Value]) -> dict[str, Any]:
        """Return the content of a case file with the parameters at ``values``."""
        content = dict(self.content)
        for one, places, value in zip(self.parameters, self.places, values, strict=True):
            for keys in places:
                product = _times(value_at(content, keys), value) if one.multiplies else value
                product = list(product) if isinstance(product, tuple) else product
                content = _with_value(content, keys, product)
        return content


def _times(value: Any, factor: Any) -> Any:
    """Return a number, or a list of numbers, times a factor."""
    if isinstance(value, list):
        return [_times(one, factor) for one in value]
    return value * factor


def _check_factor(content: Mapping[str, Any], keys: Keys, one: Parameter) -> None:
    """Raise CaseError where there is nothing that a factor could multiply."""
    value = value_at(content, keys)
    parts = value if isinstance(value, list) and value else [value]
    if not all(isinstance(part, int | float) and not isinstance(part, bool) for part in parts):
        raise CaseError(
            f"'{_written(keys)}' is not a number of the case that could be multiplied",
            where=f"vary {one.name}",
            remedy="give it in the case, or draw the value itself: leave out times(...)",
        )
    drawn = one.drawn
    listed = drawn.values if isinstance(drawn, Values | Discrete) else ()
    if not all(isinstance(part, int | float) and math.isfinite(part) for part in listed):
        what = "a factor has to be a number"
        raise CaseError(what, where=f"vary {one.name}", remedy="write numbers")


def _written(keys: Sequence[str | int]) -> str:
    """Return a place as a path."""
    return ".".join(str(key + 1) if isinstance(key, int) else key for key in keys)


Schema = Mapping[str, Any]
PLAIN = {"-": "", "degrees": "°"}
"""Unit of the case file -> how figures and tables of numbers write it."""


def units_of(places: ParameterPlaces) -> dict[str, str]:
    """Return the units of parameters by name; "" of factors, and where keys have none or several.

    They are read from the meanings of keys, of which the JSON Schema consists.
    """
    schema = json_schema()
    bolts = places.content.get("bolt_kind", {})

    def unit(keys: Keys) -> str:
        # forces of bolts at a distance are of one of them
        is_of_one = keys[0] == "bolt_kind" and "out_of_plane_spacing" in bolts[keys[1]]
        unit = unit_of_key(schema, keys)
        return "N" if is_of_one and unit == "N per metre of thickness" else unit

    units: dict[str, str] = {}
    for one, own in zip(places.parameters, places.places, strict=True):
        different = {unit(keys) for keys in own}
        units[one.name] = different.pop() if len(different) == 1 and not one.multiplies else ""
    return units


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


def _inside(node: Schema, key: str | int) -> Iterator[Schema]:
    """Give the value of a node at a key of a table, or at a position of a list."""
    if isinstance(key, int):
        inner = [node.get("items"), *node.get("prefixItems", ())[key : key + 1]]
    else:
        inner = [node.get("properties", {}).get(key), node.get("additionalProperties")]
    yield from (one for one in inner if isinstance(one, Mapping))


def _alternatives(node: Schema, schema: Schema) -> Iterator[Schema]:
    """Give a node, and all that it refers to or is a choice of."""
    yield node
    if "$ref" in node:
        yield from _alternatives(schema["$defs"][node["$ref"].rpartition("/")[2]], schema)
    for word in ("anyOf", "allOf", "oneOf"):
        for one in node.get(word, ()):
            yield from _alternatives(one, schema)


def with_units(names: Iterable[str], units: Mapping[str, str]) -> list[str]:
    """Return names of parameters with their units, "joint.plane.cohesion, Pa"."""
    return [f"{name}, {units[name]}" if units.get(name) else name for name in names]


Content = Mapping[str, Any]


def content_of(case: Case) -> dict[str, Any]:
    """Return the tables of a case without its references, which are those of one run.

    Raises CaseError where it holds objects of a script.
    """
    content = case_text.parse(case.to_toml(), case.file)
    content.pop("reference", None)
    return content


def changed(case: Case, content: Content) -> Case:
    """Return a case with other tables; raises CaseError naming file, table, key and remedy.

    Blocks are cut once where nothing that cuts them has changed.
    """
    other = Case.validated(dict(content), case.file)
    mass = other._rock_mass
    if mass is not None and mass == case._rock_mass:
        case.cut()
        other._cut = case._cut
    return other
