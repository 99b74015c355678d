"""Meanings of keys: the docstrings below them, read from the source where they are asked for.

A run does not ask: they are for messages and for the JSON Schema.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from functools import cache
from itertools import pairwise

from pydantic import BaseModel

UNITS = (
    "m/s2",
    "m/s and rad/s",
    "m/s",
    "kg/m3",
    "N/m per metre of thickness",
    "N per metre of thickness",
    "N/m per m",
    "N/m",
    "N per rad",
    "N s/m2",
    "N s",
    "N",
    "J",
    "Pa/m",
    "Pa s",
    "Pa",
    "degrees/s",
    "degrees",
    "1/s",
    "m/m2",
    "m2/s",
    "m3",
    "m2",
    "rad/s",
    "kg/(s m)",
    "m",
    "s",
    "-",
)
"""Units as the meanings of keys name them: after a comma, before a stop, comma or (semi)colon."""
UNIT = re.compile(r", (" + "|".join(map(re.escape, UNITS)) + r")(?=[.,:;])")
PLAIN_NUMBER = re.compile(
    r"\b(share|factor|number|ratio|multiple|coefficient|reduction|direction|version)s?\b", re.I
)
"""Words for numbers without a unit."""


def field_docstrings(table: type) -> dict[str, str]:
    """Return the docstring line below each field of a dataclass or a table, from its source."""
    foreign = ("builtins", "pydantic")
    bases = [one for one in table.__mro__ if not one.__module__.startswith(foreign)]
    return {key: meaning for one in reversed(bases) for key, meaning in _docstrings(one).items()}


@cache
def _docstrings(table: type) -> dict[str, str]:
    """Return the docstring line below each field of a class, without those of its bases."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(table))).body[0]
    except (OSError, TypeError):
        return {}
    meanings = {}
    body = tree.body if isinstance(tree, ast.ClassDef) else []
    for pair in pairwise(body):
        match pair:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(written))),
            ):
                meanings[name] = inspect.cleandoc(written)
    return meanings


def explain(table: type[BaseModel]) -> None:
    """Give the keys of a table their docstrings as descriptions."""
    describe(table)
    table.model_rebuild(force=True)


def describe(table: type[BaseModel]) -> None:
    """Give the keys their docstrings; the table has to be built anew."""
    meanings = field_docstrings(table)
    for key, known in table.model_fields.items():
        known.description = meanings.get(key, known.description)
