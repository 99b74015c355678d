"""All that acts on the blocks of a model, and what it adds to the equations of a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from clast.actions.action import Action, Share, StepStart
from clast.actions.gravity import Gravity
from clast.actions.ground_motion import GroundAcceleration
from clast.actions.in_situ import Outline
from clast.actions.loads import Loads
from clast.actions.pressure import Pressures
from clast.actions.supports import Supports
from clast.actions.viscous_edges import ViscousBoundary
from clast.model.ground_motion import Still
from clast.model.model import Floats, Model
from clast.model.state import State


def actions_of(model: Model, fixed_point_stiffness: float, damping: Action) -> tuple[Action, ...]:
    """Return what acts on the blocks: gravity first, then what the model has, then the user's own.

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
    if model.in_situ is not None:
        found.append(Outline(model.in_situ, fixed_point_stiffness))
    if len(model.fixed_points.block):
        found.append(Supports(fixed_point_stiffness))
    if len(model.viscous_edges):
        found.append(ViscousBoundary(fixed_point_stiffness))
    return *found, *model.actions


def own_states(actions: Sequence[Action], model: Model, state: State) -> tuple[Any, ...]:
    """Return the own state of each action: what a run carries, or that of its start."""
    if len(state.actions) == len(actions):
        return state.actions
    return tuple(action.begin(model) for action in actions)


def shares_of(actions: Sequence[Action], start: StepStart, own: Sequence[Any]) -> tuple[Share, ...]:
    """Return what each action adds to the equations of a step."""
    return tuple(action.share(start, mine) for action, mine in zip(actions, own, strict=True))


def acceleration_of(shares: Sequence[Share]) -> Floats:
    """Return the acceleration of every mass by all actions together, m/s2, shape (2,)."""
    found: Floats = np.zeros(2)
    for share in shares:
        if share.acceleration is not None:
            found = found + share.acceleration
    return found


def add_shares(shares: Sequence[Share], matrix: Floats, force: Floats) -> None:
    """Add the forces and stiffnesses of actions to blocks of K (n, 6, 6) and F (n, 6), in place."""
    for share in shares:
        if len(share.block):
            np.add.at(force, share.block, share.force)
            if share.stiffness is not None:
                np.add.at(matrix, share.block, share.stiffness)
