"""Libraries that are not part of clast."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from clast.errors import CaseError


def library(name: str) -> Any:
    """Return a library that is an extra of clast; raises CaseError where it is not installed."""
    try:
        return import_module(name)
    except ImportError as error:
        raise CaseError(
            f"{name} is not installed", remedy=f"install it: pip install 'clast[{name}]'"
        ) from error
