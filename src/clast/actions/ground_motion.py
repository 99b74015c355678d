"""The ground's motion as a body force; as a motion of the supports it is in supports.py."""

from __future__ import annotations

from dataclasses import dataclass

from clast.actions.action import ActionResult, Contribution, Solution, StepStart
from clast.actions.gravity import work_on_masses
from clast.model.model import Floats, Model
from clast.model.state import Ledger


@dataclass(frozen=True)
class GroundAcceleration:
    """The body force -rho a of the model's ground motion, where that acts by one."""

    def begin(self, model: Model) -> None:
        """Return None: the motion of the ground is known beforehand."""

    def share(self, start: StepStart, state: None) -> Contribution:
        """Return minus the mean acceleration of the ground in the step."""
        return Contribution(acceleration=self._acceleration(start))

    def finish(
        self, start: StepStart, state: None, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the body force, which comes from outside."""
        work = work_on_masses(start.model, self._acceleration(start), solution.displacement)
        return ActionResult(work=work, ledger=Ledger(loads=work))

    def _acceleration(self, start: StepStart) -> Floats:
        return start.model.ground_motion.body_acceleration(*start.span)
