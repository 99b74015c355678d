"""The numbers of run i: spread as they should, correlated as asked, the same however drawn."""

import numpy as np
import pytest
from scipy import stats

from clast.errors import CaseError
from clast.study.description import Description, parameters_of
from clast.study.sampling import (
    LatinHypercube,
    PointEstimate,
    Random,
    Sobol,
    _permute,
    copula,
    correlated,
)


def drawn(sampling: object, count: int, parameters: int = 2) -> np.ndarray:
    return np.array([sampling.probabilities(k, count, parameters) for k in range(count)])


@pytest.mark.parametrize("size", [1, 2, 3, 10, 64, 501])
def test_every_number_is_sent_to_another_one(size: int) -> None:
    assert sorted(_permute(k, size, 7) for k in range(size)) == list(range(size))


def test_random_numbers_are_uniform_and_independent() -> None:
    found = drawn(Random(3), 4000)
    for column in found.T:
        assert stats.kstest(column, "uniform").pvalue > 0.01
    assert abs(stats.pearsonr(*found.T).statistic) < 0.05
    assert abs(stats.pearsonr(found[1:, 0], found[:-1, 0]).statistic) < 0.05
    assert not np.array_equal(drawn(Random(4), 10), found[:10])


def test_each_latin_hypercube_has_one_run_in_every_slice() -> None:
    found = drawn(LatinHypercube(3, replicates=4), 80, 3)
    for replicate in found.reshape(4, 20, 3):
        for column in replicate.T:
            assert sorted((20 * column).astype(int)) == list(range(20))
    assert abs(stats.pearsonr(found[:, 0], found[:, 1]).statistic) < 0.3


def test_sobol_points_fill_every_slice_and_do_not_depend_on_who_draws_them() -> None:
    found = drawn(Sobol(5), 64, 3)
    for column in found.T:
        assert sorted((64 * column).astype(int)) == list(range(64))
    assert np.array_equal(Sobol(5).probabilities(40, 64, 3), found[40])


def test_a_copula_gives_the_correlation_of_scores() -> None:
    _, factor = copula([(0, 1, -0.4), (1, 2, 0.7)], 3)
    scores = stats.norm.ppf([correlated(one, factor) for one in drawn(Sobol(1), 512, 3)])
    assert np.corrcoef(scores.T)[0, 1] == pytest.approx(-0.4, abs=0.02)
    assert np.corrcoef(scores.T)[1, 2] == pytest.approx(0.7, abs=0.02)


def test_correlations_that_no_variables_have_are_refused() -> None:
    with pytest.raises(CaseError, match="positive"):
        copula([(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)], 3)


def test_point_estimates_have_the_moments_of_what_they_stand_for() -> None:
    study = Description(
        kind="montecarlo",
        vary=parameters_of({"a": "normal(10, 2)", "b": "uniform(0, 1)"}),
        correlate=(("a", "b", 0.5),),
        sampling=PointEstimate(),
        measure={"one": "end()"},
    ).checked()
    assert study.n == 4
    values = np.array([study.values(run) for run in range(1, 5)], np.float64)
    weights = np.array([study.weight(run) for run in range(1, 5)])
    assert weights.sum() == pytest.approx(1.0)
    mean = weights @ values
    assert mean == pytest.approx([10.0, 0.5])
    spread = (weights[:, None] * (values - mean)).T @ (values - mean)
    assert np.sqrt(np.diag(spread)) == pytest.approx([2.0, 12.0**-0.5])
    assert spread[0, 1] / np.sqrt(spread[0, 0] * spread[1, 1]) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("sampling", "count", "what"),
    [
        (LatinHypercube(1, replicates=7), 100, "cannot be divided"),
        (LatinHypercube(1, replicates=0), 100, "not a valid number of replicates"),
        (Sobol(1), 100, "not a power of two"),
        (PointEstimate(), 1, "combinations"),
    ],
)
def test_numbers_of_runs_that_a_sampling_cannot_have_are_refused(
    sampling: object, count: int, what: str
) -> None:
    with pytest.raises(CaseError, match=what):
        sampling.checked(count, 30)


def test_a_million_runs_are_drawn_one_at_a_time() -> None:
    study = Description(
        kind="montecarlo",
        vary=parameters_of({"a": "normal(0, 1)", "b": "numbered(5)"}),
        sampling=LatinHypercube(1),
        n=1_000_000,
        measure={"one": "end()"},
    ).checked()
    first, last = study.values(1), study.values(1_000_000)
    assert (first[1], last[1]) == (5, 1_000_004)
    assert abs(first[0]) < 6.0 and abs(last[0]) < 6.0
