"""Write the reference of the case file, docs/reference/case-file.md, from its JSON Schema.

    python tools/case_reference.py            # writes the page, and the schema beside it
    python tools/case_reference.py -          # prints the page

The schema is what ``clast schema`` prints, and that comes from the declarations of inputs, so the
page says what clast reads.  A test compares both files with what this writes: their difference
shows what a change of an input means to users.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from clast.inputs.declaring.field_docs import UNIT

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "case-file.md"
SCHEMA = PAGE.with_suffix(".schema.json")

HEAD = """\
# The case file

Written by `make reference` from the models that read case files; `clast schema` prints the same as
a JSON Schema, for editors that complete and check TOML. Units are SI per metre of thickness, angles
degrees, stresses tension-positive in the order xx, yy, xy. A key without a default must be given; a
dash means that it may be left out. Unknown keys are refused with the nearest valid one.
`--set time.end=2` replaces a value for a run.

"""

METHOD_HEAD = """\
Each key is a name, or a table with the name and its numbers:
`process = "modified"` or `process = {name = "modified", passes = 2}`.

"""

Schema = dict[str, Any]


def page(schema: Schema) -> str:
    """Return the page as Markdown."""
    tables = schema["$defs"]
    # tables that only stand in another one are written there
    properties = schema["properties"]
    top = {"": _table(properties, schema["required"])}
    for key, value in properties.items():
        name = _reference(value)
        if name is not None:
            top[_heading(key, value)] = _section(tables[name], tables)
        elif chosen := _alternatives(key, value):
            top[f"`[{key}]`"] = f"{_plain(value['description'])}\n\n{_headless(chosen)}"
    parts = [HEAD, "## Top of the file\n\n", top.pop("")]
    parts += [f"\n## {heading}\n\n{text}" for heading, text in top.items()]
    return "".join(parts)


def _heading(key: str, value: Schema) -> str:
    """Return how a table of the file is written."""
    if value.get("type") == "array":
        return f"`[[{key}]]`"
    return f"`[{key}.NAME]`" if "additionalProperties" in value else f"`[{key}]`"


def _section(table: Schema, tables: Schema) -> str:
    """Return the description of a table, its keys and the tables within it."""
    keys, required = table["properties"], table.get("required", [])
    text = _plain(table.get("description", "")) + "\n\n"
    if table["title"] == "MethodTable":
        text += METHOD_HEAD
    text += _table(keys, required)
    inside: dict[str, list[str]] = {}
    for key, value in keys.items():
        text += _alternatives(key, value)
        inner = _reference(value)
        if inner is not None:
            inside.setdefault(inner, []).append(f"`{key}`")
    for inner, names in inside.items():
        text += f"\n### Each of {', '.join(names)}\n\n{_section(tables[inner], tables)}"
    return text


def _alternatives(key: str, value: Schema) -> str:
    """Return what the names of a choice mean, and the numbers that each has."""
    choices = [one for one in value.get("anyOf", []) if "name" in one.get("properties", {})]
    text = f"\n### `{key}`\n\n" if choices else ""
    for choice in choices:
        numbers = {name: number for name, number in choice["properties"].items() if name != "name"}
        text += (
            f"**`{choice['properties']['name']['const']}`** — {_plain(choice['description'])}\n\n"
        )
        text += _table(numbers, []) + "\n" if numbers else ""
        for name, number in numbers.items():
            text += _nested(name, number)
    return text.rstrip("\n") + "\n" if text else ""


def _headless(text: str) -> str:
    """Return the alternatives of a choice without their heading."""
    return text.partition("\n\n")[2]


def _nested(name: str, number: Schema) -> str:
    """Return a list of the alternatives of a number that is a choice itself."""
    lines = [
        f'- `{name} = "{one["properties"]["name"]["const"]}"`: {_plain(one["description"])}\n'
        for one in number.get("anyOf", [])
        if "name" in one.get("properties", {})
    ]
    return "".join(lines) + "\n" if lines else ""


def _table(keys: Schema, required: list[str]) -> str:
    """Return the keys as a table: key, type, unit, default and meaning."""
    rows = ["| key | type | unit | default | meaning |\n", "| --- | --- | --- | --- | --- |\n"]
    for key, value in sorted(keys.items(), key=lambda one: one[0] not in required):
        meaning = _plain(value.get("description", ""))
        unit = UNIT.search(meaning)
        if unit:
            meaning = meaning[: unit.start()] + meaning[unit.end() :]
        cells = (
            f"`{key}`",
            _type(value),
            unit.group(1) if unit else "",
            "" if key in required else _default(value),
            meaning,
        )
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n")
    return "".join(rows)


def _default(value: Schema) -> str:
    """Return the default of a key as TOML has it, or why there is none to write."""
    default = value.get("default")
    return "-" if default in (None, {}, []) else f"`{json.dumps(default)}`"


def _type(value: Schema) -> str:
    """Return the type of a value in words, with its limits."""
    options = [one for one in _options(value) if one.get("type") != "null"]
    if options:
        return " or ".join(dict.fromkeys(_type(one) for one in options if not _is_chosen(one)))
    if "$ref" in value:
        return "table"
    if "const" in value or "enum" in value:
        return " or ".join(
            f"`{json.dumps(one)}`" for one in value.get("enum", [value.get("const")])
        )
    if value.get("type") == "array":
        if "prefixItems" in value:
            return "[" + ", ".join(_type(one) for one in value["prefixItems"]) + "]"
        inner = value["items"]
        return "tables" if "$ref" in inner else f"list of {_type(inner)}"
    if value.get("type") == "object":
        return "tables by name"
    return f"{value.get('type', 'any')}{_limits(value)}"


def _is_chosen(value: Schema) -> bool:
    """Return True for the long form of a choice, which has a section of its own."""
    return "name" in value.get("properties", {})


def _limits(value: Schema) -> str:
    """Return the limits of a number."""
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    found = [f"{sign} {value[key]:g}" for key, sign in signs.items() if key in value]
    return " " + ", ".join(found) if found else ""


def _reference(value: Schema) -> str | None:
    """Return the table that a key holds, one or several of."""
    for one in (
        value,
        value.get("items"),
        value.get("additionalProperties"),
    ):
        if isinstance(one, dict) and "$ref" in one:
            return str(one["$ref"]).rsplit("/", 1)[-1]
    inner = (_reference(one) for one in _options(value))
    return next((name for name in inner if name is not None), None)


def _options(value: Schema) -> list[Schema]:
    """Return the forms that a value may have, none where it has only one."""
    return [*value.get("anyOf", []), *value.get("oneOf", [])]


def _plain(text: str) -> str:
    """Return a docstring as one line of Markdown: its first paragraph."""
    first = " ".join(text.split("\n\n")[0].split())
    return first.replace("``", "`").replace(" <- ", " ← ").replace("[[", "\\[[")


def main() -> None:
    """Write the page, or print it."""
    printed = subprocess.run(
        [sys.executable, "-m", "clast", "schema"], capture_output=True, text=True, check=True
    )
    text = page(json.loads(printed.stdout))
    if "-" in sys.argv[1:]:
        sys.stdout.write(text)
    else:
        PAGE.write_text(text, "utf-8")
        SCHEMA.write_text(printed.stdout, "utf-8")


if __name__ == "__main__":
    main()
