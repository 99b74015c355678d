"""Gravity: rho g on every block, at its centroid."""

from __future__ import annotations

from dataclasses import dataclass

from clast.actions.action import ActionResult, Contribution, Solution, StepStart
from clast.model.factors import NO_FACTOR
from clast.model.model import Floats, Model
from clast.model.state import Ledger


def work_on_masses(model: Model, acceleration: Floats, displacement: Floats) -> float:
    """Return the work, J/m, of an acceleration (2,), m/s2, of every mass over d (n, 6).

    Strain and rotation move no centroid, so that m a.(u0, v0) is all of it.
    """
    return float(acceleration @ (model.mass @ displacement[:, :2]))


def gravity_at(model: Model, time: float) -> Floats:
    """Return the acceleration of gravity at a time, s, in m/s2, shape (2,)."""
    if model.gravity_factor == NO_FACTOR:
        return model.gravity
    return model.factors[model.gravity_factor].at(time) * model.gravity


@dataclass(frozen=True)
class Gravity:
    """Weight: m g at the centroid of each block."""

    def begin(self, model: Model) -> None:
        """Return nothing: weight has no state."""

    def share(self, start: StepStart, state: None) -> Contribution:
        """Return the acceleration of gravity at the end of the step."""
        return Contribution(acceleration=gravity_at(start.model, start.time_of_forces))

    def finish(
        self, start: StepStart, state: None, share: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of weight, which the potential energy of gravity has lost.

        Weight that changes with time has no potential: its work is that of a load.
        """
        if start.model.gravity_factor != NO_FACTOR:
            acting = gravity_at(start.model, start.time_of_forces)
            work = work_on_masses(start.model, acting, solution.displacement)
            return ActionResult(work=work, ledger=Ledger(loads=work))
        work = work_on_masses(start.model, start.model.gravity, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(gravity=-work))
