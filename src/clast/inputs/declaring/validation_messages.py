"""Faults of a case file, in words that name the place and the remedy.

pydantic finds the faults; the sentences are ours.  A fault's place is pydantic's: the path of keys
and list positions from the top of the file, or of a table, down to the bad value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from clast import spelling
from clast.errors import FAULTS_LISTED_MAX, CaseError, Fault, Place, shortened
from clast.inputs.declaring.text import is_tables

UDEC_WORDS = {
    "normal_stiffness": "jkn",
    "shear_stiffness": "jks",
    "friction_angle": "jfric jfriction",
    "cohesion": "jcoh jcohesion",
    "tensile_strength": "jten jtension jtens",
    "dilation_angle": "jdil jdilation",
    "residual_cohesion": "rescoh",
    "density": "dens densw",
    "aperture": "azero",
    "residual_aperture": "ares",
    "viscosity": "jperm",
    "bulk_modulus": "bulkw",
    "joint": "jmat",
    "rock": "zone",
    "joint_set": "jset voronoi",
    "trace": "crack",
    "opening": "tunnel",
    "region": "jregion",
    "in_situ": "insitu",
    "viscous_boundary": "xvisc yvisc",
    "motion": "xvel yvel",
    "fixed_sides": "bound bcond",
    "damping": "damp",
    "stage": "cycle solve",
    "excavate": "delete",
    "bolt": "cable reinforce",
    "lining": "struct",
    "water": "pfix",
    "measured_point": "history hist",
}
UDEC = {word: key for key, words in UDEC_WORDS.items() for word in words.split()}
"""Table or key of clast by UDEC's word, lower-case: see docs/how-to/from-other-programs.md."""


PLAIN, TABLE = "<value>", "<table>"
"""Tags of the two things that a key may be given as (``Either``), for pydantic alone."""


class Own(str):
    """The user's own name of a table, ``granite`` of [rock.granite]: a part of a place."""


UNKNOWN_KEY = "there is no such key"
"""Fault of a key that no table has."""


def refusal(what: str, remedy: str = "", *place: str) -> PydanticCustomError:
    """Return the error by which a validator hands over one fault, of the key at ``place``."""
    return refusals([Fault(what, remedy, place)])


def refusals(faults: Sequence[Fault]) -> PydanticCustomError:
    """Return the error by which a validator hands over faults worded by itself."""
    return PydanticCustomError("faults", "see faults", {"faults": list(faults)})


def check_one(table: BaseModel, keys: Sequence[str], remedy: str) -> None:
    """Refuse a table that has none of some keys, or several of them."""
    given = [key for key in keys if getattr(table, key) is not None]
    if not given:
        raise refusal(f"has neither {' nor '.join(keys)}", remedy)
    if len(given) > 1:
        raise refusal(f"has {' and '.join(given)}, of which one is needed", remedy)


def faults_of(error: ValidationError, table: type[BaseModel]) -> list[Fault]:
    """Return the faults that pydantic found in a table, in our words."""
    faults: list[Fault] = []
    for item in error.errors(include_url=False):
        place = tuple(part for part in item["loc"] if part not in (PLAIN, TABLE))
        top = table.model_fields.get(str(place[0])) if len(place) > 1 else None
        if top is not None and get_origin(top.annotation) is dict:
            place = (place[0], Own(place[1]), *place[2:])
        context = item.get("ctx", {})
        if item["type"] == "faults":
            for fault in context["faults"]:
                at = place + fault.place
                remedy = fault.remedy or _meaning(at, table)
                faults.append(replace(fault, place=at, remedy=remedy))
        else:
            faults.append(_in_words(item["type"], place, item["input"], context, table))
    return faults


def error_of(
    faults: Sequence[Fault],
    *,
    content: Mapping[str, Any],
    file: str = "",
    kind: type[CaseError] = CaseError,
) -> CaseError:
    """Return one error that lists all faults of a case file, or of a script's input."""
    if len(faults) == 1:
        only = faults[0]
        where = ": ".join(filter(None, (file, place_text(only.place, content))))
        return kind(only.what, where=where, remedy=only.remedy, faults=(only,))
    lines = []
    for fault in faults[:FAULTS_LISTED_MAX]:
        lines.append("  " + ": ".join(filter(None, (place_text(fault.place, content), fault.what))))
        lines += [f"    {fault.remedy}"] if fault.remedy else []
    if len(faults) > FAULTS_LISTED_MAX:
        lines.append(f"  and {len(faults) - FAULTS_LISTED_MAX} more")
    what = f"{len(faults)} things to put right\n" + "\n".join(lines)
    return kind(what, where=file, faults=tuple(faults))


def place_text(place: Place, content: Mapping[str, Any]) -> str:
    """Return a place as the reader finds it in the file: table in brackets, key, numbers from 1."""
    if not place:
        return ""
    top, rest = str(place[0]), list(place[1:])
    value: Any = content.get(top)
    number = rest[0] if rest else None
    if is_tables(value) and isinstance(number, int):
        rest = rest[1:]
        name = value[number].get("name") if number < len(value) else None
        table = f"[[{top}]] {number + 1}"
        table += f" '{shortened(name)}'" if isinstance(name, str) else ""
    elif isinstance(number, Own):
        table = f"[{top}.{shortened(str(rest.pop(0)))}]"
    elif isinstance(value, dict) and rest and isinstance(value.get(str(rest[0])), dict):
        table = f"[{top}] {shortened(str(rest.pop(0)))}"
        if rest:
            return f"{table}.{keys_text(rest)}"
    elif isinstance(value, dict):
        table = f"[{top}]"
    else:
        return keys_text([top, *rest])
    return f"{table} {keys_text(rest)}" if rest else table


def keys_text(keys: Sequence[str | int]) -> str:
    """Return keys and positions below a table: ``vertices 3, number 2``."""
    text = ""
    for depth, key in enumerate(keys):
        if isinstance(key, str):
            named = shortened(key) or "''"
            text += f".{named}" if text and isinstance(keys[depth - 1], str) else f", {named}"
        elif isinstance(keys[depth - 1], int):
            text += f", number {key + 1}"
        else:
            text += f" {key + 1}"
    return text.removeprefix(", ").removeprefix(".")


def _in_words(
    kind: str, place: Place, given: Any, context: Mapping[str, Any], table: type[BaseModel]
) -> Fault:
    """Return pydantic's fault as a sentence and a remedy."""
    if kind == "extra_forbidden":
        return Fault(UNKNOWN_KEY, _known_keys(place, table), place)
    known = field_at(table, place)
    meaning = _meaning(place, table)
    if kind == "missing" and isinstance(place[-1], int):
        return Fault(f"number {place[-1] + 1} is missing", meaning, place[:-1])
    if kind == "missing":
        remedy = f"add it: {meaning}" if meaning else "add it"
        return Fault("is missing", remedy, place)
    if kind == "literal_error":
        choices = list(_choices(known.annotation)) if known else []
        remedy = spelling.advice(str(given), choices, kind="choice")
        return Fault(f"{_shown(given)} is not known here", remedy, place)
    if kind in NO_TABLE or (kind in NO_LIST and isinstance(given, dict)):
        return _not_a_table(kind, place, given, table)
    if kind not in SENTENCES:
        return Fault(f"cannot be {_shown(given)}", meaning, place)
    return Fault(SENTENCES[kind](given, context), meaning, place)


def _meaning(place: Place, table: type[BaseModel]) -> str:
    """Return the meaning of the key at a place, or of the table of the user's own names."""
    known = field_at(table, place) or (field_at(table, place[:-1]) if place else None)
    return " ".join((known.description or "").replace("``", "`").split()) if known else ""


def _shown(given: Any) -> str:
    """Return a value as it looks in a case file, shortened."""
    if isinstance(given, dict):
        return "a table"
    try:
        text = str(given).lower() if isinstance(given, bool) else repr(given)
    except ValueError:  # Python writes no whole number of more than some thousand digits
        text = "a number of thousands of digits"
    return shortened(text, 60)


def _not_a_number(given: Any, _: Mapping[str, Any]) -> str:
    """Return the sentence for a value that cannot be a floating-point number."""
    if isinstance(given, int) and not isinstance(given, bool):
        return f"is too large a number: {_shown(given)}"
    return f"must be a number, not {_shown(given)}"


SENTENCES: dict[str, Callable[[Any, Mapping[str, Any]], str]] = {
    "float_type": _not_a_number,
    "int_type": lambda given, _: f"must be a whole number, not {_shown(given)}",
    "bool_type": lambda given, _: f"must be true or false, not {_shown(given)}",
    "string_type": lambda given, _: f"must be a text in quotes, not {_shown(given)}",
    "finite_number": lambda given, _: f"must be a finite number, not {_shown(given)}",
    "greater_than": lambda given, c: f"must be above {c['gt']:g}, not {_shown(given)}",
    "greater_than_equal": lambda given, c: f"must be {c['ge']:g} or more, not {_shown(given)}",
    "less_than": lambda given, c: f"must be below {c['lt']:g}, not {_shown(given)}",
    "less_than_equal": lambda given, c: f"must be {c['le']:g} or less, not {_shown(given)}",
    "too_long": lambda _, c: f"has {c['actual_length']} items instead of {c['max_length']}",
    "too_short": lambda _, c: f"has {c['actual_length']} items instead of {c['min_length']}",
    "list_type": lambda given, _: f"must be a list in brackets, not {_shown(given)}",
    "tuple_type": lambda given, _: f"must be a list in brackets, not {_shown(given)}",
}
"""Sentences for pydantic's kinds of fault, from the value given and the limit in the context."""


NO_TABLE = frozenset({"dict_type", "model_type", "model_attributes_type", "dataclass_type"})
NO_LIST = frozenset({"list_type", "tuple_type"})
"""pydantic's kinds of fault where something else is given than a table or a list."""


def _not_a_table(kind: str, place: Place, given: Any, table: type[BaseModel]) -> Fault:
    """Return the fault of a value that is not a table, or of one table where several are due."""
    name = ".".join(str(part) for part in place if isinstance(part, str))
    here, heads = _table_at(table, place), len(place) == 1 and "schema_" in table.model_fields
    keys = ", ".join(keys_of(here)) if here else "those of the schema"
    if kind in NO_LIST and not (here or heads):
        return Fault("must be a list in brackets, not a table", _meaning(place, table), place)
    if kind in NO_LIST:
        remedy = f"write [[{name}]], in two brackets" if heads else ""
        remedy = remedy or _meaning(place, table) or "write it in brackets: [1.0, 2.0]"
        return Fault("must be a list of tables, not a single table", remedy, place)
    what = f"must be a table, not {'a list' if isinstance(given, list) else _shown(given)}"
    if isinstance(given, list) and heads:
        return Fault(what, f"write [{name}], in one bracket", place)
    heading = _meaning(place, table) if kind == "dict_type" else ""
    return Fault(what, heading or f"it has the keys {keys}", place)


def _choices(annotation: Any) -> Iterator[str]:
    """Give the values that an annotation allows, those inside of lists and unions too."""
    for inner in get_args(annotation):
        if get_origin(annotation) is Literal:
            yield str(inner)
        else:
            yield from _choices(inner)


def _known_keys(place: Place, table: type[BaseModel]) -> str:
    """Return the nearest valid key of the table at hand, or the table where the key belongs."""
    word = str(place[-1])
    here = _table_at(table, place[:-1])
    if here is None:
        return ""
    home = _home(word, here, table)
    meant = UDEC.get(word.lower())
    if meant is not None and not home:
        if meant not in keys_of(here) and meant not in keys_of(table):
            home = f", in the table {_home(meant, here, table)}"
        return f"UDEC's '{word}' is '{meant}' in clast{home}"
    close = spelling.nearest(word, keys_of(here))
    if close is None and home:
        return f"'{word}' belongs in the table {home}"
    return spelling.advice(word, keys_of(here), kind="key")


def _home(key: str, here: type[BaseModel], table: type[BaseModel]) -> str:
    """Return the first table but the one at hand that has a key, nothing where none has."""
    for name, field in table.model_fields.items():
        inner = table_in(field.annotation)
        if inner is not None and inner is not here and key in keys_of(inner):
            return field.alias or name
    return ""


def keys_of(table: type[BaseModel]) -> list[str]:
    """Return the keys of a table as they are written in the file."""
    return [field.alias or name for name, field in table.model_fields.items()]


def field_at(table: type[BaseModel], place: Place) -> FieldInfo | None:
    """Return the field that a place leads to (its last key; list positions belong to the key)."""
    keys = [(depth, key) for depth, key in enumerate(place) if isinstance(key, str)]
    if not keys:
        return None
    depth, key = keys[-1]
    here = _table_at(table, place[:depth])
    if here is None:
        return None
    return next((f for name, f in here.model_fields.items() if key in (name, f.alias)), None)


def _table_at(table: type[BaseModel], place: Place) -> type[BaseModel] | None:
    """Return the table that a place leads to, or None."""
    here: type[BaseModel] | None = table
    parts: Iterator[str | int] = iter(place)
    for part in parts:
        if here is None:
            return None
        if isinstance(part, int):
            continue
        fields = here.model_fields.items()
        field = next((f for name, f in fields if part in (name, f.alias)), None)
        here = table_in(field.annotation) if field else None
        if field is not None and get_origin(field.annotation) is dict:
            next(parts, None)  # the user's own name of a rock or a joint
    return here


def table_in(annotation: Any) -> type[BaseModel] | None:
    """Return the table inside an annotation such as list[BlockTable], or None."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    inside = (table_in(argument) for argument in get_args(annotation))
    return next((table for table in inside if table is not None), None)
