"""Traces, outlines and joint surveys from CSV."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from clast.errors import CaseError
from clast.rockmass.drawings.csv_lines import read_csv, read_outline, read_traces
from clast.rockmass.drawings.drawing_files import as_text, write_rows
from scenes.command_line import good


@pytest.fixture
def written(tmp_path):
    def write(text: str, encoding: str = "utf-8") -> Path:
        path = tmp_path / "lines.csv"
        path.write_bytes(text.encode(encoding))
        return path

    return write


def test_four_plain_columns_need_no_heading(written):
    traces, _ = read_traces(written("0,0,10,5\n1,2.5,3,-4e0\n"))
    np.testing.assert_array_equal(traces[1].points, [(1, 2.5), (3, -4)])
    assert [one.joint for one in traces] == ["default", "default"]
    assert traces[1].place == "line 2"


def test_a_heading_names_columns_in_any_order(written):
    text = "# survey of the north wall\nSet,Joint,X2,Y2,x1,y1\n\nJ1,bedding,10,0,0,1\nJ2,,5,5,0,0\n"
    drawing = read_csv(written(text))
    np.testing.assert_array_equal(drawing.traces[0].points, [(0, 1), (10, 0)])
    assert [(t.joint, t.joint_set) for t in drawing.traces] == [
        ("bedding", "J1"),
        ("default", "J2"),
    ]
    assert drawing.traces[1].place == "line 5" and drawing.left_out == ()


def test_polylines_are_gathered_by_id(written):
    text = "id,x,y,joint\na,0,0,f\nb,5,5,g\na,1,1,f\na,1,1,f\na,2,0,f\nb,6,5,g\n"
    traces, _ = read_traces(written(text))
    np.testing.assert_array_equal(traces[0].points, [(0, 0), (1, 1), (2, 0)])
    np.testing.assert_array_equal(traces[1].points, [(5, 5), (6, 5)])
    assert [one.joint for one in traces] == ["f", "g"]


@pytest.mark.parametrize("last", ["", "0,0\n"])
@pytest.mark.parametrize("corners", ["0,0\n4,0\n4,3\n", "0,0\n4,3\n4,0\n"])
def test_an_outline_is_turned_and_closed(written, corners, last):
    outline, _ = read_outline(written("x,y\n" + corners + last))
    assert len(outline) == 3
    x, y = outline.T
    assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == 6.0


def test_a_joint_survey(written):
    text = "dip;dip direction;length;set\n35,5;120;12,5;J1\n90;360;;J2\n"
    drawing = read_csv(written(text))
    survey = drawing.orientations
    np.testing.assert_array_equal(survey.dip, [35.5, 90])
    np.testing.assert_array_equal(survey.dip_direction, [120, 0])
    np.testing.assert_array_equal(survey.length, [12.5, np.nan])
    assert survey.joint_set == ("J1", "J2") and survey.joint == ("default", "default")
    assert any("decimal commas" in note for note in drawing.notes)


@pytest.mark.parametrize("mark", [",", ";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_separators_encodings_and_ends_of_lines(written, mark, encoding, end):
    rows = [["x1", "y1", "x2", "y2", "joint"], ["0", "0", "1", "1", "Störung"]]
    path = written(end.join(mark.join(row) for row in rows) + end, encoding)
    assert read_traces(path)[0][0].joint == "Störung"


def test_names_in_quotes_may_hold_commas(written):
    drawing = read_csv(written('x1;y1;x2;y2;joint\n0;0;1;1;"a, b"\n'))
    assert drawing.traces[0].joint == "a, b" and drawing.notes == ()


def test_other_columns_and_points_are_left_out_by_name(written):
    text = "x1,y1,x2,y2,aperture\n0,0,1,1,3.5\n2,2,2,2,1\n"
    left = [str(one) for one in read_csv(written(text)).left_out]
    assert "aperture" in left[0] and "3.5" in left[0]
    assert "line 3" in left[1] and "no length" in left[1]


@pytest.mark.parametrize(
    "text",
    ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "-a", "--1", "+"],
)
def test_a_formula_is_a_text(text):
    assert as_text(text) == f"'{text}"


@pytest.mark.parametrize(
    "value",
    ["block 1", "", "1=1", "a-b", "-1.5", "+3", "-1e-05", "-inf", "'=1", -1.5, 0, None, True],
)
def test_others_are_what_they_are(value):
    assert as_text(value) is value


def test_all_cells_of_a_table_are_looked_at(tmp_path):
    count = write_rows(tmp_path / "t.csv", [["=head", "x"], ["a", -1.5], ["@b", "-2"]])
    with (tmp_path / "t.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [["'=head", "x"], ["a", "-1.5"], ["'@b", "-2"]]
    assert count == 3


PARTS = "id,part,x,y\n1,0,0.2,0\n1,0,0.2,2\n1,1,0.8,0\n1,1,0.8,2\n"
CASE = """
schema = 1
time = {step = 1e-3, end = 5e-3}
rock.r = {young = 2e10, poisson = 0.2, density = 2700.0}
joint.default = {friction_angle = 30.0}
[domain]
boundary = [[0, 0], [1, 0], [1, 2], [0, 2]]
[[trace]]
file = "lines.csv"
"""


def test_parts_of_one_id_are_lines_of_their_own(tmp_path):
    (tmp_path / "lines.csv").write_text(PARTS)
    (tmp_path / "case.toml").write_text(CASE)
    report = json.loads(good("cut", tmp_path / "case.toml", "--json"))
    assert report["blocks"] == 3
    swapped = "\n".join(PARTS.splitlines()[k] for k in (0, 1, 3, 2, 4))
    (tmp_path / "lines.csv").write_text(swapped)
    assert len(read_traces(tmp_path / "lines.csv")[0]) == 2


def test_columns_that_are_not_read_are_named(tmp_path):
    (tmp_path / "lines.csv").write_text("x1,y1,x2,y2,aperture,filling\n0.5,0,0.5,2,3.5,calcite\n")
    (tmp_path / "case.toml").write_text(CASE)
    notes = " ".join(json.loads(good("cut", tmp_path / "case.toml", "--json"))["notes"])
    assert "aperture" in notes
    assert "filling" in notes
    assert len(read_traces(tmp_path / "lines.csv")[1]) == 2


@pytest.mark.parametrize(
    "text", ["root:hunter2:0\n", "PASSWORD=hunter2\n1\n", "a,b=hunter2\n1,2\n"]
)
def test_nothing_of_a_foreign_file_is_repeated(tmp_path, text):
    (tmp_path / "lines.csv").write_text(text)
    with pytest.raises(CaseError) as error:
        read_traces(tmp_path / "lines.csv")
    assert "hunter2" not in str(error.value)
