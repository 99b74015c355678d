"""Counts the cost of the steps of a run, from a step on that may be the first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from clast.compute.compilation import working_time
from clast.model.model import Model
from clast.model.state import State
from clast.step.method import Method, StepProcess, StepResult, Workspace


@dataclass(kw_only=True)
class Costs:
    """Sums over the steps that count."""

    steps: int = 0
    """Accepted steps."""
    simulated: float = 0.0
    """Simulated time, s."""
    wall: float = 0.0
    """Wall time, from the end of the step before, or the start, to the end of the last, s; that of
    compilation is not counted."""
    seconds: dict[str, float] = field(default_factory=dict)
    """Wall time of each stage, s."""
    counts: dict[str, float] = field(default_factory=dict)
    """Counts of the process: passes, iterations, ..."""
    penetration: float = 0.0
    """Largest penetration, m."""


class Counted:
    """A process whose accepted steps are counted from number ``settle`` on; it keeps the last."""

    def __init__(self, process: StepProcess, settle: int) -> None:
        self._process = process
        self._left = settle
        self._begun = working_time()
        self.costs = Costs()
        self.last: StepResult | None = None

    def step(
        self, model: Model, method: Method, state: State, step: float, workspace: Workspace
    ) -> StepResult:
        """Return the state ``step`` seconds later."""
        result = self._process.step(model, method, state, step, workspace)
        self.last = result
        if self._left > 0:
            self._left -= 1
            self._begun = working_time()
            return result
        costs = self.costs
        costs.steps += 1
        costs.simulated += step
        costs.wall = working_time() - self._begun
        _add(costs.seconds, result.seconds)
        _add(costs.counts, result.counts)
        costs.penetration = max(costs.penetration, result.penetration)
        return result

    def advice(self, model: Model, method: Method, state: State, step: float) -> tuple[str, ...]:
        """Return the advice of the process itself."""
        return self._process.advice(model, method, state, step)

    def stiffness(self, model: Model, step: float) -> tuple[float, str]:
        """Return the stiffness of the process itself."""
        return self._process.stiffness(model, step)


def _add(sums: dict[str, float], more: Mapping[str, float]) -> None:
    for name, value in more.items():
        sums[name] = sums.get(name, 0.0) + value
