"""What is made once and not in every step, and frozen things that are replaced at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from benchmarks.scenes import SCENES
from clast.actions.active import ActiveActions, actions_of
from clast.actions.damping import Rayleigh, Undamped
from clast.compute.compilation import Stages
from clast.read_only import changed


@dataclass(frozen=True, kw_only=True)
class Thing:
    one: float
    two: float = 2.0

    @cached_property
    def both(self) -> float:
        return self.one + self.two


def test_what_is_changed_is_what_replace_gives():
    thing = Thing(one=1.0)
    assert thing.both == 3.0
    other = changed(thing, one=5.0)
    assert other == replace(thing, one=5.0) and type(other) is Thing
    assert other.both == 7.0 and thing == Thing(one=1.0)


def test_actions_are_made_anew_where_model_or_damping_change():
    model, acting, damping = SCENES["stack"].build(10), ActiveActions(), Undamped()
    first = acting.actions(model, 1e9, damping)
    assert first == actions_of(model, 1e9, damping)
    stiffness = 1e9
    kept = acting.actions(model, stiffness, damping)
    assert acting.actions(model, stiffness, damping) is kept
    other = acting.actions(model, stiffness, Rayleigh(mass=1.0))
    assert Rayleigh(mass=1.0) in other and Undamped() not in other
    again = SCENES["stack"].build(10)
    assert acting.actions(again, stiffness, damping) is not kept


def test_a_stage_ends_where_the_next_begins():
    times = iter([0.0, 1.0, 3.0, 6.0, 10.0, 15.0, 21.0])
    stages = Stages(lambda: next(times))
    stages("contacts")  # 0
    stages("law")  # 1
    stages("law")  # goes on, and asks for no time
    stages("contacts")  # 3
    assert stages.ended() == {"contacts": 1.0 + 3.0, "law": 2.0}  # 6
    with stages("ledger"):  # 10
        pass  # 15
    stages("law")  # 21
    assert stages.seconds == {"contacts": 4.0, "law": 2.0, "ledger": 5.0}
