"""Every problem with every variant: no tolerance is missed, and what is known to fail does."""

from __future__ import annotations

import pytest

from clast.verification import PROBLEMS, Problem, Variant, Verdict, cells, misses

TRIALS = [
    pytest.param(
        problem,
        variant,
        id=f"{problem.name}-{variant.name}",
        marks=() if variant in problem.quick else pytest.mark.slow,
    )
    for problem in PROBLEMS
    for variant in problem.variants
]


@pytest.mark.parametrize(("problem", "variant"), TRIALS)
def test_problem(problem: Problem, variant: Variant):
    rows = problem.run(variant)
    assert rows
    missed = misses(rows)
    assert not missed, "\n" + "\n".join(" | ".join(cells(row)) for row in missed)
    known = [failure.reason for failure in problem.known_failures if failure.variant == variant]
    failed = [row for row in rows if row.verdict is Verdict.KNOWN]
    assert bool(failed) == bool(known), f"no longer fails: {known}"
