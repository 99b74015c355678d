"""Comparisons of a case: the same system through several processes and contact laws.

comparison = clast.studies.compare(clast.load("case.toml"), ["modified", "convex"])
clast.studies.write_comparison(comparison, Path("build/compare"))
"""

from clast.studies.comparing import (
    Combination,
    ComparedMethods,
    ComparedRun,
    Deviation,
    combinations,
    compare,
    deviations,
)
from clast.studies.comparison_pages import write_comparison

__all__ = [
    "Combination",
    "ComparedMethods",
    "ComparedRun",
    "Deviation",
    "combinations",
    "compare",
    "deviations",
    "write_comparison",
]
