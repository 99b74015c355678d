"""A run: step after step from its start to its end, each accepted, cut or grown (the paper's (15)).

All that a run carries from one step to the next is its ``RunState`` (run_state.py).  Whoever has
that of any step goes on as the run did, to the bit: ``simulate(..., begin=...)``.
"""

from __future__ import annotations

import math
import signal
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clast.actions.active import actions_of, states_of
from clast.compute.compilation import COMPILATION, working_time
from clast.compute.parallel import threads_worth
from clast.contact.contacts import Contacts
from clast.errors import ActionFault, ResultsLost, RunStopped, StepRejected
from clast.model.flow.solving import NoFlow
from clast.model.model import Model
from clast.model.stage_records import StageRecord
from clast.model.stages import Stage
from clast.model.state import initial_state
from clast.read_only import changed
from clast.results import Report, Run, RunRecorder
from clast.results.run_report import about_method
from clast.run import following, law_check
from clast.run.checkpointing import Checkpointing
from clast.run.drawing import drawn
from clast.run.events import Listener, bonds_break
from clast.run.excavation import excavated
from clast.run.flow_warnings import flow_warnings
from clast.run.interrupts import held_back
from clast.run.method_warnings import check_coupling, check_overlaps
from clast.run.run_checks import Watch, reject_created_energy
from clast.run.run_state import Halt, Leader, RunState
from clast.run.schedule import Progress, Schedule
from clast.run.stages.equilibrium import EquilibriumCheck
from clast.run.stages.stage_position import EquilibriumStreak, Position
from clast.run.stages.stage_sequence import StageSequence, fails
from clast.run.stages.static_path import StaticPath
from clast.run.stages.transition import Setting
from clast.run.start_in_situ import in_equilibrium
from clast.step import energy_balance
from clast.step.method import Method, StepResult, Workspace
from clast.step.remedies import remedy

STEP_GROWTH = 1.5
"""After a step that was far from its limits the next one is longer by this factor."""
APPROACH_MAX = 0.8
"""Approach of blocks up to which the step grows, in units of max_displacement."""
TIME_ROUNDING = 1e-9
"""Difference of times that are the same, in steps."""


@dataclass(frozen=True, kw_only=True)
class Stepping:
    """The parts that all steps of a run, or of one of its stages, have in common."""

    model: Model
    method: Method
    schedule: Schedule
    watch: Watch
    workspace: Workspace
    listener: Listener
    judge: EquilibriumCheck | None = None
    """Judges the steps of a stage."""
    statics: StaticPath | None = None
    """Leads a static run, or a static stage."""

    @classmethod
    def of(cls, setting: Setting, workspace: Workspace, stage: Stage | None) -> Stepping:
        """Return the common parts of the steps of a setting."""
        model, method = setting.model, setting.method
        return cls(
            model=model,
            method=method,
            schedule=setting.schedule,
            watch=Watch(model=model, method=method),
            workspace=workspace,
            listener=Listener(model=model, method=method, stage=stage.name if stage else ""),
            judge=EquilibriumCheck(model=model, method=method, stage=stage) if stage else None,
            statics=StaticPath.of(model, method, setting.schedule, stage),
        )

    def begin(self) -> RunState:
        """Return the run before its first step: at rest, or with its initial velocities."""
        state, notes = in_equilibrium(
            self.model, self.method, initial_state(self.model), self.schedule.step
        )
        if self.model.flow is not None:  # the first frame shows the water before any stage
            actions = actions_of(self.model, self.method.fixed_point_stiffness, self.method.damping)
            state = replace(state, actions=states_of(actions, self.model, state))
        ledger = energy_balance.opening(self.model, state)
        state, step = replace(state, ledger=ledger), self.schedule.step
        seen = self.watch.begin(state)
        return self.ready(RunState(state=state, step=step, first=ledger, seen=seen, notes=notes))

    def ready(self, now: RunState) -> RunState:
        """Return the run before the first step of its schedule, or of a stage."""
        if self.statics is None:
            return replace(now, step=self.schedule.step, path=None)
        path = self.statics.begin(now.state)
        return replace(now, step=self.statics.first_step, path=path)

    def is_over(self, now: RunState) -> bool:
        """Return whether the end of the schedule is reached, or the equilibrium of the stage."""
        if self.statics is not None and now.path is not None:
            return self.statics.is_over(now.path, now.position, now.state)
        if self.judge is not None and now.position is not None and self.judge.is_over(now.position):
            return True
        return self.schedule.end - now.state.time <= TIME_ROUNDING * self.schedule.step

    def next(self, now: RunState) -> tuple[RunState, StepResult]:
        """Return the run one accepted step later, and that step's result; raises StepRejected."""
        result, taken, clock, cuts = self._accepted(now)
        while self.statics is not None and now.path is not None:
            finer = self.statics.finer(now.path, result)
            if finer is None:
                break
            now = replace(now, path=finer)
            result, taken, clock, more = self._accepted(now)
            cuts += more + 1
        first, position = now.first, now.position
        if now.state.time == 0.0:
            first = energy_balance.with_overlap(first, self.method, result.contacts)
        if self.judge is not None and position is not None:
            judge = self.judge
            if self.statics is not None and now.path is not None:
                judge = self.statics.judge_of(now.path)
            position = judge.after(position, now.state, result, taken)
        # The length of the next step, s: grown back where the last one was comfortable.
        comfortable = result.approach * STEP_GROWTH < APPROACH_MAX * self.method.max_displacement
        after = changed(
            now,
            state=result.state,
            step=min(self.schedule.step, taken * STEP_GROWTH if comfortable else taken),
            taken=taken,
            first=first,
            tally=now.tally.with_step(result, cuts),
            seen=self.watch.with_step(now.seen, result),
            events=(*now.events, *self.listener.events(now.state, result)),
            position=position,
        )
        if self.statics is not None:
            after = self._along(now, after, result, (clock, cuts))
        if self.model.flow is not None and self.is_over(after):
            after = self._with_flow(after)
        if self.is_over(after):
            result = changed(result, state=after.state)
            if self.statics is not None and after.path is not None:
                after = replace(after, path=self.statics.examined(after.path, after.state))
            if position is not None:
                after = replace(after, position=replace(position, over=True))
        return after, result

    def _with_flow(self, now: RunState) -> RunState:
        """Return a run at its end, or that of a stage; it goes on where the flow has to follow."""
        judge, path, position = self.judge, now.path, now.position
        if self.statics is not None and path is not None:
            judge, rests = self.statics.judge, path.balanced and path.failure is None
        else:
            rests = judge is not None and position is not None and judge.is_over(position)
        if judge is None or not rests:
            return now
        return following.after_equilibrium(self.model, now, judge.stage)

    def _along(
        self, now: RunState, after: RunState, result: StepResult, taken: tuple[float, int]
    ) -> RunState:
        """Return the run after a static step, further on its path; ``taken`` are clock and cuts."""
        statics, path = self.statics, now.path
        if statics is None or path is None:
            return after
        clock, cuts = taken
        judged = after.position.judged if after.position is not None else None
        stage = self.judge.stage.name if self.judge is not None else ""
        events = after.events
        if len(result.broken):
            events = (*events, bonds_break(self.model, stage, result, path.load))
        unfinished = path.load < 1.0 or path.held
        path = statics.cut(path, clock, cuts)
        path = statics.after(path, now.state, result, (after.taken, clock), judged)
        if after.position is not None:
            held = after.position.held
            if unfinished or path.judged.hindrance:
                held = EquilibriumStreak()
            after = replace(after, position=replace(after.position, judged=path.judged, held=held))
        if path.failure is not None and (now.path is None or now.path.failure is None):
            events = (*events, fails(stage, after.state.time, path.failure))
        step = statics.next_step(path, after.taken, result)
        return replace(after, path=path, step=step, events=events)

    def frame_is_due(self, now: RunState) -> bool:
        """Return whether a frame is to be kept; a stage ends with one.

        Where time stands still until static steps balance it is that of the last of them.
        """
        if self.judge is not None and self.is_over(now):
            return True
        time, step = now.state.time, self.schedule.step
        if time < now.frame * self.schedule.every - TIME_ROUNDING * step:
            return False
        if self.statics is None or now.path is None or now.path.failure is not None:
            return True
        if time >= self.schedule.end - TIME_ROUNDING * step:
            return self.is_over(now)
        return not self.statics.waits(now.path, now.state)

    def with_frame(self, now: RunState) -> RunState:
        """Return the run after a frame has been kept."""
        seen = self.watch.with_frame(now.seen, now.state)
        return replace(now, frame=self.next_frame(now.state.time), seen=seen)

    def next_frame(self, time: float) -> int:
        """Return the number of the frame that is due after a time, s."""
        return int((time + TIME_ROUNDING * self.schedule.step) / self.schedule.every) + 1

    def _accepted(self, now: RunState) -> tuple[StepResult, float, float, int]:
        """Return the longest step accepted, its length and that of time, s, and cuts; or raise."""
        model, method, state, cuts = self.model, self.method, now.state, 0
        step, clock, varies = now.step, None, False
        if self.statics is not None and now.path is not None:
            clock = self.statics.clock(now.path, state)
            varies = clock > 0.0 and self.statics.is_under_way(state)
            model, method = self.statics.at(now.path, clock)
        else:
            step = min(step, self.schedule.end - state.time)
        smallest = self.schedule.smallest_step or 2.0**-12 * self.schedule.step
        while True:
            try:
                result = method.process.step(model, method, state, step, self.workspace)
                return result, step, step if clock is None else clock, cuts
            except StepRejected as rejected:
                cuts += 1
                if step * rejected.cut < smallest:
                    detail = f"{rejected.detail}; " if rejected.detail else ""
                    last = StepRejected(
                        rejected.outcome,
                        f"{detail}the smallest step tried was {step:.3g} s",
                        remedy=remedy(rejected.outcome, model, method, state, step),
                    )
                    last.cuts = cuts
                    raise last from rejected
                step *= rejected.cut
                if clock is not None and varies:
                    clock *= rejected.cut
                    method = replace(method, clock=clock)


def simulate(
    model: Model,
    method: Method,
    schedule: Schedule,
    *,
    recorder: RunRecorder | None = None,
    watch: Callable[[Progress], None] | None = None,
    keep: Callable[[RunState], None] | None = None,
    begin: RunState | None = None,
    warnings: tuple[str, ...] = (),
) -> Run:
    """Simulate a model from rest (or its initial velocities) to the end of the schedule.

    Raises RunStopped, with the partial results in its ``run``, where even the smallest step is
    rejected or a frame cannot be written.  The interrupt key, SIGTERM and SIGHUP end the run early,
    with its results kept; the latter two then end the process.  ``warnings`` are put into the
    report beside those of the process; a contact law of one's own is tried on the run's contacts
    (see ``clast.check_law``), and its faults are warnings too.  Raises ModelError where blocks
    overlap by more than contacts of this stiffness explain.

    ``keep`` receives the data of the run after each step; a run of the same model, method and
    schedule that has them as ``begin`` goes on from there, and records from there on.
    """
    check_coupling(model, method)
    check_overlaps(model, method)
    course = StageSequence(base=Setting(model=model, method=method, schedule=schedule))
    start = working_time()
    march = _March.begin(course, recorder or RunRecorder(model), begin)
    march.watch, march.keep = watch, keep
    advice = method.process.advice(model, method, march.now.state, schedule.step)
    warnings = tuple(dict.fromkeys((*warnings, *advice)))
    march.recorder.start(march.now.state, _about(method, schedule))
    failure, outcome, ended_by = "", "the run reached its end", 0
    cause: Exception | None = None
    with held_back() as let_go, threads_worth(model.block_count):
        try:
            march.to_the_end(let_go)
        except (StepRejected, ResultsLost, ActionFault, NoFlow) as gave_up:
            cuts = march.now.tally.cut_steps + getattr(gave_up, "cuts", 0)
            march.now = replace(march.now, tally=replace(march.now.tally, cut_steps=cuts))
            failure, cause = str(gave_up), gave_up
            outcome = f"stopped at t = {march.recorder.state.time:.6g} s: {failure}"
        except KeyboardInterrupt as asked:
            ended_by = getattr(asked, "number", signal.SIGINT)
            by = "" if ended_by == signal.SIGINT else f" by {signal.Signals(ended_by).name}"
            how = getattr(asked, "how", f"interrupted{by}")
            outcome = f"{how} at t = {march.recorder.state.time:.6g} s"
        finished = not failure and not ended_by
        if isinstance(keep, Checkpointing):
            warnings += keep.over(outcome, finished=finished)
        wall = working_time() - start
        report = march.report(wall, outcome, finished=finished, warnings=warnings)
        compiling = COMPILATION.unreported()
        if compiling > 0.0:
            report = replace(report, seconds={**report.seconds, "compilation": compiling})
        run = replace(march.recorder.finish(report), ended_by=ended_by)
    if failure:
        raise RunStopped(f"the run {outcome}", run) from cause
    return run


def _about(method: Method, schedule: Schedule) -> dict[str, Any]:
    about = about_method(method, schedule.step, schedule.latest)
    names = [stage.name for stage in schedule.stages]
    begins = {name: stage.name for stage in schedule.stages for name in stage.loads}
    return {**about, "stages": names, "begins": begins} if names else about


@dataclass
class _March:
    """A run that goes on: where it is, and who is informed of it."""

    course: StageSequence
    setting: Setting
    stepping: Stepping
    recorder: RunRecorder
    now: RunState
    watch: Callable[[Progress], None] | None = None
    keep: Callable[[RunState], None] | None = None
    touching: Contacts | None = None
    """Contacts of the last step that had any, on which a law of a script is tried."""

    @classmethod
    def begin(cls, course: StageSequence, recorder: RunRecorder, begin: RunState | None) -> _March:
        """Return a run before its first step, or where it is to go on."""
        position = begin.position if begin else None
        setting = course.setting_at(position, begin.state) if begin else course.first
        stage = None if position is None else course.stage(position)
        stepping = Stepping.of(setting, Workspace(), stage)
        now = begin or stepping.begin()
        if (now.path is None) != (stepping.statics is None):
            now = stepping.ready(now)  # static and dynamic by turns
        march = cls(course, setting, stepping, recorder, now)
        if position is not None:
            recorder.enter(position.number, position.reference)
        elif course.stages:
            march.now = replace(march.now, position=Position())
            march._enter()
        return march

    def to_the_end(self, let_go: Callable[[], None]) -> None:
        """Step to the end of the schedule, or through all stages; ``let_go`` may interrupt it."""
        self._step_on(let_go)
        while self.now.position is not None:
            self._leave()
            if self.course.is_done(self.now.position):
                return
            self._enter()
            self._step_on(let_go)

    def _step_on(self, let_go: Callable[[], None]) -> None:
        stepping = self.stepping
        leader = self.watch if isinstance(self.watch, Leader) else None
        keep = self.keep.at_once if isinstance(self.keep, Checkpointing) else None
        halt = Halt(
            let_go=let_go,
            keep_frame=self.recorder.keep_last,
            checkpoint=keep or (lambda: "a run that writes no file has no checkpoints"),
            where=lambda: _progress(self.now, stepping, len(self.now.state.memory), 0.0),
        )
        while not stepping.is_over(self.now):
            let_go()
            if leader is not None:
                leader.lead(halt)
            self.now, result = stepping.next(self.now)
            self.touching = result.contacts if len(result.contacts) else self.touching
            position = self.now.position
            unbalanced = math.nan if position is None else position.judged.force_ratio
            self.recorder.step(result, self.now.taken, unbalanced)
            if self.watch:
                contacts = len(result.contacts)
                self.watch(_progress(self.now, stepping, contacts, result.penetration))
            if stepping.frame_is_due(self.now):
                self.recorder.frame(result.state, result.contacts, result.response)
                self.now = stepping.with_frame(self.now)
            reject_created_energy(
                stepping.model, stepping.method, self.now.state, self.now.first, self.now.seen
            )
            if stepping.model.drawpoints and stepping.statics is None:
                stepping = self._draw()
            if self.keep:
                self.keep(self.now)

    def _draw(self) -> Stepping:
        """Take out the blocks that have passed a drawpoint; return how the run goes on."""
        now, stepping, model = self.now, self.stepping, self.setting.model
        events = drawn(model, now.state, now.events, stepping.listener.stage)
        if events:
            blocks = np.array([one.block for one in events])
            model, state = excavated(model, self.setting.method, now.state, blocks)
            self.setting = replace(self.setting, model=model)
            stage = stepping.judge.stage if stepping.judge is not None else None
            self.stepping = Stepping.of(self.setting, stepping.workspace, stage)
            self.now = replace(now, state=state, events=(*now.events, *events))
        return self.stepping

    def _enter(self) -> None:
        now, course = self.now, self.course
        position = now.position or Position()
        self.setting, state, position, events = course.enter(self.setting, now.state, position)
        workspace, stage = self.stepping.workspace, course.stage(position)
        self.stepping = Stepping.of(self.setting, workspace, stage)
        self.now = self.stepping.ready(
            replace(
                now,
                state=state,
                frame=self.stepping.next_frame(state.time),
                events=(*now.events, *events),
                position=position,
            )
        )
        self.recorder.enter(position.number, position.reference)

    def _leave(self) -> None:
        now, judge = self.now, self.stepping.judge
        if now.position is not None and judge is not None:
            if isinstance(self.keep, Checkpointing):
                self.keep.stage_ended(judge.stage.name, now)
            position, events = self.course.leave(now.position, now.state, judge, now.path)
            self.now = replace(now, position=position, events=(*now.events, *events))

    def report(
        self, wall: float, outcome: str, *, finished: bool, warnings: tuple[str, ...]
    ) -> Report:
        """Return the report of a run that is over, after ``wall`` s of work."""
        model, method = self.stepping.model, self.stepping.method
        watch = replace(self.stepping.watch, carried=self.course.least_carried)
        state, tally = self.recorder.state, self.now.tally
        seen = watch.with_frame(self.now.seen, state)
        position = self.now.position
        stages: tuple[StageRecord, ...] = ()
        if position is not None:
            stages = self.course.all_records(position, state)
            warnings = (*warnings, *self.course.warnings(position))
        taken = self.now.taken
        if self.now.path is not None and (failure := self.now.path.failure) is not None:
            taken = 0.0  # its blocks move, and the failure says so
            if position is None:
                failed = f"the static run fails: {failure}. Later results show no equilibrium"
                warnings = (*warnings, failed)
        if position is None and self.now.path is not None and self.now.path.branch:
            warnings = (*warnings, f"the static run: {self.now.path.branch}")
        warnings = *warnings, *watch.warnings(seen, state, taken)
        if model.flow is not None:
            warnings += tuple(flow_warnings(model, state))
        if self.touching is not None:
            warnings += law_check.warnings_of(method.contact_law, self.touching)
        return Report(
            steps=tally.steps,
            passes=tally.passes,
            cut_steps=tally.cut_steps,
            largest_contacts=tally.contacts,
            largest_penetration=tally.penetration,
            ledger=state.ledger,
            seconds=dict(tally.seconds),
            counts=dict(tally.counts),
            wall_seconds=wall,
            outcome=outcome,
            finished=finished,
            warnings=warnings,
            overlaps=tuple(seen.overlaps.values()),
            notes=(*map(str, model.repairs), *model.notes, *method.notes, *self.now.notes),
            stages=stages,
            events=self.now.events,
        )


def _progress(now: RunState, stepping: Stepping, contacts: int, penetration: float) -> Progress:
    """Return where a run is after a step with so many contacts that penetrate so far, m."""
    progress = Progress(
        time=now.state.time,
        end=stepping.schedule.end,
        step=now.taken or now.step,
        steps=now.tally.steps,
        contacts=contacts,
        penetration=penetration,
    )
    if now.position is None or stepping.judge is None:
        return progress
    return replace(
        progress,
        stage=stepping.judge.stage.name,
        start=now.position.start,
        force_ratio=now.position.judged.force_ratio,
        speed=now.position.judged.mover.speed,
    )
