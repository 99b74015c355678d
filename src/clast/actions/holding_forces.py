"""Forces that hold blocks back while weight, stress and loads come on by increments.

Where a static stage begins, the forces on each block have a sum that is not nothing: weight, stress
and loads that have just begun to act, supports that have just been taken away.  The negative of
that sum keeps every block where it is; a share of it lets the rest come on.  The forces are dead:
they stay with the centroids and turn with nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.actions.action import ActionResult, Contribution, Solution, StepStart, energy_of_linear
from clast.model.model import Floats, Model
from clast.model.state import Ledger


@dataclass(frozen=True, eq=False)
class HoldingForces:
    """Forces against the loads that have not come on yet, where other steps have their damping."""

    force: Floats
    """Generalised force on each block, N/m and N, shape (n, 6)."""

    def begin(self, model: Model) -> None:
        """Return nothing: it has no state of its own."""

    def share(self, start: StepStart, state: Any) -> Contribution:
        """Return the forces."""
        return Contribution(block=np.arange(len(self.force)), force=self.force)

    def finish(
        self, start: StepStart, state: Any, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return their work, which is numerical: they are not forces of the system."""
        work, _ = energy_of_linear(share, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(), state=state)
