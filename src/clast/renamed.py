"""Earlier names of public objects: they work for one version more, with a DeprecationWarning."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def warn_of(earlier: str, name: str, depth: int = 3) -> None:
    """Warn that ``earlier`` is called ``name`` now; ``depth`` frames above is who used it."""
    text = f"{earlier} is called {name} now; the earlier name will be removed in the next version"
    warnings.warn(text, DeprecationWarning, stacklevel=depth)


def names_of(module: str, names: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a module that also knows ``names``, earlier -> present name."""

    def attribute(name: str) -> Any:
        if name not in names:
            raise AttributeError(f"module '{module}' has no attribute '{name}'")
        warn_of(f"{module}.{name}", names[name])
        return getattr(import_module(module), names[name])

    return attribute


class Renamed:
    """An attribute or method by its earlier name; a field of a dataclass has it as its default."""

    def __init__(self, name: str) -> None:
        self.name = name
        """Present name of the attribute."""
        self.earlier = name

    def __set_name__(self, owner: type, name: str) -> None:
        """Learn the earlier name."""
        self.earlier = name

    def __get__(self, one: Any, owner: type | None = None) -> Any:
        """Return the value of the attribute, with a warning."""
        if one is None:
            return self
        warn_of(self.earlier, self.name)
        return getattr(one, self.name)

    def __set__(self, one: Any, value: Any) -> None:
        """Set the attribute, with a warning; the default of a dataclass sets nothing."""
        if value is not self:
            warn_of(self.earlier, self.name)
            setattr(one, self.name, value)


def earlier_argument(earlier: str, name: str, given: Any, value: Any) -> Any:
    """Return the ``value`` of the argument ``name``, or the one ``given`` by its earlier name."""
    if given is None:
        return value
    warn_of(earlier, name, depth=4)
    return given
