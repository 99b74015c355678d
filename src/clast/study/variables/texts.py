"""Distributions as texts: normal(35, 5, low=15, high=70), on the command line and in files."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import MISSING, Field, fields
from typing import Any

from clast import spelling
from clast.errors import CaseError, shortened
from clast.study.variables.distributions import (
    Beta,
    Discrete,
    Distribution,
    Lognormal,
    Normal,
    Numbered,
    Range,
    Times,
    Triangular,
    Uniform,
    Values,
)

KINDS: dict[str, type[Any]] = {
    one.WORD: one
    for one in (
        Normal,
        Lognormal,
        Uniform,
        Triangular,
        Beta,
        Discrete,
        Values,
        Range,
        Numbered,
        Times,
    )
}
"""Word -> class."""


def parsed(text: str, where: str) -> Distribution:
    """Return the distribution or list that a text says; raises CaseError naming place and remedy.

    A number, a list in brackets and a text in quotes are lists: ``[20, 30]``.
    """
    remedy = 'e.g. "normal(35, 5)", "uniform(20, 40)" or "[20, 30, 40]"'
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        what = f"'{shortened(text)}' is not a valid distribution"
        raise CaseError(what, where=where, remedy=remedy) from None
    return _made(tree, where, remedy)


def _made(tree: ast.expr, where: str, remedy: str) -> Distribution:
    """Return the value of an expression."""
    if not isinstance(tree, ast.Call):
        value = _plain(tree, where)
        return _of_kind(Values, {"values": value if isinstance(value, list) else [value]}, where)
    word = tree.func.id if isinstance(tree.func, ast.Name) else ""
    if word not in KINDS:
        said = spelling.advice(word, KINDS, kind="distribution")
        what = f"there is no distribution '{shortened(word or ast.unparse(tree.func))}'"
        raise CaseError(what, where=where, remedy=said)
    kind = KINDS[word]
    names = [one.name for one in fields(kind)]
    if len(tree.args) > len(names):
        what = f"{word} has {len(tree.args)} numbers, but at most {len(names)}"
        raise CaseError(what, where=where, remedy=f"write {usage(kind)}")
    given = dict(zip(names, tree.args, strict=False))
    for one in tree.keywords:
        if one.arg not in names or one.arg in given:
            what = f"{word} has no '{shortened(str(one.arg))}' left to be given"
            raise CaseError(what, where=where, remedy=f"write {usage(kind)}")
        given[one.arg] = one.value
    missing = [one.name for one in fields(kind) if one.default is MISSING and one.name not in given]
    if missing:
        what = f"{word} lacks {', '.join(missing)}"
        raise CaseError(what, where=where, remedy=f"write {usage(kind)}")
    values = {
        name: _made(one, where, remedy) if name == "factor" else _plain(one, where)
        for name, one in given.items()
    }
    return _of_kind(kind, values, where)


def _of_kind(kind: type[Any], values: Mapping[str, Any], where: str) -> Any:
    """Return a distribution of a kind; its errors name the place of its text."""
    try:
        return kind(**values)
    except CaseError as error:
        raise CaseError(error.what, where=where, remedy=error.remedy) from None


def usage(kind: type[Any]) -> str:
    """Return how a distribution is written: normal(mean, sd, low=..., high=...)."""
    return f"{kind.WORD}({', '.join(_usage_of(one) for one in fields(kind))})"


def _usage_of(one: Field[Any]) -> str:
    return one.name if one.default is MISSING else f"{one.name}=..."


def _plain(tree: ast.expr, where: str) -> Any:
    """Return a number, a text or a list of these."""
    if isinstance(tree, ast.List | ast.Tuple):
        return [_plain(one, where) for one in tree.elts]
    if isinstance(tree, ast.Name) and tree.id in ("true", "false"):
        return tree.id == "true"
    try:
        return ast.literal_eval(tree)
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        raise CaseError(
            f"'{shortened(ast.unparse(tree))}' is not a number",
            where=where,
            remedy="write numbers; texts in quotes",
        ) from None
