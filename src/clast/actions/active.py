"""All actions on the blocks of a model, and their contributions to the equations of a step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from operator import is_not
from typing import Any, TypeVar

import numpy as np

from clast.actions.action import Action, ActionResult, Contribution, Solution, StepStart
from clast.actions.bolts import Bolting
from clast.actions.in_situ import InSituBoundary
from clast.actions.loads import Gravity, GroundAcceleration, Loads, Pressures
from clast.actions.relaxation import Relaxation
from clast.actions.supports import Supports
from clast.actions.viscous_edges import BoundaryDashpots
from clast.actions.water import WaterPressure
from clast.contact.clipped_spring import Clipped, Springs
from clast.errors import ActionFault
from clast.model.flow.given import FULL, Flow
from clast.model.ground_motion import Still
from clast.model.model import Floats, Model
from clast.model.state import Ledger, State

Answer = TypeVar("Answer")
HELP = "see the how-to page on actions"


def answer(action: Action, method: Callable[..., Answer], *given: Any) -> Answer:
    """Return the answer of an action's method; raises ActionFault if it edits its arguments."""
    try:
        return method(*given)
    except ValueError as error:
        if "read-only" not in str(error):
            raise
        raise ActionFault(
            f"{method.__name__}() writes into an array that is read-only: state and model are "
            "replaced from step to step, never edited",
            where=_name(action),
            remedy="change a copy (array.copy()), and act on blocks by the forces, stiffnesses and "
            "springs of a Contribution",
        ) from error


def _name(action: Action) -> str:
    return f"action {type(action).__name__}"


def _is_number(value: Any) -> bool:
    return isinstance(value, float | int | np.floating | np.integer) and bool(np.isfinite(value))


def _faults_of(contribution: Any, blocks: int) -> Iterator[str]:
    """Yield the faults of a contribution for so many blocks."""
    if not isinstance(contribution, Contribution):
        yield f"a {type(contribution).__name__}, not a Contribution"
        return
    count = np.shape(contribution.block)[0] if np.ndim(contribution.block) == 1 else -1
    yield from _of_blocks("block", contribution.block, blocks)
    yield from _of_numbers("force", contribution.force, (count, 6))
    if contribution.stiffness is not None:
        yield from _of_numbers("stiffness", contribution.stiffness, (count, 6, 6))
    if contribution.acceleration is not None:
        yield from _of_numbers("acceleration", contribution.acceleration, (2,))
    if not _is_number(contribution.carried) or not 0.0 <= contribution.carried <= 1.0:
        yield f"carried = {contribution.carried!r:.40}, which is not a valid share from 0 to 1"
    if contribution.springs is not None:
        yield from _of_springs(contribution.springs, blocks)


def _of_blocks(name: str, number: Any, blocks: int) -> Iterator[str]:
    """Yield the faults of an array of block numbers (k,)."""
    if not isinstance(number, np.ndarray) or number.ndim != 1:
        yield f"{name} as a {type(number).__name__} of shape {np.shape(number)}, not an array (k,)"
    elif number.dtype != np.int64:
        yield f"{name} as numbers of type {number.dtype}, not whole numbers (numpy.int64)"
    elif len(number) and (number.min() < 0 or number.max() >= blocks):
        wrong = int(number[(number < 0) | (number >= blocks)][0])
        yield f"{name} {wrong}, and there are only the blocks 0 to {blocks - 1}"


def _of_numbers(
    name: str, values: Any, shape: tuple[int, ...], limit: float = 0.0
) -> Iterator[str]:
    """Yield the faults of an array of numbers, which ``limit`` infinity lets be infinite."""
    if not isinstance(values, np.ndarray) or values.dtype != np.float64:
        kind = values.dtype if isinstance(values, np.ndarray) else type(values).__name__
        yield f"{name} as {kind}, not an array of numbers (numpy.float64)"
    elif values.shape != shape:
        yield f"{name} of shape {values.shape}, not {shape}"
    elif np.isnan(values).any() or (limit == 0.0 and not np.isfinite(values).all()):
        yield f"{name} with a value that is not a finite number"


def _of_springs(springs: Any, blocks: int) -> Iterator[str]:
    """Yield the faults of springs between blocks."""
    if not isinstance(springs, Springs):
        yield f"springs as a {type(springs).__name__}, not as clipped_spring.table makes them"
        return
    count = len(springs.gap)
    for name in ("vertex_block", "edge_block"):
        yield from _of_blocks(f"springs with {name}", getattr(springs, name), blocks)
    yield from _of_blocks("springs with pair", springs.pair, len(springs.pairs))
    yield from _of_blocks("springs with pairs", np.ravel(springs.pairs), blocks)
    if any(len(one) != count for one in (springs.vertex_block, springs.edge_block, springs.pair)):
        yield "springs whose blocks are not as many as their gaps"
    for name, shape in {"arms": (count, 6), "gap": (count,), "slip": (count,)}.items():
        yield from _of_numbers(f"springs with {name}", getattr(springs, name), shape)
    for name in ("normal", "shear"):
        clipped: Clipped = getattr(springs, name)
        for part, limit in PARTS.items():
            values = getattr(clipped, part)
            yield from _of_numbers(f"springs with {name}.{part}", values, (count,), limit)


PARTS = {"at_zero": 0.0, "stiffness": 0.0, "low": np.inf, "high": np.inf}
"""Numbers of clipped springs, and whether they may be infinite."""


def actions_of(model: Model, fixed_point_stiffness: float, damping: Action) -> tuple[Action, ...]:
    """Return all actions: gravity first, then those of the model, then the user's own.

    ``fixed_point_stiffness`` is that of the supports, N/m per m.  Some ``damping`` there is always,
    were it none: stages may change it, and own states belong to actions by their places.
    """
    actions: list[Action] = [Gravity(), damping]
    if not isinstance(model.ground_motion, Still):
        actions.append(GroundAcceleration())
    if len(model.point_loads.block) or len(model.line_loads.block):
        actions.append(Loads())
    if len(model.pressures.block):
        actions.append(Pressures())
    if len(model.bolts):
        actions.append(Bolting())
    if model.water:
        actions.append(WaterPressure())
    if model.flow is not None:
        actions.append(_flow(model.flow))
    if model.in_situ is not None:
        actions.append(InSituBoundary(model.in_situ, fixed_point_stiffness))
    if len(model.fixed_points.block):
        actions.append(Supports(fixed_point_stiffness))
    if len(model.viscous_edges):
        actions.append(BoundaryDashpots(fixed_point_stiffness))
    if model.openings or model.drawpoints or model.absent.any() or model.lined.any():
        actions.append(Relaxation())
    return *actions, *model.actions


def _flow(flow: Flow) -> Action:
    """Return the action of water that flows in joints; few cases need it."""
    if flow.coupling == FULL:
        from clast.actions.coupled_flow import CoupledFlow

        return CoupledFlow(flow.passes)
    from clast.actions.flow import JointFlow

    return JointFlow()


class ActiveActions:
    """The actions on the blocks of a model, kept for as long as model and method stay the same."""

    def __init__(self) -> None:
        self._asked: tuple[Any, ...] = ()
        self._actions: tuple[Action, ...] = ()

    def actions(self, *asked: Any) -> tuple[Action, ...]:
        """Return the actions that ``actions_of`` finds for the same arguments."""
        if len(asked) != len(self._asked) or any(map(is_not, asked, self._asked)):
            self._asked, self._actions = asked, actions_of(*asked)
        return self._actions


def states_of(actions: Sequence[Action], model: Model, state: State) -> tuple[Any, ...]:
    """Return the own state of each action: the one that a run carries, or that of its start."""
    if len(state.actions) == len(actions):
        return state.actions
    return tuple(answer(action, action.begin, model) for action in actions)


def contributions_of(
    actions: Sequence[Action], start: StepStart, states: Sequence[Any]
) -> tuple[Contribution, ...]:
    """Return the contribution of each action to the equations of a step."""
    contributions = []
    for action, mine in zip(actions, states, strict=True):
        if action.__class__.__module__.startswith("clast."):
            contributions.append(action.contribution(start, mine))
        else:  # of a script
            one = answer(action, action.contribution, start, mine)
            # A contribution that kernels can count on; raises ActionFault naming the action.
            for fault in _faults_of(one, start.model.block_count):
                raise ActionFault(f"contribution() gives {fault}", where=_name(action), remedy=HELP)
            checked: Contribution = one
            contributions.append(checked)
    return tuple(contributions)


def result_of(
    action: Action, start: StepStart, state: Any, contribution: Contribution, solution: Solution
) -> ActionResult:
    """Return the result of an action in a step, checked for an action of a script."""
    if action.__class__.__module__.startswith("clast."):
        return action.finish(start, state, contribution, solution)
    # The result of an action; raises ActionFault where it is not an ActionResult.
    done = answer(action, action.finish, start, state, contribution, solution)
    if not isinstance(done, ActionResult):
        fault = f"a {type(done).__name__}, not an ActionResult"
    elif not _is_number(done.work):
        fault = f"work = {done.work!r:.40}, which is not a finite number"
    elif not isinstance(done.ledger, Ledger):
        fault = f"a {type(done.ledger).__name__} as its ledger, not a Ledger"
    elif not all(map(_is_number, vars(done.ledger).values())):
        fault = "a ledger with an entry that is not a finite number"
    else:
        return done
    raise ActionFault(f"finish() gives {fault}", where=_name(action), remedy=HELP)


def acceleration_of(contributions: Sequence[Contribution]) -> Floats:
    """Return the acceleration of every mass by all actions together, m/s2, shape (2,)."""
    total: Floats = np.zeros(2)
    for contribution in contributions:
        if contribution.acceleration is not None:
            total = total + contribution.acceleration
    return total


def add_contributions(contributions: Sequence[Contribution], matrix: Floats, force: Floats) -> None:
    """Add the forces and stiffnesses of actions to blocks of K (n, 6, 6) and F (n, 6), in place."""
    for contribution in contributions:
        if len(contribution.block):
            np.add.at(force, contribution.block, contribution.force)
            if contribution.stiffness is not None:
                np.add.at(matrix, contribution.block, contribution.stiffness)
