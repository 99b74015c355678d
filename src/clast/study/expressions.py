"""The small language of measures and failure conditions: arithmetic, comparisons, and, or, not.

    displacement(A) > 0.05 and not bolt_yields()

Nothing of it is handed to Python: an expression is a tree of a few kinds of nodes.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Collection, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.errors import CaseError, shortened
from clast.spelling import advice, require_known

ARITHMETIC: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    # Python would give powers of whole numbers all their digits, and -1 complex roots
    ast.Pow: np.float_power,
}
COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
OF_NUMBERS: dict[str, Callable[..., Any]] = {
    "abs": np.abs,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": lambda x: np.sin(np.radians(x)),
    "cos": lambda x: np.cos(np.radians(x)),
    "tan": lambda x: np.tan(np.radians(x)),
    "largest": np.max,
    "least": np.min,
    "first": lambda x: np.atleast_1d(x)[0],
    "last": lambda x: np.atleast_1d(x)[-1],
    "min": lambda *x: min(map(number, x)),
    "max": lambda *x: max(map(number, x)),
}
"""Functions of numbers; ``largest`` and its like are of a history, sin and its like of degrees."""
LENGTH_MAX, DEPTH_MAX = 1000, 40
"""Characters of an expression, and levels of its brackets and operators, at most."""
KEEP_UNITS = ("abs", "largest", "least", "first", "last", "min", "max")
"""Functions of numbers whose value has the unit of their arguments."""
CALLED = re.compile(r"""(\w+)\(\s*([^()"',]*[^()"',\s])\s*[,)]""")
"""A function, and its first argument without quotes."""


@dataclass(frozen=True, kw_only=True)
class Expression:
    """An expression that has been read."""

    text: str
    tree: ast.expr
    where: str
    """Its place in messages."""

    def calls(self) -> Iterator[tuple[str, list[str]]]:
        """Give the functions that it calls, with those of their arguments that are names."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                if node.func.id not in OF_NUMBERS:
                    yield node.func.id, [_word(one) for one in node.args]

    def is_condition(self, conditions: Container[str]) -> bool:
        """Return whether it is true or false, not a number.

        ``conditions`` are the names of functions and of other expressions that are.
        """
        return _is_condition(self.tree, conditions)

    def unit(self, names: Mapping[str, str], functions: Callable[[str, Sequence[str]], str]) -> str:
        """Return its unit; "" where it has none, or where none is known.

        ``names`` are the units of other expressions, ``functions`` gives that of a function.
        """
        return _unit(self.tree, names, functions)

    def value(
        self, names: Mapping[str, Any], functions: Mapping[str, Callable[..., Any]]
    ) -> float | bool:
        """Return its value: of a history the last one.  Raises CaseError where it has none."""
        try:
            value = _value(self.tree, names, functions)
        except (ArithmeticError, TypeError, ValueError) as error:
            raise CaseError(
                f"'{shortened(self.text)}' has no value: {error}",
                where=self.where,
                remedy="check its functions and numbers",
            ) from None
        return bool(value) if isinstance(value, bool | np.bool_) else number(value)


def _value(
    node: ast.expr, names: Mapping[str, Any], functions: Mapping[str, Callable[..., Any]]
) -> Any:
    """Return the value of a part of an expression."""

    def of(inner: ast.expr) -> Any:
        return _value(inner, names, functions)

    match node:
        case ast.Constant():
            return float(node.value)  # type: ignore[arg-type]
        case ast.Name():
            return names[node.id]
        case ast.UnaryOp(op=ast.Not()):
            return not number(of(node.operand))
        case ast.UnaryOp(op=ast.USub()):
            return -of(node.operand)
        case ast.UnaryOp():
            return of(node.operand)
        case ast.BinOp():
            with np.errstate(all="ignore"):
                return ARITHMETIC[type(node.op)](of(node.left), of(node.right))
        case ast.BoolOp():
            every = all if isinstance(node.op, ast.And) else any
            return every(bool(number(of(one))) for one in node.values)
        case ast.Compare():
            values = [_known(of(one), one) for one in (node.left, *node.comparators)]
            pairs = zip(node.ops, values[:-1], values[1:], strict=True)
            return all(COMPARISONS[type(op)](first, second) for op, first, second in pairs)
        case ast.Call(func=ast.Name(id=called)):
            if called in OF_NUMBERS:
                with np.errstate(all="ignore"):
                    return OF_NUMBERS[called](*map(of, node.args))
            return functions[called](*map(_word, node.args))
    raise TypeError(ast.unparse(node))


def read(text: Any, where: str, names: Collection[str], functions: Collection[str]) -> Expression:
    """Return the expression of a text; raises CaseError naming the fault in it.

    ``names`` are those of values that it may use, ``functions`` those that it may call.
    """
    remedy = 'e.g. "displacement(A)", "largest(speed(A))", "crest > 0.05"'
    if not isinstance(text, str) or not text.strip() or len(text) > LENGTH_MAX:
        raise CaseError(f"{shortened(repr(text))} is not an expression", where=where, remedy=remedy)
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        what = f"'{shortened(text)}' is not an expression"
        for called, name in CALLED.findall(text):
            if called in functions and not name.isidentifier():
                quoted = f'{called}("{shortened(name)}")'
                remedy = f"put names of several words in quotes: {quoted}"
        raise CaseError(what, where=where, remedy=remedy) from None
    _check(tree, where, names, functions, 0)
    return Expression(text=text.strip(), tree=tree, where=where)


def _check(
    node: ast.expr, where: str, names: Collection[str], functions: Collection[str], depth: int
) -> None:
    """Raise CaseError for parts that the language does not have, and for unknown names."""
    if depth > DEPTH_MAX:
        raise CaseError("the expression is nested too deeply", where=where, remedy="shorten it")
    inner: list[ast.expr] = []
    match node:
        case ast.Constant(value=int() | float()):
            return
        case ast.Name():
            if node.id not in names:
                what = f"there is no measure '{shortened(node.id)}'"
                remedy = advice(node.id, [*names, *functions], kind="measure")
                raise CaseError(what, where=where, remedy=remedy)
            return
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.UAdd()):
            inner = [node.operand]
        case ast.BinOp() if type(node.op) in ARITHMETIC:
            inner = [node.left, node.right]
        case ast.BoolOp():
            inner = node.values
        case ast.Compare() if all(type(one) in COMPARISONS for one in node.ops):
            inner = [node.left, *node.comparators]
        case ast.Call(func=ast.Name(id=called), keywords=[]):
            if called in OF_NUMBERS:
                inner = node.args
                if not inner:
                    what = f"{called}() has no argument"
                    raise CaseError(what, where=where, remedy="give a value")
            else:
                require_known(called, [*functions, *OF_NUMBERS], kind="function", where=where)
                if not all(isinstance(one, ast.Name | ast.Constant) for one in node.args):
                    what = f"'{shortened(ast.unparse(node))}' needs a name"
                    remedy = f'write {called}(A), or {called}("the name")'
                    raise CaseError(what, where=where, remedy=remedy)
        case _:
            raise CaseError(
                f"'{shortened(ast.unparse(node))}' is not allowed in an expression",
                where=where,
                remedy="use numbers, measures, + - * / **, < <= > >= == !=, and, or, not",
            )
    for one in inner:
        _check(one, where, names, functions, depth + 1)


def _is_condition(node: ast.expr, conditions: Container[str]) -> bool:
    match node:
        case ast.Compare() | ast.UnaryOp(op=ast.Not()):
            return True
        case ast.BoolOp():
            return all(_is_condition(one, conditions) for one in node.values)
        case ast.Name():
            return node.id in conditions
        case ast.Call(func=ast.Name(id=called)):
            return called in conditions
    return False


def _unit(
    node: ast.expr, names: Mapping[str, str], functions: Callable[[str, Sequence[str]], str]
) -> str:
    inner: Sequence[ast.expr] = ()
    match node:
        case ast.Name():
            return names.get(node.id, "")
        case ast.UnaryOp(op=ast.USub() | ast.UAdd()):
            inner = [node.operand]
        case ast.BinOp(op=ast.Add() | ast.Sub()):
            inner = [node.left, node.right]
        case ast.Call(func=ast.Name(id=called)):
            if called in KEEP_UNITS:
                inner = node.args
            elif called not in OF_NUMBERS:
                return functions(called, list(map(_word, node.args)))
    units = {_unit(one, names, functions) for one in inner}
    return units.pop() if len(units) == 1 else ""


def number(value: Any) -> Any:
    """Return a value, or the last one of a history."""
    values = np.asarray(value)
    if values.size == 0:
        raise ValueError("there is no value at all")
    last = values.ravel()[-1]
    return bool(last) if values.dtype == np.bool_ else float(last)


def _known(value: Any, node: ast.expr) -> Any:
    """Return a value that is compared; raises ValueError for NaN, which is on no side of a limit.

    A run whose displacement is unknown would be one that stands.
    """
    last = number(value)
    if math.isnan(last):
        raise ValueError(f"{shortened(ast.unparse(node))} is NaN")
    return last


def _word(node: ast.expr) -> str:
    """Return a name that is an argument, quoted or not."""
    return node.id if isinstance(node, ast.Name) else str(getattr(node, "value", ""))
