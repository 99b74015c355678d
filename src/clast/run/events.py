"""Events of a run: those that actions report, and bonds that break."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clast.actions.action import ReportsEvents
from clast.actions.active import actions_of, states_of
from clast.model.model import Model
from clast.model.stage_records import Event
from clast.model.state import State
from clast.step.method import Method, StepResult


@dataclass(frozen=True, kw_only=True)
class Listener:
    """Collects the events that actions report."""

    model: Model
    method: Method
    stage: str = ""
    """Name of the stage."""

    @cached_property
    def _actions(self) -> Sequence[Any]:
        return actions_of(self.model, self.method.fixed_point_stiffness, self.method.damping)

    @cached_property
    def _reporting(self) -> tuple[int, ...]:
        """Numbers of the actions that report events."""
        return tuple(k for k, one in enumerate(self._actions) if isinstance(one, ReportsEvents))

    def heard(self, before: State, after: State) -> Iterator[Event]:
        """Yield the events of a step from one state to another."""
        if not self._reporting:
            return
        states = states_of(self._actions, self.model, before)
        for number in self._reporting:
            action = self._actions[number]
            for kind, what, text in action.events(
                self.model, states[number], after.actions[number]
            ):
                yield Event(time=after.time, stage=self.stage, kind=kind, what=what, text=text)


def joints_wear(model: Model, stage: str, result: StepResult) -> Iterator[Event]:
    """Yield the joints that have come down to residual strength in a step, and where first."""
    contacts, names = result.contacts, model.block_name
    _, first = np.unique(contacts.joint[result.worn], return_index=True)
    for row in result.worn[np.sort(first)].tolist():
        joint = model.joint_table.joints[contacts.joint[row]].name
        own, other = names[contacts.vertex_block[row]], names[contacts.edge_block[row]]
        x, y = contacts.foot[row] + model.origin
        yield Event(
            time=result.state.time,
            stage=stage,
            kind="joint at residual",
            what=joint,
            text=f"sliding has brought joint '{joint}' down to its residual strength, first "
            f"between '{own}' and '{other}' at ({x:.5g}, {y:.5g})",
        )


def bonds_break(model: Model, stage: str, result: StepResult, load: float) -> Event:
    """Return how many bonds have broken in a step of a static stage, of which joints, and where.

    ``load`` is the share of weight, stress and loads that acted.
    """
    rows, contacts = result.broken, result.contacts
    joints = [model.joint_table.joints[one].name for one in np.unique(contacts.joint[rows])]
    first = int(rows[0])
    names = model.block_name
    own, other = names[contacts.vertex_block[first]], names[contacts.edge_block[first]]
    x, y = result.state.vertices[contacts.vertex[first]] + model.origin
    count = f"{len(rows)} bonds break" if len(rows) > 1 else "a bond breaks"
    return Event(
        time=result.state.time,
        stage=stage,
        kind="bonds break",
        what=joints[0],
        text=f"{count} under {100.0 * load:.4g} % of the load, of joint "
        f"{', '.join(map(repr, joints))}, first of '{own}' with '{other}' at ({x:.5g}, {y:.5g})",
    )
