"""Distributions of spacings and lengths, in m, above 0, and their checks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.distributions import Lognormal, Values
from clast.model.model import Floats


class Spacing(Protocol):
    """The distribution of a spacing or a length: most of clast.model.distributions."""

    @property
    def mean(self) -> float:
        """Mean, m."""
        ...

    @property
    def large(self) -> float:
        """A value that is hardly ever exceeded, m."""
        ...

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m, above 0; ``first`` have been drawn before them."""
        ...


@dataclass(frozen=True)
class Fixed:
    """Always the same value."""

    value: float
    """Value, m."""

    @property
    def mean(self) -> float:
        """The value, m."""
        return float(self.value)

    @property
    def large(self) -> float:
        """The value, m."""
        return float(self.value)

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return the value (count,) times, m."""
        return np.full(count, float(self.value))


@dataclass(frozen=True, kw_only=True)
class Scaled:
    """Another distribution times a factor: true spacings as a section shows them."""

    spread: Spacing
    """The distribution to scale."""
    factor: float
    """Factor, -."""

    @property
    def mean(self) -> float:
        """Mean, m."""
        return self.factor * self.spread.mean

    @property
    def large(self) -> float:
        """A value that is hardly ever exceeded, m."""
        return self.factor * self.spread.large

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m."""
        return self.factor * self.spread.draw(rng, count, first)


def check_spacing(spread: Spacing, where: str) -> None:
    """Raise ModelError for numbers that the distribution of a spacing or a length cannot have."""

    def refuse(what: str, where: str, remedy: str) -> None:
        raise ModelError(what, where=where, remedy=remedy)

    numbers = vars(spread) if hasattr(spread, "__dict__") else {}
    if isinstance(spread, Fixed):
        _check_positive(spread.value, where)
    elif isinstance(spread, Values):
        if len(spread.values) == 0:
            refuse("is an empty list", where, "give values in m")
        for number, value in enumerate(spread.values, 1):
            _check_positive(value, f"{where}, value {number}")
    elif not all(hasattr(type(spread), name) for name in ("large", "draw")):
        what = f"{shortened(repr(spread))} is not a distribution of spacings or lengths"
        refuse(what, where, "give a number, or e.g. Lognormal(mean=2.0, sd=0.5)")
    for name in ("low", "high", "mean"):
        if numbers.get(name) is not None:
            _check_positive(numbers[name], f"{where}, {name}")
    low, high = numbers.get("low"), numbers.get("high")
    if low is not None and high is not None and high < low:
        refuse(f"high {high:g} is below low {low:g}", where, "swap")
    if "sd" in numbers:
        sd = numbers["sd"]
        if not isinstance(sd, int | float | np.number) or not 0.0 <= sd < math.inf:
            what = f"{shortened(repr(sd))} is not a standard deviation"
            refuse(what, f"{where}, sd", "give 0 or more, in m")
        if isinstance(spread, Lognormal) and sd > 100.0 * spread.mean:
            refuse(
                f"{sd:g} is more than 100 times the mean: nearly all values would be close to zero",
                f"{where}, sd",
                "give the standard deviation of the values, not of their logarithms, in m",
            )


def _check_positive(value: Any, where: str) -> None:
    if not isinstance(value, int | float | np.number) or not 0.0 < value < math.inf:
        what = f"{shortened(repr(value))} must be a number above 0"
        remedy = "give it in m; for a set without end in that direction, leave the key out"
        raise ModelError(what, where=where, remedy=remedy)
    ranges.check_size(float(value), ranges.LENGTH, where, "give m")


def number_or(value: float | Spacing | None) -> Spacing | None:
    """Return a number as a fixed distribution, a distribution or None as it is."""
    return Fixed(float(value)) if isinstance(value, int | float | np.number) else value


def running(spread: Spacing, rng: np.random.Generator, reach: float) -> Floats:
    """Return the sums 0 < s1 < s2 ... of values up to the first beyond ``reach``, m, shape (k,)."""
    if reach <= 0.0:
        return spread.draw(rng, 1)
    parts: list[Floats] = []
    total, drawn = 0.0, 0
    while total <= reach:
        count = int(1.1 * (reach - total) / spread.mean) + 8
        sums = total + np.cumsum(spread.draw(rng, count, drawn))
        parts.append(sums)
        total, drawn = float(sums[-1]), drawn + count
    sums = np.concatenate(parts)
    return sums[: int(np.searchsorted(sums, reach, side="right")) + 1]
