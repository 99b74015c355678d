"""From the inputs of a script to the content of a case file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from pydantic import BaseModel

from clast.errors import CaseError
from clast.inputs.declaring.alternatives import GivenObject
from clast.inputs.declaring.text import is_tables
from clast.inputs.declaring.validation_messages import Place, place_text


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


Instead = Callable[[Any, str], str]
"""Makes a text of an object and of its place."""


def without_objects(content: Mapping[str, Any], instead: Instead) -> dict[str, Any]:
    """Return a content in which texts are ``instead`` of the objects that a script has put in."""

    def without(value: Any, place: Place) -> Any:
        if isinstance(value, dict):
            return {key: without(inner, (*place, key)) for key, inner in value.items()}
        if is_tables(value):
            return [without(inner, (*place, number)) for number, inner in enumerate(value)]
        return (
            instead(value.value, place_text(place, content))
            if isinstance(value, GivenObject)
            else value
        )

    return {key: without(value, (key,)) for key, value in content.items()}


def refuse_object(value: Any, where: str) -> str:
    """Raise CaseError: no file holds an object of a script."""
    raise CaseError(
        f"{type(value).__name__} is an object of a script, which a case file cannot hold",
        where=where,
        remedy="register a name for it (see CONTRIBUTING), or run the case from the script",
    )
