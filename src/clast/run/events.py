"""Events of a run: those that actions report, and bonds that break."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clast.actions.action import ReportsEvents
from clast.actions.active import actions_of, states_of
from clast.model.model import Floats, Model
from clast.model.stage_records import Event
from clast.model.state import State
from clast.step.method import Method, StepResult


@dataclass(frozen=True, kw_only=True)
class Listener:
    """Collects the events of the steps of a run, or of one of its stages."""

    model: Model
    method: Method
    stage: str = ""

    @cached_property
    def _actions(self) -> Sequence[Any]:
        return actions_of(self.model, self.method.fixed_point_stiffness, self.method.damping)

    @cached_property
    def _reporting(self) -> tuple[int, ...]:
        """Numbers of the actions that report events."""
        return tuple(k for k, one in enumerate(self._actions) if isinstance(one, ReportsEvents))

    def events(self, before: State, result: StepResult) -> Iterator[Event]:
        """Yield the events of a step that actions report, and joints worn to the residual in it."""
        after = result.state
        states = states_of(self._actions, self.model, before) if self._reporting else ()
        for number in self._reporting:
            of_action = self._actions[number].events(
                self.model, states[number], after.actions[number]
            )
            for kind, what, text in of_action:
                yield Event(time=after.time, stage=self.stage, kind=kind, what=what, text=text)
        if not len(result.worn):
            return
        contacts = result.contacts
        _, first = np.unique(contacts.joint[result.worn], return_index=True)
        for row in result.worn[np.sort(first)].tolist():
            joint = self.model.joint_table.joints[contacts.joint[row]].name
            text = (
                f"sliding has brought joint '{joint}' down to its residual strength, first "
                f"between {_place(self.model, result, row, ' and ', contacts.foot[row])}"
            )
            kind = "joint at residual"
            yield Event(time=after.time, stage=self.stage, kind=kind, what=joint, text=text)


def _place(model: Model, result: StepResult, row: int, joined: str, at: Floats) -> str:
    """Return the blocks of a contact and its place in words."""
    own, other = (
        model.block_name[blocks[row]]
        for blocks in (result.contacts.vertex_block, result.contacts.edge_block)
    )
    x, y = at + model.origin
    return f"'{own}'{joined}'{other}' at ({x:.5g}, {y:.5g})"


def bonds_break(model: Model, stage: str, result: StepResult, load: float) -> Event:
    """Return how many bonds have broken in a step of a static stage, of which joints, and where.

    ``load`` is the fraction of weight, stress and loads that acted.
    """
    rows, contacts = result.broken, result.contacts
    joints = [model.joint_table.joints[one].name for one in np.unique(contacts.joint[rows])]
    first = int(rows[0])
    place = _place(model, result, first, " with ", result.state.vertices[contacts.vertex[first]])
    count = f"{len(rows)} bonds break" if len(rows) > 1 else "a bond breaks"
    return Event(
        time=result.state.time,
        stage=stage,
        kind="bonds break",
        what=joints[0],
        text=f"{count} under {100.0 * load:.4g} % of the load, of joint "
        f"{', '.join(map(repr, joints))}, first of {place}",
    )
