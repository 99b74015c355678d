"""An action of one's own with a state of a class of one's own: a door closer that wears out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from clast.actions.action import ActionResult, Contribution, Solution, StepStart
from clast.model.model import Floats, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class Wear:
    """What a closer remembers."""

    work: float
    ways: Floats
    words: tuple[str, ...] = ("new",)
    counts: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Closer:
    """Pushes a block to the left with a force that falls with the way that it has done."""

    block: str
    force: float

    def begin(self, model: Model) -> Wear:
        return Wear(0.0, np.zeros(2))

    def contribution(self, start: StepStart, state: Wear) -> Contribution:
        force = np.zeros((1, 6))
        force[0, 0] = -self.force * float(np.exp(-10.0 * state.ways[1]))
        return Contribution(block=np.array([start.model.block_name.index(self.block)]), force=force)

    def finish(
        self, start: StepStart, state: Wear, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        way = solution.displacement[contribution.block][0, :2]
        work = float(np.sum(contribution.force * solution.displacement[contribution.block]))
        new = Wear(
            state.work + work,
            state.ways + np.array([way[0], np.hypot(*way)]),
            ("worn", *state.words)[:3],
            {**state.counts, "steps": state.counts.get("steps", 0) + 1},
        )
        return ActionResult(work=work, ledger=Ledger(loads=work), state=new)


@dataclass(frozen=True)
class Forgetful:
    """An action whose own state no checkpoint can hold."""

    def begin(self, model: Model) -> Any:
        return iter([1.0])

    def contribution(self, start: StepStart, state: Any) -> Contribution:
        return Contribution()

    def finish(
        self, start: StepStart, state: Any, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        return ActionResult(work=0.0, ledger=Ledger(), state=state)
