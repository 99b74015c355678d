"""The search for a factor, on blocks whose limit is known: nothing is simulated."""

import math

import pytest

from clast.errors import CaseError
from clast.study.collapsing.trial import (
    FAILED,
    STANDS,
    UNDECIDED,
    FactorBracket,
    FactorSearch,
    Trial,
    Trials,
)


def searched(limit: float, search: FactorSearch, doubt: tuple[float, float] = (0.0, 0.0)) -> Trials:
    def make(number: int, factor: float) -> Trial:
        verdict = STANDS if factor < limit else FAILED
        verdict = UNDECIDED if doubt[0] < factor < doubt[1] else verdict
        return Trial(factor=factor, verdict=verdict, displacement=0.0, mover="")

    trials = Trials(search, make)
    trials.all()
    return trials


@pytest.mark.parametrize("limit", [0.013, 0.6771, 0.99, 1.2057, 1.5843, 17.0, 345.0])
@pytest.mark.parametrize("start", [0.3, 1.0, 2.7])
@pytest.mark.parametrize("growth", [1.1, 1.25, 4.0])
def test_the_bracket_holds_the_limit_and_is_as_narrow_as_asked(
    limit: float, start: float, growth: float
) -> None:
    found = searched(limit, FactorSearch(start=start, growth=growth, tolerance=0.004)).all()
    assert found.low < limit <= found.high
    assert found.high - found.low <= 0.004 * found.high * (1.0 + 1e-12)
    assert found.value == found.low


def test_few_trials_are_needed() -> None:
    trials = searched(1.5843, FactorSearch(start=1.0, growth=1.25))
    assert len(trials.done) == 9


def test_what_never_fails_is_said() -> None:
    found = searched(math.inf, FactorSearch(start=1.0, growth=2.0)).all()
    assert found.low == 512.0
    assert math.isinf(found.high) and not found.is_closed
    assert found.sentence("F") == "F at least 512: no failure was found up to there"


def test_what_never_stands_is_said() -> None:
    found = searched(0.0, FactorSearch(start=1.0, growth=2.0)).all()
    assert found.low == 0.0 and found.high < 0.001 and not found.is_closed


@pytest.mark.parametrize("doubt", [(1.5, 1.6), (1.584, 1.7), (1.2, 1.58)])
def test_an_undecided_range_is_closed_in_from_both_sides(doubt: tuple[float, float]) -> None:
    found = searched(1.5843, FactorSearch(start=1.0, growth=1.25), doubt).all()
    assert found.undecided
    low, high = min(doubt[0], 1.5843), max(doubt[1], 1.5843)
    assert low - 0.02 <= found.low <= low and high <= found.high <= high + 0.02
    assert not found.width() <= 0.01


def test_an_undecided_point_that_no_trial_meets_changes_nothing() -> None:
    plain = searched(1.5843, FactorSearch(start=1.0, growth=1.25)).all()
    assert searched(1.5843, FactorSearch(start=1.0, growth=1.25), (1.3, 1.301)).all() == plain
    assert plain == FactorBracket(low=1.57470703125, high=1.5869140625)


@pytest.mark.parametrize(
    "wrong",
    [
        {"start": 0.0},
        {"start": -1.0},
        {"start": math.nan},
        {"growth": 1.0},
        {"growth": 1e6},
        {"tolerance": 0.0},
        {"tolerance": 1.0},
    ],
)
def test_searches_that_lead_nowhere_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(CaseError) as refused:
        FactorSearch(**{"start": 1.0, "growth": 1.25, **wrong})
    assert refused.value.where == next(iter(wrong))
