"""What happens in a run, as far as what acts on blocks can tell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from clast.actions.acting import actions_of, own_states
from clast.actions.action import Telling
from clast.model.model import Model
from clast.model.stages.records import Event
from clast.model.state import State
from clast.step.method import Method


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
