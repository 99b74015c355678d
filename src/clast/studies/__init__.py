"""Studies of a case: the same system through several processes, laws and numbers.

comparison = clast.studies.compare(clast.load("case.toml"), ["modified", "convex"])
clast.studies.write_comparison(comparison, Path("build/compare"))
"""

from __future__ import annotations

from clast.studies.comparing import Combination, Comparison, Row, combinations, compare
from clast.studies.comparison_pages import write_comparison
from clast.studies.references import Deviation, deviations

__all__ = [
    "Combination",
    "Comparison",
    "Deviation",
    "Row",
    "combinations",
    "compare",
    "deviations",
    "write_comparison",
]
