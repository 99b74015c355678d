"""The report of a sweep: results that are written by hand, and what the page makes of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clast
from clast.study import statistics, study_report
from clast.study.folder import DONE, NO_RESULT, StudyFolder
from clast.study.report_page import Page

ANGLES, COHESIONS = [30.0, 20.0, 95.0], [1e3, 1e4]
VARY = {"phi: joint.plane.friction_angle": ANGLES, "c: joint.plane.cohesion": COHESIONS}
UNITS = {"phi": "°", "c": "Pa"}


def case():
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2600.0)
    builder.add_joint("plane", friction_angle=30.0)
    builder.block(name="base", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], fixed=True)
    corners = [(0, 1), (1, 1), (1, 2), (0, 2)]
    builder.block(name="top", vertices=corners, edge_joint=["plane", "", "", ""])
    builder.measured_point("A", (0.5, 0.5), block="base")
    return builder.case(step=0.01, end=0.01)


def made(path: Path, without: int = 0, **changes):
    """Return the folder of a sweep with u = angle c, no result above 90, and one run not made."""
    given = {"vary": VARY, "measure": {"u": "displacement(A)"}, "fail": "u > 1e5", **changes}
    study = clast.Study(case(), **given)
    folder = StudyFolder.made(path, study.case, study.described())
    for run in range(1, folder.study.n + 1):
        values = folder.values(run)
        one = {
            "run": run,
            "parameters": dict(zip([v.name for v in folder.study.vary], values, strict=True)),
        }
        u = float(np.prod(values))
        if run == without:
            continue
        if values[0] > 90.0:
            one |= {"status": NO_RESULT, "reason": "too steep"}
        else:
            one |= {"status": DONE, "fails": u > 1e5}
            one["measures"] = {"u": u} if folder.study.measure else {}
        with folder.making(run) as part:
            folder.write_result(part, one)
    return folder


def only_grid(folder, name="u"):
    (found,) = study_report.grids_of(statistics.columns_of(folder), UNITS, name)
    return found


def test_each_run_is_at_the_values_of_its_parameters(tmp_path):
    found = only_grid(made(tmp_path, without=4))
    assert [one.title for one in found.axes] == ["phi (°)", "c (Pa)"] and found.label == "u (m)"
    u = np.outer(ANGLES, COHESIONS)
    u[2] = u[1, 1] = np.nan  # no result, and not made
    assert np.array_equal(found.values, u, equal_nan=True)
    assert np.array_equal(found.fails, u > 1e5)
    assert found.lost.tolist() == [[False] * 2, [False] * 2, [True] * 2]


def test_lists_in_step_have_a_curve_each(tmp_path):
    vary = {"phi: joint.plane.friction_angle": [30.0, 20.0], "c: joint.plane.cohesion": COHESIONS}
    folder = made(tmp_path, vary=vary, together=True)
    found = study_report.grids_of(statistics.columns_of(folder), UNITS, "u")
    assert [[axis.label for axis in one.axes] for one in found] == [["phi"], ["c"]]
    assert [one.values.tolist() for one in found] == [[3e4, 2e5], [3e4, 2e5]]


def test_a_list_of_one_value_is_no_dimension(tmp_path):
    vary = {"phi: joint.plane.friction_angle": [30.0], "c: joint.plane.cohesion": COHESIONS}
    found = only_grid(made(tmp_path / "two", vary=vary))
    assert [axis.label for axis in found.axes] == ["c"] and found.values.tolist() == [3e4, 3e5]
    alone = made(tmp_path / "one", vary={"phi: joint.plane.friction_angle": [30.0]})
    assert not study_report.grids_of(statistics.columns_of(alone), UNITS, "u")


def test_where_nothing_is_measured_failure_is_drawn(tmp_path):
    found = only_grid(made(tmp_path, measure={}, fail="displacement(A) > 1e5"), "")
    assert found.label == study_report.FAILURE
    assert np.array_equal(found.values[:2], [[0.0, 1.0], [0.0, 1.0]])
    assert found.lost[2].all()


def test_the_table_has_units_and_reasons(tmp_path):
    folder = made(tmp_path, without=4)
    page = Page("sweep")
    study_report.write_runs(page, folder, statistics.columns_of(folder), UNITS)
    text = page.text()
    for head in ("run", "phi, °", "c, Pa", "u, m", "fails", "reason"):
        assert f">{head}</th>" in text
    cells = "<td>30</td><td>10000</td><td>3e+05</td><td>true</td>"
    assert f'<tr><td>2</td><td class="text">done</td>{cells}' in text
    empty = "<td>95</td><td>1000</td><td>-</td><td>-</td>"
    assert f'<td class="text">no result</td>{empty}<td class="text">too steep</td>' in text
    assert text.count("<tr>") == 1 + 5
    assert "All digits are in results.csv." in text


def test_a_long_table_says_where_the_rest_is(tmp_path, monkeypatch):
    monkeypatch.setattr(study_report, "SWEEP_ROWS_MAX", 2)
    folder = made(tmp_path)
    page = Page("sweep")
    study_report.write_runs(page, folder, statistics.columns_of(folder), UNITS)
    assert page.text().count("<tr>") == 1 + 2
    assert "The first 2 of 6 runs; all are in results.csv." in page.text()


@pytest.mark.parametrize(
    ("measure", "head"), [({"u": "displacement(A)"}, "u = "), ({}, "Failure: ")]
)
def test_curves_have_a_heading_and_a_figure(tmp_path, measure, head):
    pytest.importorskip("matplotlib")
    folder = made(tmp_path, measure=measure, fail="displacement(A) > 1e5")
    page = Page.of(folder, "sweep")
    study_report.write_curves(page, statistics.columns_of(folder), UNITS, next(iter(measure), ""))
    assert f"<h2>{head}" in page.text() and page.text().count("data:image/png") == 1
    places = "run 3 (phi = 20.0, c = 1000.0), largest 3e+05 m in run 2 (phi = 30.0, c = 10000.0)"
    said = f"Least 20000 m in {places}."
    assert (said in page.text()) is bool(measure)


def test_a_sweep_is_summed_up_by_its_extremes_and_where_they_are(tmp_path):
    columns = statistics.columns_of(made(tmp_path))
    found = statistics.extremes(columns, columns.measures["u"])
    assert {name: (one.value, one.run, one.parameters) for name, one in found.items()} == {
        "least": (2e4, 3, {"phi": 20.0, "c": 1e3}),
        "largest": (3e5, 2, {"phi": 30.0, "c": 1e4}),
    }
    assert columns.gaps == []
    nothing = np.full(len(columns.run), np.nan)
    assert statistics.extremes(columns, nothing) is None
    (sentence,) = replace(columns, measures={"u": nothing}).gaps
    assert "4 of 4 runs have no finite value of u" in sentence
