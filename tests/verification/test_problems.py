"""What of every problem fits into a minute: no tolerance is missed, known failures do fail.

The whole set is run by ``make verify``.
"""

from __future__ import annotations

import pytest

from clast.verification import PROBLEMS, Problem, Variant, cells, fixed_failures, misses

BRIEF = [problem.brief() for problem in PROBLEMS]
TRIALS = [
    pytest.param(problem, variant, id=f"{problem.name}-{variant.name}")
    for problem in BRIEF
    for variant in problem.variants
]


@pytest.mark.parametrize(("problem", "variant"), TRIALS)
@pytest.mark.one_in(2)
def test_problem(problem: Problem, variant: Variant):
    found = problem.findings(variant)
    assert found.rows and all(row.reason for row in found.rows)
    missed = misses(found.rows)
    assert not missed, "\n" + "\n".join(" | ".join(cells(row)) for row in missed)
    if not problem.cases and problem.briefly is None:
        assert fixed_failures([found]) == []
