"""The shipped arches, walls and columns fail under the push of limit analysis, by one command."""

from __future__ import annotations

import push_cases
import pytest

import clast

CASES = {one.name: one for one in push_cases.cases()}
TOLERANCE = 0.005
"""Of the brackets; joints and blocks give a little, which takes another 0.3 % of the factor."""
LEFT = ("arch-180-t15-n21-phi60", "wall-2x8")
"""Symmetrical ones: walls with halves in every other course are."""


@pytest.mark.parametrize("name", list(CASES))
def test_a_shipped_case_is_that_of_the_problem(name):
    assert CASES[name].file.read_text(encoding="utf-8") == CASES[name].text


@pytest.mark.parametrize("name", [name for name in CASES if "n31" not in name])
@pytest.mark.one_in(3)
def test_a_case_fails_under_the_push_of_limit_analysis(name):
    one = CASES[name]
    found = clast.collapse_load(one.file, "pga", tolerance=TOLERANCE)
    assert found.is_settled and not found.undecided
    assert found.low == pytest.approx(one.exact, rel=TOLERANCE + 0.003)
    assert found.high >= one.exact * (1.0 - 0.003)


@pytest.mark.parametrize("name", LEFT)
def test_a_push_to_the_left_is_that_to_the_right(name):
    pair = [
        clast.collapse_load(CASES[name].file, by, tolerance=TOLERANCE).value
        for by in ("pga", "pga left")
    ]
    assert pair[0] == pytest.approx(pair[1], rel=TOLERANCE)
