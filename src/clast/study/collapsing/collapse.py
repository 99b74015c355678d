"""Factor of safety and collapse load: trials in a folder or in memory, and their result.

clast.factor_of_safety("slope.toml", joints=["bedding"]).value
clast.collapse_load("arch.toml", "pga").value
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from clast.case.api import case_of
from clast.case.case_file import Case
from clast.case.script import ModelBuilder
from clast.errors import CaseError
from clast.model.model import Model
from clast.rockmass.drawings.drawing_files import write_rows
from clast.study.collapsing.reduction import Reduction, reduction
from clast.study.collapsing.search import (
    AFTER_MOVING,
    FAILED,
    STANDS,
    UNDECIDED,
    FactorBracket,
    FactorSettings,
    Trial,
    bracket_of,
    search_factor,
    trial_of,
)
from clast.study.collapsing.support_forces import SupportForce, write_supports
from clast.study.collapsing.trial import (
    Settled,
    largest_of,
    over_weight,
    run_trial,
    settle_standing,
    trial_content,
)
from clast.study.description import COLLAPSE, Description
from clast.study.folder import CASE, DONE, RUN_FILE, StudyFolder, write_whole
from clast.study.parameters import content_of

MOVES_FROM = 1.05
"""Ratio of the answer to the largest factor that moves nothing from which movement is told of."""
Watch = Callable[[int, Trial], None]
Given = str | Path | Case | ModelBuilder | Model
"""Types that a script may give for a case."""


@dataclass(frozen=True, kw_only=True)
class Collapse(FactorBracket):
    """The factor with which blocks fail, as a bracket of trials."""

    trials: tuple[Trial, ...]
    by: Reduction
    """The quantity that the factor multiplies or divides."""
    tolerance: float
    """Width of the bracket that was asked for, as a share of its upper end."""
    folder: Path | None = None
    """Where the study is kept; None: in memory."""
    over_weight: float = 0.0
    """A load with factor 1 over the weight of all blocks; 0 of other quantities."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Doubts about the state from which the trials begin, and about the answer."""
        texts = [text for one in self.trials for text in one.warnings]
        for one in self.trials:
            if one.bolts and (one.factor, one.verdict) == (self.low, STANDS):
                texts.append(
                    f"bolts carry more than their pretension with {self.by.SYMBOL} = "
                    f"{one.factor:.6g}, and have no yield_force: {listed(one.bolts, 5)}. "
                    "The answer counts on these forces: give the kind a yield_force, or "
                    'hold the pretension: pretension_is = "jacked"'
                )
        still = (
            one.factor
            for one in self.trials
            if one.verdict == STANDS and AFTER_MOVING not in one.warnings
        )
        if max(still, default=0.0) >= self.low / MOVES_FROM:
            texts = [text for text in texts if text != AFTER_MOVING]
        return tuple(dict.fromkeys(texts))

    @property
    def supports(self) -> tuple[SupportForce, ...]:
        """Forces of anchors, linings and links in the last trial that stands."""
        for one in self.trials:
            if (one.factor, one.verdict) == (self.low, STANDS):
                return one.supports
        return ()

    @property
    def is_settled(self) -> bool:
        """Whether the bracket is closed and as narrow as was asked for."""
        return self.width <= self.tolerance * (1.0 + 1e-9)

    @property
    def sentence(self) -> str:
        """The answer in words, with its reservations."""
        text = self.describe(self.by.TITLE)
        if self.over_weight and math.isinf(self.high) and self.low:
            share = f"{self.low * self.over_weight:.3g}"
            text += f", where the load is {share} times the weight of all blocks that can move"
        return text

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        return {
            "what": self.by.TITLE,
            "value": self.value if self.is_closed else None,
            "low": self.low,
            "high": self.high if math.isfinite(self.high) else None,
            "undecided": list(self.undecided),
            "settled": self.is_settled,
            "sentence": self.sentence,
            "warnings": list(self.warnings),
            "supports": [dict(vars(one)) for one in self.supports],
            "trials": [one.as_dict() for one in self.trials],
            "folder": None if self.folder is None else str(self.folder),
        }

    def __repr__(self) -> str:
        return f"Collapse({self.sentence}; {len(self.trials)} trials)"


def factor_of_safety(
    case: Given,
    *,
    joints: Sequence[str] = (),
    tolerance: float = 0.01,
    folder: str | Path | None = None,
    watch: Watch | None = None,
    start: float | None = None,
    growth: float | None = None,
    refine: int = 0,
) -> Collapse:
    """Return the factor by which the strengths of joints may be divided until blocks fail.

    Cohesion, tensile strength and tan(phi) of all joints, or of ``joints``.  ``case`` is a file, a
    case, a builder or its model.  Raises CaseError for a case that cannot be used, and where its
    blocks do not come to rest.

    Args:
        case: Name of a case file, ``clast.load(file)``, a ModelBuilder or ``builder.build()``.
        joints: Names of the joints whose strength is reduced; none: all.
        tolerance: Relative width of the final bracket.
        folder: Keeps all trials, and goes on with those that are there.
        watch: Called with the number and the result of each trial.
        start: First factor; None: 1.
        growth: By how much the next ones grow until one fails; None: 1.25.
        refine: More trials at equal distances near the bracket, for the curve of displacements.
    """
    given = FactorSettings(
        joints=_names(joints), tolerance=tolerance, start=start, growth=growth, refine=refine
    )
    return collapse(case_of(case), given, folder, watch)


def collapse_load(
    case: Given,
    by: str,
    *,
    tolerance: float = 0.01,
    folder: str | Path | None = None,
    watch: Watch | None = None,
    start: float | None = None,
    growth: float | None = None,
    refine: int = 0,
) -> Collapse:
    """Return the factor of gravity, of a load, or of a push on all blocks, with which blocks fail.

    ``by`` is "gravity", "load NAME", "pga" (a push to the right of so much of the weight) or "pga
    left"; all else as in ``factor_of_safety``, but for ``start`` (1, of pga 0.1) and ``growth``
    (2), None by default.
    """
    given = FactorSettings(by=by, tolerance=tolerance, start=start, growth=growth, refine=refine)
    return collapse(case_of(case), given, folder, watch)


def collapse(
    case: Case, how: FactorSettings, folder: str | Path | None = None, watch: Watch | None = None
) -> Collapse:
    """Return the factor with which the blocks of a case fail; raises CaseError as above."""
    by = reduction(how.by, how.joints)
    by.check(content_of(case))
    how.of(by)  # NaN and infinity are rejected before any run
    if not (isinstance(how.refine, int) and 0 <= how.refine <= 500):
        what = f"{how.refine!r} is not a valid number of trials"
        raise CaseError(what, where="refine", remedy="give 0 to 500")
    if folder is None:
        return TrialMaker(case=case, how=how, watch=watch).all()
    kept = StudyFolder.made(Path(folder), case, Description(kind=COLLAPSE, factor=how).checked())
    return go_on(kept, watch)


def go_on(folder: StudyFolder, watch: Watch | None = None) -> Collapse:
    """Go on with the trials in a folder; return their result."""
    how = folder.study.factor or FactorSettings()
    with folder.driven():
        result = TrialMaker(case=folder.base, how=how, watch=watch, folder=folder).all()
        heads = ["trial", "factor", "verdict", "displacement", "block", "steps", "reason"]
        rows = (
            [k, one.factor, one.verdict, one.displacement, one.mover, one.steps, one.reason]
            for k, one in enumerate(result.trials, 1)
        )
        write_rows(folder.path / "trials.csv", [heads, *rows])
        if result.supports:
            write_supports(folder.path, result.supports)
        kept = [*ends(result), *undecided(result)]
        for number in range(1, len(result.trials) + 1):
            if number not in kept and folder.study.keep != "all":
                for file in folder.place(number).glob("run*"):
                    file.unlink()
    return result


@dataclass(kw_only=True)
class TrialMaker:
    """Makes the trials of a study of collapse."""

    case: Case
    how: FactorSettings
    watch: Watch | None = None
    folder: StudyFolder | None = None
    """Where trials are kept; None: nowhere."""

    @cached_property
    def by(self) -> Reduction:
        """The quantity that the factor multiplies or divides."""
        return reduction(self.how.by, self.how.joints)

    @cached_property
    def start(self) -> Settled:
        """The state from which all trials begin."""
        return settle_standing(self.case, self.by)

    def all(self) -> Collapse:
        """Return the result of all trials."""
        share = over_weight(self.case, self.by)
        trials = search_factor(self.how.of(self.by), self.trial, largest_of(share))
        for factor in self._more(bracket_of(trials)):
            trials += (self.trial(len(trials) + 1, factor),)
        return Collapse(
            **vars(bracket_of(trials)),
            trials=trials,
            by=self.by,
            tolerance=self.how.tolerance,
            over_weight=share,
            folder=None if self.folder is None else self.folder.path,
        )

    def trial(self, number: int, factor: float) -> Trial:
        """Return the result of a trial: the one on disk, or a new one."""
        trial = self._written(number, factor) or self._made(number, factor)
        if self.watch is not None:
            self.watch(number, trial)
        return trial

    def _more(self, bracket: FactorBracket) -> list[float]:
        """Return the factors of more trials near the bracket."""
        count = self.how.refine
        if not count or not bracket.is_closed:
            return []
        # How far more trials reach on both sides of the bracket, in units of the tolerance
        reach = 5.0 * self.how.tolerance * bracket.high
        low, high = max(0.0, bracket.low - reach), bracket.high + reach
        return [low + (high - low) * (k + 1) / (count + 1) for k in range(count)]

    def _written(self, number: int, factor: float) -> Trial | None:
        """Return a trial that is in the folder."""
        result = None if self.folder is None else self.folder.result(number)
        trial = None if result is None else trial_of(result["trial"])
        return trial if trial is not None and trial.factor == factor else None

    def _made(self, number: int, factor: float) -> Trial:
        """Return a trial that is made now, and written down."""
        start = self.start
        if self.folder is None:
            return run_trial(start, self.by, factor)
        with self.folder.making(number) as part:
            trial = run_trial(start, self.by, factor, part / RUN_FILE)
            content = trial_content(start.content, self.by, factor, 3 if trial.longer else 1)
            write_whole(part / CASE, self.folder.case_text(content))
            plain = {"run": number, "status": DONE, "parameters": {}, "trial": trial.as_dict()}
            self.folder.write_result(part, plain)
        return trial


def listed(names: Sequence[str], most: int) -> str:
    """Return the first names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def ends(result: Collapse) -> list[int]:
    """Return the numbers of the last trial that stands and the first that fails, from 1."""
    wanted = ((result.low, STANDS), (result.high, FAILED))
    return [
        k
        for factor, verdict in wanted
        for k, one in enumerate(result.trials, 1)
        if one.factor == factor and one.verdict == verdict
    ]


def undecided(result: Collapse) -> list[int]:
    """Return the numbers of the trials that are undecided, from 1."""
    return [k for k, one in enumerate(result.trials, 1) if one.verdict == UNDECIDED]


def _names(joints: Any) -> tuple[str, ...]:
    if isinstance(joints, str) or not all(isinstance(one, str) for one in joints):
        raise CaseError(
            f"{joints!r} are not names of joints", where="joints", remedy='e.g. joints=["bedding"]'
        )
    return tuple(joints)
