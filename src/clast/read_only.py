"""Read-only arrays, and frozen dataclasses that are replaced.

The arrays are those of a model, and of the states that a run goes through.  The next step, a
rejected step that is tried again, and a checkpoint rely on the state.  An array that is edited in
place would change them without a word.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

Value = TypeVar("Value")


def read_only(value: Any) -> Any:
    """Return an array as a view that cannot be written to, and tuples and dataclasses of them.

    The arrays of a dataclass are replaced in it; the array that a caller holds stays as it is.
    """
    if isinstance(value, np.ndarray):
        if value.flags.writeable:
            value = value.view()
            value.flags.writeable = False
        return value
    if type(value) is tuple and value and not isinstance(value[0], str | float | int):
        return tuple([None if one is None else read_only(one) for one in value])
    if hasattr(type(value), "__dataclass_fields__"):
        seal(value)
    return value


def seal(thing: Any, but: tuple[str, ...] = ()) -> None:
    """Make the arrays of a dataclass read-only, and those of its fields; ``but`` some fields."""
    held = thing.__dict__
    for name, value in held.items():
        kind = type(value)
        # a state is sealed in every step: what it has most of goes first
        if kind is float or value is None or name in but:
            continue
        if kind is np.ndarray:
            if value.flags.writeable:
                held[name] = view = value.view()
                view.flags.writeable = False
            continue
        sealed = read_only(value)
        if sealed is not value:
            held[name] = sealed


def changed(thing: Value, **fields: Any) -> Value:
    """Return a frozen dataclass with other ``fields``: dataclasses.replace, in a third of its time.

    For classes without ``__post_init__``; cached properties of ``thing`` are computed anew.
    """
    before: Any = thing
    made = object.__new__(before.__class__)
    now, held = made.__dict__, before.__dict__
    for name in before.__dataclass_fields__:
        now[name] = held[name]
    now |= fields
    result: Value = made
    return result


class kept_property(cached_property[Value]):  # noqa: N801 - used as `property` is
    """A property that is computed once; its arrays are read-only."""

    def __init__(self, function: Callable[[Any], Value]) -> None:
        super().__init__(lambda thing: read_only(function(thing)))
        self.__doc__ = function.__doc__
