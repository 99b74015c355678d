"""Earlier keys of tables: they are read for one version more, and said to have another name.

A table says which of its keys had another name in ``EARLIER``, earlier -> present key.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from clast.inputs.declaring.text import is_tables
from clast.inputs.declaring.validation_messages import Place, table_in

Content = Mapping[str, Any]


def earlier_of(table: type[BaseModel] | None) -> Mapping[str, str]:
    """Return the earlier keys of a table with the present ones."""
    earlier: Mapping[str, str] = getattr(table, "EARLIER", {})
    return earlier


def with_present_keys(keys: Content, table: type[BaseModel]) -> tuple[dict[str, Any], list[str]]:
    """Return the keys of a table by their present names, and the earlier ones that it had.

    Where both are given the earlier one stays, to be refused; tables by name are put together.
    """
    given, said = dict(keys), []
    for earlier, name in earlier_of(table).items():
        if earlier not in given:
            continue
        one, other = given[earlier], given.get(name, {})
        named = isinstance(one, dict) and isinstance(other, dict)
        if name in given and not (named and one.keys().isdisjoint(other)):
            continue
        del given[earlier]
        given[name] = {**other, **one} if named else one
        said.append(earlier)
    return given, said


def case_with_present_keys(content: Content, case: type[BaseModel]) -> tuple[Content, list[str]]:
    """Return the content of a case file by present names, and how each earlier one is called."""
    given, said = with_present_keys(content, case)
    pairs = [(earlier, earlier_of(case)[earlier]) for earlier in said]
    for key, entry in case.model_fields.items():
        kind = table_in(entry.annotation)
        if kind is None or not earlier_of(kind) or not is_tables(given.get(key)):
            continue
        tables = [with_present_keys(one, kind) for one in given[key]]
        given[key] = [one for one, _ in tables]
        pairs += [(earlier, earlier_of(kind)[earlier]) for _, said in tables for earlier in said]
    return given, [f"{earlier} is called {name}" for earlier, name in dict.fromkeys(pairs)]


def warning_of(renamed: Iterable[str]) -> tuple[str, ...]:
    """Return the warning that a case file has earlier keys, if it has any."""
    listed = ", ".join(renamed)
    return (
        (f"{listed} now; the earlier names will be removed in the next version",) if listed else ()
    )


def present_path(keys: Sequence[str], case: type[BaseModel]) -> tuple[str, ...]:
    """Return the keys of a path, table.ramp.value or point_load.1.factor, by present names."""
    first = earlier_of(case).get(keys[0], keys[0])
    entry = case.model_fields.get(first)
    earlier = earlier_of(None if entry is None else table_in(entry.annotation))
    return first, *keys[1:2], *(earlier.get(key, key) for key in keys[2:])


def as_written(place: Place, content: Content, case: type[BaseModel]) -> Place:
    """Return a place by the names that its file has, be they earlier ones."""
    if not place:
        return place
    top, within = place[:2], place[2:]
    for earlier, name in earlier_of(case).items():
        if top[0] != name or earlier not in content:
            continue
        other: Any = content.get(name)
        elsewhere = len(top) > 1 and isinstance(other, dict) and top[1] not in other
        if name not in content or elsewhere:
            return earlier, *place[1:]
    entry = case.model_fields.get(str(top[0]))
    tables: Any = content.get(str(top[0]))
    if not within or entry is None or not is_tables(tables):
        return place
    own: Any = tables[top[1]]
    for earlier, name in earlier_of(table_in(entry.annotation)).items():
        if within[0] == name and name not in own and earlier in own:
            return *top, earlier, *within[1:]
    return place
