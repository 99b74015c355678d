"""The sequence of stages of a run: the end of one, and the start of the next."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from clast.actions.damping import Undamped
from clast.errors import ModelError
from clast.model.flow.given import STEADY
from clast.model.stage_records import (
    BROKEN_OFF,
    FAILS,
    MOVING,
    REACHED,
    TIME_OVER,
    Event,
    Mechanism,
    StageRecord,
)
from clast.model.stages import EQUILIBRIUM, TIME, Stage
from clast.model.state import State, here
from clast.run.excavation import as_in
from clast.run.stages.equilibrium import EquilibriumCheck
from clast.run.stages.stage_checks import check_stages
from clast.run.stages.stage_position import EquilibriumStreak, Judgement, Position
from clast.run.stages.static_path import OnPath
from clast.run.stages.transition import Setting, before_all, changed, entered, events_at_start
from clast.step.method import is_stable_for_any_step


@dataclass(frozen=True, kw_only=True)
class StageSequence:
    """The stages of a run, of which there may be none."""

    base: Setting
    """Model, method and schedule without stages."""

    @property
    def stages(self) -> tuple[Stage, ...]:
        """The stages."""
        return self.base.schedule.stages

    @property
    def least_carried(self) -> float:
        """Least share of velocity that a stage carries to the next step."""
        carried = (self._dynamic_ratio(stage) for stage in self.stages)
        return min(carried, default=self.base.method.dynamic_ratio)

    @cached_property
    def first(self) -> Setting:
        """The setting with which a run begins.  Raises ModelError for stages that are none."""
        self.check()
        return before_all(self.base) if self.stages else self.base

    def check(self) -> None:
        """Refuse stages that are none, and drawpoints where all steps are static: nothing moves."""
        check_stages(self.stages, self.base.model)
        ratios = [self._dynamic_ratio(stage) for stage in self.stages]
        ratios = ratios or [self.base.method.dynamic_ratio]
        self._check_flow(any(ratio == 0.0 for ratio in ratios))
        points = self.base.model.drawpoints
        if points and not any(ratios):
            raise ModelError(
                "no block comes past it: all steps are static",
                where=f"drawpoint '{points[0].name}'",
                remedy="give time.dynamic_ratio = 1.0, or a stage with dynamic_ratio = 1.0",
            )

    def _check_flow(self, static: bool) -> None:
        """Refuse a flow that follows equilibria where none comes; ``static``: some steps are."""
        flow = self.base.model.flow
        comes = static or any(stage.until == EQUILIBRIUM for stage in self.stages)
        if flow is not None and flow.coupling == STEADY and not comes:
            raise ModelError(
                '"steady" follows equilibria, and this run comes to none',
                where="flow, coupling",
                remedy="give time.dynamic_ratio = 0.0, a stage until equilibrium, or "
                'coupling = "none"',
            )

    def setting_at(self, position: Position | None, state: State) -> Setting:
        """Return the setting of a run that goes on from a position."""
        if position is None or not position.starts:
            return replace(self.first, model=as_in(self.first.model, state))
        # The setting of a run that goes on in the stage that began last at ``position.starts``, s.
        setting = before_all(self.base)
        for begun in range(1, len(position.starts) + 1):
            setting = changed(self.base, setting, position.starts[:begun])
        return replace(setting, model=as_in(setting.model, state))

    def is_done(self, position: Position) -> bool:
        """Return whether no stage is left."""
        return position.number + 1 >= len(self.stages)

    def enter(
        self, current: Setting, state: State, position: Position
    ) -> tuple[Setting, State, Position, tuple[Event, ...]]:
        """Return setting, state and position at the start of the next stage, and the events."""
        starts = (*position.starts, state.time)
        setting, state = entered(self.base, current, state, starts)
        position = replace(
            position,
            starts=starts,
            steps=0,
            seconds=0.0,
            broken=0,
            held=EquilibriumStreak(),
            judged=Judgement(),
            over=False,
        )
        stage = self.stage(position)
        events = tuple(events_at_start(self.base.model, stage, state.time))
        return setting, state, position, events

    def leave(
        self, position: Position, state: State, judge: EquilibriumCheck, path: OnPath | None = None
    ) -> tuple[Position, tuple[Event, ...]]:
        """Return the position at the end of a stage, and the events.

        ``path`` is that of a static stage.
        """
        stage = judge.stage
        failure = None if path is None else path.failure
        outcome = REACHED if judge.is_over(position) else MOVING
        outcome = TIME_OVER if stage.until == TIME else outcome
        outcome = FAILS if failure is not None else outcome
        reference = here(state) if stage.reset_displacement else position.reference
        record = self.record(position, state, outcome)
        if path is not None:
            record = replace(record, branch=path.branch)
        if failure is not None:
            record = replace(
                record, mover=failure.mover, mechanism=failure.blocks, hindrance=failure.hindrance
            )
            position = replace(position, failures=(*position.failures, (stage.name, failure)))
        if stage.reset_displacement:
            points = self.base.model.measured_points.at
            moved = state.points[self.base.model.point_slices.measured] - points
            record = replace(record, reset=tuple((x, y) for x, y in moved.tolist()))
        records = (*position.records, record)
        position = replace(position, records=records, reference=reference)
        return position, tuple(_events_at_end(stage, record))

    def record(self, position: Position, state: State, outcome: str = BROKEN_OFF) -> StageRecord:
        """Return how a stage went that ends in a state."""
        return StageRecord(
            name=self.stage(position).name,
            start=position.start,
            end=state.time,
            steps=position.steps,
            outcome=outcome,
            force_ratio=position.judged.force_ratio if position.steps else 0.0,
            mover=position.judged.mover,
            seconds=position.seconds,
            broken=position.broken,
            hindrance=position.judged.hindrance if position.steps else "",
        )

    def all_records(self, position: Position, state: State) -> tuple[StageRecord, ...]:
        """Return how all stages went, one that was broken off in a state included."""
        if len(position.records) == len(position.starts):
            return position.records
        return (*position.records, self.record(position, state))

    def stage(self, position: Position) -> Stage:
        """Return the stage that goes on."""
        return self.stages[position.number]

    def warnings(self, position: Position) -> Iterator[str]:
        """Report the stages that ended without equilibrium, the failed condition, and a remedy."""
        for name, failure in position.failures:
            yield f"stage '{name}' fails: {failure}. Later results show no equilibrium"
        for stage, record in zip(self.stages, position.records, strict=False):
            if record.branch:
                yield f"stage '{record.name}': {record.branch}"
            if record.outcome == MOVING:
                lasted = record.end - record.start
                too_few = f"fewer than {stage.hold} steps in a row were in equilibrium (hold)"
                yield (
                    f"stage '{record.name}' ended at its limit of {lasted:.6g} s without "
                    f"equilibrium: {record.hindrance or too_few}. Most moved "
                    f"{record.mover}. {self._advice(stage)}"
                )
            elif self._left_unbalanced(stage, record):
                yield (
                    f"stage '{record.name}' is static, and ended by its time before forces were in "
                    f"balance: {record.hindrance}. Later results start from there. Raise its time, "
                    f"and relax_time with it, {self._or_how_else(stage)}"
                )

    def _left_unbalanced(self, stage: Stage, record: StageRecord) -> bool:
        """Return whether a static stage was ended by its time while forces were out of balance."""
        least = max(0.01, stage.force_ratio)
        is_over = record.outcome == TIME_OVER and record.force_ratio > least
        return is_over and self._dynamic_ratio(stage) == 0.0

    def _or_how_else(self, stage: Stage) -> str:
        """Return the remedy beside more time for a static stage that its time ends."""
        if is_stable_for_any_step(self.base.method.process):
            return f'or set until = "{EQUILIBRIUM}"'
        return 'or set method.process = "convex", whose static steps have next to no mass term'

    def _dynamic_ratio(self, stage: Stage) -> float:
        usual = self.base.method.dynamic_ratio
        return usual if stage.dynamic_ratio is None else stage.dynamic_ratio

    def _advice(self, stage: Stage) -> str:
        """Return the remedies that may bring a stage to rest and are not set yet."""
        damping = self.base.method.damping if stage.damping is None else stage.damping
        remedies = ["raise its time"]
        if self._dynamic_ratio(stage) > 0.0:
            remedies.append("set dynamic_ratio = 0.0")
            if isinstance(damping, Undamped):
                remedies.append('set damping = "adaptive"')
        return f"If the blocks come to rest: {', or '.join(remedies)}"


def fails(stage: str, time: float, failure: Mechanism) -> Event:
    """Return that a stage, or a run without stages (""), has no equilibrium from a time on, s."""
    what = failure.blocks[0] if failure.blocks else ""
    return Event(time=time, stage=stage, kind="fails", what=what, text=str(failure))


def _events_at_end(stage: Stage, record: StageRecord) -> Iterator[Event]:
    texts = {
        REACHED: f"stage '{stage.name}' is in equilibrium",
        FAILS: f"stage '{stage.name}' ends without equilibrium",
        MOVING: f"stage '{stage.name}' ends while blocks move: {record.mover}",
        TIME_OVER: f"the time of stage '{stage.name}' is over",
    }
    text = texts[record.outcome]
    yield Event(time=record.end, stage=stage.name, kind="stage ends", what=stage.name, text=text)
    if stage.reset_displacement:
        text = "displacements count from here"
        kind = "displacements reset"
        yield Event(time=record.end, stage=stage.name, kind=kind, what="", text=text)
