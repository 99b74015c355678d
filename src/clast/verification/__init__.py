"""Problems with closed-form answers, run with every process, law and integrator that applies.

    rows = clast.verification.run(["incline"])
    findings = clast.verification.examine(choose=quick)

Each problem is a file here that reads like a textbook page: set-up, formula with its source,
numbers.  The same problems are the tests in ``tests/verification`` and the page
``docs/verification.md``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from clast import spelling
from clast.errors import CaseError
from clast.verification.catalogue import PROBLEMS
from clast.verification.problem import Findings, Problem, Row, Verdict, misses
from clast.verification.report import write_report
from clast.verification.tables import HEADINGS, cells
from clast.verification.variants import Variant

Choose = Callable[[Problem], Sequence[Variant]]
"""Picks the variants that a problem is run with."""
Watch = Callable[[Problem, Variant], None]
"""Called before a problem is run with a variant."""


def every(problem: Problem) -> Sequence[Variant]:
    """Choose all variants of a problem."""
    return problem.variants


def quick(problem: Problem) -> Sequence[Variant]:
    """Choose the variants that together take less than a minute."""
    return problem.quick


def problems(names: Iterable[str] = ()) -> list[Problem]:
    """Return the named problems, all if none is named; raise CaseError for a name unknown."""
    known = {problem.name: problem for problem in PROBLEMS}
    wanted = list(names)
    for name in wanted:
        if name not in known:
            raise CaseError(
                f"there is no verification problem '{name}'",
                remedy=spelling.advice(name, known, kind="problem"),
            )
    return [known[name] for name in wanted] if wanted else list(PROBLEMS)


def examine(
    names: Iterable[str] = (), *, choose: Choose = every, watch: Watch | None = None
) -> list[Findings]:
    """Run problems with the variants chosen; return rows and charts of each."""
    found = []
    for problem in problems(names):
        for variant in choose(problem):
            if watch:
                watch(problem, variant)
            found.append(problem.findings(variant))
    return found


def run(
    names: Iterable[str] = (), *, choose: Choose = every, watch: Watch | None = None
) -> list[Row]:
    """Run problems with the variants chosen; return a row for every quantity compared."""
    return [row for findings in examine(names, choose=choose, watch=watch) for row in findings.rows]


__all__ = [
    "HEADINGS",
    "PROBLEMS",
    "Findings",
    "Problem",
    "Row",
    "Variant",
    "Verdict",
    "cells",
    "every",
    "examine",
    "misses",
    "problems",
    "quick",
    "run",
    "write_report",
]
