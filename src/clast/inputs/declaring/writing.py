"""From what a script has put together to the content of a case file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from pydantic import BaseModel

from clast.errors import CaseError
from clast.inputs.declaring.choices import Given


def table_of(kind: type[BaseModel], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table of a case file with those of its ``values`` that differ from the defaults."""
    plain = {key: as_plain(value) for key, value in values.items()}
    defaults = {key: as_plain(field.default) for key, field in kind.model_fields.items()}
    names = {key: field.alias or key for key, field in kind.model_fields.items()}
    return {names[key]: value for key, value in plain.items() if value != defaults[key]}


def as_plain(value: Any) -> Any:
    """Return a value in the types of a case file: arrays and tuples become lists, tables too."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [as_plain(item) for item in value]
    if isinstance(value, dict):
        return {key: as_plain(item) for key, item in value.items()}
    if isinstance(value, BaseModel):
        return table_of(type(value), dict(value))
    return value


def without_objects(value: Any, instead: Callable[[Any], str]) -> Any:
    """Return a value in which texts are ``instead`` of the objects that a script has put in."""
    if isinstance(value, dict):
        return {key: without_objects(inner, instead) for key, inner in value.items()}
    return instead(value.value) if isinstance(value, Given) else value


def refuse_object(value: Any) -> str:
    """Raise CaseError: no file holds an object of a script."""
    raise CaseError(
        f"{type(value).__name__} is an object of a script, which no case file can hold",
        where="[method]",
        remedy="give it a name there (CONTRIBUTING says how), or run the case from the script",
    )
