"""One trial of a study of collapse: whether the blocks stand with a factor.

Each trial is a static stage, a path of equilibria (decision 70, 0083), that begins where
the blocks have come to rest without the factor, with displacements at zero.  Friction that contacts
remember is capped to their reduced strength as the first step begins: the return mapping of
Coulomb's law does it.

A trial *stands* where it comes to an equilibrium.  It *fails* where blocks have moved by
2 % of their median size or more and their unbalanced force does not become less.  With a
process that carries no steps of any length it also fails where its time is over and blocks are
driven on.  All else (nothing moves far, but no equilibrium is found; the run cannot go on) is tried
again, three times as long, and is *undecided* if that is no better.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.case.case_file import Case
from clast.errors import CaseError, ResultsLost, RunStopped
from clast.inputs.declaring.text import to_toml
from clast.inputs.method import TimeTable
from clast.model.model import Floats, Model
from clast.model.stage_records import FAILS, MOVING, REACHED, StageRecord
from clast.results import Run, RunRecorder
from clast.results.frame_samples import bolt_states
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.run.stages.convergence import goes_from
from clast.step.method import Method, is_stable_for_any_step
from clast.study.collapsing.reduction import Load, Reduction, staged
from clast.study.collapsing.search import AFTER_MOVING, FAILED, STANDS, UNDECIDED, Trial
from clast.study.collapsing.support_forces import support_forces
from clast.study.parameters import Content, changed, content_of

if TYPE_CHECKING:
    from clast.run.run_state import RunState

LONGER = 3
"""By how much a trial is longer that was undecided."""
AT_REST_RATIO = 5e-4
"""Unbalanced acceleration over gravity below which blocks are not driven."""
MOVEMENT_PER_STEP_MAX = 0.05
"""Movement in a step of a trial, in units of that from which blocks fail, at most."""
TOGETHER = 0.5
"""Movement, in units of the largest, of the blocks that fail."""
WEIGHT_RATIO_MAX = 1e3
"""Largest load that is tried, over the weight of all blocks that can move."""


@dataclass(frozen=True, kw_only=True)
class Settled:
    """A case whose blocks have come to rest, from where all trials begin."""

    case: Case
    """The case, without stages of the study."""
    content: Content
    model: Model
    method: Method
    run: RunState
    base: float
    """Factor with which the blocks came to rest."""
    record: StageRecord
    """How they did."""
    stages: tuple[StageRecord, ...] = ()
    """How the stages of the case itself ended."""
    trials: dict[int, tuple[Model, Schedule]] = field(default_factory=dict)
    """Parts of a trial -> model and schedule, where trials differ in strengths of joints alone."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Stages of the case without an equilibrium, from which all trials begin."""
        return tuple(
            f"stage '{one.name}' of the case ends without equilibrium, and every trial begins "
            "from what it leaves: see clast run"
            for one in self.stages
            if one.outcome in (FAILS, MOVING)
        )


def settle(case: Case, by: Reduction, base: float) -> Settled:
    """Return a case after its stages and one in which its blocks come to rest.

    ``base`` is the factor that acts meanwhile.  Raises CaseError for a case that cannot be used.
    """
    content: Content = content_of(case)
    kept: list[RunState] = []

    def keep(now: RunState) -> None:
        kept[:] = [now]

    model = changed(case, staged(by.base(content, base))).model()
    # no step may leap past an equilibrium (decision 186)
    longest = MOVEMENT_PER_STEP_MAX * goes_from(model)
    if TimeTable.model_validate(content["time"]).largest_movement(model) > longest:
        content = {**content, "time": {**content["time"], "max_displacement": longest}}
    ready = changed(case, staged(by.base(content, base)))
    # Time between frames of which only the first and the last are wanted, s
    method, schedule = ready.method(model), replace(ready.schedule(), every=1e9)
    run = _simulated(model, method, schedule, RunRecorder(model, contacts=False), keep=keep)
    if len(run.stages) <= len(content.get("stage", [])) or not run.report.finished:
        raise CaseError(
            f"the run stops before its blocks have come to rest: {run.report.outcome}",
            where=case.file,
            remedy="check the case first: clast check, clast run",
        )
    return Settled(
        case=case,
        content=content,
        model=model,
        method=method,
        run=kept[0],
        base=base,
        record=run.stages[-1],
        stages=tuple(run.stages[:-1]),
    )


def settle_standing(case: Case, by: Reduction) -> Settled:
    """Return a case whose blocks have come to rest, with more strength where they need it.

    Raises CaseError where they do not stand with any.
    """
    base = 1.0
    while True:
        start = settle(case, by, base)
        if start.record.outcome == REACHED:
            return start
        base *= 0.5
        # Least factor at which blocks are let settle where they do not stand at 1
        if not by.DIVIDES or base < 1.0 / 64.0:
            raise CaseError(
                "the blocks do not come to rest before the factor acts"
                + (f", nor with the factor {2.0 * base:g}" if by.DIVIDES else "")
                + f": {start.record.hindrance or start.record.outcome}",
                where=case.file,
                remedy=REMEDY + ("" if is_stable_for_any_step(start.method.process) else SLOW),
            )


def over_weight(case: Case, by: Reduction) -> float:
    """Return the load of a factor of 1 over the weight of all blocks that can move; 0: no load."""
    if not isinstance(by, Load):
        return 0.0
    model = case.model()
    weight = float((model.mass * ~model.fixed).sum()) * float(np.hypot(*model.gravity))
    return by.over_weight(content_of(case), weight)


def largest_of(share: float) -> float:
    """Return the largest factor of a load that has a share of the weight at 1; 0: the usual."""
    return WEIGHT_RATIO_MAX / share if share > 0.0 else 0.0


REST_AFTER = 0.5
"""Movement after which standing blocks are warned of, in units of that of failure."""
REMEDY = "see the moving blocks: clast run; if they only need time, raise time.end"
SLOW = (
    ". This process needs many steps, the more the softer contacts are: give it passes and a "
    'normal_stiffness, or leave statics to process = "convex"'
)


def run_trial(
    start: Settled, by: Reduction, factor: float, output: Path | None = None, *, parts: int = 1
) -> Trial:
    """Return the result of a trial; an undecided one is tried again, longer.

    Its result file is written to ``output``.
    """
    model, schedule = _trial_model(start, by, factor, parts)
    third = schedule.stages[-1].time or schedule.end
    schedule = replace(schedule, every=third / 3.0)
    text = "" if output is None else to_toml(trial_content(start.content, by, factor, parts))
    recorder = RunRecorder(model, case_text=text, output=output, contacts=output is not None)
    run = _simulated(model, start.method, schedule, recorder, begin=start.run)
    trial = _judged(start, run, factor, parts)
    if trial.verdict == UNDECIDED and parts == 1:
        return run_trial(start, by, factor, output, parts=LONGER)
    return trial


def _trial_model(
    start: Settled, by: Reduction, factor: float, parts: int
) -> tuple[Model, Schedule]:
    """Return model and schedule of a trial.

    Where the factor changes strengths of joints alone, the case is validated and built once, and
    the first stage of the trial gets other strengths.
    """
    tables, extra = by.trial(start.content, factor)
    if tables is not start.content or parts not in start.trials:
        case = changed(start.case, staged(tables, extra, parts))
        built = case.model(), case.schedule()
        if tables is not start.content:
            return built
        start.trials[parts] = built
    model, schedule = start.trials[parts]
    *before, first = schedule.stages[: len(schedule.stages) - parts + 1]
    after = schedule.stages[len(before) + 1 :]
    return model, replace(schedule, stages=(*before, replace(first, joints=extra["joint"]), *after))


def trial_content(content: Content, by: Reduction, factor: float, parts: int = 1) -> dict[str, Any]:
    """Return the case of a trial as a whole, the stage in which blocks come to rest included."""
    tables, extra = by.trial(content, factor)
    return staged(tables, extra, parts)


def _simulated(
    model: Model, method: Method, schedule: Any, recorder: RunRecorder, **how: Any
) -> Run:
    """Return the run of a model, or as much of it as there is."""
    try:
        run = simulate(model, method, schedule, recorder=recorder, **how)
    except RunStopped as stopped:
        if isinstance(stopped.__cause__, ResultsLost):  # that says nothing of the blocks
            raise
        return stopped.run  # type: ignore[return-value]
    if not run.report.finished:
        raise KeyboardInterrupt
    return run


def _judged(start: Settled, run: Run, factor: float, parts: int) -> Trial:
    """Return the verdict on a run."""
    before = len(start.content.get("stage", [])) + 1
    records = run.stages[before:]
    far = moved(start.model, start.run.state.vertices, run.state.vertices)
    farthest = int(far.argmax())
    names = start.model.block_name
    trial = Trial(
        factor=factor,
        verdict=UNDECIDED,
        displacement=float(far[farthest]),
        mover=names[farthest] if far[farthest] > 0.0 else "",
        steps=sum(record.steps for record in records),
        longer=parts > 1,
        warnings=start.warnings,
        bolts=_unlimited(run),
    )
    if not run.report.finished:
        return replace(trial, reason=run.report.outcome)
    last = records[-1]
    if last.outcome == REACHED:
        far_enough = far[farthest] > REST_AFTER * goes_from(start.model)
        told = (*start.warnings, AFTER_MOVING) if far_enough else start.warnings
        return replace(trial, verdict=STANDS, supports=support_forces(run), warnings=told)
    trial = replace(trial, reason=last.hindrance)
    fails = last.outcome == FAILS and far[farthest] > goes_from(start.model)
    if fails or (last.outcome == MOVING and is_driven(start, run)):
        order = np.argsort(-far, kind="stable")
        together = order[far[order] >= TOGETHER * far[farthest]]
        blocks = tuple(names[block] for block in together)
        return replace(trial, verdict=FAILED, blocks=blocks)
    return trial


def _unlimited(run: Run) -> tuple[str, ...]:
    """Return the bolts without a yield force that carry more at the end than their pretension."""
    bolts = run.model.bolts
    if not len(bolts):
        return ()
    force = np.abs(bolt_states(run.model, run.state).force)
    more = np.isinf(bolts.yield_force) & (force > bolts.pretension * (1.0 + 1e-3))
    owner = bolts.of_spring[more]
    worst = {int(k): float(force[more][owner == k].max()) for k in owner}
    return tuple(f"'{bolts.name[k]}' {most:.4g} N/m" for k, most in worst.items())


def is_driven(start: Settled, run: Run) -> bool:
    """Return whether a run that its time has ended was driven on at its end.

    For processes that carry no steps of any length.  A static step of length h moves a block by
    theta a h2, a being the acceleration of its unbalanced force.  It is driven on where a is more
    than a share of gravity and has not become less in the last third of the time.
    """
    model, step = start.model, float(run.step_sizes[-1])
    instants = [run.times[-1] - share * (run.times[-1] - run.times[0]) for share in (2 / 3, 1 / 3)]
    frames = [run.frame(at=float(one)).number for one in instants]
    places = [run.vertices(frame) for frame in (*frames, -1)]
    times = np.array([*(run.times[frame] for frame in frames), run.times[-1]])
    if not (np.diff(times) > 0.0).all():
        return False
    speeds = [
        float(moved(model, places[k], places[k + 1]).max()) / float(times[k + 1] - times[k])
        for k in range(2)
    ]
    least = AT_REST_RATIO * model.usual_gravity * start.method.integrator.theta * step
    # Speed in the last third of a trial, over that before, that has not become less
    return speeds[1] > least and speeds[1] >= 0.9 * speeds[0]


def moved(model: Model, before: Floats, after: Floats) -> Floats:
    """Return how far each block has moved, m, shape (n,), between vertices (nv, 2), m."""
    start = model.block_start
    displacement = np.add.reduceat(after - before, start[:-1], axis=0) / np.diff(start)[:, None]
    return np.where(model.fixed, 0.0, np.hypot(*displacement.T))
