"""A heading in jointed rock with all that stages may have, in every process: it stays closed."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.model.state import LEDGER_ENTRIES, Ledger
from clast.run.run_state import RunState
from clast.run.simulate import simulate
from scenes.staged_heading import STAGES, prepared


def turned_over(run: clast.Run) -> float:
    """Return the largest change of an entry of the ledger, J/m."""
    entries = [name for name in LEDGER_ENTRIES if name != "unaccounted"]
    return max(float(np.ptp(run.energy[name])) for name in entries)


@pytest.mark.parametrize(
    ("process", "law"),
    [
        ("convex", "penalty"),
        ("convex", "augmented-lagrangian"),
        ("open-close", "penalty"),
        ("modified", "penalty"),
        pytest.param("open-close", "augmented-lagrangian", marks=pytest.mark.slow),
        pytest.param("modified", "augmented-lagrangian", marks=pytest.mark.slow),
    ],
)
@pytest.mark.one_in(3)
def test_all_that_stages_have_at_once(process: str, law: str):
    model, method, schedule = prepared(process, law)
    carried: list[RunState] = []
    run = simulate(model, method, schedule, keep=carried.append)
    assert [stage.name for stage in run.stages] == [stage.name for stage in STAGES]
    assert abs(run.energy["unaccounted"]).max() < 1e-6 * turned_over(run)
    assert carried[-1].state.ledger != Ledger()
    for entry in ("removed", "water", "bolts", "damping", "loads"):
        assert getattr(carried[-1].state.ledger, entry) != 0.0, entry
    assert run.bolts(-1).force.max() > 5e3
    ends = [k for k in range(len(carried) - 1) if carried[k].position.over]
    for at in (ends[1] - 5, ends[3] + 7):
        last: list[RunState] = []
        simulate(model, method, schedule, begin=carried[at], keep=last.append)
        assert np.array_equal(last[-1].state.vertices, carried[-1].state.vertices)
        assert np.array_equal(last[-1].state.velocity, carried[-1].state.velocity)
        assert last[-1].state.ledger == carried[-1].state.ledger
