"""Fingerprints of a model and a method, part by part: these must be the same to go on."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from enum import Enum
from functools import cached_property
from hashlib import sha256
from typing import Any

import numpy as np

LENGTH = 16
"""Hexadecimal digits of a fingerprint."""
SHAPE = (
    "origin",
    "block_name",
    "block_start",
    "block_rock",
    "fixed",
    "vertices",
    "area",
)
"""Parts of a model that no stage changes: the blocks."""


def fingerprints(**things: Any) -> dict[str, str]:
    """Return a fingerprint of every field of some dataclasses: ``model.vertices`` and so on."""
    return {
        f"{name}.{field.name}": digest(getattr(thing, field.name))
        for name, thing in things.items()
        for field in dataclasses.fields(thing)
    }


def digest(value: Any) -> str:
    """Return a fingerprint of anything: of its class, and of its content."""
    found = sha256()
    _feed(found, value)
    return found.hexdigest()[:LENGTH]


def _feed(found: Any, value: Any) -> None:
    """Add a value to a checksum, with its type, so that equal contents of other types differ."""
    if isinstance(value, np.ndarray | np.generic) and not value.dtype.hasobject:
        array = np.ascontiguousarray(value)
        found.update(f"{array.dtype.str}{array.shape}".encode())
        found.update(array.tobytes())
        return
    kind = type(value)
    found.update(f"<{kind.__module__}.{kind.__qualname__}".encode())
    if value is None or isinstance(value, bool | int | float | str | bytes | slice):
        found.update(repr(value).encode(errors="surrogatepass"))
    elif isinstance(value, Enum):
        found.update(value.name.encode())
    else:
        for name, part in _parts(value).items():
            _feed(found, name)
            _feed(found, part)
    found.update(b">")


def _parts(value: Any) -> Mapping[Any, Any]:
    """Return the content of an object, by name or place."""
    if isinstance(value, Mapping):
        return value
    if isinstance(value, tuple | list | np.ndarray):
        return dict(enumerate(value))
    if isinstance(value, set | frozenset):
        return dict(enumerate(sorted(value, key=repr)))
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if hasattr(value, "__qualname__"):
        return {"name": f"{value.__module__}.{value.__qualname__}"}
    # what is computed when it is first asked for is not part of a thing
    computed = {name for name in vars(type(value)) if _is_computed(type(value), name)}
    held = getattr(value, "__dict__", {})
    return {name: held[name] for name in sorted(held) if name not in computed}


def _is_computed(kind: type, name: str) -> bool:
    return isinstance(vars(kind).get(name), cached_property)
