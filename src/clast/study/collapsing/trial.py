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
from clast.run.stages.failure_verdict import Scales
from clast.step.method import Method, is_stable_for_any_step
from clast.study.collapsing.reduction import Reduction, staged
from clast.study.parameters import Content, changed, content_of

if TYPE_CHECKING:
    from clast.run.run_state import RunState
import math
from collections.abc import Callable, Sequence

STANDS, FAILED, UNDECIDED = "stands", "fails", "undecided"
"""Verdicts."""
LONGER = 3
"""By how much a trial is longer that was undecided."""
AT_REST = 5e-4
"""Unbalanced acceleration over gravity below which blocks are not driven."""
STEADY = 0.9
"""Speed in the last third of a trial, as a share of that before, that has not become less."""
STRIDE = 0.05
"""Movement in a step of a trial, in units of that from which blocks fail, at most."""
TOGETHER = 0.5
"""Movement, in units of the largest, of the blocks that fail."""
LISTS = ("blocks", "warnings", "bolts")
"""Parts of a trial that are lists."""
MORE = 1e-3
"""Force of a bolt above its pretension, as a share of it, from which it carries more."""
LEAST_BASE = 1.0 / 64.0
"""Least factor at which blocks are let settle where they do not stand at 1."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """The result of a trial."""

    factor: float
    """Its factor."""
    verdict: str
    """"stands", "fails" or "undecided"."""
    displacement: float
    """Largest movement of a block since the blocks came to rest, m."""
    mover: str
    """Block that has moved farthest; "" where none has."""
    blocks: tuple[str, ...] = ()
    """Blocks that fail, the one that moves most first."""
    steps: int = 0
    """Steps of the trial."""
    longer: bool = False
    """True where it was undecided at first, and tried again."""
    reason: str = ""
    """The condition of equilibrium that fails, or why the run could not go on; "" where it
    stands."""
    warnings: tuple[str, ...] = ()
    """Doubts about the state from which it begins."""
    bolts: tuple[str, ...] = ()
    """Bolts without a yield force that carry more than their pretension, each with its force."""

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        return {**vars(self), **{name: list(getattr(self, name)) for name in LISTS}}


@dataclass(frozen=True, kw_only=True)
class Settled:
    """A case whose blocks have come to rest, from where all trials begin."""

    case: Case
    """The case, without stages of the study."""
    content: Content
    """Its tables."""
    model: Model
    """Its blocks."""
    method: Method
    """How it is simulated."""
    run: RunState
    """Data of the run at its end."""
    base: float
    """Factor with which the blocks came to rest."""
    record: StageRecord
    """How they did."""
    stages: tuple[StageRecord, ...] = ()
    """How the stages of the case itself ended."""
    trials: dict[int, tuple[Model, Schedule]] = field(default_factory=dict)
    """Parts of a trial -> model and schedule, where trials differ in strengths of joints alone."""

    @property
    def stands(self) -> bool:
        """Whether they have come to an equilibrium."""
        return self.record.outcome == REACHED

    @property
    def warnings(self) -> tuple[str, ...]:
        """Stages of the case without an equilibrium, from which all trials begin."""
        return tuple(
            f"stage '{one.name}' of the case ends without equilibrium, and every trial begins "
            "from what it leaves: see clast run"
            for one in self.stages
            if one.outcome in (FAILS, MOVING)
        )


def settled(case: Case, by: Reduction, base: float) -> Settled:
    """Return a case after its own stages and one in which its blocks come to rest.

    ``base`` is the factor that acts meanwhile.  Raises CaseError for a case that cannot be used.
    """
    content: Content = content_of(case)
    kept: list[RunState] = []

    def keep(now: RunState) -> None:
        kept[:] = [now]

    model = changed(case, staged(by.base(content, base))).model()
    content = in_short_steps(content, model)
    ready = changed(case, staged(by.base(content, base)))
    method, schedule = ready.method(model), replace(ready.schedule(), every=FOREVER)
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


def in_short_steps(content: Content, model: Model) -> Content:
    """Return the tables of a case with steps that cannot leap past an equilibrium.

    No step moves a block by more than a share of the movement from which blocks fail
    (decision 186).
    """
    longest = STRIDE * Scales.of(model).goes
    time = TimeTable.model_validate(content["time"])
    if time.largest_movement(model) <= longest:
        return content
    return {**content, "time": {**content["time"], "max_displacement": longest}}


def standing(case: Case, by: Reduction) -> Settled:
    """Return a case whose blocks have come to rest, with more strength where they need it.

    Raises CaseError where they do not stand with any.
    """
    base = 1.0
    while True:
        found = settled(case, by, base)
        if found.stands:
            return found
        base *= 0.5
        if not by.DIVIDES or base < LEAST_BASE:
            raise CaseError(
                "the blocks do not come to rest before the factor acts"
                + (f", nor with the factor {2.0 * base:g}" if by.DIVIDES else "")
                + f": {found.record.hindrance or found.record.outcome}",
                where=case.file,
                remedy=REMEDY + ("" if is_stable_for_any_step(found.method.process) else SLOW),
            )


REMEDY = "see the moving blocks: clast run; if they only need time, raise time.end"
SLOW = (
    ". This process needs many steps, the more the softer contacts are: give it passes and a "
    'normal_stiffness, or leave statics to process = "convex"'
)
FOREVER = 1e9
"""Time between frames of which only the first and the last are wanted, s."""


def tried(
    start: Settled, by: Reduction, factor: float, output: Path | None = None, *, parts: int = 1
) -> tuple[Trial, Run]:
    """Return the result of a trial, and its run.

    Its result file is written to ``output``.  An undecided trial is tried again, longer.
    """
    model, schedule = trial_model(start, by, factor, parts)
    third = schedule.stages[-1].time or schedule.end
    schedule = replace(schedule, every=third / 3.0)
    text = "" if output is None else to_toml(trial_content(start.content, by, factor, parts))
    recorder = RunRecorder(model, case_text=text, output=output, contacts=output is not None)
    run = _simulated(model, start.method, schedule, recorder, begin=start.run)
    trial = _judged(start, run, factor, parts)
    if trial.verdict == UNDECIDED and parts == 1:
        return tried(start, by, factor, output, parts=LONGER)
    return trial, run


def trial_model(start: Settled, by: Reduction, factor: float, parts: int) -> tuple[Model, Schedule]:
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
        return replace(trial, verdict=STANDS)
    trial = replace(trial, reason=last.hindrance)
    fails = last.outcome == FAILS and far[farthest] > Scales.of(start.model).goes
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
    more = np.isinf(bolts.yield_force) & (force > bolts.pretension * (1.0 + MORE))
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
    least = AT_REST * model.usual_gravity * start.method.integrator.theta * step
    return speeds[1] > least and speeds[1] >= STEADY * speeds[0]


def moved(model: Model, before: Floats, after: Floats) -> Floats:
    """Return how far each block has moved, m, shape (n,), between vertices (nv, 2), m."""
    start = model.block_start
    way = np.add.reduceat(after - before, start[:-1], axis=0) / np.diff(start)[:, None]
    return np.where(model.fixed, 0.0, np.hypot(*way.T))


def as_plain(trial: Any) -> Trial | None:
    """Return the trial that ``Trial.as_dict`` gave; None where a value is of another kind."""
    try:
        lists = {name: tuple(trial.get(name, ())) for name in LISTS}
        found = Trial(**{**trial, **lists})
    except (AttributeError, TypeError):
        return None
    like = vars(Trial(factor=0.0, verdict="", displacement=0.0, mover=""))
    kinds = all(
        type(value) is type(like[name]) or (type(value) is int and type(like[name]) is float)
        for name, value in vars(found).items()
    )
    texts = all(isinstance(one, str) for name in LISTS for one in getattr(found, name))
    return found if kinds and texts and found.verdict in (STANDS, FAILED, UNDECIDED) else None


MOST_TRIALS = 100
"""Most trials of a search."""


@dataclass(frozen=True, kw_only=True)
class FactorSearch:
    """Where and how well a factor is looked for."""

    start: float
    """First factor that is tried."""
    growth: float
    """By how much the next ones are larger, or smaller, until the bracket is closed; above 1."""
    tolerance: float = 0.01
    """Width of the bracket, as a share of its upper end, that is narrow enough."""
    least: float = 1e-4
    """No smaller factors are tried, in units of ``start``."""
    most: float = 1e3
    """No larger factors are tried, in units of ``start``."""

    def __post_init__(self) -> None:
        for name, low, high in (("start", 0.0, 1e12), ("tolerance", 1e-6, 0.5)):
            value = getattr(self, name)
            if not (isinstance(value, int | float) and low < value < high):
                raise CaseError(
                    f"{value!r} is not a valid {name}",
                    where=name,
                    remedy=f"give a number between {low:g} and {high:g}",
                )
        if not 1.01 <= self.growth <= 100.0:
            raise CaseError(
                f"{self.growth!r} is not a valid growth from trial to trial",
                where="growth",
                remedy="give a number from 1.01 to 100, e.g. 1.25",
            )


@dataclass(frozen=True, kw_only=True)
class FactorBracket:
    """The bracket of the factor at which blocks fail, from the trials."""

    low: float
    """Largest factor with which they stand; 0 where they stand with none that was tried."""
    high: float
    """Least factor with which they fail; inf where they fail with none that was tried."""
    undecided: tuple[float, ...] = ()
    """Factors between the two that are neither."""

    @property
    def value(self) -> float:
        """The lower end: the answer where the bracket is closed."""
        return self.low

    @property
    def is_closed(self) -> bool:
        """Whether both ends were found."""
        return self.low > 0.0 and math.isfinite(self.high)

    def width(self) -> float:
        """Return the width as a share of the upper end."""
        return (self.high - self.low) / self.high if self.is_closed else math.inf

    def sentence(self, title: str) -> str:
        """Return the answer in words, with its reservations; ``title`` says of which factor."""
        if math.isinf(self.high):
            if self.low == 0.0:
                return f"{title} unknown: every trial is undecided"
            return f"{title} at least {self.low:.6g}: no failure was found up to there"
        if self.low == 0.0:
            return f"{title} below {self.high:.6g}: the blocks stand with nothing that was tried"
        text = f"{title} {self.low:.4g}: stands with {self.low:.6g}, fails with {self.high:.6g}"
        if self.undecided:
            listed = ", ".join(f"{one:.6g}" for one in self.undecided)
            text += f"; undecided with {listed}, also three times as long"
        return text


def bracket_of(trials: Sequence[Trial]) -> FactorBracket:
    """Return the bracket that trials leave."""
    failed = [one.factor for one in trials if one.verdict == FAILED]
    high = min(failed, default=math.inf)
    low = max((t.factor for t in trials if t.verdict == STANDS and t.factor < high), default=0.0)
    open_ = sorted(t.factor for t in trials if t.verdict == UNDECIDED and low < t.factor < high)
    return FactorBracket(low=low, high=high, undecided=tuple(open_))


def next_factor(search: FactorSearch, trials: Sequence[Trial]) -> float | None:
    """Return the factor to try next; None where enough is known, or no more can be."""
    if not trials:
        return search.start
    if len(trials) >= MOST_TRIALS:
        return None
    found = bracket_of(trials)
    tried = [one.factor for one in trials]
    if math.isinf(found.high):
        factor = max(tried) * search.growth
        return factor if factor <= search.most * search.start * (1.0 + 1e-9) else None
    if found.low == 0.0:
        # the steps down grow: a limit may be anywhere below
        factor = min(tried) / search.growth ** (1 + sum(one < search.start for one in tried))
        return factor if factor >= search.least * search.start else None
    enough = search.tolerance * found.high
    ends = [found.low, *found.undecided, found.high]
    # the gaps that touch what stands and what fails; between undecided ones nothing is to be known
    gaps = [(ends[1] - ends[0], ends[0], ends[1]), (ends[-1] - ends[-2], ends[-2], ends[-1])]
    width, below, above = max(gaps)
    return 0.5 * (below + above) if width > enough else None


@dataclass
class Trials:
    """Makes the trials of a search, each once, in their order."""

    search: FactorSearch
    make: Callable[[int, float], Trial]
    """Makes the trial of a number, from 1, with a factor."""
    done: list[Trial] = field(default_factory=list)

    def all(self) -> FactorBracket:
        """Return the bracket when all trials have been made."""
        while (factor := next_factor(self.search, self.done)) is not None:
            self.done.append(self.make(len(self.done) + 1, factor))
        return bracket_of(self.done)
