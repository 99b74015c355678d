"""Probabilities with which single blocks and joints fail: intervals, and their table."""

import numpy as np
import pytest
from scipy import stats

from clast.study import study_report
from clast.study.description import MONTECARLO, Description, parameters_of, sampling_of
from clast.study.report_page import Page
from clast.study.statistics import StudyResults, interval_of_count, probability

RUNS, LOST = 40, 3


def results(sampling="random", counts=None, lost=LOST):
    study = Description(
        kind=MONTECARLO,
        vary=parameters_of({"x": "uniform(0, 1)"}),
        measure={"u": "steps()"},
        fail="fails()",
        sampling=sampling_of(sampling),
        n=60 if sampling == "latin-hypercube" else 64,
    ).checked()
    counts = counts or {}
    fails = np.arange(RUNS) < max(counts.values(), default=0)
    return StudyResults(
        study=study,
        run=np.arange(1.0, RUNS + 1),
        parameters={},
        measures={},
        fails=1.0 * fails,
        blocks=counts,
        joints={},
        reasons={"it stopped": lost} if lost else {},
    )


@pytest.mark.parametrize("count", [1, 7, 20, 36])
@pytest.mark.parametrize("lost", [0, LOST])
def test_ends_are_as_far_from_the_share_as_chance_would_have_it(count, lost):
    """(share - p)^2 = z^2 p (1 - p)/n at both ends (Wilson 1927), lost runs as either."""
    low, high = interval_of_count(results(lost=lost), count)
    z, n = stats.norm.ppf(0.975), RUNS + lost
    for end, failed in ((low, count), (high, count + lost)):
        assert (failed / n - end) ** 2 == pytest.approx(z**2 * end * (1.0 - end) / n, rel=1e-9)
    assert low < count / n <= (count + lost) / n < high


def test_a_block_that_fails_whenever_the_slope_does_has_its_interval():
    found = results(counts={"slab": 7})
    whole = probability(found)
    assert interval_of_count(found, 7) == (whole.low, whole.high)


@pytest.mark.parametrize("sampling", ["latin-hypercube", "sobol"])
def test_runs_that_depend_on_each_other_have_none(sampling):
    assert interval_of_count(results(sampling), 7) is None


@pytest.mark.parametrize(("sampling", "columns"), [("random", 5), ("sobol", 3)])
def test_the_table_of_blocks_has_the_interval_where_there_is_one(sampling, columns):
    found = results(sampling, counts={"slab": 7, "wedge": 2})
    page = Page("study")
    study_report.write_counts(page, found, "block", found.blocks)
    text = page.text()
    assert text.count("<th") == columns and text.count("<td") == 2 * columns
    if columns == 5:
        low, high = interval_of_count(found, 2)
        cells = "".join(f"<td>{one}</td>" for one in (2, "0.05", f"{low:.5g}", f"{high:.5g}"))
        assert f'<tr><td class="text">wedge</td>{cells}</tr>' in text
        assert "95 %: from" in text
