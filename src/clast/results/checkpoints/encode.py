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
from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import shortened
from clast.results.checkpoints.field_types import wrong_field

Arrays = list[NDArray[Any]]
"""Arrays that a text refers to by their numbers."""
MOVED = {
    "clast.run.simulate:RunState": "clast.run.run_state:RunState",
    "clast.run.tally:Tally": "clast.run.run_state:Tally",
    "clast.results.report:Report": "clast.results.run_report:Report",
    "clast.run.stages.position:Held": "clast.run.stages.stage_position:EquilibriumStreak",
    "clast.run.stages.position:Position": "clast.run.stages.stage_position:Position",
    "clast.run.stages.position:EquilibriumStreak": (
        "clast.run.stages.stage_position:EquilibriumStreak"
    ),
    "clast.run.stages.position:Judged": "clast.run.stages.stage_position:Judgement",
    "clast.run.stages.failing:Scales": "clast.run.stages.failure_verdict:Scales",
    "clast.actions.held_back:HeldBack": "clast.actions.holding_forces:HoldingForces",
    "clast.actions.damping:Motion": "clast.actions.damping:DampingState",
    "clast.model.stages.reference:Reference": "clast.model.stages.reference:ReferenceState",
    "clast.results.recorder:Mark": "clast.results.recorder:RecordMark",
}
"""Earlier names of classes, module and name, in older checkpoints -> present names."""
MOVED_FIELDS = {"SupportForces": {"gone": "absent"}}
"""Class -> earlier names of its fields, in older checkpoints -> present names."""
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


# writing ---------------------------------------------------------------------------------------


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
    """Put an array into the list; return its number."""
    if array.dtype.hasobject:
        raise NotPlainError("array of objects", place.removeprefix("."))
    arrays.append(array)
    return len(arrays) - 1


# reading ---------------------------------------------------------------------------------------


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
        return arrays[_number(written["array"], len(arrays))]
    if "scalar" in written:
        return arrays[_number(written["scalar"], len(arrays))][()]
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


def _number(written: Any, count: int) -> int:
    """Return the number of an array, counted from the first."""
    if type(written) is not int or not 0 <= written < count:
        raise IndexError("there is no such array")
    return written


def _class(name: str, known: Mapping[str, type]) -> type:
    """Return the class of a name: a dataclass or an enumeration."""
    if not isinstance(name, str):
        raise TypeError("no name of a class")
    module, _, inner = MOVED.get(name, name).partition(":")
    found: Any = known.get(name)
    if found is None and OURS.fullmatch(module):
        try:
            found = import_module(module)
            for part in inner.split("."):
                found = getattr(found, part)
        except (ImportError, AttributeError):
            found = None
    if not isinstance(found, type) or not (
        dataclasses.is_dataclass(found) or issubclass(found, Enum)
    ):
        raise UnknownClassError(f"{shortened(inner)} of {shortened(module)} is not known")
    return found


def _made(kind: type, values: Mapping[str, Any]) -> Any:
    """Return an object with these fields, as they were: nothing is computed anew.

    Raises UnknownClassError for other fields than the class has, TypeError for those of other
    types than it says.
    """
    if not dataclasses.is_dataclass(kind):
        raise TypeError("no dataclass")
    earlier = MOVED_FIELDS.get(kind.__name__, {})
    values = {earlier.get(name, name): value for name, value in values.items()}
    fields = {entry.name for entry in dataclasses.fields(kind)}
    if fields != set(values):
        raise UnknownClassError(f"{kind.__qualname__} has other fields than it had")
    wrong = wrong_field(kind, values)
    if wrong:
        raise TypeError(f"{kind.__qualname__}.{wrong} is of another type")
    one: Any = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(one, name, value)
    return one


def classes_near(things: Iterable[Any]) -> dict[str, type]:
    """Return the dataclasses and enumerations that stand beside the classes of things, by name."""
    modules = {type(thing).__module__ for thing in things}
    kinds = (kind for name in modules for kind in _classes_in(sys.modules.get(name)))
    return {name_of(kind): kind for kind in (*kinds, *map(type, things))}


def _classes_in(module: Any) -> Iterator[type]:
    for value in vars(module).values() if module is not None else ():
        if isinstance(value, type) and (dataclasses.is_dataclass(value) or issubclass(value, Enum)):
            yield value
