"""Arguments of a script's functions from the declarations of inputs: types, defaults, sentences.

``help`` and the stub of scripts (tools/script_stub.py) show them.
"""

from __future__ import annotations

from collections.abc import Mapping
from inspect import Parameter, cleandoc
from keyword import iskeyword
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from clast.inputs.declaring.alternatives import Choice
from clast.inputs.declaring.field_docs import field_docstrings

OBJECTS = {
    "process": "StepProcess",
    "contact_law": "ContactLaw",
    "corner_rule": "CornerRule",
    "rotation": "RotationRule",
    "integrator": "Integrator",
    "solver": "LinearSolver",
    "damping": "Action",
}
"""Key that offers a choice -> protocol of the objects that a script may give instead."""


def arguments_of(kind: type[BaseModel], usual: Any = Parameter.empty) -> dict[str, Parameter]:
    """Return the keys of a table as arguments by keyword; ``usual``: the default of all."""
    arguments = {}
    for key, one in kind.model_fields.items():
        name = one.alias or key
        if iskeyword(name):
            continue
        default = usual
        if usual is Parameter.empty and not one.is_required():
            default = one.get_default(call_default_factory=True)
            default = tuple(default) if isinstance(default, list) else default
        annotation = type_text(one.annotation, *one.metadata)
        arguments[name] = Parameter(
            name, Parameter.KEYWORD_ONLY, default=default, annotation=annotation
        )
    return arguments


def type_text(annotation: Any, *extras: Any) -> str:
    """Return a type as an annotation writes it, without the limits of its values."""
    for extra in extras:
        if isinstance(extra, Choice):
            names = ", ".join(f'"{name}"' for name in extra.names)
            return f"Literal[{names}] | dict[str, Any] | {OBJECTS[extra.key]}"
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return type_text(*parts)
    if origin is Literal:
        written = (f'"{one}"' if isinstance(one, str) else repr(one) for one in parts)
        return f"Literal[{', '.join(written)}]"
    if origin in (Union, UnionType):
        return " | ".join(dict.fromkeys(type_text(one) for one in parts))
    if origin is not None:
        return f"{origin.__name__}[{', '.join(type_text(one) for one in parts)}]"
    if annotation is NoneType:
        return "None"
    is_table = isinstance(annotation, type) and issubclass(annotation, BaseModel)
    return "dict[str, Any]" if is_table else getattr(annotation, "__name__", "Any")


def meanings_of(*kinds: type) -> dict[str, str]:
    """Return the sentence of every key of tables, or of every field of dataclasses, in one line."""
    meanings = {}
    for kind in kinds:
        declared: Mapping[str, Any] = getattr(kind, "model_fields", {})
        for key, text in field_docstrings(kind).items():
            if not declared or key in declared:
                name = getattr(declared.get(key), "alias", None) or key
                meanings[name] = " ".join(text.split())
    return meanings


def with_arguments(text: str | None, meanings: Mapping[str, str]) -> str:
    """Return a docstring with the meanings of arguments below it."""
    listed = "".join(f"\n    {name}: {meaning}" for name, meaning in meanings.items())
    return f"{cleandoc(text or '')}\n\nArgs:{listed}\n"
