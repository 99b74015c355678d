"""The search for a factor: its settings, the results of its trials, the bracket that they leave."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from clast.errors import CaseError
from clast.study.collapsing.reduction import Reduction
from clast.study.collapsing.support_forces import SupportForce, supports_of

STANDS, FAILED, UNDECIDED = "stands", "fails", "undecided"
AFTER_MOVING = (
    "in some trials that stand, blocks come to rest only after moving by more than 1 % of their "
    "size, on bolts that stretch or against what lies before them. Limit equilibrium, which knows "
    "no movement, calls that failure: see the displacements of the trials"
)
"""Warning of a trial."""
LISTS = ("blocks", "warnings", "bolts")
"""Parts of a trial that are lists."""
TRIALS_MAX = 100
"""Trials of a search, at most."""
FACTOR_RATIO_MIN, FACTOR_RATIO_MAX = 1e-4, 1e3
"""Least and largest factor that is tried, over the first one; a small load goes on beyond."""
GROWTH_BEYOND = 16.0
"""Growth from trial to trial beyond the largest factor."""


@dataclass(frozen=True, kw_only=True)
class FactorSettings:
    """How a factor of safety, or a load at collapse, is looked for."""

    by: str = "strength"
    """The quantity of the factor: strength, gravity, "load NAME", pga, "pga left"."""
    joints: tuple[str, ...] = ()
    """Joints whose strength is reduced; none: all."""
    start: float | None = None
    """First factor; None: 1, of pga 0.1."""
    growth: float | None = None
    """By how much the next ones grow until one fails; None: 1.25 of strengths, else 2."""
    tolerance: float = 0.01
    """Relative width of the final bracket."""
    refine: int = 0
    """More trials at equal distances near the bracket, for the curve of displacements."""

    def of(self, by: Reduction) -> FactorSettings:
        """Return them with the numbers of a reduction; raises CaseError for wrong ones."""
        start = by.START if self.start is None else self.start
        growth = by.GROWTH if self.growth is None else self.growth
        for name, value, low, high in (
            ("start", start, 0.0, 1e12),
            ("tolerance", self.tolerance, 1e-6, 0.5),
        ):
            if not (isinstance(value, int | float) and low < value < high):
                remedy = f"give a number between {low:g} and {high:g}"
                raise CaseError(f"{value!r} is not a valid {name}", where=name, remedy=remedy)
        if not 1.01 <= growth <= 100.0:
            what = f"{growth!r} is not a valid growth from trial to trial"
            remedy = "give a number from 1.01 to 100, e.g. 1.25"
            raise CaseError(what, where="growth", remedy=remedy)
        return replace(self, start=start, growth=growth)


@dataclass(frozen=True, kw_only=True)
class Trial:
    """The result of a trial."""

    factor: float
    verdict: str
    """"stands", "fails" or "undecided"."""
    displacement: float
    """Largest movement of a block since the blocks came to rest, m."""
    mover: str
    """Block that has moved farthest; "" where none has."""
    blocks: tuple[str, ...] = ()
    steps: int = 0
    longer: bool = False
    """True where it was undecided at first, and tried again."""
    reason: str = ""
    """The condition of equilibrium that fails, or why the run could not go on; "" where it
    stands."""
    warnings: tuple[str, ...] = ()
    """Doubts about the state from which it begins."""
    bolts: tuple[str, ...] = ()
    """Bolts without a yield force that carry more than their pretension, each with its force."""
    supports: tuple[SupportForce, ...] = ()
    """Forces of anchors, linings and links at its end, where it stands."""

    def as_dict(self) -> dict[str, Any]:
        """Return it ready for JSON."""
        lists = {name: list(getattr(self, name)) for name in LISTS}
        return {**vars(self), **lists, "supports": [dict(vars(one)) for one in self.supports]}


def trial_of(content: Any) -> Trial | None:
    """Return the trial that ``Trial.as_dict`` gave; None where a value is of another kind."""
    try:
        lists: dict[str, Any] = {name: tuple(content.get(name, ())) for name in LISTS}
        lists["supports"] = supports_of(content)
        trial = Trial(**{**content, **lists})
    except (AttributeError, TypeError):
        return None
    like = vars(Trial(factor=0.0, verdict="", displacement=0.0, mover=""))
    kinds = all(
        type(value) is type(like[name]) or (type(value) is int and type(like[name]) is float)
        for name, value in vars(trial).items()
    )
    texts = all(isinstance(one, str) for name in LISTS for one in getattr(trial, name))
    return trial if kinds and texts and trial.verdict in (STANDS, FAILED, UNDECIDED) else None


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
    def is_closed(self) -> bool:
        """Whether both ends were found."""
        return self.low > 0.0 and math.isfinite(self.high)

    @property
    def value(self) -> float:
        """The answer: the lower end of the bracket; nan where an end is open."""
        return self.low if self.is_closed else math.nan

    @property
    def width(self) -> float:
        """Width as a fraction of the upper end."""
        return (self.high - self.low) / self.high if self.is_closed else math.inf

    def describe(self, title: str) -> str:
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


def next_factor(
    search: FactorSettings, trials: Sequence[Trial], beyond: float = 0.0
) -> float | None:
    """Return the factor to try next; None where enough is known, or no more can be.

    ``beyond`` is the largest one, where that is more than usual.
    """
    start, growth = search.start or 0.0, search.growth or 0.0
    if not trials:
        return start
    if len(trials) >= TRIALS_MAX:
        return None
    bracket = bracket_of(trials)
    tried = [one.factor for one in trials]
    if math.isinf(bracket.high):
        factor, most = max(tried) * growth, FACTOR_RATIO_MAX * start * (1.0 + 1e-9)
        if factor > most:
            factor, most = max(tried) * GROWTH_BEYOND, beyond
        return factor if factor <= most else None
    if bracket.low == 0.0:
        # the steps down grow: a limit may be anywhere below
        factor = min(tried) / growth ** (1 + sum(one < start for one in tried))
        return factor if factor >= FACTOR_RATIO_MIN * start else None
    if bracket.high > max(GROWTH_BEYOND**0.5 * bracket.low, FACTOR_RATIO_MAX * start):
        if not bracket.undecided:
            return math.sqrt(bracket.low * bracket.high)
    ends = [bracket.low, *bracket.undecided, bracket.high]
    return next_between(ends, search.tolerance * bracket.high)


def next_between(ends: Sequence[float], enough: float) -> float | None:
    """Return the middle of the wider end of a bracket; None where both are narrow enough.

    ``ends`` are its two ends and the undecided values between them, ascending: only the gaps that
    touch an end tell anything.
    """
    gaps = [(ends[1] - ends[0], ends[0], ends[1]), (ends[-1] - ends[-2], ends[-2], ends[-1])]
    width, below, above = max(gaps)
    return 0.5 * (below + above) if width > enough else None


def search_factor(
    search: FactorSettings, make: Callable[[int, float], Trial], beyond: float = 0.0
) -> tuple[Trial, ...]:
    """Return the trials of a search; ``make`` gives that of a number, from 1, with a factor.

    ``beyond`` is the largest factor, where that is more than usual.
    """
    trials: list[Trial] = []
    while (factor := next_factor(search, trials, beyond)) is not None:
        trials.append(make(len(trials) + 1, factor))
    return tuple(trials)
