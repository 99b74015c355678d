"""The factor at which blocks fail: a bracket of trials, made narrower until it is known.

From a factor that stands the next ones grow by steps until one fails; then the bracket is bisected.
Its lower end is the answer: the largest factor with which the blocks were seen to stand.  A trial
that is undecided is neither end: the bracket is made narrower on both sides of it, and the
remainder is reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from clast.errors import CaseError
from clast.study.collapsing.trial import FAILED, STANDS, UNDECIDED, Trial

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
