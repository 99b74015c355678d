"""Methods of the builder that follow from the declarations of inputs.

    class ModelBuilder(Inputs):
        bolt = gives("bolt", Bolt, "start", "end")

gives the builder the method ``bolt``: it takes the keys of ``[[bolt]]``, those two also by their
place, and refuses whatever a case file would be refused for, in the same words.

        in_situ = single("in_situ", InSituTable)

gives it an attribute for a table of which there is one: it takes the keys of the table, or an
object that has their place in a model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from clast.errors import ModelError, shortened
from clast.inputs.declaring.arguments import (
    arguments_of,
    meanings_of,
    type_text,
    with_arguments,
)
from clast.inputs.declaring.field_docs import explain
from clast.inputs.declaring.table import Inputs, Table, as_plain
from clast.inputs.declaring.validation_messages import UNKNOWN_KEY, Own, error_of, faults_of
from clast.model.model import PLANES, Plane
from clast.model.ranges import check_names

T = TypeVar("T", bound=Table)
F = TypeVar("F", bound=Callable[..., Any])
Keys = dict[str, Any]

POSITIONAL = Parameter.POSITIONAL_OR_KEYWORD
NAME = Parameter("name", POSITIONAL, annotation="str")
HERE = Path()
"""Where files are that a script names: the working directory."""


class BuilderMethod:
    """A method of a builder; its arguments are explained when it is first looked at."""

    def __init__(self, method: Any, key: str, kind: type[Table], also: tuple[type[Table], ...]):
        self.method = method
        """The function."""
        self.kinds = (kind, *also)
        """Tables whose keys are arguments."""
        self.is_explained = False
        """Whether the docstring of the function lists its arguments."""
        method.__name__ = method.__qualname__ = key

    def __get__(self, builder: Inputs | None, owner: type | None = None) -> Any:
        """Return the method of a builder, or the function itself."""
        if not self.is_explained:
            self.is_explained = True
            shown = signature(self.method).parameters
            meanings = {"name": "Name by which others refer to it.", **meanings_of(*self.kinds)}
            own = {key: meanings[key] for key in shown if key in meanings}
            self.method.__doc__ = with_arguments(self.kinds[0].__doc__, own)
        return self.method.__get__(builder, owner)


def gives(
    key: str,
    kind: type[Table],
    *places: str,
    turned: Callable[[Keys], Keys] = dict,
    also: type[Table] | None = None,
) -> Any:
    """Return the method of a builder that adds a record, ``[[key]]`` of a case file.

    ``places`` are keys that may be given by their place; ``turned`` makes keys of the file of those
    of a script where these differ, which are those of ``also``.  Raises ModelError for an invalid
    record.
    """

    def method(self: Inputs, *values: Any, **keys: Any) -> str | None:
        keys = turned(_by_name(key, places, values, keys))
        return record_of(kind, keys, (key, self.count(kind))).add_to(self, key, HERE)

    extra = () if also is None else (also,)
    shown = {name: one for each in (kind, *extra) for name, one in arguments_of(each).items()}
    inner = [name for name, one in kind.model_fields.items() if one.annotation in extra]
    shown = {name: one for name, one in shown.items() if name not in inner}
    returned = "str" if signature(kind.add_to).return_annotation == "str" else "None"
    _sign(method, shown, places, returned)
    return BuilderMethod(method, key, kind, extra)


def gives_named(key: str, kind: type[Table], *places: str, usual: str | None = None) -> Any:
    """Return the method ``add_...`` of a builder that adds a record by its name and returns it."""

    def method(self: Inputs, name: Any = usual, *values: Any, **keys: Any) -> str:
        keys = _by_name(key, places, values, keys)
        known, said = self.named(kind), key.replace("_", " ")
        check_names(said, [name])
        if name in known:
            what = f"there are two {said}s with that name"
            raise ModelError(what, where=f"{said} '{shortened(name)}'", remedy="rename one of them")
        record_of(kind, keys, (key, Own(name))).add_to(self, name, HERE)
        return str(name)

    own = NAME if usual is None else NAME.replace(default=usual)
    _sign(method, {"name": own, **arguments_of(kind)}, ("name", *places), "str")
    return BuilderMethod(method, f"add_{key}", kind, ())


def _sign(method: Any, shown: dict[str, Parameter], places: Sequence[str], returned: str) -> None:
    """Give a method its signature; ``places`` are arguments that may be given by their place."""
    first = [shown[name].replace(kind=POSITIONAL) for name in places]
    rest = [one for name, one in shown.items() if name not in places]
    own = [Parameter("self", POSITIONAL), *first, *rest]
    method.__signature__ = Signature(own, return_annotation=returned)


class Single:
    """An attribute of a builder that is a table of which there is one, ``[in_situ]``."""

    def __init__(self, key: str, kind: type[Table], usual: Any) -> None:
        self.key = key
        """Key of the table in a case file."""
        self.kind = kind
        """Class of the table."""
        self.usual = usual
        """The value without it."""

    def __get__(self, builder: Inputs | None, owner: type | None = None) -> Any:
        """Return the object that was given or that the table makes, or the usual one."""
        return self.usual if builder is None else vars(builder).get(self.key, self.usual)

    def __set__(self, builder: Inputs, value: Any) -> None:
        """Take an object, or the keys of the table; raise ModelError in the words of the file."""
        ours = f"[{self.key}] "
        builder.notes[:] = [note for note in builder.notes if not note.startswith(ours)]
        if isinstance(value, dict):
            record_of(self.kind, value, (self.key,)).add_to(builder, self.key, HERE)
            return
        if value is not self.usual:
            self.kind.judge(value, self.key)
        vars(builder)[self.key] = value

    def written(self, value: Any) -> Keys | None:
        """Return the keys of the table that makes an object; None where no file can hold it."""
        if value == self.usual:
            return {}
        keys = self.kind.keys_of(value)
        return None if keys is None else as_plain(keys)


class PlaneOfBuilder:
    """The attribute of a builder that is the plane assumption, by its name or as an object."""

    def __get__(self, builder: Inputs | None, owner: type | None = None) -> Plane:
        """Return the plane assumption; plane stress where none is given."""
        usual = PLANES["stress"]
        return usual if builder is None else vars(builder).get("plane", usual)

    def __set__(self, builder: Inputs, value: Plane | str) -> None:
        """Take a name or an object; raise ModelError for anything else."""
        plane = PLANES.get(value) if isinstance(value, str) else value
        if isinstance(plane, type) or not hasattr(plane, "elasticity"):
            remedy = f"give {' or '.join(map(repr, PLANES))}, or clast.PlaneStrain()"
            what = f"{shortened(repr(value))} is no plane assumption"
            raise ModelError(what, where="plane", remedy=remedy)
        vars(builder)["plane"] = plane


class ByKeys(Table):
    """A single table that a script gives by its keys alone."""

    @classmethod
    def keys_of(cls, value: Any) -> dict[str, Any] | None:
        """Return the keys of the table of a script."""
        return value.model_dump(exclude_unset=True) if isinstance(value, cls) else None

    @classmethod
    def judge(cls, value: Any, key: str) -> None:
        """Refuse anything but the keys of the table."""
        if not isinstance(value, cls):
            what = f"{shortened(repr(value))} is no such table"
            raise ModelError(what, where=key, remedy=f"give the keys of [{key}]")
        record_of(cls, cls.keys_of(value) or {}, (key,))

    def add_to(self, builder: Any, key: str, folder: Path) -> None:
        """Give the table to the builder."""
        setattr(builder, key, self)


def single(key: str, kind: type[Table], usual: Any = None) -> Any:
    """Return the attribute of a builder that is the table ``[key]``."""
    return Single(key, kind, usual)


def singles(builder: type) -> Iterator[tuple[str, Single]]:
    """Give the attributes of a builder that are tables, with their names."""
    for base in reversed(builder.__mro__):
        yield from ((name, one) for name, one in vars(base).items() if isinstance(one, Single))


def _by_name(key: str, places: tuple[str, ...], values: tuple[Any, ...], keys: Keys) -> Keys:
    """Return all arguments by their names."""
    if len(values) > len(places) or keys.keys() & set(places[: len(values)]):
        raise TypeError(f"{key}() takes {len(places)} values by place: {', '.join(places)}")
    return {**dict(zip(places, values, strict=False)), **keys}


def record_of(kind: type[T], keys: Mapping[str, Any], place: tuple[str | int, ...]) -> T:
    """Return a record; ModelError in the words of a case file that has it at this place.

    ``place`` is the key of its table, and its name or its number from 0 where there are several.
    """
    try:
        return kind.model_validate({name: as_plain(value) for name, value in keys.items()})
    except ValidationError as error:
        explain(kind)
        faults = faults_of(error, kind)
        # a key that is misspelt is the cause of one that is missing
        first = min(faults, key=lambda fault: fault.what != UNKNOWN_KEY)
        first = replace(first, place=(*place, *first.place))
        tables: Any = dict(keys)
        for own in place[1:]:
            tables = {own: tables} if isinstance(own, str) else [*[{}] * own, tables]
        raise error_of([first], content={str(place[0]): tables}, kind=ModelError) from None


def with_keys(*kinds: type[Table], whole: Mapping[str, Any]) -> Callable[[F], F]:
    """Return the decorator of a function that takes the keys of tables, for its signature.

    ``whole`` has the types of keys that are tables themselves.
    """
    shown = [one for kind in kinds for one in arguments_of(kind, usual=...).values()]
    for key, kind in whole.items():
        shown.append(
            Parameter(key, Parameter.KEYWORD_ONLY, default=..., annotation=type_text(kind))
        )

    def decorated(function: F) -> F:
        own = signature(function)
        first = [one for one in own.parameters.values() if one.kind != Parameter.VAR_KEYWORD]
        vars(function)["__signature__"] = own.replace(parameters=[*first, *shown])
        return function

    return decorated
