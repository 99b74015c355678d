"""Problems with closed-form answers, run with every process, law and integrator that applies.

    rows = clast.verification.run(["incline"])
    findings = clast.verification.examine(choose=quick)

Each problem is a file here that reads like a textbook page: set-up, formula with its source,
numbers.  The same problems are the tests in ``tests/verification`` and the page
``docs/verification.md``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from clast.verification.catalogue import PROBLEMS, Choose, every, narrowed, problems, quick
from clast.verification.problem import Findings, Problem, Row, Verdict, fixed_failures, misses
from clast.verification.report import HEADINGS, cells, write_report
from clast.verification.variants import Variant

Watch = Callable[[Problem, Variant], None]
"""Called before a problem is run with a variant."""


def examine(
    names: Iterable[str] = (), *, choose: Choose = every, watch: Watch | None = None
) -> list[Findings]:
    """Run the chosen problems; return rows and charts of each variant."""
    findings = []
    for problem in map(choose, problems(names)):
        for variant in problem.variants:
            if watch:
                watch(problem, variant)
            findings.append(problem.findings(variant))
    return findings


def run(
    names: Iterable[str] = (), *, choose: Choose = every, watch: Watch | None = None
) -> list[Row]:
    """Run the chosen problems; return a row for every quantity compared."""
    return [row for findings in examine(names, choose=choose, watch=watch) for row in findings.rows]


__all__ = [
    "HEADINGS",
    "PROBLEMS",
    "Choose",
    "Findings",
    "Problem",
    "Row",
    "Variant",
    "Verdict",
    "cells",
    "every",
    "examine",
    "fixed_failures",
    "misses",
    "narrowed",
    "problems",
    "quick",
    "run",
    "write_report",
]
