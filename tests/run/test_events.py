"""What actions tell of themselves is among the events of a run."""

from collections.abc import Iterable
from dataclasses import dataclass

import clast
from clast import Stage
from clast.actions.action import ActionResult, Contribution, Solution, StepStart
from clast.model.model import Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Clock:
    """An action that does nothing, and tells when a time is over."""

    alarm: float

    def begin(self, model: Model) -> float:
        """Return the time."""
        return 0.0

    def contribution(self, start: StepStart, state: float) -> Contribution:
        """Return nothing."""
        return Contribution()

    def finish(
        self, start: StepStart, state: float, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the time at the end of the step."""
        return ActionResult(work=0.0, ledger=Ledger(), state=start.end)

    def events(self, model: Model, before: float, after: float) -> Iterable[tuple[str, str, str]]:
        """Tell that the time is over, once."""
        if before < self.alarm <= after:
            yield "rung", "clock", "the clock rings"


def falling(alarm: float) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(actions=[Clock(alarm)])
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    return builder


def test_a_run_has_what_an_action_tells():
    run = clast.simulate(falling(0.0035).build(), step=1e-3, end=0.01)
    (event,) = run.events
    assert (event.kind, event.what, event.stage) == ("rung", "clock", "")
    assert event.time == run.steps["time"][3]


def test_it_is_told_in_the_first_step_and_with_its_stage():
    stages = [Stage(name=name, until="time", time=0.005) for name in ("one", "two")]
    run = clast.simulate(falling(0.0005).build(), step=1e-3, stages=stages)
    (event,) = (one for one in run.events if one.kind == "rung")
    assert event.stage == "one" and event.time == run.steps["time"][0]
    run = clast.simulate(falling(0.0075).build(), step=1e-3, stages=stages)
    (event,) = (one for one in run.events if one.kind == "rung")
    assert event.stage == "two"
