"""Texts in CSV files that a spreadsheet would compute."""

import csv

import pytest

from clast.rockmass.drawings.drawing_files import as_text, write_rows


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
