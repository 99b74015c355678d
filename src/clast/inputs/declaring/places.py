"""Places of faults and remarks: from the words of a message to keys of the file and points.

Deep inside a model tables are known by labels: ``bolt 2``, ``joint_set 'foliation', spacing``,
``measured point 'crown' at (0, 33)``.  All of them are a table, its number or name, and keys; here
they lead back to the case file, so that a message, a script and an editor mean the same place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, get_origin

from pydantic import BaseModel

from clast.errors import CaseError, Fault, Place, Points, Remark, shortened
from clast.inputs.declaring.annotations import geometry_of
from clast.inputs.declaring.validation_messages import Own, field_at, keys_of, table_in

NUMBER = r"-?\d+(?:\.\d*)?(?:e[-+]?\d+)?"
POINT = re.compile(rf"\(({NUMBER}), ({NUMBER})\)(?! (?:m|Pa)\b)")
"""A point as messages write it, and no stress, displacement, velocity or acceleration."""
LABEL = re.compile(r"\[{0,2}([a-z_]+(?: [a-z_]+)*)\]{0,2}(?: (\d+))?(?: '([^']*)')?")
"""Words of a table, its number, its name."""
KEY = re.compile(r"(?:, |: | |\.)(?:number )?(\w+)(?: '([^']*)')?")
"""A key, a number or a name below a table."""
LISTED = re.compile(r"^  (?! )(.*?): (.*)(?:\n    (.*))?$", re.MULTILINE)
"""A fault among several of one message: place, fault, remedy."""
SHOWN_MAX = 20
"""Most points of a message."""

OutlineOf = Callable[[str], Points]
"""Outline of the block of a name."""


def no_outline(name: str) -> Points:
    """Return no point: blocks are not known."""
    return ()


def place_of(words: str, content: Mapping[str, Any], case: type[BaseModel]) -> Place:
    """Return the place of the table and keys with which a message begins, () for none of them."""
    label = LABEL.match(words)
    if label is None:
        return ()
    number, name = label[2], label[3]
    for said in _beginnings(label[1]):
        place = _table(said, number, name, content)
        if not place:
            continue
        whole = len(said) == len(label[1])
        rest = words[label.end() if whole else label.start(1) + len(said) :].lstrip("]")
        while (key := KEY.match(rest)) is not None:
            further = _below(place, key, content, case)
            if further == place:
                break
            place, rest = further, rest[key.end() :]
        return place
    return ()


def points_in(text: str) -> Points:
    """Return the points that a message names, m."""
    return tuple((float(one[1]), float(one[2])) for one in POINT.finditer(text))[:SHOWN_MAX]


def points_at(place: Place, content: Mapping[str, Any], case: type[BaseModel]) -> Points:
    """Return the points of the value at a place, or of the table that it belongs to, m."""
    for depth in range(len(place), 0, -1):
        value = _value(place[:depth], content)
        known = field_at(case, place[:depth]) if isinstance(place[depth - 1], str) else None
        if known is not None and geometry_of(known) and (found := points_of(value)):
            return found
        table = _table_class(place[:depth], case)
        if isinstance(value, dict) and table is not None:
            of = [_of_key(key, field, value) for key, field in table.model_fields.items()]
            if ends := tuple(point for one in of for point in one if len(one) == 1):
                return ends
            if lines := [one for one in of if one]:
                return lines[0]
    return ()


def located(fault: Fault, words: str, content: Mapping[str, Any], case: type[BaseModel]) -> Fault:
    """Return a fault with its place and its points, from the words that say where it is."""
    place = fault.place or _naming(place_of(words, content, case), fault.what, content)
    at = fault.at or points_in(f"{words} {fault.what}") or points_at(place, content, case)
    return Fault(fault.what, fault.remedy, place, at)


def located_error(
    error: CaseError, content: Mapping[str, Any], case: type[BaseModel]
) -> tuple[Fault, ...]:
    """Return the faults of an error with their places: each, where it lists several."""
    each = LISTED.findall(error.what) or [(error.where, error.what, "")]
    return tuple(
        located(Fault(what, remedy or error.remedy), at, content, case) for at, what, remedy in each
    )


def remark(
    text: str,
    content: Mapping[str, Any],
    case: type[BaseModel],
    outline: OutlineOf = no_outline,
) -> Remark:
    """Return a note or a warning with its place and its points."""
    if isinstance(text, Remark) and (text.place or text.at):
        place = text.place
        return Remark(text, place, text.at or points_in(text) or points_at(place, content, case))
    place = place_of(text, content, case)
    block = re.search(r"\bblock (?:\d+ )?'([^']*)'", text)
    at = points_in(text) or (outline(block[1]) if block else ())
    return Remark(text, place, at or points_at(place, content, case))


def _naming(place: Place, what: str, content: Mapping[str, Any]) -> Place:
    """Return the key of the table at a place that names something there is not."""
    said, table = re.match(r"there is no [\w ]+ '([^']*)'", what), _value(place, content)
    if said is None or not isinstance(table, dict):
        return place
    keys = (key for key, value in table.items() if isinstance(value, str))
    key = next((key for key in keys if shortened(table[key]) == said[1]), None)
    return place if key is None else (*place, key)


def _beginnings(words: str) -> list[str]:
    """Return words, and each beginning of them, the longest first."""
    parts = words.split(" ")
    return [" ".join(parts[:k]) for k in range(len(parts), 0, -1)]


def _table(said: str, number: str | None, name: str | None, content: Mapping[str, Any]) -> Place:
    """Return the place of a table of some words, with its number from 1 or its name."""
    key = said.replace(" ", "_")
    if key == "block":
        return _block(number, name, content)
    if key not in content:
        return ()
    value = content[key]
    if isinstance(value, dict) and name is not None:
        own = next((one for one in value if shortened(str(one)) == name), None)
        return (key, Own(own)) if own is not None else (key,)
    if not _is_tables(value):
        return (key,)
    if number is not None:
        return (key, int(number) - 1) if 0 < int(number) <= len(value) else (key,)
    found = _index(value, name)
    return (key,) if found is None else (key, found)


def _block(number: str | None, name: str | None, content: Mapping[str, Any]) -> Place:
    """Return the place of a block: those by numbered vertices come first."""
    loops = (content.get("geometry") or {}).get("blocks", [])
    blocks = content.get("block", [])
    for place, tables in ((("geometry", "blocks"), loops), (("block",), blocks)):
        found = _index(tables, name)
        if name is not None and found is not None:
            return (*place, found)
    if number is None:
        return ()
    at = int(number) - 1
    if 0 <= at < len(loops):
        return ("geometry", "blocks", at)
    return ("block", at - len(loops)) if 0 <= at - len(loops) < len(blocks) else ()


def _index(tables: Sequence[Any], name: str | None) -> int | None:
    """Return the position of the table of a name."""
    names = [one.get("name") if isinstance(one, dict) else None for one in tables]
    return next((k for k, one in enumerate(names) if one and shortened(str(one)) == name), None)


def _below(
    place: Place, key: re.Match[str], content: Mapping[str, Any], case: type[BaseModel]
) -> Place:
    """Return a place with one key more, itself where there is no such key."""
    word, value = key[1], _value(place, content)
    if word.isdigit():
        is_there = isinstance(value, list | tuple) and 0 < int(word) <= len(value)
        return (*place, int(word) - 1) if is_there else place
    table = _table_class(place, case)
    if isinstance(value, dict) and (word in value or (table and word in keys_of(table))):
        name = key[2]
        named = isinstance(value.get(word), dict) and name in value[word]
        return (*place, word, Own(name)) if named else (*place, word)
    return place


def _table_class(place: Place, case: type[BaseModel]) -> type[BaseModel] | None:
    """Return the class of the table at a place, None where there is a value."""
    here, names = case, False
    for part in place:
        if isinstance(part, int) or names:
            names = names and isinstance(part, int)
            continue
        known = next((f for k, f in here.model_fields.items() if part in (k, f.alias)), None)
        table = table_in(known.annotation) if known else None
        if known is None or table is None:
            return None
        here, names = table, get_origin(known.annotation) is dict
    return here


def _value(place: Place, content: Mapping[str, Any]) -> Any:
    """Return the value at a place, None where there is none."""
    value: Any = content
    for part in place:
        try:
            value = value[part]
        except (KeyError, IndexError, TypeError):
            return None
    return value


def _of_key(key: str, field: Any, value: Mapping[str, Any]) -> Points:
    """Return the points of one key of a table."""
    return points_of(value.get(field.alias or key)) if geometry_of(field) else ()


def points_of(value: Any) -> Points:
    """Return the points of a value of the file, () where it has others or none."""
    if not isinstance(value, list | tuple) or not value:
        return ()
    each = [value] if isinstance(value[0], int | float) else value
    pairs = [one for one in each if isinstance(one, list | tuple) and len(one) == 2]
    numbers = all(isinstance(x, int | float) for one in pairs for x in one)
    return tuple((float(x), float(y)) for x, y in pairs) if numbers and pairs == each else ()


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(one, dict) for one in value)
