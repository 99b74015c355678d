"""Tables that grow: rows one behind the other, whenever somebody asks for them, and none twice."""

from __future__ import annotations

import numpy as np
import pytest

from clast.results.result_tables import FIRST_ROWS, MORE_ROWS, GrowingTable

ROW = np.dtype([("time", np.float64), ("force", np.float64, (2,))])


@pytest.mark.parametrize("asked", [[], [5], [FIRST_ROWS, FIRST_ROWS + 1], [300, 301, 2500]])
def test_rows_are_those_that_were_added(asked):
    table, number = GrowingTable(ROW), FIRST_ROWS + MORE_ROWS + 400
    given = []
    for k in range(number):
        table.append((float(k), (k + 0.25, k + 0.5)))
        if k + 1 in asked:
            given.append(table.rows)
    assert len(table) == number
    assert np.array_equal(table.rows["time"], np.arange(float(number)))
    assert np.array_equal(table.rows["force"][:, 1], np.arange(number) + 0.5)
    for count, rows in zip(asked, given, strict=True):
        assert np.array_equal(rows["time"], np.arange(float(count))), "later rows change it"
    for first in (0, 7, FIRST_ROWS, 2500, number):
        assert np.array_equal(table.since(first)["time"], np.arange(float(first), number))


def test_rows_that_were_asked_for_are_kept_once():
    table = GrowingTable(ROW)
    for k in range(FIRST_ROWS + 1):
        table.append((float(k), (0.0, 0.0)))
    assert table.rows is table.rows
    table.append((-1.0, (0.0, 0.0)))
    assert len(table.rows) == FIRST_ROWS + 2 and table.rows[-1]["time"] == -1.0
