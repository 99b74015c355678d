"""What is recorded is what the schema says, and the ledger's entries say what they are."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import clast
from clast.model.state import LEDGER, LEDGER_ENTRIES, Kind, Ledger, entries_of
from clast.results import schema
from clast.results.frame_samples import ROWS, STEP_ROWS
from clast.results.schema import Per
from clast.run.run_checks import COUNTED


def run() -> clast.Run:
    builder = clast.ModelBuilder(title="falls")
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.block(name="a", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.measured_point("tip", (1.0, 1.0))
    return builder.case(end=0.02, step=1e-3).run()


@pytest.fixture(scope="module")
def falls() -> clast.Run:
    return run()


def test_every_table_has_what_gives_its_rows():
    tables = {one.name: one.per for one in schema.OVER_TIME}
    assert set(ROWS) == {name for name, per in tables.items() if per is Per.INSTANT}
    assert set(STEP_ROWS) == {name for name, per in tables.items() if per is Per.STEP}


def test_a_table_is_asked_for_by_its_name(falls: clast.Run):
    for name in ("energy", "steps"):
        asked, known = falls.table(name).rows, getattr(falls, name).rows
        assert asked.dtype == known.dtype
        for column in known.dtype.names:  # of some columns a dynamic step has none: NaN
            np.testing.assert_array_equal(asked[column], known[column])
    tip = falls.history("tip")
    np.testing.assert_array_equal(falls.table("history", "tip").rows, tip.rows)
    np.testing.assert_array_equal(falls.table("steps").travel, falls.steps["travel"])
    assert list(falls.table("energy")) == ["time", *LEDGER_ENTRIES]
    with pytest.raises(clast.CaseError, match="there is no table 'enrgy'"):
        falls.table("enrgy")
    with pytest.raises(clast.CaseError, match="there is no measured point 'top'"):
        falls.table("history", "top")
    with pytest.raises(clast.CaseError, match="there is no bolt"):
        falls.table("bolts", "one")
    with pytest.raises(AttributeError, match="no column 'speed'"):
        _ = falls.table("steps").speed


def test_every_entry_of_the_ledger_is_of_one_kind():
    assert {about["kind"] for about in LEDGER.values()} == set(Kind)
    together = [entries_of(kind) for kind in Kind]
    assert sorted(name for names in together for name in names) == sorted(LEDGER_ENTRIES)
    values = {name: 2.0**k for k, name in enumerate(LEDGER_ENTRIES)}
    ledger = Ledger(**values)
    assert dataclasses.asdict(ledger) == values
    # powers of two: a sum says which entries are in it
    springs = ("fixed_points", "bolts", "links")
    stored = ("kinetic", "elastic", "gravity", "contact", *springs, "water_stored", "actions")
    assert ledger.stored == sum(values[name] for name in stored)
    assert ledger.brought == values["loads"] + values["water"] + values["motions"]
    lost = ("friction", "impacts", "yielding", "damping", "boundary", "seepage", "removed")
    assert ledger.lost == sum(values[name] for name in lost)


def test_what_is_turned_over_counts_all_but_what_is_unexplained():
    assert set(COUNTED) == set(LEDGER_ENTRIES) - {"unaccounted"}
