"""The kernels that Python calls, and the types that it calls them with: the work of a first run.

A kernel that others call becomes part of them (compute/linking.py); only those that Python calls
are kept on disk.  They are listed in roots.json, so that several processes can share the work of
compiling them before anybody waits for it:  `clast warmup` does so, and `make env` at its end.
`python -m tools.compile_cost --write` lists them anew.  Kernels that are not listed are compiled
when first needed, as ever.
"""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from numba.core import types
from numba.core.errors import TypingError as TypingError

from clast.compute.linking import Kernel

LISTED = Path(__file__).with_name("roots.json")
"""The file of the list."""


@dataclass(frozen=True, order=True)
class Root:
    """A kernel that Python calls."""

    module: str
    """Its module."""
    name: str
    """Its name there, of the function that is compiled."""
    types: str
    """The types of its arguments, a signature of numba."""
    seconds: float = field(default=0.0, compare=False)
    """Time that it takes to be compiled, s, on the machine that made the list."""

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
    kernels = [one for one in vars(module).values() if isinstance(one, Kernel)]
    return {
        one.py_func.__name__: one for one in kernels if one.py_func.__module__ == module.__name__
    }


def called() -> Iterator[Root]:
    """Yield the kernels that this process has called so far, each once for its types."""
    for name, module in sorted(sys.modules.items()):
        if name.startswith("clast."):
            for kernel in kernels_of(module).values():
                for signature in kernel.signatures:
                    metadata = kernel.get_metadata(signature) or {}
                    seconds = metadata.get("timers", {}).get("compiler_lock", 0.0)
                    text = f"({text_of(signature)})"
                    yield Root(name, kernel.py_func.__name__, text, round(seconds, 1))


def listed() -> dict[str, tuple[Root, ...]]:
    """Return the list: kernels of the first case of all, and those of others beside it."""
    content = json.loads(LISTED.read_text("utf-8"))
    return {key: tuple(Root(*one) for one in roots) for key, roots in content.items()}


def written(roots: dict[str, Iterable[Root]]) -> str:
    """Return the text of a list, a line for each kernel."""
    parts = []
    for key, own in roots.items():
        rows = [json.dumps([one.module, one.name, one.types, one.seconds]) for one in sorted(own)]
        parts.append(f'"{key}": [\n' + ",\n".join(rows) + "\n]")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def text_of(kinds: Iterable[Any]) -> str:
    """Return how numba writes types of arguments, a comma behind each."""
    return "".join(f"{_text_of(kind)}, " for kind in kinds)


def _text_of(kind: Any) -> str:
    if isinstance(kind, types.Array):
        last = "::1" if kind.layout == "C" else ":"
        return f"{kind.dtype}[{':, ' * (kind.ndim - 1)}{last}]".replace("bool[", "boolean[")
    if isinstance(kind, types.BaseNamedTuple):
        named: Any = kind
        own = named.instance_class
        return f"named('{own.__module__}', '{own.__name__}', ({text_of(named.types)}))"
    if isinstance(kind, types.Tuple | types.UniTuple):
        return f"Tuple(({text_of(kind)}))"
    return {"bool": "boolean"}.get(str(kind), str(kind))


def types_of(text: str) -> tuple[Any, ...]:
    """Return the types of arguments that a text means."""
    kinds: tuple[Any, ...] = eval(text, {**vars(types), "named": _named})  # of our own file
    return kinds


def _named(module: str, name: str, kinds: tuple[Any, ...]) -> Any:
    """Return the type of a named tuple of a module."""
    return types.BaseTuple.from_types(kinds, getattr(importlib.import_module(module), name))
