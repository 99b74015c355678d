"""What is made once and not in every step, and frozen things that are replaced at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest

from benchmarks.scenes import SCENES
from clast.actions.active import ActiveActions, actions_of
from clast.actions.damping import Rayleigh, Undamped
from clast.compute.reductions import is_any, largest_size, least
from clast.compute.stopwatch import Stages
from clast.read_only import changed
from clast.results.result_tables import FIRST_ROWS, MORE_ROWS, GrowingTable


@dataclass(frozen=True, kw_only=True)
class Thing:
    one: float
    two: float = 2.0

    @cached_property
    def both(self) -> float:
        return self.one + self.two


def test_what_is_changed_is_what_replace_gives():
    thing = Thing(one=1.0)
    assert thing.both == 3.0
    other = changed(thing, one=5.0)
    assert other == replace(thing, one=5.0) and type(other) is Thing
    assert other.both == 7.0 and thing == Thing(one=1.0)


def test_actions_are_made_anew_where_model_or_damping_change():
    model, acting, damping = SCENES["stack"].build(10), ActiveActions(), Undamped()
    first = acting.actions(model, 1e9, damping)
    assert first == actions_of(model, 1e9, damping)
    stiffness = 1e9
    kept = acting.actions(model, stiffness, damping)
    assert acting.actions(model, stiffness, damping) is kept
    other = acting.actions(model, stiffness, Rayleigh(mass=1.0))
    assert Rayleigh(mass=1.0) in other and Undamped() not in other
    again = SCENES["stack"].build(10)
    assert acting.actions(again, stiffness, damping) is not kept


def test_a_stage_ends_where_the_next_begins():
    times = iter([0.0, 1.0, 3.0, 6.0, 10.0, 15.0, 21.0])
    stages = Stages(lambda: next(times))
    stages("contacts")  # 0
    stages("law")  # 1
    stages("law")  # goes on, and asks for no time
    stages("contacts")  # 3
    assert stages.ended() == {"contacts": 1.0 + 3.0, "law": 2.0}  # 6
    with stages("ledger"):  # 10
        pass  # 15
    stages("law")  # 21
    assert stages.seconds == {"contacts": 4.0, "law": 2.0, "ledger": 5.0}


@pytest.mark.parametrize("count", [0, 1, FIRST_ROWS, FIRST_ROWS + 1, FIRST_ROWS + 2 * MORE_ROWS])
def test_rows_of_a_table_stay_in_their_order(count):
    table = GrowingTable(np.dtype([("a", "f8"), ("b", "i8")]))
    for k in range(count):
        table.append((0.5 * k, k))
    assert len(table) == count
    assert table.rows["b"].tolist() == list(range(count))
    for first in (0, count // 2, count):
        assert table.since(first)["b"].tolist() == list(range(first, count))
    table.extend(np.array([(0.0, -1), (0.0, -2)], table.rows.dtype))
    table.append((0.0, -3))
    assert table.rows["b"].tolist() == [*range(count), -1, -2, -3]
    assert table.since(count)["b"].tolist() == [-1, -2, -3]


def test_reductions_of_a_few_numbers():
    assert not is_any(np.zeros(3, np.bool_)) and not is_any(np.zeros(0, np.bool_))
    assert is_any(np.array([False, True]))
    assert least(np.array([3.0, -2.0, 1.0]), 0.0) == -2.0
    assert least(np.array([3.0]), 0.0) == 0.0 and least(np.zeros(0), 0.0) == 0.0
    assert np.isnan(least(np.array([3.0, np.nan, -4.0]), 0.0))
    assert largest_size(np.array([3.0, -4.0, 1.0])) == 4.0 and largest_size(np.zeros(0)) == 0.0
    assert np.isnan(largest_size(np.array([3.0, np.nan, -4.0])))
