"""All actions on the blocks of a model, and their contributions to the equations of a step."""

from __future__ import annotations

from collections.abc import Sequence
from operator import is_not
from typing import Any

import numpy as np

from clast.actions.action import Action, ActionResult, Contribution, Solution, StepStart
from clast.actions.bolts import Bolting
from clast.actions.gravity import Gravity, GroundAcceleration
from clast.actions.in_situ import InSituBoundary
from clast.actions.loads import Loads, Pressures
from clast.actions.relaxation import Relaxation
from clast.actions.script_action_checks import (
    HEAD,
    OWN,
    answer,
    checked_contribution,
    checked_result,
)
from clast.actions.supports import Supports
from clast.actions.viscous_edges import BoundaryDashpots
from clast.actions.water import WaterPressure
from clast.model.ground_motion import Still
from clast.model.model import Floats, Model
from clast.model.state import State


def actions_of(model: Model, fixed_point_stiffness: float, damping: Action) -> tuple[Action, ...]:
    """Return all actions: gravity first, then those of the model, then the user's own.

    ``fixed_point_stiffness`` is that of the supports, N/m per m.  Some ``damping`` there is always,
    were it none: stages may change it, and own states belong to actions by their places.
    """
    found: list[Action] = [Gravity(), damping]
    if not isinstance(model.ground_motion, Still):
        found.append(GroundAcceleration())
    if len(model.point_loads.block) or len(model.line_loads.block):
        found.append(Loads())
    if len(model.pressures.block):
        found.append(Pressures())
    if len(model.bolts):
        found.append(Bolting())
    if model.water:
        found.append(WaterPressure())
    if model.in_situ is not None:
        found.append(InSituBoundary(model.in_situ, fixed_point_stiffness))
    if len(model.fixed_points.block):
        found.append(Supports(fixed_point_stiffness))
    if len(model.viscous_edges):
        found.append(BoundaryDashpots(fixed_point_stiffness))
    if model.openings or model.absent.any() or model.lined.any():
        found.append(Relaxation())
    return *found, *model.actions


class ActiveActions:
    """The actions on the blocks of a model, kept for as long as model and method stay the same."""

    def __init__(self) -> None:
        self._asked: tuple[Any, ...] = ()
        self._found: tuple[Action, ...] = ()

    def actions(self, *asked: Any) -> tuple[Action, ...]:
        """Return the actions that ``actions_of`` finds for the same arguments."""
        if len(asked) != len(self._asked) or any(map(is_not, asked, self._asked)):
            self._asked, self._found = asked, actions_of(*asked)
        return self._found


def states_of(actions: Sequence[Action], model: Model, state: State) -> tuple[Any, ...]:
    """Return the own state of each action: the one that a run carries, or that of its start."""
    if len(state.actions) == len(actions):
        return state.actions
    return tuple(answer(action, action.begin, model) for action in actions)


def contributions_of(
    actions: Sequence[Action], start: StepStart, states: Sequence[Any]
) -> tuple[Contribution, ...]:
    """Return the contribution of each action to the equations of a step."""
    return tuple(
        [
            _contribution_of(action, start, mine)
            for action, mine in zip(actions, states, strict=True)
        ]
    )


def _contribution_of(action: Action, start: StepStart, state: Any) -> Contribution:
    """Return the contribution of an action to a step, checked for an action of a script."""
    if action.__class__.__module__[HEAD] == OWN:
        return action.contribution(start, state)
    return checked_contribution(action, answer(action, action.contribution, start, state), start)


def result_of(
    action: Action, start: StepStart, state: Any, contribution: Contribution, solution: Solution
) -> ActionResult:
    """Return the result of an action in a step, checked for an action of a script."""
    if action.__class__.__module__[HEAD] == OWN:
        return action.finish(start, state, contribution, solution)
    return checked_result(
        action, answer(action, action.finish, start, state, contribution, solution)
    )


def acceleration_of(contributions: Sequence[Contribution]) -> Floats:
    """Return the acceleration of every mass by all actions together, m/s2, shape (2,)."""
    found: Floats = np.zeros(2)
    for contribution in contributions:
        if contribution.acceleration is not None:
            found = found + contribution.acceleration
    return found


def add_contributions(contributions: Sequence[Contribution], matrix: Floats, force: Floats) -> None:
    """Add the forces and stiffnesses of actions to blocks of K (n, 6, 6) and F (n, 6), in place."""
    for contribution in contributions:
        if len(contribution.block):
            np.add.at(force, contribution.block, contribution.force)
            if contribution.stiffness is not None:
                np.add.at(matrix, contribution.block, contribution.stiffness)
