"""A case file with every way of TOML to write something, and a second hand on its values."""

from __future__ import annotations

import copy
import json
import tomllib
from collections.abc import Iterator
from typing import Any

from clast.editor.edits import Edit, edited
from clast.errors import Place
from clast.inputs.declaring.positions import places_of

ODD = (
    r"""# Of a hand that likes variety.

schema = 1
"title" = "A \"wall\" # [not] a comment"   # with a comment
note = '''
[time] = ] # no table
''''
method.process = "modified"
method . "open" = 0x1F

  [time]   # indented
  step = 1e-3
  end= +2.0
day = 1979-05-27 07:32:00Z  # a date with a space
  # about rock
[rock.granite]
young=5_000e6
[rock."hard # rock"]
young = 6e9

[[block]]
name = "a"
vertices = [[0, 0], [1.50, 0], # corner
    [1, 1],   # another
  [0, 1] ]
# between
[region.x]
polygon = []
[[block]]  # interleaved
name = '''b'''
law = { name = "penalty", stiffness={a=1,  b = [1 ,2 , ] } }
empty = {}

# of its own

[block.inner]
deep.down = true
[[block.item]]
x = """
    + '"""three\n""quotes"""""'
    + r"""
[[block.item]]
[output]
points = [
  1,
  2 # last, no comma
]
tables = [{a = 1}, {a = 2}]"""
)
"""Valid TOML, though no case."""


def places(content: Any, above: Place = ()) -> Iterator[Place]:
    """Give the places of all values, tables and items."""
    pairs = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in pairs:
        yield (*above, key)
        if isinstance(value, dict | list):
            yield from places(value, (*above, key))


def at(content: Any, place: Place) -> Any:
    """Return what stands at a place."""
    for key in place:
        content = content[key]
    return content


def changed(content: dict[str, Any], edit: Edit) -> dict[str, Any]:
    """Return a content after an edit, by another way than the text's."""
    after = copy.deepcopy(content)
    holder, key = at(after, edit.place[:-1]), edit.place[-1]
    value = json.loads(edit.toml) if edit.do in ("set", "insert") else None
    if edit.do == "insert":
        holder.insert(key, value)
    elif edit.do == "set":
        holder[key] = value
    elif edit.do == "rename":
        holder[edit.toml] = holder.pop(key)
    else:
        del holder[key]
    return after


def without_empty(content: Any) -> Any:
    """Return a content without keys of nothing: of a list without entries nothing is written."""
    if isinstance(content, list):
        return [without_empty(one) for one in content]
    if not isinstance(content, dict):
        return content
    inside = {key: without_empty(one) for key, one in content.items()}
    return {key: one for key, one in inside.items() if one not in ({}, [])}


def written(text: str) -> dict:
    """Return the values of a text by place."""
    return {place: text[one.start : one.end] for place, one in places_of(text).values.items()}


def changed_and_back(text: str, content: dict, place: Place, raw: str) -> None:
    """Change a value to a text and back: nothing else of the case changes."""
    other = edited(text, Edit("set", place, '"another"'))
    assert at(tomllib.loads(other), place) == "another"
    assert len(other) == len(text) + len('"another"') - len(raw)
    back = edited(other, Edit("set", place, raw))
    assert back == text
