"""Comparisons of processes and laws, their references and their pages."""

from __future__ import annotations

import json
import re
from base64 import b64decode
from dataclasses import dataclass

import numpy as np
import pytest

from clast import studies
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.contact.laws import Penalty
from clast.errors import CaseError
from clast.pictures import canvas
from clast.step.convex import Convex
from clast.studies.comparison_pages import cells, headings, remarks

END = "time.end=0.05"
FALL = """
schema = 1
title = "A block that falls"
gravity = [0.0, -10.0]
time = {step = 1e-3, end = 0.1}
rock.stone = {young = 1e9, poisson = 0.2, density = 2500.0}
[[block]]
name = "stone"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[measured_point]]
name = "P"
at = [0.5, 0.5]
[[reference]]
point = "P"
displacement = [0.0, -0.05]
source = "g t2/2"
[[reference]]
point = "P"
displacement = [0.0, -0.0125]
time = 0.05
[[reference]]
point = "P"
displacement = [1.0, 0.0]
time = 0.2
"""


@pytest.fixture(scope="module")
def incline() -> studies.ComparedMethods:
    case = Case.from_toml(INCLINE, [END, "reference=[]"])
    return studies.compare(case, ["modified", "convex"], ["penalty", "augmented-lagrangian"])


def test_every_process_with_every_law(incline):
    assert [str(row.combination) for row in incline.rows] == [
        "modified, penalty",
        "modified, augmented-lagrangian",
        "convex, penalty",
        "convex, augmented-lagrangian",
    ]
    assert all(row.report.finished for row in incline.rows)
    u = [row.displacement["A"][0] for row in incline.rows]
    assert u == pytest.approx(4 * [0.5 * 9.8 * 0.5 * (1 - np.tan(np.radians(20))) * 0.05**2], 0.2)
    assert incline.rows[1].penetration < 0.5 * incline.rows[0].penetration
    assert incline.rows[1].solves_per_step == pytest.approx(4.0, abs=0.2)


def test_numbers_of_the_case_are_kept():
    case = Case.from_toml(
        INCLINE, ["method.process={name='modified', passes=3}", "method.contact_law.name=penalty"]
    )
    same = studies.Combination("modified", "penalty").applied_to(case).method()
    assert same.process.passes == 3
    assert same.contact_law.normal_stiffness == 1e9
    other = studies.Combination("convex", "augmented-lagrangian").applied_to(case).method()
    assert type(other.process).__name__ == "Convex"
    assert other.contact_law.normal_stiffness == 1e9
    assert other.contact_law.solves == 4


def test_references_are_compared_at_their_times():
    case = Case.from_toml(FALL)
    first, second, third = studies.deviations(case, case.run())
    assert first.time == 0.1
    assert first.distance == pytest.approx(0.0, abs=1e-9)
    assert second.relative == pytest.approx(0.0, abs=1e-6)
    assert third.computed is None
    assert third.as_text() == "not reached"


def test_a_reference_of_zero_has_an_error_in_metres():
    case = Case.from_toml(FALL, ["reference=[{point='P', displacement=[0.0, 0.0]}]"])
    (only,) = studies.deviations(case, case.run())
    assert only.relative is None
    assert only.as_text() == "0.05 m"


def test_a_run_that_stops_is_a_row():
    tight = [END, "time.max_displacement=1e-4", "time.smallest_step=9e-4"]
    comparison = studies.compare(Case.from_toml(INCLINE, tight), ["convex"], ["penalty"])
    (row,) = comparison.rows
    assert not row.report.finished
    assert row.outcome.startswith("stopped at t = 0.0")
    assert cells(comparison, row)[-1] == row.outcome
    assert any("max_displacement" in text for text in remarks(comparison))


def test_pages(incline, tmp_path):
    paths = studies.write_comparison(incline, tmp_path / "new" / "pages")
    assert [path.name for path in paths] == [f"comparison.{end}" for end in ("html", "json", "png")]
    page, content = (path.read_text(encoding="utf-8") for path in paths[:2])
    for row in incline.rows:
        assert "".join(f"<td>{text}" for text in cells(incline, row)) in page
    assert all(heading in page for heading in headings(incline))
    embedded = re.search(r"base64,([^\"]+)\"", page)
    assert embedded is not None
    assert b64decode(embedded[1]) == paths[2].read_bytes()
    assert "http" not in page
    processes = [row["process"] for row in json.loads(content)["rows"]]
    assert processes == ["modified", "modified", "convex", "convex"]


@pytest.mark.parametrize(
    ("processes", "laws", "message"),
    [
        (["convx"], ["penalty"], "no process 'convx'"),
        (["convex"], ["penality"], "no contact law 'penality'"),
        ([], ["penalty"], "no process to compare"),
        (["convex", "convex"], ["penalty"], "listed twice"),
    ],
)
def test_names_are_checked_first(processes, laws, message):
    with pytest.raises(CaseError, match=message) as caught:
        studies.compare(Case.from_toml(INCLINE), processes, laws)
    assert caught.value.remedy


@dataclass(frozen=True)
class Renamed:
    """The penalty law under another name."""

    normal_stiffness: float = 1e9

    def respond(self, contacts, gap, slip):
        return Penalty(self.normal_stiffness).respond(contacts, gap, slip)


def test_objects_beside_names(tmp_path):
    case = Case.from_toml(INCLINE, [END, "reference=[]"])
    comparison = studies.compare(case, ["modified", Convex()], ["penalty", Renamed()])
    assert [str(row.combination) for row in comparison.rows] == [
        "modified, penalty",
        "modified, Renamed",
        "Convex, penalty",
        "Convex, Renamed",
    ]
    ends = [row.displacement["A"] for row in comparison.rows]
    assert ends[1] == ends[0]
    assert ends[3] == pytest.approx(ends[2], rel=1e-6)
    assert [row.stiffness for row in comparison.rows] == 4 * [1e9]
    assert "Convex, Renamed" in [str(row.combination) for row in comparison.rows]
    studies.write_comparison(comparison, tmp_path)
    assert "<td>Convex<td>Renamed" in (tmp_path / "comparison.html").read_text(encoding="utf-8")


def test_two_objects_of_a_class_are_told_apart():
    found = studies.combinations(["convex"], [Renamed(1e8), Renamed(1e9), "penalty"])
    assert [one.law for one in found] == [
        "Renamed(normal_stiffness=100000000.0)",
        "Renamed(normal_stiffness=1000000000.0)",
        "penalty",
    ]
    with pytest.raises(CaseError, match="listed twice"):
        studies.combinations(["convex"], [Renamed(1e8), Renamed(1e8)])


def test_objects_that_are_no_law_are_refused_before_anything_runs():
    case = Case.from_toml(INCLINE, [END])
    with pytest.raises(CaseError, match="Convex is not a valid contact_law: it has no respond"):
        studies.compare(case, ["convex"], ["penalty", Convex()])
    with pytest.raises(CaseError, match=r"'convex' is not a list\n  give one: \[\"convex\"\]"):
        studies.compare(case, "convex")


DUG = """
schema = 1
title = "Two of three stay"
time = {step = 1e-3, end = 0.02, dynamic_ratio = 0.0}
rock.stone = {young = 1e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
[[block]]
name = "floor"
vertices = [[0, -1], [1, -1], [1, 0], [0, 0]]
fixed = true
[[block]]
name = "low"
vertices = [[0, 0], [1, 0], [1, 1], [0, 1]]
[[block]]
name = "high"
vertices = [[0, 1], [1, 1], [1, 2], [0, 2]]
[[stage]]
name = "rest"
until = "time"
time = 0.01
[[stage]]
name = "dig"
until = "time"
time = 0.01
excavate = ["high"]
"""


def test_excavated_blocks_are_outlines_only(tmp_path, monkeypatch):
    figures: list = []
    save = canvas.save

    def kept(figure, path):
        figures.append(figure)
        return save(figure, path)

    monkeypatch.setattr(canvas, "save", kept)
    compared = studies.compare(Case.from_toml(DUG), ["convex", "open-close"], ["penalty"])
    assert [row.absent.tolist() for row in compared.rows] == [[False, False, True]] * 2
    studies.write_comparison(compared, tmp_path)
    for axes in figures[0].axes[:2]:
        polygons = [c for c in axes.collections if type(c).__name__ == "PolyCollection"]
        _, dashed, _, coloured = polygons
        assert [len(one.get_paths()) for one in polygons] == [2, 1, 1, 1]
        assert dashed.get_paths()[0].vertices[:, 1].max() == pytest.approx(2.0, abs=0.01)
        assert len(coloured.get_array()) == 1


def test_references_belong_to_the_system_of_the_file():
    assert Case.from_toml(INCLINE, ["time.end=0.5", "method.process=convex"]).reference
    assert not Case.from_toml(INCLINE, ["joint.default.friction_angle=30"]).reference
    kept = Case.from_toml(INCLINE, ["joint.default.friction_angle=30", "reference.1.time=0.5"])
    assert kept.reference[0].time == 0.5
