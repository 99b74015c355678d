"""Values of a parameter of a study, as texts: normal(35, 5, low=15, high=70), [20, 30, 40].

Distributions are those of clast.model.distributions; here are the ones of studies alone, and how
all of them are read from the command line and from files.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from clast.model.distribution_texts import DRAWN, read
from clast.model.distributions import (
    VALUES_MAX,
    Continuous,
    Distribution,
    Value,
    Values,
    fault,
    is_number,
    is_place,
)


@dataclass(frozen=True)
class Range(Continuous):
    """Values at equal distances, the first and the last included, each of which is run."""

    WORD: ClassVar[str] = "range"
    LISTED: ClassVar[bool] = True
    CONTINUOUS: ClassVar[bool] = False
    first: float
    last: float
    count: int
    """How many, at least 2."""

    def validate(self) -> None:
        """Raise CaseError for a count that is none."""
        super().validate()
        if not isinstance(self.count, int) or not 2 <= self.count <= VALUES_MAX:
            raise fault(
                self,
                "has no count from 2 to 1,000,000",
                "first, last and how many: range(20, 40, 5) is 20, 25, 30, 35, 40",
            )

    def __len__(self) -> int:
        return self.count

    def at(self, number: int) -> float:
        """Return a value by its number, from 0."""
        fraction = number / (self.count - 1)
        # 12 digits: 0.3 in place of 0.30000000000000004
        return float(f"{(1.0 - fraction) * self.first + fraction * self.last:.12g}")


@dataclass(frozen=True)
class Numbered(Distribution):
    """The number of the run: a seed of its own for each, as in ``domain.seed``."""

    WORD: ClassVar[str] = "numbered"
    CONTINUOUS: ClassVar[bool] = False
    first: int = 1
    """Value of the first run."""

    def validate(self) -> None:
        """Raise CaseError for a first number that is not a whole number."""
        if not isinstance(self.first, int) or isinstance(self.first, bool) or self.first < 0:
            raise fault(self, "has no whole number to begin with", "e.g. numbered(1)")


@dataclass(frozen=True)
class Times(Distribution):
    """The value of the case, multiplied by one from a distribution or a list."""

    WORD: ClassVar[str] = "times"
    factor: Distribution

    def validate(self) -> None:
        """Raise CaseError where the factor is none."""
        if not isinstance(self.factor, Distribution) or isinstance(self.factor, Times | Numbered):
            raise fault(self, "needs a distribution or a list", "e.g. times(normal(1, 0.1))")
        self.factor.validate()


@dataclass(frozen=True)
class Between(Distribution):
    """The range in which a target is sought: numbers, or places on the line between two."""

    WORD: ClassVar[str] = "between"
    CONTINUOUS: ClassVar[bool] = False
    first: Any
    """Number, or place (x, y)."""
    last: Any
    """Number, or place (x, y)."""

    def __post_init__(self) -> None:
        for name in ("first", "last"):
            value = getattr(self, name)
            value = value.tolist() if isinstance(value, np.ndarray) else value
            object.__setattr__(self, name, tuple(value) if isinstance(value, list) else value)

    def validate(self) -> None:
        """Raise CaseError where the ends are neither two numbers nor two places, or the same."""
        ends = (self.first, self.last)
        if not (
            all(map(is_number, ends)) or (all(map(is_place, ends)) and len({*map(len, ends)}) == 1)
        ):
            remedy = "e.g. between(0, 500e3), or between([14, 16], [17, 16])"
            raise fault(self, "needs two numbers, or two places [x, y]", remedy)
        if self.first == self.last:
            raise fault(self, f"goes from {self.first} to itself", "give two different ends")

    def quantile(self, p: float) -> Value:
        """Return the value at a share of the way, 0 <= p <= 1."""

        def at(first: float, last: float) -> float:
            return float(f"{(1.0 - p) * first + p * last:.12g}")

        if is_place(self.first):
            return tuple(map(at, self.first, self.last))
        return at(self.first, self.last)


KINDS: dict[str, type[Any]] = {
    **DRAWN,
    **{one.WORD: one for one in (Values, Range, Numbered, Times, Between)},
}


def value_text(value: Any) -> str:
    """Return a value of a parameter as text: 6 digits, of a place both."""
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(value_text, value))}]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def parsed(text: str, where: str) -> Distribution:
    """Return the distribution or list that a text says; raises CaseError as ``read`` does."""
    return read(text, where, KINDS)
