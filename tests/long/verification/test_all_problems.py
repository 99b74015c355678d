"""All of `clast verify`, a variant of a problem at a time: no tolerance is missed, failures fail.

Of these CI draws a tenth; what of every problem is brief is in tests/verification.
"""

from __future__ import annotations

import pytest

from clast.verification import PROBLEMS, Problem, Variant, cells, fixed_failures, misses

TRIALS = [
    pytest.param(problem, variant, id=f"{problem.name}-{variant.name}")
    for problem in PROBLEMS
    for variant in problem.variants
]


@pytest.mark.parametrize(("problem", "variant"), TRIALS)
def test_problem(problem: Problem, variant: Variant):
    found = problem.findings(variant)
    assert found.rows
    missed = misses(found.rows)
    assert not missed, "\n" + "\n".join(" | ".join(cells(row)) for row in missed)
    assert fixed_failures([found]) == []
