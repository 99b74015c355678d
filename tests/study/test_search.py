"""The search for a factor, on blocks whose limit is known: nothing is simulated."""

import math

import pytest

from clast.errors import CaseError
from clast.study.collapsing.reduction import reduction
from clast.study.collapsing.search import (
    FAILED,
    STANDS,
    UNDECIDED,
    FactorBracket,
    FactorSettings,
    Trial,
    bracket_of,
    search_factor,
)


def trials_of(limit, doubt=(0.0, 0.0), start=1.0, growth=1.25, tolerance=0.01):
    def make(number: int, factor: float) -> Trial:
        verdict = STANDS if factor < limit else FAILED
        verdict = UNDECIDED if doubt[0] < factor < doubt[1] else verdict
        return Trial(factor=factor, verdict=verdict, displacement=0.0, mover="")

    return search_factor(FactorSettings(start=start, growth=growth, tolerance=tolerance), make)


def bracket(*given, **named) -> FactorBracket:
    return bracket_of(trials_of(*given, **named))


@pytest.mark.parametrize("limit", [0.013, 0.6771, 0.99, 1.2057, 1.5843, 17.0, 345.0])
@pytest.mark.parametrize("start", [0.3, 1.0, 2.7])
@pytest.mark.parametrize("growth", [1.1, 1.25, 4.0])
def test_the_bracket_holds_the_limit_and_is_as_narrow_as_asked(
    limit: float, start: float, growth: float
) -> None:
    found = bracket(limit, start=start, growth=growth, tolerance=0.004)
    assert found.low < limit <= found.high
    assert found.high - found.low <= 0.004 * found.high * (1.0 + 1e-12)


def test_few_trials_are_needed() -> None:
    assert len(trials_of(1.5843)) == 9


def test_what_never_fails_is_said() -> None:
    found = bracket(math.inf, growth=2.0)
    assert found.low == 512.0
    assert math.isinf(found.high) and not found.is_closed
    assert found.describe("F") == "F at least 512: no failure was found up to there"


def test_what_never_stands_is_said() -> None:
    found = bracket(0.0, growth=2.0)
    assert found.low == 0.0 and found.high < 0.001 and not found.is_closed


@pytest.mark.parametrize("doubt", [(1.5, 1.6), (1.584, 1.7), (1.2, 1.58)])
def test_an_undecided_range_is_closed_in_from_both_sides(doubt: tuple[float, float]) -> None:
    found = bracket(1.5843, doubt)
    assert found.undecided
    low, high = min(doubt[0], 1.5843), max(doubt[1], 1.5843)
    assert low - 0.02 <= found.low <= low and high <= found.high <= high + 0.02
    assert not found.width <= 0.01


def test_an_undecided_point_that_no_trial_meets_changes_nothing() -> None:
    plain = bracket(1.5843)
    assert bracket(1.5843, (1.3, 1.301)) == plain
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
        FactorSettings(**wrong).of(reduction("strength"))
    assert refused.value.where == next(iter(wrong))


@pytest.mark.parametrize("limit", [700.0, 5e3, 1.04e5, 3.3e8])
def test_a_small_load_goes_on_in_a_larger_bracket(limit: float) -> None:
    def make(number: int, factor: float) -> Trial:
        verdict = STANDS if factor < limit else FAILED
        return Trial(factor=factor, verdict=verdict, displacement=0.0, mover="")

    search = FactorSettings(start=1.0, growth=2.0, tolerance=0.01)
    usual = search_factor(search, make)
    trials = search_factor(search, make, 1e9)
    found = bracket_of(trials)
    assert found.low < limit <= found.high and found.width <= 0.01 * (1.0 + 1e-12)
    assert math.isinf(bracket_of(usual).high) and trials[: len(usual)] == usual
    assert len(trials) < 30


def test_a_load_beyond_what_is_tried_has_no_limit() -> None:
    search = FactorSettings(start=1.0, growth=2.0)

    def make(number: int, factor: float) -> Trial:
        return Trial(factor=factor, verdict=STANDS, displacement=0.0, mover="")

    assert 1e9 / 16.0 < bracket_of(search_factor(search, make, 1e9)).low <= 1e9


def test_loads_are_compared_with_the_weight() -> None:
    content = {
        "point_load": [{"name": "a", "force": [3.0, -4.0]}, {"name": "b", "force": [1e9, 0.0]}],
        "line_load": [{"name": "a", "traction": [0.0, -2.0], "start": [0, 0], "end": [3, 4]}],
        "pressure": [{"name": "a", "value": [1.0, 5.0], "start": [0, 0], "end": [0, 1]}],
        "load_train": [{"name": "a", "loads": [2.0, 2.0, 3.0]}],
    }
    by = reduction("load a")
    assert by.over_weight(content, 100.0) == pytest.approx((5.0 + 10.0 + 5.0 + 7.0) / 100.0)
    assert by.over_weight(content, 0.0) == 0.0
