"""Case files as text: reading TOML, single values set from the command line, writing TOML."""

from __future__ import annotations

import copy
import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from clast.errors import CaseError

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
"""Keys that TOML allows without quotes."""


def read_text(path: Path) -> str:
    """Return the text of a case file, or say why it cannot be read."""
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise CaseError("there is no such file", where=str(path), remedy=_beside(path)) from None
    except IsADirectoryError:
        raise CaseError(
            "is a directory, not a case file", where=str(path), remedy=_beside(path / "x")
        ) from None
    except UnicodeDecodeError as error:
        raise CaseError(
            f"is not a text file (byte {error.start})",
            where=str(path),
            remedy="a case file is TOML in UTF-8; results are read by clast info and clast plot",
        ) from None
    except OSError as error:
        raise CaseError(
            f"cannot be read: {error.strerror}",
            where=str(path),
            remedy="see to the file's permissions",
        ) from None


def _beside(path: Path) -> str:
    """Return which case files lie where one was looked for."""
    try:
        found = sorted(path.parent.glob("*.toml"))[:8]
    except OSError:
        found = []
    listed = ", ".join(str(one) for one in found)
    return f"here are: {listed}" if found else "clast new makes one"


def parse(text: str, file: str) -> dict[str, Any]:
    """Return the content of a TOML text, or say in which line it is no TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = str(error)
        found = re.search(r"\(at line (\d+), column (\d+)\)", message)
        place = f"{file}: line {found[1]}, column {found[2]}" if found else f"{file}: at its end"
        what = message.partition(" (at ")[0]
        lines = text.splitlines()
        number = int(found[1]) if found else 0
        line = lines[number - 1].strip() if 1 <= number <= len(lines) else ""
        raise CaseError(
            f"is not TOML: {what[:1].lower()}{what[1:]}",
            where=place,
            remedy=f"the line reads: {line}" if line else "something is not closed before the end",
        ) from None


def with_values(content: Mapping[str, Any], settings: Iterable[str]) -> dict[str, Any]:
    """Return the content with values replaced by settings such as ``time.end=2``.

    Positions in lists count from 1: ``block.2.fixed=true``.
    """
    result: Any = copy.deepcopy(dict(content))
    for setting in settings:
        path, equals, written = setting.partition("=")
        if not equals or not path.strip():
            raise CaseError(
                f"'{setting}' sets nothing",
                where="--set",
                remedy="write it as table.key=value, e.g. --set time.end=2",
            )
        _set(result, path.strip().split("."), _value(written.strip()), setting)
    return dict(result)


def _value(written: str) -> Any:
    """Return a value written as in TOML; anything else is a text."""
    try:
        return tomllib.loads(f"value = {written}")["value"]
    except tomllib.TOMLDecodeError:
        return written


def _set(table: Any, keys: list[str], value: Any, setting: str) -> None:
    """Replace one value, making tables on the way."""
    here = table
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        if isinstance(here, list):
            if not key.isdigit() or not 1 <= int(key) <= len(here):
                raise CaseError(
                    f"'{'.'.join(keys[:depth])}' has the entries 1 to {len(here)}, not '{key}'",
                    where=f"--set {setting}",
                    remedy="give the number of an entry, from 1",
                )
            position: Any = int(key) - 1
        else:
            position = key
        if last:
            here[position] = value
            return
        inner = here[position] if isinstance(here, list) else here.setdefault(position, {})
        if isinstance(inner, str):
            # A choice given by its name alone gets numbers of its own.
            inner = here[position] = {"name": inner}
        if not isinstance(inner, dict | list):
            raise CaseError(
                f"'{'.'.join(keys[: depth + 1])}' is a single value",
                where=f"--set {setting}",
                remedy="set it as a whole",
            )
        here = inner


def to_toml(content: Mapping[str, Any]) -> str:
    """Return a case file's content as TOML: single values, then tables, then lists of tables."""
    lines = [
        f"{_key(key)} = {_written(value)}"
        for key, value in content.items()
        if not isinstance(value, dict) and not is_tables(value)
    ]
    for key, value in content.items():
        if isinstance(value, dict):
            lines += _table_lines(_key(key), value)
        elif is_tables(value):
            for table in value:
                lines += ["", f"[[{_key(key)}]]"]
                lines += [f"{_key(k)} = {_written(v)}" for k, v in table.items()]
    return "\n".join(lines) + "\n"


def _table_lines(name: str, table: Mapping[str, Any]) -> list[str]:
    """Return the lines of one table; a table of tables only (rock, joint) has one head each."""
    if table and all(isinstance(value, dict) for value in table.values()):
        return [
            line
            for key, inner in table.items()
            for line in _table_lines(f"{name}.{_key(key)}", inner)
        ]
    return ["", f"[{name}]", *(f"{_key(k)} = {_written(v)}" for k, v in table.items())]


def is_tables(value: Any) -> bool:
    """Return whether a value is a list of tables, as [[block]] gives."""
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def _key(key: str) -> str:
    return key if BARE_KEY.fullmatch(key) else json.dumps(key, ensure_ascii=False)


def _written(value: Any) -> str:
    """Return a value as TOML writes it; floats keep every digit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {_written(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_written(item) for item in value) + "]"
    return repr(value)
