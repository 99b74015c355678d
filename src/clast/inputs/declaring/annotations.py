"""Unit, geometry, references and conditions of keys, from their declarations.

``x-clast`` of a property in the JSON Schema, for editors of case files: other readers pass it over.

``unit``      unit of its numbers, "-" for none, from the sentence below the key
``geometry``  point, polyline or polygon, m, where the section shows it; or radius, width, height,
              size, angle, spacing, vector, pressure, length, along, direction, level or station
              of something that it shows
``from``      key of the point or outline at which such a size or direction begins
``refers_to`` tables of which it holds a name
``when``      values of other keys with one of which it goes, "*" for any of them
``level``     "basic" for keys that most tables have, "rare" for those that few have, else "more"
``typical``   smallest and largest usual value of a number

``x-clast`` of a table has ``one_of``, groups of keys of which it has one, at most.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.config import JsonDict, JsonValue
from pydantic.fields import FieldInfo

from clast.inputs.declaring.field_docs import PLAIN_NUMBER, UNIT

Geometry = Literal["point", "polyline", "polygon"]
Extent = Literal[
    "radius",
    "width",
    "height",
    "size",
    "angle",
    "spacing",
    "vector",
    "pressure",
    "length",
    "along",
    "direction",
    "level",
    "station",
]
ANY = "*"
"""Stands for every value of a key."""
MARK = "x-clast"
"""Key of the annotations in the JSON Schema."""


@dataclass(frozen=True)
class Drawn:
    """Annotation of a key that is somewhere in the section."""

    geometry: Geometry


@dataclass(frozen=True)
class Extends:
    """Annotation of a size or a direction that the section shows, from the place of another key."""

    geometry: Extent
    begins: str = ""
    """Key of the point or outline; empty for a level y and for a station x, which have none."""


class RefersTo:
    """Annotation of a text that is a name of one of some tables."""

    def __init__(self, *tables: str) -> None:
        self.tables = tables
        """Their keys in the file."""


def parts_of(annotation: Any, depth: type = object) -> Iterator[Any]:
    """Give a type and all types inside it, and their annotations; lists only where asked for."""
    origin = get_origin(annotation)
    if origin is Annotated:
        yield from annotation.__metadata__
    yield annotation
    if origin in (Annotated, Union, UnionType) or depth is list:
        for part in () if origin is Literal else get_args(annotation):
            yield from parts_of(part, depth)


def geometry_of(field: FieldInfo) -> Geometry | None:
    """Return how the section shows a key, None where it does not."""
    marks = (*field.metadata, *parts_of(field.annotation))
    return next((one.geometry for one in marks if isinstance(one, Drawn)), None)


def extent_of(field: FieldInfo) -> Extends | None:
    """Return the size or direction that a key is in the section, None where it is neither."""
    marks = (*field.metadata, *parts_of(field.annotation))
    return next((one for one in marks if isinstance(one, Extends)), None)


def names_of(key: str, field: FieldInfo, tables: frozenset[str]) -> tuple[str, ...]:
    """Return the tables that a key names; ``tables`` are those of the file.

    A key is called as its table: ``rock``, ``blocks``, ``head_joint``; others have ``RefersTo``.
    """
    every = [*field.metadata, *parts_of(field.annotation, list)]
    named = [one.tables for one in every if isinstance(one, RefersTo)]
    if named:
        return named[0]
    word = key.rsplit("_", 1)[-1]
    own = next((one for one in (key, word, word.removesuffix("s")) if one in tables), None)
    return (own,) if own is not None and str in every else ()


def unit_of(field: FieldInfo) -> str | None:
    """Return the unit of the numbers of a key, None where it has none of them."""
    kinds = [one for one in parts_of(field.annotation, list) if one in (int, float)]
    if not kinds:
        return None
    meaning = " ".join((field.description or "").split())
    said, plain = UNIT.search(meaning), PLAIN_NUMBER.search(meaning.partition(".")[0])
    return said[1] if said else "-" if plain or int in kinds else None


def annotation_of(
    key: str, field: FieldInfo, table: type[BaseModel], tables: frozenset[str]
) -> dict[str, Any]:
    """Return ``x-clast`` of a key of a table; ``tables`` are those of the file."""
    is_file = tables <= {one.alias or name for name, one in table.model_fields.items()}
    extent = extent_of(field)
    found: dict[str, Any] = {
        "unit": unit_of(field),
        "geometry": extent.geometry if extent else geometry_of(field),
        "from": extent.begins if extent else "",
        "refers_to": list(names_of(key, field, tables - {key} if is_file else tables)),
        "when": when_of(key, table),
        "level": _level(key, field, table),
        "typical": list(getattr(table, "TYPICAL", {}).get(key, ())),
    }
    return {name: value for name, value in found.items() if value}


def when_of(key: str, table: type[BaseModel]) -> dict[str, list[str]]:
    """Return the values of other keys with which a key goes; of all others nothing is said."""
    chosen = getattr(table, "WHEN", {})
    found = {
        by: [value for value, keys in values.items() if key in keys]
        for by, values in chosen.items()
    }
    return {by: values for by, values in found.items() if values}


def _level(key: str, field: FieldInfo, table: type[BaseModel]) -> str:
    if key in getattr(table, "RARE", ()):
        return "rare"
    basic = {*getattr(table, "BASIC", ()), *(one for keys in _groups(table) for one in keys)}
    return "basic" if field.is_required() or key in basic else "more"


def _groups(table: type[BaseModel]) -> list[Sequence[str]]:
    return [*getattr(table, "ONE_OF", {}).values(), *getattr(table, "INSTEAD", ())]


def annotate(table: type[BaseModel], tables: frozenset[str]) -> None:
    """Give the keys of a table, and the table, their annotations in the JSON Schema."""
    for key, field in table.model_fields.items():
        field.json_schema_extra = {MARK: annotation_of(field.alias or key, field, table, tables)}
    groups: list[JsonValue] = [list(keys) for keys in _groups(table)]
    if groups:
        extra: JsonDict = {MARK: {"one_of": groups}}
        table.model_config = {**table.model_config, "json_schema_extra": extra}


def without_null(schema: Any) -> Any:
    """Return a JSON Schema without null, which TOML cannot hold: a key is left out instead."""
    if isinstance(schema, list):
        return [without_null(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {key: without_null(one) for key, one in schema.items()}
    options = kept.get("anyOf")
    if isinstance(options, list) and {"type": "null"} in options:
        options = [one for one in options if one != {"type": "null"}]
        rest = {key: one for key, one in kept.items() if key != "anyOf"}
        kept = {**options[0], **rest} if len(options) == 1 else {**rest, "anyOf": options}
        if "default" in kept and kept["default"] is None:
            del kept["default"]
    return kept
