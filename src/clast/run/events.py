"""What happens in a run, as far as what acts on blocks can tell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clast.actions.acting import actions_of, own_states
from clast.actions.action import Telling
from clast.model.model import Model
from clast.model.stages.records import Event
from clast.model.state import State
from clast.step.method import Method, StepResult


@dataclass(frozen=True, kw_only=True)
class Listener:
    """Hears of actions what happens to what they act by."""

    model: Model
    method: Method
    stage: str = ""
    """Name of the stage."""

    @cached_property
    def _telling(self) -> tuple[tuple[int, Telling], ...]:
        """The actions that have something to tell, with their numbers."""
        actions = actions_of(self.model, self.method.fixed_point_stiffness, self.method.damping)
        return tuple((k, one) for k, one in enumerate(actions) if isinstance(one, Telling))

    def heard(self, before: State, after: State) -> Iterator[Event]:
        """Give what has happened in a step from one state to another."""
        if not self._telling:
            return
        actions = actions_of(self.model, self.method.fixed_point_stiffness, self.method.damping)
        own = own_states(actions, self.model, before)
        for number, action in self._telling:
            for kind, what, text in action.told(self.model, own[number], after.actions[number]):
                yield Event(time=after.time, stage=self.stage, kind=kind, what=what, text=text)


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
