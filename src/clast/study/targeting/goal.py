"""The target of a study: a condition, and how closely the value that meets it is sought."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from clast.errors import CaseError, shortened
from clast.study.expressions import read
from clast.study.measures import CONDITIONS, FOS, MEASURES, STANDS_WITH

REACHED = "reached"
"""Measure that is true where a run meets the target."""
EQUALS = re.compile(r"(?<![<>])=")
RUNS_MAX = 60
"""Runs of a search beside those that halve the range to its tolerance, at most."""
ABOVE = {ast.Gt: True, ast.GtE: True, ast.Lt: False, ast.LtE: False}
"""Comparison -> whether its left side is the larger one."""


@dataclass(frozen=True, kw_only=True)
class TargetSettings:
    """The target of a study, and how closely the value that meets it is sought."""

    reach: str = ""
    """Condition that is true where the target is met."""
    tolerance: float = 0.002
    """Width of the final bracket as a share of the range."""

    def checked(self) -> TargetSettings:
        """Return itself; raises CaseError for an invalid tolerance."""
        if not (isinstance(self.tolerance, int | float) and 1e-6 <= self.tolerance <= 0.5):
            what = f"{self.tolerance!r} is not a valid tolerance"
            remedy = "give a share of the range from 1e-6 to 0.5, e.g. 0.002"
            raise CaseError(what, where="tolerance", remedy=remedy)
        return self

    @property
    def most_runs(self) -> int:
        """Most runs of the search: both ends, the halvings, and as many more for undecided ones."""
        return RUNS_MAX + math.ceil(math.log2(1.0 / self.tolerance))


def measures_of(reach: str, measure: Mapping[str, str]) -> dict[str, str]:
    """Return the measures of a target: those given, the compared one, and whether it is reached.

    A factor that is compared with a number takes one trial a run, with that factor.  Raises
    CaseError for a target that is no condition.
    """
    if isinstance(reach, str) and EQUALS.search(reach):
        raise CaseError(
            f"'{shortened(reach)}' does not say on which side the target is met",
            where="reach",
            remedy="write >= or <= in place of =, e.g. factor_of_safety() >= 1.3",
        )
    for name, text in measure.items():
        read(text, f"measure {shortened(name)}", list(measure), list(MEASURES))
    condition = read(reach, "reach", list(measure), list(MEASURES))
    if not condition.is_condition(CONDITIONS):
        raise CaseError(
            f"'{shortened(reach)}' is a number, not a target",
            where="reach",
            remedy=f'compare it, e.g. "{shortened(reach)} >= 1.3"',
        )
    found = dict(measure)
    match condition.tree:
        case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in ABOVE:
            stands = _as_trial(left, right, is_above=ABOVE[type(op)])
            if stands:
                return {**found, REACHED: stands}
            if any(isinstance(one, ast.Call) for one in ast.walk(left)):
                found.setdefault(ast.unparse(left), ast.unparse(left))
    return {**found, REACHED: condition.text}


def _as_trial(left: ast.expr, right: ast.expr, *, is_above: bool) -> str:
    """Return the comparison of a factor with a number as one trial; "" where it is none."""
    if isinstance(left, ast.Constant):
        left, right, is_above = right, left, not is_above
    match left, right:
        case (ast.Call(func=ast.Name(id=called)), ast.Constant(value=factor)) if called == FOS:
            return f"{'' if is_above else 'not '}{STANDS_WITH}({factor!r})"
    return ""
