"""Comparisons of a case: the same system through several processes and contact laws.

comparison = clast.studies.compare(clast.load("case.toml"), ["modified", "convex"])
clast.studies.write_comparison(comparison, Path("build/compare"))

A name is loaded when it is first used: a run needs the references alone.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from clast.studies.comparing import Combination as Combination
    from clast.studies.comparing import ComparedMethods as ComparedMethods
    from clast.studies.comparing import ComparedRun as ComparedRun
    from clast.studies.comparing import combinations as combinations
    from clast.studies.comparing import compare as compare
    from clast.studies.comparison_pages import write_comparison as write_comparison
    from clast.studies.references import Deviation as Deviation
    from clast.studies.references import deviations as deviations

COMPARING = ("Combination", "ComparedMethods", "ComparedRun", "combinations", "compare")
HOME = {
    **dict.fromkeys(COMPARING, "clast.studies.comparing"),
    "write_comparison": "clast.studies.comparison_pages",
    **dict.fromkeys(("Deviation", "deviations"), "clast.studies.references"),
}
"""Public name -> module that defines it."""

__all__ = list(HOME)


def __getattr__(name: str) -> Any:
    if name not in HOME:
        raise AttributeError(f"module 'clast.studies' has no attribute '{name}'")
    return getattr(import_module(HOME[name]), name)
