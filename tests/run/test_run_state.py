"""A run that goes on from what it carried at any of its steps ends with the same bits."""

import numpy as np
import pytest

from clast.model.model import Model
from clast.results import Run
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method
from scenes.restarts import same
from scenes.shaken import LAWS, PROCESSES, shaken_case


def prepared(process: str, law: str) -> tuple[Model, Method, Schedule]:
    """Return the model, the method and the schedule of the test."""
    case = shaken_case(process, law)
    model = case.model()
    return model, case.method(model), case.schedule()


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.one_in(3)
def test_a_run_goes_on_from_any_of_its_steps(process: str, law: str):
    model, method, schedule = prepared(process, law)
    carried: list[RunState] = []
    whole = simulate(model, method, schedule, keep=carried.append)
    assert whole.report.cut_steps < len(carried)
    chosen = np.linspace(0, len(carried) - 2, 10).astype(int)
    for at in chosen:
        ends: list[RunState] = []
        rest = simulate(model, method, schedule, begin=carried[at], keep=ends.append)
        assert same(ends[-1], carried[-1])
        assert same(rest.final, whole.final)
        assert_same_tail(whole, rest)


def assert_same_tail(whole: Run, rest: Run) -> None:
    """Compare tables, frames and the report of a run with those of one that began later."""
    for table in ("energy", "steps"):
        for name, column in getattr(rest, table).items():
            later = getattr(whole, table)[name][-len(column) :]
            np.testing.assert_array_equal(column, later, err_msg=name)
    for entry in ("steps", "passes", "cut_steps", "largest_penetration", "ledger", "counts"):
        assert getattr(rest.report, entry) == getattr(whole.report, entry), entry
    assert rest.report.warnings == whole.report.warnings
    assert list(rest.times[1:]) == list(whole.times[-len(rest.times) + 1 :])
