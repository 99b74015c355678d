"""The loop over steps: accept, cut or grow the step (the paper's (15)), record."""

from __future__ import annotations

import signal
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from time import perf_counter

from clast.compute.threads import threads_worth
from clast.contact.contacts import Contacts
from clast.errors import ResultsLost, RunStopped, StepOutcome, StepRejected
from clast.model.model import Model
from clast.model.state import Ledger, State, initial_state
from clast.results import Report, Run, RunRecorder
from clast.results.about import about_method
from clast.run import law_check
from clast.run.interrupts import held_back
from clast.run.method_doubts import check_overlaps
from clast.run.schedule import Progress, Schedule
from clast.run.watch import Watch
from clast.step import energy_balance as energy
from clast.step.method import Method, StepResult
from clast.step.remedies import remedy

GROW = 1.5
"""After a step that was far from its limits the next one is longer by this factor."""
COMFORT = 0.8
"""The step grows only while blocks near each other move less than this share of
max_displacement."""
SMALLEST_SHARE = 2.0**-12
"""The smallest step tried, as a share of the wanted one, unless the schedule names it."""


@dataclass(kw_only=True)
class _Tally:
    """Counts of a run, gathered while it goes."""

    steps: int = 0
    passes: int = 0
    cut_steps: int = 0
    contacts: int = 0
    penetration: float = 0.0
    seconds: dict[str, float] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    touching: Contacts | None = None
    """Contacts of the last step that had any."""

    def add(self, result: StepResult) -> None:
        self.steps += 1
        self.touching = result.contacts if len(result.contacts) else self.touching
        self.passes += result.passes
        self.contacts = max(self.contacts, len(result.contacts))
        self.penetration = max(self.penetration, result.penetration)
        for stage, seconds in result.seconds.items():
            self.seconds[stage] = self.seconds.get(stage, 0.0) + seconds
        for name, number in result.counts.items():
            self.counts[name] = self.counts.get(name, 0) + number

    def report(self, ledger: Ledger, wall: float, outcome: str, finished: bool) -> Report:
        return Report(
            steps=self.steps,
            passes=self.passes,
            cut_steps=self.cut_steps,
            largest_contacts=self.contacts,
            largest_penetration=self.penetration,
            ledger=ledger,
            seconds=dict(self.seconds),
            counts=dict(self.counts),
            wall_seconds=wall,
            outcome=outcome,
            finished=finished,
            warnings=(),
            overlaps=(),
        )


def simulate(
    model: Model,
    method: Method,
    schedule: Schedule,
    *,
    recorder: RunRecorder | None = None,
    watch: Callable[[Progress], None] | None = None,
    warnings: tuple[str, ...] = (),
) -> Run:
    """Simulate a model from rest (or its initial velocities) to the end of the schedule.

    Raises RunStopped, with the partial results in its ``run``, where even the smallest step is
    rejected or a frame cannot be written.  The interrupt key, SIGTERM and SIGHUP end the run early,
    with its results kept; the latter two then end the process.  ``warnings`` are put into the
    report beside what the process itself has to say; a contact law of one's own is tried on the
    run's contacts (see :func:`clast.check_law`), and its faults are warnings too.  Raises
    ModelError where blocks overlap by more than contacts of this stiffness explain.
    """
    check_overlaps(model, method)
    recorder = recorder or RunRecorder(model)
    tally = _Tally()
    start = perf_counter()
    state = initial_state(model)
    state = replace(state, ledger=energy.opening(model, method, state))
    advice = method.process.advice(model, method, state, schedule.step)
    warnings = tuple(dict.fromkeys((*warnings, *advice)))
    recorder.start(state, about_method(method, schedule.step, schedule.end))
    on_watch = Watch(model=model, method=method, state=state)
    failure = ""
    outcome = "the run reached its end"
    ended_by = 0
    with held_back() as let_go, threads_worth(model.block_count):
        try:
            _march(model, method, schedule, state, recorder, watch, on_watch, tally, let_go)
        except (StepRejected, ResultsLost) as gave_up:
            failure = str(gave_up)
            outcome = f"stopped at t = {recorder.state.time:.6g} s: {failure}"
        except KeyboardInterrupt as asked:
            ended_by = getattr(asked, "number", signal.SIGINT)
            outcome = f"interrupted{_by(ended_by)} at t = {recorder.state.time:.6g} s"
        state = recorder.state
        finished = not failure and not ended_by
        report = tally.report(state.ledger, perf_counter() - start, outcome, finished)
        on_watch.frame(state)
        warnings += on_watch.warnings()
        if tally.touching is not None:
            warnings += law_check.warnings_of(method.contact_law, tally.touching)
        report = replace(
            report,
            warnings=warnings,
            overlaps=tuple(on_watch.overlaps.values()),
            notes=(*model.notes, *method.notes),
        )
        run = replace(recorder.finish(report), ended_by=ended_by)
    if failure:
        raise RunStopped(f"the run {outcome}", run)
    return run


def _by(number: int) -> str:
    """Return which signal interrupted a run, where it was not the key."""
    return "" if number == signal.SIGINT else f" by {signal.Signals(number).name}"


def _march(
    model: Model,
    method: Method,
    schedule: Schedule,
    state: State,
    recorder: RunRecorder,
    watch: Callable[[Progress], None] | None,
    on_watch: Watch,
    tally: _Tally,
    let_go: Callable[[], None],
) -> State:
    """Step from ``state`` to the end of the schedule and return the last state.

    ``let_go`` is called between steps, and raises KeyboardInterrupt if the key was pressed.
    """
    smallest = schedule.smallest_step or SMALLEST_SHARE * schedule.step
    step, frame, first = schedule.step, 1, state.ledger
    result: StepResult | None = None
    while schedule.end - state.time > 1e-9 * schedule.step:
        let_go()
        wanted = min(step, schedule.end - state.time)
        result, taken = _accepted_step(model, method, state, wanted, smallest, tally)
        if state.time == 0.0:
            first = energy.with_overlap(first, method, result.contacts)
        state = result.state
        tally.add(result)
        recorder.step(result, taken)
        on_watch.step(result, taken)
        if watch:
            watch(
                Progress(
                    time=state.time,
                    end=schedule.end,
                    step=taken,
                    steps=tally.steps,
                    contacts=len(result.contacts),
                    penetration=result.penetration,
                )
            )
        if state.time >= frame * schedule.every - 1e-9 * schedule.step:
            recorder.frame(state, result.contacts, result.response)
            on_watch.frame(state)
            frame = int((state.time + 1e-9 * schedule.step) / schedule.every) + 1
        _reject_created_energy(model, method, state, first)
        step = _next_step(taken, result, schedule, method)
    return state


def _reject_created_energy(model: Model, method: Method, state: State, first: Ledger) -> None:
    """Raise StepRejected where the blocks hold far more energy than they can have."""
    created = energy.created(state.ledger, first)
    allowed = energy.tolerated(model, state.ledger, first)
    allowed += energy.round_off(method, state, len(state.memory))
    if created > allowed:
        raise StepRejected(
            StepOutcome.ENERGY_CREATED,
            f"{created:.3g} J/m too much at t = {state.time:.6g} s",
            remedy=remedy(StepOutcome.ENERGY_CREATED, model, method, state, 0.0),
        )


def _accepted_step(
    model: Model, method: Method, state: State, step: float, smallest: float, tally: _Tally
) -> tuple[StepResult, float]:
    """Return the result of the longest step that is accepted, cutting from ``step``, s.

    Raises the last rejection where a step would become smaller than ``smallest``.
    """
    while True:
        try:
            return method.process.step(model, method, state, step), step
        except StepRejected as rejected:
            tally.cut_steps += 1
            if step * rejected.cut < smallest:
                raise StepRejected(
                    rejected.outcome,
                    _last_words(rejected, step),
                    remedy=remedy(rejected.outcome, model, method, state, step),
                ) from rejected
            step *= rejected.cut


def _last_words(rejected: StepRejected, step: float) -> str:
    detail = f"{rejected.detail}; " if rejected.detail else ""
    return f"{detail}the smallest step tried was {step:.3g} s"


def _next_step(taken: float, result: StepResult, schedule: Schedule, method: Method) -> float:
    """Return the length of the next step, s: grown back where the last one was comfortable."""
    comfortable = result.approach * GROW < COMFORT * method.max_displacement
    return min(schedule.step, taken * GROW if comfortable else taken)


__all__ = ["Progress", "Schedule", "simulate"]
