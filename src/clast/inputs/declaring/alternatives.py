"""A key whose value is one of several named things, each with numbers of its own.

``process = "modified"`` and ``process = {name = "modified", passes = 2}`` both choose the class
that the name stands for.  Its numbers are the fields of its dataclass: adding an alternative takes
the dataclass and one line in the dictionary of names (clast.inputs.method).  A script may give
an object in the place of the name.
"""

from __future__ import annotations

import datetime
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from functools import cache
from importlib import import_module
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    StrictBool,
    StrictInt,
    StrictStr,
    ValidationError,
    ValidatorFunctionWrapHandler,
    create_model,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from clast import spelling
from clast.errors import shortened
from clast.inputs.declaring.annotations import annotate
from clast.inputs.declaring.field_docs import field_docstrings
from clast.inputs.declaring.validation_messages import faults_of, refusal, refusals
from clast.model.ranges import AllowedRange

Number = Annotated[float, Strict()]


def within(limits: AllowedRange) -> AfterValidator:
    """Return the annotation of a number that is refused outside its range."""

    def validate(value: Any) -> Any:
        fault = None if value is None else limits.fault(value)
        if fault is not None:
            raise refusal(fault)
        return value

    return AfterValidator(validate)


AUTO = "auto"
"""Value that leaves a number to clast."""

OPTION_TYPES: dict[str, Any] = {
    "float": Number,
    "float | None": Number | None,
    "int": StrictInt,
    "int | None": StrictInt | None,
    "bool": StrictBool,
    "str": StrictStr,
}
"""Type annotation of a dataclass field -> type of the value in the file."""


@dataclass(frozen=True)
class Alternatives:
    """The named classes of every key that offers a choice, and the limits of their numbers."""

    classes: Mapping[str, Mapping[str, str]]
    """Key -> name -> "module:class"; a field of a class that is such a key is a choice too."""
    limits: Mapping[str, tuple[Any, ...]]
    """Field name -> pydantic's checks of it, as annotations."""
    automatic: frozenset[str] = frozenset()
    """Fields that may be "auto", and are unless given: whoever builds the class provides them."""
    needs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Key -> attributes that an object of a script must have in the place of a name."""

    def __hash__(self) -> int:
        return id(self)


@dataclass(frozen=True)
class Chosen:
    """One alternative and its numbers, as the file gives them."""

    name: str
    """Name in the file."""
    path: str
    """Where its class is, "module:class"."""
    numbers: Mapping[str, Any] = field(default_factory=dict)
    """The values that the file gives; the others are the class's own defaults."""

    def build(self, **provided: Any) -> Any:
        """Return the object that was chosen; ``provided`` are the values of fields on "auto"."""
        given = {
            key: value.build() if isinstance(value, Chosen | GivenObject) else value
            for key, value in self.numbers.items()
        }
        return class_at(self.path)(**{**given, **provided})

    def is_automatic(self, key: str) -> bool:
        """Return True where the file leaves a number to clast: "auto", or nothing."""
        return self.numbers.get(key, AUTO) == AUTO

    def as_written(self) -> str | dict[str, Any]:
        """Return its shortest form in a file; an object without a name stays as it is."""
        if not self.numbers:
            return self.name
        numbers = {
            key: value.as_written() if isinstance(value, Chosen | GivenObject) else value
            for key, value in self.numbers.items()
        }
        return {"name": self.name, **numbers}


class GivenObject:
    """An object of a script in the place of a name; a file can hold it if its class has a name."""

    # no dataclass: pydantic would take it, and the object with it, to pieces when it is written
    def __init__(self, value: Any, choice: Choice) -> None:
        self.value = value
        """The object."""
        self.choice = choice
        """Where it was given."""

    @property
    def name(self) -> str:
        """Name of its class."""
        return type(self.value).__name__

    def build(self, **provided: Any) -> Any:
        """Return the object; it has all its numbers."""
        return self.value

    def is_automatic(self, key: str) -> bool:
        """Return False: nothing is left to clast."""
        return False

    def as_written(self) -> str | dict[str, Any] | GivenObject:
        """Return its name or table in a file; itself where it has none."""
        written = self.choice.written(self.value)
        return self if written is None else written


PLAIN = (str, bool, int, float, list, tuple, dict, datetime.date, datetime.time, type(None))
"""Types of a value in a file; anything else is an object of a script."""


def class_at(path: str) -> Any:
    """Return the class at "module:class", loading its module (and numba with it) only now."""
    module, name = path.split(":")
    return getattr(import_module(module), name)


@dataclass(frozen=True)
class Choice:
    """Type annotation of a key that offers a choice: ``Annotated[Any, Choice("process", ...)]``."""

    key: str
    """The key."""
    alternatives: Alternatives
    """All choices."""
    usual: str = ""
    """Name of a table that has none; empty: a table has to have one."""

    @property
    def names(self) -> Mapping[str, str]:
        """Name -> "module:class"."""
        return self.alternatives.classes[self.key]

    def validate(self, value: Any) -> Chosen | GivenObject:
        """Return the choice that a name, a table or an object makes; hand faults to pydantic."""
        if isinstance(value, Chosen | GivenObject):
            return value
        if not isinstance(value, PLAIN):
            return self._object(value)
        table = {"name": value} if isinstance(value, str) else value
        if self.usual and isinstance(table, dict):
            table = {"name": self.usual, **table}
        known = ", ".join(f'"{name}"' for name in self.names)
        if not isinstance(table, dict) or not isinstance(table.get("name"), str):
            remedy = f'one of {known}, or e.g. {{name = "{next(iter(self.names))}", ...}}'
            raise refusal("must be a name or a table with a name", remedy)
        name = table["name"]
        if name not in self.names:
            what = f"there is no {self.key} '{shortened(name)}'"
            raise refusal(what, spelling.advice(name, self.names, kind=self.key))
        try:
            parsed = options_table(self, name).model_validate(table)
        except ValidationError as error:
            raise refusals(faults_of(error, options_table(self, name, True))) from None
        given = {key: getattr(parsed, key) for key in table if key != "name"}
        return Chosen(name, self.names[name], given)

    def written(self, value: Any) -> str | dict[str, Any] | None:
        """Return name or table of an object in a file, None where its class has no name there."""
        path = f"{type(value).__module__}:{type(value).__qualname__}"
        name = next((name for name, known in self.names.items() if known == path), None)
        if name is None:
            return None
        numbers: dict[str, Any] = {}
        for one in fields(value):
            number: Any = getattr(value, one.name)
            unsaid = one.name not in self.alternatives.automatic and number == default_of(one)
            if unsaid or not one.init or one.name == "name":
                continue
            if one.name in self.alternatives.classes:
                number = Choice(one.name, self.alternatives).written(number)
                if number is None:
                    return None
            numbers[one.name] = number
        return {"name": name, **numbers} if numbers else name

    def _object(self, value: Any) -> GivenObject:
        """Return an object of a script, if it is of the right kind."""
        if isinstance(value, type):
            what = f"{value.__name__} is a class, not an instance"
            raise refusal(what, f"give {value.__name__}(...)")
        needed = self.alternatives.needs.get(self.key, ())
        missing = [name for name in needed if not hasattr(value, name)]
        if missing:
            raise refusal(
                f"{type(value).__name__} is not a valid {self.key}: it has no {', '.join(missing)}",
                f"a {self.key} has {', '.join(needed)}; see clast.step.method",
            )
        return GivenObject(value, self)

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(
            self.validate,
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda chosen: (
                    chosen.as_written() if isinstance(chosen, Chosen | GivenObject) else chosen
                )
            ),
        )

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        tables = [options_table(self, name, True) for name in self.names]
        alone = [
            name
            for name, table in zip(self.names, tables, strict=True)
            if not any(f.is_required() for key, f in table.model_fields.items() if key != "name")
        ]
        variants = [handler(table.__pydantic_core_schema__) for table in tables]
        for name, variant in zip(self.names, variants, strict=True):
            if name == self.usual:
                needed = [key for key in variant.pop("required", []) if key != "name"]
                variant |= {"required": needed} if needed else {}
        names: list[JsonSchemaValue] = [{"type": "string", "enum": alone}] if alone else []
        return {"anyOf": names + variants}


@cache
def options_table(choice: Choice, name: str, explained: bool = False) -> type[BaseModel]:
    """Return the table of one alternative: its name and the fields of its dataclass."""
    chosen = class_at(choice.names[name])
    meanings = field_docstrings(chosen) if explained else {}
    options: dict[str, Any] = {"name": (Literal[name], ...)}
    for option in fields(chosen):
        if option.init and option.name != "name":
            options[option.name] = _option(choice, option, meanings.get(option.name))
    table = create_model(
        f"{chosen.__name__}Table",
        __config__=ConfigDict(extra="forbid", allow_inf_nan=False),
        __doc__=(chosen.__doc__ or "").split("\n")[0],
        **options,
    )
    if explained:
        annotate(table, frozenset())
        table.model_rebuild(force=True)
    return table


def _option(choice: Choice, option: Any, meaning: str | None) -> tuple[Any, Any]:
    """Return type and default of one field of an alternative, as pydantic wants them."""
    default = default_of(option)
    written = ... if default is MISSING else default
    extras: list[Any] = [Field(description=meaning)]
    if option.name in choice.alternatives.classes:
        kind: Any = Any
        inner = Choice(option.name, choice.alternatives)
        extras.insert(0, inner)
        path = f"{type(default).__module__}:{type(default).__name__}"
        written = next((name for name, known in inner.names.items() if known == path), ...)
    else:
        kind = OPTION_TYPES[option.type if isinstance(option.type, str) else option.type.__name__]
        extras[:0] = choice.alternatives.limits.get(option.name, ())
        if option.name in choice.alternatives.automatic:
            extras.insert(-1, OrAuto())
            written = AUTO
    for extra in extras:
        kind = Annotated[kind, extra]
    return kind, written


def default_of(option: Any) -> Any:
    """Return the default of a field of a dataclass, MISSING where it has none."""
    made = option.default_factory is not MISSING
    return option.default_factory() if made else option.default


@dataclass(frozen=True)
class OrAuto:
    """Annotation of a number that may be "auto" as well; its other limits stay as they are."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_wrap_validator_function(self._validate, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {"anyOf": [handler(schema), {"const": AUTO, "type": "string"}]}

    @staticmethod
    def _validate(value: Any, number: ValidatorFunctionWrapHandler) -> Any:
        if isinstance(value, str):
            if value != AUTO:
                raise refusal(f'must be a number or "{AUTO}", not "{shortened(value)}"')
            return value
        return number(value)
