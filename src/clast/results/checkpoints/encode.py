"""Plain data as a text and a list of arrays, and back, to the bit.

Plain are None, truth values, numbers, texts, arrays, enumerations, and tuples, lists, sets,
mappings and dataclasses of plain data.  Classes go by their names.  A name is looked up among
clast's own dataclasses and enumerations, and among classes that are handed in: reading a file never
runs anything that the file names.  Decoded objects have fields of the types that their classes
declare.
"""

from __future__ import annotations

import dataclasses
import re
import sys
import types
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum
from importlib import import_module
from operator import attrgetter
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from clast.errors import shortened

Arrays = list[NDArray[Any]]
"""Arrays that a text refers to by their numbers."""
NUMBERS: dict[Any, tuple[type, ...]] = {
    float: (float, int, np.floating, np.integer),
    int: (int, np.integer),
}
"""Types that may stand for a number, but for truth values."""
OURS = re.compile(r"clast\.(actions|contact|model|results|run|step)(\.[a-z][a-z0-9_]*)+")
"""Modules whose classes a run may carry; to import one does nothing else."""


class NotPlainError(Exception):
    """A value that is not plain data; ``place`` is where it is, ``kind`` its type."""

    def __init__(self, kind: str, place: str) -> None:
        self.kind = kind
        self.place = place
        super().__init__(f"{place} is a {kind}")


class UnknownClassError(Exception):
    """A text that names a class which is not known, or has other fields than it had."""


def name_of(kind: type) -> str:
    """Return the name that a class goes by: module and name in it."""
    return f"{kind.__module__}:{kind.__qualname__}"


def taken_apart(value: Any, arrays: Arrays, place: str = "") -> Any:
    """Return a value as JSON has it; its arrays go into ``arrays``.

    Raises NotPlainError, with the place, for values that are not plain data.
    """
    if value is None or type(value) in (bool, int, float, str):
        return value
    if isinstance(value, Enum):
        return {"enum": name_of(type(value)), "name": value.name}
    if isinstance(value, np.generic):
        return {"scalar": _kept(np.asarray(value), arrays, place)}
    if isinstance(value, np.ndarray):
        return {"array": _kept(value, arrays, place)}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        parts = {
            entry.name: taken_apart(getattr(value, entry.name), arrays, f"{place}.{entry.name}")
            for entry in dataclasses.fields(value)
        }
        return {"is": name_of(type(value)), "with": parts}
    if isinstance(value, Mapping):
        pairs = [
            [taken_apart(one, arrays, f"{place}[...]") for one in pair] for pair in value.items()
        ]
        return {"map": pairs}
    name = next((name for name, kind in ROWS.items() if type(value) is kind), None)
    if name is None:
        raise NotPlainError(type(value).__name__, place.removeprefix("."))
    return {name: [taken_apart(one, arrays, f"{place}[{at}]") for at, one in enumerate(value)]}


ROWS: dict[str, Any] = {"tuple": tuple, "list": list, "set": frozenset}
"""Kinds of rows of values."""


def _kept(array: NDArray[Any], arrays: Arrays, place: str) -> int:
    if array.dtype.hasobject:
        raise NotPlainError("array of objects", place.removeprefix("."))
    arrays.append(array)
    return len(arrays) - 1


def put_together(written: Any, arrays: Sequence[NDArray[Any]], known: Mapping[str, type]) -> Any:
    """Return the value that ``taken_apart`` gave; ``known`` are classes that are not clast's own.

    Raises UnknownClassError for a class that is not known, KeyError, IndexError, TypeError or
    ValueError for data that ``taken_apart`` never writes.
    """
    if not isinstance(written, dict):
        if written is not None and not isinstance(written, bool | int | float | str):
            raise TypeError("a row of JSON")
        return written
    if "array" in written:
        return _array_of(written["array"], arrays)
    if "scalar" in written:
        return _array_of(written["scalar"], arrays)[()]
    if "enum" in written:
        kind = _class(written["enum"], known)
        if not issubclass(kind, Enum):
            raise TypeError("no enumeration")
        return kind[written["name"]]
    if "is" in written:
        parts = written["with"].items()
        values = {name: put_together(part, arrays, known) for name, part in parts}
        return _made(_class(written["is"], known), values)
    if "map" in written:
        pairs = ([put_together(one, arrays, known) for one in pair] for pair in written["map"])
        return {key: value for key, value in pairs}
    name = next(iter(written), "")
    return ROWS[name](put_together(one, arrays, known) for one in written[name])


def _array_of(number: Any, arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    if type(number) is not int or not 0 <= number < len(arrays):
        raise IndexError("there is no such array")
    return arrays[number]


def _class(name: str, known: Mapping[str, type]) -> type:
    """Return the class of a name: a dataclass or an enumeration."""
    if not isinstance(name, str):
        raise TypeError("no name of a class")
    module, _, inner = name.partition(":")
    kind: Any = known.get(name)
    if kind is None and OURS.fullmatch(module):
        try:
            kind = attrgetter(inner)(import_module(module))
        except (ImportError, AttributeError):
            kind = None
    if not isinstance(kind, type) or not (dataclasses.is_dataclass(kind) or issubclass(kind, Enum)):
        raise UnknownClassError(f"{shortened(inner)} of {shortened(module)} is not known")
    return kind


def _made(kind: type, values: Mapping[str, Any]) -> Any:
    """Return an object with these fields, as they were: nothing is computed anew.

    Raises UnknownClassError for other fields than the class has, TypeError for those of other
    types than it says.
    """
    if not dataclasses.is_dataclass(kind):
        raise TypeError("no dataclass")
    fields = {entry.name for entry in dataclasses.fields(kind)}
    if fields != set(values):
        raise UnknownClassError(f"{kind.__qualname__} has other fields than it had")
    hints = _hints(kind)
    for name, value in values.items():
        if not fits(value, hints.get(name, Any)):
            raise TypeError(f"{kind.__qualname__}.{name} is of another type")
    one: Any = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(one, name, value)
    return one


def is_well_typed(value: Any) -> bool:
    """Return whether all fields of a dataclass, and of those in it, are of their types."""
    if isinstance(value, tuple):
        return all(map(is_well_typed, value))
    if not dataclasses.is_dataclass(value):
        return True
    hints = _hints(type(value))
    parts = ((one.name, getattr(value, one.name)) for one in dataclasses.fields(value))
    return all(fits(part, hints.get(name, Any)) and is_well_typed(part) for name, part in parts)


def fits(value: Any, hint: Any) -> bool:
    """Return whether a value is of a type: numbers, texts, arrays, and collections of them.

    A type without plain data, as a protocol, takes whatever there is.
    """
    if hint is Any:
        return True
    if hint is None or hint is type(None):
        return value is None
    if hint in NUMBERS:
        return isinstance(value, NUMBERS[hint]) and not isinstance(value, bool)
    if hint is bool:
        return isinstance(value, bool | np.bool_)
    origin = get_origin(hint)
    check = OF_ORIGIN.get(origin)
    if check is not None:
        return bool(check(value, get_args(hint)))
    if origin is None and isinstance(hint, type) and not getattr(hint, "_is_protocol", False):
        return isinstance(value, hint)
    return True


def _hints(kind: type) -> dict[str, Any]:
    """Return the types of the fields of a class; nothing where they cannot be known."""
    try:
        return get_type_hints(kind)
    except (NameError, AttributeError, TypeError):  # names that only a type checker sees
        return {}


def _tuple(value: Any, hints: tuple[Any, ...]) -> bool:
    if not isinstance(value, tuple):
        return False
    if len(hints) == 2 and hints[1] is Ellipsis:
        return all(fits(one, hints[0]) for one in value)
    same = len(value) == len(hints)
    return same and all(fits(one, hint) for one, hint in zip(value, hints, strict=True))


def _row(value: Any, hints: tuple[Any, ...]) -> bool:
    return all(fits(one, hints[0]) for one in value)


def _mapping(value: Any, hints: tuple[Any, ...]) -> bool:
    return isinstance(value, Mapping) and all(
        fits(key, hints[0]) and fits(one, hints[1]) for key, one in value.items()
    )


def _array(value: Any, hints: tuple[Any, ...]) -> bool:
    """Return whether a value is an array of NDArray's number."""
    if not isinstance(value, np.ndarray) or value.dtype.hasobject:
        return False
    wanted = get_args(hints[1])
    return not wanted or wanted[0] is Any or value.dtype == np.dtype(wanted[0])


def _one_of(value: Any, hints: tuple[Any, ...]) -> bool:
    return any(fits(value, hint) for hint in hints)


OF_ORIGIN: dict[Any, Any] = {
    types.UnionType: _one_of,
    Union: _one_of,
    tuple: _tuple,
    list: lambda value, hints: isinstance(value, list) and _row(value, hints),
    frozenset: lambda value, hints: isinstance(value, frozenset) and _row(value, hints),
    dict: _mapping,
    Mapping: _mapping,
    np.ndarray: _array,
}
"""Checks of types with parts, by their origin."""


def classes_near(things: Iterable[Any]) -> dict[str, type]:
    """Return the dataclasses and enumerations that stand beside the classes of things, by name."""
    modules = {type(thing).__module__ for thing in things} & set(sys.modules)
    beside = (value for name in modules for value in vars(sys.modules[name]).values())
    kinds = (
        kind
        for kind in beside
        if isinstance(kind, type) and (dataclasses.is_dataclass(kind) or issubclass(kind, Enum))
    )
    return {name_of(kind): kind for kind in (*kinds, *map(type, things))}
