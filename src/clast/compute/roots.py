"""The kernels that Python calls, and the types that it calls them with: the work of a first run.

A kernel that others call becomes part of them (compute/linking.py); only those that Python calls
are kept on disk.  They are listed in roots.json, so that several processes can share the work of
compiling them before anybody waits for it:  `clast warmup` does so, and `make env` at its end.
`python -m tools.compile_cost --write` lists them anew.  Kernels that are not listed are compiled
when first needed, as ever.

Types are written as numba has them: `float64`, `int64[2]` for an array of two dimensions in the
order of C, `(bool, float64[1])` for a tuple.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import json
import sys
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numba.core import types
from numba.core.errors import TypingError as TypingError

from clast.compute.linking import Kernel

LISTED = Path(__file__).with_name("roots.json")
"""The file of the list."""
NUMBERS: dict[str, Any] = {
    "float64": types.float64,
    "float32": types.float32,
    "int64": types.int64,
    "int32": types.int32,
    "bool": types.boolean,
    "none": types.none,
}
"""Types that are no arrays and no tuples."""


@dataclass(frozen=True)
class Root:
    """A kernel that Python calls."""

    module: str
    """Its module."""
    name: str
    """Its name there, of the function that is compiled."""
    types: str
    """The types of its arguments."""

    def kernel(self) -> Any:
        """Return the kernel itself; raises LookupError if there is none of this name."""
        return kernels_of(importlib.import_module(self.module))[self.name]

    @property
    def is_there(self) -> bool:
        """Whether there is one of this name."""
        try:
            return self.kernel() is not None
        except (ImportError, LookupError):
            return False

    def compile(self) -> None:
        """Compile it, or find it on disk."""
        self.kernel().compile(types_of(self.types))


def kernels_of(module: Any) -> dict[str, Any]:
    """Return the kernels that a module makes, by the names of their functions."""
    found = [one for one in vars(module).values() if isinstance(one, Kernel)]
    return {one.py_func.__name__: one for one in found if one.py_func.__module__ == module.__name__}


def called() -> Iterator[Root]:
    """Yield the kernels that this process has called so far, each once for its types."""
    for name, module in sorted(sys.modules.items()):
        if name.startswith("clast."):
            for kernel in kernels_of(module).values():
                for signature in kernel.signatures:
                    yield Root(name, kernel.py_func.__name__, text_of(signature))


def listed() -> dict[str, tuple[Root, ...]]:
    """Return the list: kernels of the first case of all, and those of others beside it."""
    content = json.loads(LISTED.read_text("utf-8"))
    return {key: tuple(Root(*one) for one in roots) for key, roots in content.items()}


def written(roots: dict[str, Iterable[Root]]) -> str:
    """Return the text of a list."""
    rows = {
        key: [[one.module, one.name, one.types] for one in sorted(own, key=str)]
        for key, own in roots.items()
    }
    return json.dumps(rows, indent=1) + "\n"


# --- types ---------------------------------------------------------------------------------


def text_of(given: Any) -> str:
    """Return how types are written; raises TypeError for one that has no way to be."""
    if isinstance(given, tuple):
        return f"({''.join(f'{text_of(one)}, ' for one in given)})"
    kind: Any = given
    if isinstance(kind, types.Array):
        layout = "" if kind.layout == "C" else f", {kind.layout}"
        return f"{text_of(kind.dtype)}[{kind.ndim}{layout}]"
    if isinstance(kind, types.Tuple | types.UniTuple):
        return text_of(tuple(kind))
    if str(kind) in NUMBERS:
        return str(kind)
    raise TypeError(f"{kind} has no way to be written")


def types_of(text: str) -> tuple[Any, ...]:
    """Return the types of arguments; raises ValueError where the text is none of ``text_of``."""
    body = ast.parse(text, mode="eval").body
    if not isinstance(body, ast.Tuple):
        raise ValueError(f"{text} is no type of arguments")
    return tuple(_type(one) for one in body.elts)


def _type(node: ast.expr) -> Any:
    """Return the type that a part of the text means."""
    if isinstance(node, ast.Tuple):
        return types.BaseTuple.from_types([_type(one) for one in node.elts])
    if isinstance(node, ast.Name) and node.id in NUMBERS:
        return NUMBERS[node.id]
    if isinstance(node, ast.Subscript):
        shape = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        layout = shape[1].id if len(shape) > 1 and isinstance(shape[1], ast.Name) else "C"
        array: Any = types.Array
        return array(_type(node.value), ast.literal_eval(shape[0]), layout)
    raise ValueError(f"{ast.unparse(node)} is no type")


# --- how much there is to compile ----------------------------------------------------------


def statements(*kernels: Any) -> list[int]:
    """Return how many statements are compiled for each kernel, with those of all that it calls.

    A kernel that is called is compiled once, one that is taken in where it is called as often as
    that.  Compilation takes about as long as this number says.
    """
    known: dict[Any, tuple[int, list[Any]]] = {}
    return [_statements(kernel, set(), known) for kernel in kernels]


def _statements(kernel: Any, seen: set[Any], known: dict[Any, tuple[int, list[Any]]]) -> int:
    """Return the number for a kernel, without those ``seen`` in it already."""
    if kernel not in known:
        known[kernel] = _read(kernel.py_func)
    number, calls = known[kernel]
    for other in calls:
        if other.targetoptions.get("inline") == "always" or other not in seen:
            seen.add(other)
            number += _statements(other, seen, known)
    return number


def _read(function: Any) -> tuple[int, list[Any]]:
    """Return how many statements a function has, indexing included, and the kernels it calls."""
    names = {**function.__globals__, **inspect.getclosurevars(function).nonlocals}
    number, calls = 0, []
    for node in ast.walk(_tree(function)):
        number += isinstance(node, ast.stmt | ast.Subscript)
        name = node.func if isinstance(node, ast.Call) else None
        used = names.get(name.id) if isinstance(name, ast.Name) else None
        if isinstance(name, ast.Attribute) and isinstance(name.value, ast.Name):
            used = getattr(names.get(name.value.id), name.attr, None)
        if isinstance(used, Kernel):
            calls.append(used)
    return number, calls


def _tree(function: Any) -> ast.AST:
    """Return the statements of a function; of a loop that threads share, its call of the body."""
    if function.__name__.endswith("_loop") and "_body" in function.__globals__:
        return ast.parse("_body()")
    return ast.parse(textwrap.dedent(inspect.getsource(function)))
