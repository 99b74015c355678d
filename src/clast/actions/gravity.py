"""Accelerations of every mass: gravity, and the ground's motion as a body force.

As a motion of the supports the ground's motion is in supports.py.
"""

from __future__ import annotations

from dataclasses import dataclass

from clast.actions.action import Action, ActionResult, Contribution, Solution, StepStart
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
class Gravity(Action):
    """Weight: m g at the centroid of each block."""

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return the acceleration of gravity at the end of the step."""
        return Contribution(acceleration=gravity_at(start.model, start.time_of_forces))

    def finish(
        self, start: StepStart, state: None, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of weight, which the potential energy of gravity has lost.

        Weight that changes with time has no potential: its work is that of a load.
        """
        model, moved = start.model, solution.displacement
        if model.gravity_factor != NO_FACTOR:
            work = work_on_masses(model, gravity_at(model, start.time_of_forces), moved)
            return ActionResult(work=work, ledger=Ledger(loads=work))
        work = work_on_masses(model, model.gravity, moved)
        return ActionResult(work=work, ledger=Ledger(gravity=-work))


@dataclass(frozen=True)
class GroundAcceleration(Action):
    """The body force -rho a of the model's ground motion, where that acts by one."""

    def contribution(self, start: StepStart, state: None) -> Contribution:
        """Return minus the mean acceleration of the ground in the step."""
        return Contribution(acceleration=start.model.ground_motion.body_acceleration(*start.span))

    def finish(
        self, start: StepStart, state: None, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        """Return the work of the body force, which comes from outside."""
        acceleration = start.model.ground_motion.body_acceleration(*start.span)
        work = work_on_masses(start.model, acceleration, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(loads=work))
