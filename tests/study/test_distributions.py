"""Distributions against scipy.stats, how they are written, and what is refused."""

import numpy as np
import pytest
from scipy import stats

from clast.errors import CaseError
from clast.model.distributions import (
    Beta,
    Discrete,
    Distribution,
    Lognormal,
    Normal,
    Triangular,
    Uniform,
    Values,
)
from clast.study.distributions import Range, Times, parsed

TRUNCATED = stats.truncnorm(-1.0, 2.0, 35.0, 5.0)
LOG = float(np.sqrt(np.log1p(0.25)))
KNOWN = [
    (Normal(35.0, 5.0), stats.norm(35.0, 5.0)),
    (Normal(35.0, 5.0, low=30.0, high=45.0), TRUNCATED),
    (Lognormal(4.0, 2.0), stats.lognorm(LOG, scale=4.0 / np.sqrt(1.25))),
    (Uniform(-1.0, 3.0), stats.uniform(-1.0, 4.0)),
    (Triangular(1.0, 2.0, 4.0), stats.triang(1.0 / 3.0, 1.0, 3.0)),
    (Beta(2.0, 3.0, low=-1.0, high=4.0), stats.beta(2.0, 3.0, -1.0, 5.0)),
]


@pytest.mark.parametrize(
    ("ours", "known"), KNOWN, ids=lambda one: str(one) if isinstance(one, Distribution) else ""
)
def test_distributions_are_those_of_scipy(ours: Distribution, known: object) -> None:
    chances = (1e-6, 0.02, 0.3, 0.5, 0.9, 1.0 - 1e-6)
    found = [ours.quantile(p) for p in chances]
    assert found == pytest.approx(known.ppf(chances), rel=1e-9)  # type: ignore[attr-defined]
    mean, sd = ours.moments
    assert mean == pytest.approx(known.mean(), rel=1e-3)  # type: ignore[attr-defined]
    assert sd == pytest.approx(known.std(), rel=1e-3)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "written",
    [
        "normal(35, 5, low=15, high=70)",
        "normal(35, 5, high=70)",
        "lognormal(1e5, 2e4)",
        "discrete(['clay', 'sand'], [0.3, 0.7])",
        "values([true, false])",
        "range(0, 0.6, 3)",
        "numbered(7)",
        "times(triangular(0.5, 1, 2))",
        "[20, 30]",
        "-3",
    ],
)
def test_a_distribution_is_read_as_it_is_written(written: str) -> None:
    found = parsed(written, "vary x")
    assert parsed(str(found), "vary x") == found


def test_a_range_has_its_ends_and_no_rounding() -> None:
    found = Range(0.0, 0.6, 3)
    assert [found.at(k) for k in range(len(found))] == [0.0, 0.3, 0.6]


def test_a_discrete_value_has_its_share() -> None:
    one = Discrete(["a", "b"], [0.25, 0.75])
    assert [one.quantile(p) for p in (0.1, 0.24, 0.26, 0.99)] == ["a", "a", "b", "b"]
    assert Discrete([1, 2, 3]).moments == pytest.approx((2.0, np.sqrt(2.0 / 3.0)))
    assert Times(Values([1.0])).factor == Values([1.0])


@pytest.mark.parametrize(
    ("written", "what"),
    [
        ("normal(35)", "lacks sd"),
        ("normal(35, -5)", "not positive"),
        ("normal(35, 0)", "not positive"),
        ("normal('a', 5)", "for mean"),
        ("normal(35, 5, low=70, high=15)", "goes from 70 to 15"),
        ("normal(35, 1, low=90, high=95)", "no probability"),
        ("normal(35, 5, lo=3)", "no 'lo'"),
        ("normal(35, 5, 1, 2, 3)", "has 5 numbers"),
        ("normal(35, 5", "is not a valid distribution"),
        ("gauss(35, 5)", "no distribution 'gauss'"),
        ("lognormal(-1, 2)", "not positive"),
        ("uniform(3, 1)", "goes from 3 to 1"),
        ("uniform(1, inf)", "is not a number"),
        ("triangular(1, 5, 4)", "mode outside"),
        ("beta(0, 1)", "not positive"),
        ("discrete([])", "has 0 values"),
        ("[]", "has 0 values"),
        ("[[20], [30]]", r"has \[20\] among its values"),
        ("discrete([1, 2], [0.5])", "1 probabilities for 2"),
        ("discrete([1, 2], [0.5, 0.6])", "sum up to 1.1"),
        ("range(1, 2, 1)", "no count"),
        ("range(1, 2, 2.5)", "no count"),
        ("times(3)", ""),
        ("times(times(normal(1, 2)))", "needs a distribution"),
        ("numbered(-1)", "no whole number"),
        ("__import__('os')", "no distribution"),
        ("values({})", "needs a list"),
        ("", "is not a valid distribution"),
    ],
)
def test_what_is_no_distribution_is_refused(written: str, what: str) -> None:
    if written == "times(3)":
        assert parsed(written, "vary x").factor == Values([3])  # type: ignore[attr-defined]
        return
    with pytest.raises(CaseError, match=what) as refused:
        parsed(written, "vary x")
    assert refused.value.where == "vary x"
    assert refused.value.remedy
