"""Case files as text: reading TOML, single values set from the command line, writing TOML."""

from __future__ import annotations

import copy
import json
import re
import stat
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from clast.errors import CaseError, ModelError, shortened

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
"""Keys that TOML allows without quotes."""
BYTE_ORDER_MARK = "\ufeff"
ECHO_LENGTH_MAX = 100
"""Most characters of a line that a message repeats."""


TEXT_FILE_BYTES_MAX = 300_000_000
"""Text files above this size are not read, bytes."""


def read_text(path: Path, advice: str = "") -> str:
    """Return the text of a case file or a record, or say why it cannot be read.

    Only regular files are read: a pipe may wait and a device go on for ever.  ``advice`` is the
    remedy where there is no such file; case files nearby are named without it.
    """
    return _read(path, advice, partial(Path.read_text, path, encoding="utf-8"))


def read_exact(path: Path) -> str:
    """Return the text of a file with the ends of lines that it has, or say why it has none."""
    return _read(path, "", lambda: path.read_bytes().decode("utf-8"))


def read_bytes(path: Path, advice: str) -> bytes:
    """Return the content of a file that is not text, or say why it cannot be read."""
    return _read(path, advice, path.read_bytes)


T = TypeVar("T")


def _read(path: Path, advice: str, read: Callable[[], T]) -> T:
    """Return the content that ``read`` gives, or say why it cannot be read, with the remedy."""
    where = str(path)
    try:
        _check_regular(path)
        return read()
    except FileNotFoundError:
        what, remedy = "there is no such file", advice or _beside(path)
    except IsADirectoryError:
        what, remedy = "is a directory, not a file", advice or _beside(path / "x")
    except UnicodeDecodeError as error:
        what = f"is not a text file (byte {error.start})"
        remedy = "a case file is TOML in UTF-8; results are read by clast info and clast plot"
        remedy = advice or remedy
    except ValueError:  # a NUL in the name
        what, where, remedy = "is not a valid file name", repr(where), "write a path without it"
    except OSError as error:
        what = f"cannot be read: {error.strerror}"
        remedy = "check the file's name and permissions"
    raise CaseError(what, where=where, remedy=remedy)


@contextmanager
def asked_by(where: str) -> Iterator[None]:
    """Name the table that asks for a file in the errors of its reader."""
    try:
        yield
    except CaseError as error:
        place = f"{where}: {error.where}" if error.where else where
        raise ModelError(error.what, where=place, remedy=error.remedy) from None


def _check_regular(path: Path) -> None:
    """Refuse a path that is not a regular file, or a file too large to be a text."""
    status = path.stat()
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError
    if not stat.S_ISREG(status.st_mode):
        what = "is a pipe, a socket or a device, not a regular file"
        raise CaseError(what, where=str(path), remedy="write its content into a file first")
    if status.st_size > TEXT_FILE_BYTES_MAX:
        raise CaseError(
            f"has {status.st_size:.3g} bytes, which is more than any text file of clast should "
            "have",
            where=str(path),
            remedy=f"files of up to {TEXT_FILE_BYTES_MAX:.0e} bytes are read; make large systems "
            "with clast.ModelBuilder",
        )


def _beside(path: Path) -> str:
    """Return which case files lie where one was looked for."""
    try:
        listed = ", ".join(map(str, sorted(path.parent.glob("*.toml"))[:8]))
    except OSError:
        listed = ""
    return f"files here: {listed}" if listed else "clast new makes one"


def parse(text: str, file: str) -> dict[str, Any]:
    """Return the content of a TOML text, or say in which line it is not TOML."""
    try:
        return tomllib.loads(text.removeprefix(BYTE_ORDER_MARK))
    except tomllib.TOMLDecodeError as error:
        message = str(error)
        at = re.search(r"\(at line (\d+), column (\d+)\)", message)
        place = f"{file}: line {at[1]}, column {at[2]}" if at else f"{file}: at its end"
        what = shortened(message.partition(" (at ")[0], ECHO_LENGTH_MAX)
        lines = text.splitlines()
        number = int(at[1]) if at else 0
        line = (
            shortened(lines[number - 1].strip(), ECHO_LENGTH_MAX)
            if 1 <= number <= len(lines)
            else ""
        )
        remedy = f"the line reads: {line}" if line else "a bracket or quote is not closed"
        raise CaseError(
            f"is not TOML: {what[:1].lower()}{what[1:]}", where=place, remedy=remedy
        ) from None
    except RecursionError:
        remedy = "close all brackets and braces; a few levels are enough"
        raise CaseError("is nested too deeply", where=file, remedy=remedy) from None
    except ValueError:  # Python converts no whole number of more than some thousand digits
        long = re.search(r"\d{1000}", text)
        row = text.count("\n", 0, long.start()) + 1 if long else 1
        what, remedy = "holds a number of more than 1000 digits", "write it in fewer digits"
        raise CaseError(what, where=f"{file}: line {row}", remedy=remedy) from None


def with_values(content: Mapping[str, Any], settings: Iterable[str]) -> dict[str, Any]:
    """Return the content with values replaced by settings such as ``time.end=2``.

    Positions in lists count from 1: ``block.2.fixed=true``.
    """
    result: Any = copy.deepcopy(dict(content))
    for setting in settings:
        path, equals, written = setting.partition("=")
        if not equals or not path.strip():
            remedy = "write it as table.key=value, e.g. --set time.end=2"
            raise CaseError(f"'{shortened(setting)}' sets no value", where="--set", remedy=remedy)
        where = f"--set {shortened(setting, ECHO_LENGTH_MAX)}"
        _set(result, path.strip().split("."), _value(written.strip(), where), where)
    return dict(result)


def _value(written: str, where: str) -> Any:
    """Return a value written as in TOML; anything else is a text."""
    try:
        table = tomllib.loads(f"value = {written}")
    except tomllib.TOMLDecodeError:
        return written
    except (RecursionError, ValueError):
        what = "is nested too deeply, or has too many digits"
        raise CaseError(what, where=where, remedy="write a number, a text or a list") from None
    return table["value"] if len(table) == 1 else written


def _set(table: Any, keys: list[str], value: Any, where: str) -> None:
    """Replace one value, making tables where there are none."""
    here = table
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        position: Any = key
        if isinstance(here, list):
            position = _position(key, len(here)) - 1
            if position < 0:
                what = (
                    f"'{shortened('.'.join(keys[:depth]))}' has entries 1 to {len(here)}, not "
                    f"'{shortened(key)}'"
                )
                raise CaseError(what, where=where, remedy="give the number of an entry, from 1")
        if last:
            here[position] = value
            return
        inner = here[position] if isinstance(here, list) else here.setdefault(position, {})
        if isinstance(inner, str):
            # A choice given by its name alone gets numbers of its own.
            inner = here[position] = {"name": inner}
        if not isinstance(inner, dict | list):
            what = f"'{shortened('.'.join(keys[: depth + 1]))}' is a single value"
            raise CaseError(what, where=where, remedy="set it as a whole")
        here = inner


def _position(key: str, count: int) -> int:
    """Return the number from 1 of an entry of a list, 0 where there is none."""
    is_number = re.fullmatch("[0-9]{1,9}", key) is not None
    return int(key) if is_number and 1 <= int(key) <= count else 0


def to_toml(content: Mapping[str, Any]) -> str:
    """Return a case file's content as TOML: single values, then tables, then lists of tables."""
    lines = [
        f"{written_key(key)} = {_written(value)}"
        for key, value in content.items()
        if not isinstance(value, dict) and not is_tables(value)
    ]
    for key, value in content.items():
        if isinstance(value, dict):
            lines += _table_lines(written_key(key), value)
        elif is_tables(value):
            for table in value:
                lines += ["", f"[[{written_key(key)}]]"]
                lines += [f"{written_key(k)} = {_written(v)}" for k, v in table.items()]
    return "\n".join(lines) + "\n"


def _table_lines(name: str, table: Mapping[str, Any]) -> list[str]:
    """Return the lines of one table; a table of tables only (rock, joint) has one head each."""
    if table and all(isinstance(value, dict) for value in table.values()):
        return [
            line
            for key, inner in table.items()
            for line in _table_lines(f"{name}.{written_key(key)}", inner)
        ]
    return ["", f"[{name}]", *(f"{written_key(k)} = {_written(v)}" for k, v in table.items())]


def is_tables(value: Any) -> bool:
    """Return whether a value is a list of tables, as [[block]] gives."""
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def written_key(key: str) -> str:
    """Return a key as TOML writes it: in quotes where it must be."""
    return key if BARE_KEY.fullmatch(key) else _text(key)


def _text(text: str) -> str:
    """Return a text in quotes; TOML wants DEL escaped, which JSON does not."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _written(value: Any) -> str:
    """Return a value as TOML writes it; floats keep every digit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{written_key(k)} = {_written(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_written(item) for item in value) + "]"
    return repr(value)
