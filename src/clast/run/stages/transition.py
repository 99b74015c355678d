"""Changes in a run at the start of a stage.

Model, method and schedule are replaced, never the shapes of arrays, so that the data of a run fit
all of its stages.  The same changes, but for those of the state, are made again where a run goes on
from a checkpoint.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from clast.model.ground_motion import GroundMotion, InStages, Still
from clast.model.model import Ints, Model
from clast.model.stage_records import Event
from clast.model.stages import EQUILIBRIUM, LOCK, Stage, with_loads, with_strengths
from clast.model.state import State
from clast.model.surroundings import blocks_called
from clast.run.excavation import as_in, excavated
from clast.run.schedule import Schedule
from clast.run.stages.spraying import lined
from clast.step.method import Method

WELL_BELOW = 0.1
"""Unbalanced force to which a step is solved, in units of the limit of equilibrium."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Model, method and schedule of a stage."""

    model: Model
    method: Method
    schedule: Schedule


def before_all(base: Setting) -> Setting:
    """Return the setting before the first stage: loads that stages name do not act yet."""
    stages = base.schedule.stages
    model = with_loads(base.model, base.model, stages, ())
    motion = _motion(base.model.ground_motion, stages, ())
    named = [name for stage in stages for name in stage.install]
    return replace(
        base, model=replace(model, ground_motion=motion, bolts=model.bolts.without(named))
    )


def entered(
    base: Setting, current: Setting, state: State, starts: Sequence[float]
) -> tuple[Setting, State]:
    """Return setting and state of the stage that begins last at ``starts``, s.

    ``current`` is the setting before, ``base`` that without stages.
    """
    stage = base.schedule.stages[len(starts) - 1]
    setting = changed(base, current, starts)
    if stage.excavate:
        model, state = excavated(
            setting.model,
            setting.method,
            state,
            excavated_by(setting.model, stage),
            stage.relax,
            stage.relax_time,
        )
        setting = replace(setting, model=model)
    model, state = lined(setting.model, setting.method, state, stage, setting.schedule.step)
    setting = replace(setting, model=model)
    if current.method.dynamic_ratio == 0.0 < setting.method.dynamic_ratio:
        state = at_rest(state)
    return setting, state


def entered_again(base: Setting, state: State, starts: Sequence[float]) -> Setting:
    """Return the setting of a run that goes on in the stage that began last at ``starts``, s."""
    setting = before_all(base)
    for begun in range(1, len(starts) + 1):
        setting = changed(base, setting, starts[:begun])
    return replace(setting, model=as_in(setting.model, state))


def changed(base: Setting, current: Setting, starts: Sequence[float]) -> Setting:
    """Return the setting with the changes of a stage beside excavation."""
    stages = base.schedule.stages
    stage = stages[len(starts) - 1]
    model = with_loads(current.model, base.model, stages, starts)
    model = replace(
        model,
        joint_table=with_strengths(model.joint_table, stage.joints),
        ground_motion=_motion(base.model.ground_motion, stages, starts),
        viscous_edges=model.viscous_edges.at_stage(stage.name, starts[-1]),
        begun=tuple((one.name, at) for one, at in zip(stages, starts, strict=False)),
    )
    locks = len(starts) > 1 and stage.jacks == LOCK
    bolts = model.bolts.locked_by_now() if locks else model.bolts
    return Setting(
        model=replace(model, bolts=bolts.at_stage(stage.name, stage.install)),
        method=_method(base.method, stage),
        schedule=_schedule(base.schedule, stage, starts[-1]),
    )


def at_rest(state: State) -> State:
    """Return a state without velocities: a static run has thrown them away at every step."""
    ledger = state.ledger
    stopped = replace(ledger, kinetic=0.0, removed=ledger.removed + ledger.kinetic)
    return replace(state, velocity=np.zeros_like(state.velocity), ledger=stopped)


def excavated_by(model: Model, stage: Stage) -> Ints:
    """Return the blocks that a stage excavates, shape (k,)."""
    return blocks_called(stage.excavate, model.openings, model.block_name)


def events_at_start(stage: Stage, time: float) -> Iterator[Event]:
    """Yield the events at the start of a stage."""

    def event(kind: str, what: str, text: str) -> Event:
        return Event(time=time, stage=stage.name, kind=kind, what=what, text=text)

    yield event("stage begins", stage.name, f"stage '{stage.name}' begins")
    for name in stage.excavate:
        yield event("excavated", name, f"'{name}' is excavated")
    for name in stage.install:
        yield event("installed", name, f"'{name}' is installed")
    for name, changes in stage.joints.items():
        numbers = ", ".join(f"{key} {value:g}" for key, value in changes.items())
        yield event("joint changes", name, f"joint '{name}' gets {numbers}")
    for name in stage.loads:
        yield event("load begins", name, f"'{name}' begins to act")
    if stage.ground_motion:
        yield event("ground motion begins", "", "the ground begins to move")


def _motion(motion: GroundMotion, stages: Sequence[Stage], starts: Sequence[float]) -> GroundMotion:
    if isinstance(motion, Still):
        return motion
    ends = (*starts[1:], math.inf)
    parts = tuple(
        (start, end)
        for stage, start, end in zip(stages, starts, ends, strict=False)
        if stage.ground_motion
    )
    return InStages(motion=motion, parts=parts)


def _method(method: Method, stage: Stage) -> Method:
    if stage.dynamic_ratio is not None:
        method = replace(method, dynamic_ratio=stage.dynamic_ratio)
    if stage.until == EQUILIBRIUM:
        method = replace(method, balance=WELL_BELOW * stage.force_ratio)
    return method if stage.damping is None else replace(method, damping=stage.damping)


def _schedule(schedule: Schedule, stage: Stage, start: float) -> Schedule:
    step = stage.step or schedule.step
    smallest = schedule.smallest_step
    return replace(
        schedule,
        stages=(),
        step=step,
        end=start + (stage.time or schedule.end),
        every=stage.every or schedule.every,
        smallest_step=None if smallest is None else min(smallest, step),
    )
