"""Things that all inputs have in common: kinds of numbers, methods of a table, plain values.

A group of tables is a file of ``inputs`` and a line in ``clast.case.case_file.Case``: the name of
the table in the file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self, TypeVar, get_args

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from clast.errors import CaseError, Place
from clast.inputs.declaring.alternatives import GivenObject, Number, within
from clast.inputs.declaring.annotations import Drawn
from clast.inputs.declaring.text import is_tables
from clast.inputs.declaring.validation_messages import PLAIN, TABLE, check_one, place_text
from clast.model import ranges

Positive = Annotated[Number, Field(gt=0.0)]
Interval = Annotated[Positive, within(ranges.INTERVAL)]
Length = Annotated[Positive, within(ranges.LENGTH)]
Strength = Annotated[Number, Field(ge=0.0), within(ranges.STRESS)]
Coordinate = Annotated[Number, within(ranges.COORDINATE)]
Shift = tuple[Coordinate, Coordinate]
Point = Annotated[Shift, Drawn("point")]
Force = Annotated[Number, within(ranges.FORCE)]
Speed = Annotated[Number, within(ranges.SPEED)]
Motion = tuple[Speed, Speed, Speed]
Acceleration = Annotated[Number, within(ranges.ACCELERATION)]
Share = Annotated[Number, within(ranges.FACTOR)]
Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]
Instant = Annotated[Number, within(ranges.TIME)]
Stress = Annotated[Number, within(ranges.STRESS)]
Stresses = tuple[Stress, Stress, Stress]
Loop = Annotated[list[Point], Drawn("polygon")]
Line = Annotated[list[Point], Drawn("polyline")]
Ends = Annotated[tuple[Point, Point], Drawn("polyline")]


@dataclass(frozen=True)
class Either:
    """Annotation of a key that takes one of two types: faults are those of the type given."""

    is_second: Callable[[Any], bool]
    """Whether a value is meant as the second of the two."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        first, second = map(handler.generate_schema, get_args(source))
        return core_schema.tagged_union_schema(
            {PLAIN: first, TABLE: second},
            discriminator=lambda value: TABLE if self.is_second(value) else PLAIN,
        )


OR_TABLE = Either(lambda value: isinstance(value, dict | BaseModel))
OR_TEXT = Either(lambda value: isinstance(value, str))
OR_PAIR = Either(lambda value: isinstance(value, list | tuple))
OR_LINE = Either(
    lambda value: isinstance(value, list | tuple) and OR_PAIR.is_second([*value, 0][0])
)


class Table(BaseModel):
    """A table of the case file, or its keys from a script.

    Unknown keys and numbers that are not finite are refused.
    """

    model_config = ConfigDict(defer_build=True, extra="forbid", frozen=True, allow_inf_nan=False)
    NAMED: ClassVar[bool] = False
    """True where tables are told apart by their keys: [bolt_kind.NAME]."""
    ONE_OF: ClassVar[Mapping[str, Sequence[str]]] = {}
    """Groups of keys of which a table has exactly one, by the remedy where it has not."""
    WHEN: ClassVar[Mapping[str, Mapping[str, Sequence[str]]]] = {}
    """Key that chooses -> its values, ANY for all -> the keys that go with each of them."""
    INSTEAD: ClassVar[Sequence[Sequence[str]]] = ()
    """Groups of keys of which a table has at most one, each in place of the others."""
    BASIC: ClassVar[Sequence[str]] = ()
    """Keys that most tables have, beside those that are needed and the groups."""
    RARE: ClassVar[Sequence[str]] = ()
    """Keys that few tables have."""
    TYPICAL: ClassVar[Mapping[str, tuple[float, float]]] = {}
    """Range of the usual values of a number, in its unit."""

    @model_validator(mode="after")
    def _has_one_of_each(self) -> Self:
        for remedy, keys in self.ONE_OF.items():
            check_one(self, keys, remedy)
        return self

    def add_to(self, builder: Any, key: str, folder: Path) -> str | None:
        """Add the table to the system of blocks; return the name that it then has.

        ``key`` is the table's own name, or its key; ``folder`` is where the case file is.
        """
        builder.add(self, key)
        return None

    @classmethod
    def actions(cls, records: Sequence[Any], ground: Any) -> Iterable[Any]:
        """Return the actions by which all records of a kind act on the blocks of the ``ground``.

        Most have none: they become arrays of the model.  An action is an object with the methods of
        ``clast.actions.action.Action``; raises ModelError for one that cannot be placed.
        """
        return ()

    @classmethod
    def keys_of(cls, value: Any) -> dict[str, Any] | None:
        """Return the keys of the table that makes an object of a script, None where none does."""
        return None

    @classmethod
    def judge(cls, value: Any, key: str) -> None:
        """Raise ModelError for an object of a script that cannot be; ``key`` is the table's."""

    def remarks(self, folder: Path) -> Iterator[str]:
        """Report doubts that need the whole case file."""
        return iter(())


T = TypeVar("T", bound=Table)


@dataclass(kw_only=True)
class Inputs:
    """All that a user gives, each kind of table in the order in which it was given."""

    notes: list[str] = field(default_factory=list)
    """Notes for the user on values that were read, assumed and changed."""
    _listed: dict[type[Table], list[Any]] = field(default_factory=dict, init=False, repr=False)
    _named: dict[type[Table], dict[str, Any]] = field(default_factory=dict, init=False, repr=False)

    def all(self, kind: type[T]) -> list[T]:
        """Return the tables of a kind of which there may be several: [[bolt]]."""
        return self._listed.setdefault(kind, [])

    def named(self, kind: type[T]) -> dict[str, T]:
        """Return the tables of a kind by their names: [bolt_kind.NAME]."""
        return self._named.setdefault(kind, {})

    def actions_from(self, ground: Any) -> tuple[Any, ...]:
        """Return the actions by which tables act that have one of their own."""
        listed = self._listed.items()
        return tuple(one for kind, records in listed for one in kind.actions(records, ground))

    def count(self, kind: type[Table]) -> int:
        """Return how many tables of a kind there are."""
        return len(self._listed.get(kind, ()))

    def has(self, kind: type[Table]) -> bool:
        """Return whether there is a table of a kind."""
        return bool(self._listed.get(kind) or self._named.get(kind))

    def add(self, table: Table, key: str) -> None:
        """Add a table that is whole; its key is its name where it has one."""
        if table.NAMED:
            self.named(type(table))[key] = table
        else:
            self.all(type(table)).append(table)


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


def unwritable(value: Any, where: str, remedy: str) -> CaseError:
    """Return the error of an object of a script: no file holds one."""
    what = f"{type(value).__name__} is an object of a script, which a case file cannot hold"
    return CaseError(what, where=where, remedy=remedy)


def refuse_object(value: Any, where: str) -> str:
    """Raise CaseError where an object would be written into a file."""
    remedy = "register a name for it (see CONTRIBUTING), or run the case from the script"
    raise unwritable(value, where, remedy)
