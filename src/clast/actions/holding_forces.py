"""Forces that lead a static run along its path of equilibria.

Where a static stage begins, the forces on each block have a sum that is not zero: weight, stress
and loads that have just begun to act, supports that have just been taken away.  The negative of
that sum keeps every block where it is; a fraction of it lets the rest come on.  Where it is known
how movements add to the moments of forces, a step is made against the forces that are still to
come.  Both are dead: they stay with the centroids.

Forces in a block that turns by r add to the moment on it, with y the places where they act,

    sum (R y) x f - sum y x f = -r sum y.f = -r A (s_xx + s_yy)

since the stress in balance with them is A s = sum of the symmetric part of y f.  In tension, that
is the stiffness of a rope: without it links that carry are swung about as if they were slack.  In
compression it is negative, and the equations of a step would have no minimum: its effect comes
with the next step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.actions.action import (
    NO_CONTRIBUTION,
    Action,
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.model.model import Floats
from clast.model.state import Ledger


@dataclass(frozen=True, eq=False)
class HoldingForces(Action):
    """Forces on a static path, where other steps have their damping."""

    force: Floats
    """Generalised force on each block, N/m and N, shape (n, 6), or (0, 6) for none."""

    def contribution(self, start: StepStart, state: Any) -> Contribution:
        """Return the forces, and the stiffness against rotation of blocks in tension."""
        tension = start.model.area * (start.state.stress[:, 0] + start.state.stress[:, 1])
        on_all = len(self.force) == len(tension)
        block = np.flatnonzero(on_all | (tension > 0.0))
        if not len(block):
            return NO_CONTRIBUTION
        stiffness = np.zeros((len(block), 6, 6))
        stiffness[:, 2, 2] = np.maximum(0.0, tension[block])
        force = self.force if on_all else np.zeros((len(block), 6))
        return Contribution(block=block, force=force, stiffness=stiffness)

    def finish(
        self, start: StepStart, state: Any, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return their work, which is numerical: they are not forces of the system."""
        work, _ = energy_of_linear(contribution, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(), state=state)
