"""Distributions as texts, normal(35, 5, low=15, high=70): those of studies and of rockfall."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

from clast.errors import CaseError, shortened
from clast.model.distributions import (
    Beta,
    Discrete,
    Distribution,
    Exponential,
    Lognormal,
    Normal,
    Triangular,
    Uniform,
    Values,
)
from clast.spelling import require_known

Kinds = Mapping[str, type[Any]]
"""Name -> distribution."""
DRAWN: Kinds = {
    one.WORD: one for one in (Normal, Lognormal, Uniform, Triangular, Beta, Exponential, Discrete)
}
"""Distributions that single values are drawn from."""


def read(text: str, where: str, kinds: Kinds) -> Distribution:
    """Return the distribution or list that a text says; raises CaseError naming place and remedy.

    A number, a list in brackets and a text in quotes are lists: ``[20, 30]``; ``kinds`` are those
    that may be named.
    """
    remedy = 'e.g. "normal(35, 5)", "uniform(20, 40)" or "[20, 30, 40]"'
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        what = f"'{shortened(text)}' is not a valid distribution"
        raise CaseError(what, where=where, remedy=remedy) from None
    return _made(tree, where, remedy, kinds)


def _made(tree: ast.expr, where: str, remedy: str, kinds: Kinds) -> Distribution:
    """Return the value of an expression."""
    if not isinstance(tree, ast.Call):
        value = _plain(tree, where)
        return _of_kind(Values, {"values": value if isinstance(value, list) else [value]}, where)
    word = tree.func.id if isinstance(tree.func, ast.Name) else ""
    what = f"there is no distribution '{shortened(word or ast.unparse(tree.func))}'"
    require_known(word, kinds, kind="distribution", where=where, what=what)
    kind = kinds[word]
    names = [one.name for one in fields(kind)]
    given = dict(zip(names, tree.args, strict=False))
    fault = ""
    if len(tree.args) > len(names):
        fault = f"{word} has {len(tree.args)} numbers, but at most {len(names)}"
    for one in tree.keywords:
        if one.arg not in names or one.arg in given:
            fault = fault or f"{word} has no '{shortened(str(one.arg))}' left to be given"
        given[str(one.arg)] = one.value
    missing = [one.name for one in fields(kind) if one.default is MISSING and one.name not in given]
    if missing:
        fault = fault or f"{word} lacks {', '.join(missing)}"
    if fault:
        raise CaseError(fault, where=where, remedy=f"write {usage(kind)}")
    values = {
        name: _made(one, where, remedy, kinds) if name == "factor" else _plain(one, where)
        for name, one in given.items()
    }
    return _of_kind(kind, values, where)


def _of_kind(kind: type[Any], values: Mapping[str, Any], where: str) -> Any:
    """Return a distribution of a kind; its errors name the place of its text."""
    try:
        one = kind(**values)
        one.validate()
        return one
    except CaseError as error:
        raise CaseError(error.what, where=where, remedy=error.remedy) from None


def usage(kind: type[Any]) -> str:
    """Return how a distribution is written: normal(mean, sd, low=..., high=...)."""
    names = (one.name if one.default is MISSING else f"{one.name}=..." for one in fields(kind))
    return f"{kind.WORD}({', '.join(names)})"


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
