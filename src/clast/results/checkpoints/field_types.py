"""Whether values can stand in the fields of a dataclass, by the types that it says."""

from __future__ import annotations

import types
from collections.abc import Mapping
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

NUMBERS: dict[Any, tuple[type, ...]] = {
    float: (float, int, np.floating, np.integer),
    int: (int, np.integer),
}
"""Types that may stand for a number, but for truth values."""


def wrong_field(kind: type, values: Mapping[str, Any]) -> str:
    """Return the name of a field whose value has another type than its class says; "" for none."""
    hints = _hints(kind)
    return next((name for name in values if not fits(values[name], hints.get(name, Any))), "")


def fits(value: Any, hint: Any) -> bool:
    """Return whether a value is of a type: numbers, texts, arrays, and collections of them.

    A type that says nothing of plain data, as a protocol does, takes whatever there is.
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


def _one_of(value: Any, hints: tuple[Any, ...]) -> bool:
    return any(fits(value, hint) for hint in hints)


def _tuple(value: Any, hints: tuple[Any, ...]) -> bool:
    if not isinstance(value, tuple):
        return False
    if len(hints) == 2 and hints[1] is Ellipsis:
        return all(fits(one, hints[0]) for one in value)
    same = len(value) == len(hints)
    return same and all(fits(one, hint) for one, hint in zip(value, hints, strict=True))


def _row(kind: Any) -> Any:
    return lambda value, hints: (
        isinstance(value, kind) and all(fits(one, hints[0]) for one in value)
    )


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


OF_ORIGIN: dict[Any, Any] = {
    types.UnionType: _one_of,
    Union: _one_of,
    tuple: _tuple,
    list: _row(list),
    frozenset: _row(frozenset),
    dict: _mapping,
    Mapping: _mapping,
    np.ndarray: _array,
}
"""Checks of types with parts, by their origin."""
