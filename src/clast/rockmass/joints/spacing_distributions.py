"""Distributions of spacings and lengths, in m, above 0, and their checks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from clast.errors import ModelError, shortened
from clast.model import ranges
from clast.model.model import Floats

FAR = 4.0
"""Values further than this many standard deviations above the mean are not counted on."""
WIDEST = 100.0
"""Largest standard deviation of a lognormal distribution, as a multiple of its mean."""


class Distribution(Protocol):
    """The distribution of a spacing or a length."""

    @property
    def mean(self) -> float:
        """Return the mean, m."""
        ...

    @property
    def large(self) -> float:
        """Return a value that is hardly ever exceeded, m."""
        ...

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m, above 0; ``first`` have been drawn before them."""
        ...

    def check(self, where: str) -> None:
        """Raise ModelError for numbers that it cannot have."""
        ...


def _refuse(fault: bool, what: str, where: str, remedy: str) -> None:
    if fault:
        raise ModelError(what, where=where, remedy=remedy)


def _positive(value: Any, where: str) -> None:
    number = value if isinstance(value, int | float | np.number) else math.nan
    _refuse(
        not 0.0 < number < math.inf,
        f"{shortened(repr(value))} must be a number above 0",
        where,
        "give it in m; for a set without end in that direction, leave the key out",
    )
    ranges.check_size(float(number), ranges.LENGTH, where, "give m")


def _deviation(value: Any, where: str) -> None:
    number = value if isinstance(value, int | float | np.number) else math.nan
    _refuse(
        not 0.0 <= number < math.inf,
        f"{shortened(repr(value))} is not a standard deviation",
        f"{where}, std",
        "give 0 or more, in m",
    )


@dataclass(frozen=True)
class Fixed:
    """Always the same value."""

    value: float
    """Value, m."""

    @property
    def mean(self) -> float:
        """Return the value, m."""
        return float(self.value)

    @property
    def large(self) -> float:
        """Return the value, m."""
        return float(self.value)

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return the value (count,) times, m."""
        return np.full(count, float(self.value))

    def check(self, where: str) -> None:
        """Refuse values that are not above 0."""
        _positive(self.value, where)


@dataclass(frozen=True, kw_only=True)
class Uniform:
    """Any value between two, equally likely."""

    low: float
    """Smallest, m."""
    high: float
    """Largest, m."""

    @property
    def mean(self) -> float:
        """Return the mean, m."""
        return 0.5 * (self.low + self.high)

    @property
    def large(self) -> float:
        """Return the largest, m."""
        return self.high

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m."""
        return rng.uniform(self.low, self.high, count)

    def check(self, where: str) -> None:
        """Refuse bounds that are not above 0, or in the wrong order."""
        _positive(self.low, f"{where}, low")
        _positive(self.high, f"{where}, high")
        _refuse(
            self.high < self.low, f"high {self.high:g} is below low {self.low:g}", where, "swap"
        )


@dataclass(frozen=True, kw_only=True)
class Normal:
    """Gauss' distribution, of which values of 0 and below are drawn again."""

    mean: float
    """Mean before that, m."""
    std: float
    """Standard deviation before that, m."""

    @property
    def large(self) -> float:
        """Return the mean and four standard deviations, m."""
        return self.mean + FAR * self.std

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m, above 0."""
        values = rng.normal(self.mean, self.std, count)
        while (low := values <= 0.0).any():
            values[low] = rng.normal(self.mean, self.std, int(low.sum()))
        return values

    def check(self, where: str) -> None:
        """Refuse means that are not above 0 and deviations below 0."""
        _positive(self.mean, f"{where}, mean")
        _deviation(self.std, where)


@dataclass(frozen=True, kw_only=True)
class Lognormal:
    """Values whose logarithms have Gauss' distribution; mean and std are those of the values.

    With s^2 = ln(1 + (std/mean)^2) and m = ln(mean) - s^2/2, ln(value) is normal(m, s).
    """

    mean: float
    """Mean of the values, m."""
    std: float
    """Standard deviation of the values, m."""

    @property
    def _log(self) -> tuple[float, float]:
        square = math.log1p((self.std / self.mean) ** 2)
        return math.log(self.mean) - 0.5 * square, math.sqrt(square)

    @property
    def large(self) -> float:
        """Return the value whose logarithm is four deviations above its mean, m."""
        mean, std = self._log
        return math.exp(mean + FAR * std)

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m."""
        return np.exp(rng.normal(*self._log, count))

    def check(self, where: str) -> None:
        """Refuse means that are not above 0 and deviations below 0."""
        _positive(self.mean, f"{where}, mean")
        _deviation(self.std, where)
        _refuse(
            self.std > WIDEST * self.mean,
            f"{self.std:g} is more than {WIDEST:g} times the mean: nearly all values would be "
            "close to zero",
            f"{where}, std",
            "give the standard deviation of the values, not of their logarithms, in m",
        )


@dataclass(frozen=True, kw_only=True)
class Exponential:
    """Distances between independent points (a Poisson process)."""

    mean: float
    """Mean, m."""

    @property
    def large(self) -> float:
        """Return ten times the mean, m."""
        return 10.0 * self.mean

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m."""
        return rng.exponential(self.mean, count)

    def check(self, where: str) -> None:
        """Refuse means that are not above 0."""
        _positive(self.mean, f"{where}, mean")


@dataclass(frozen=True, kw_only=True)
class Values:
    """Given values in their order, again and again; on both sides of the origin from the first."""

    values: Sequence[float]
    """Values, m."""

    @property
    def mean(self) -> float:
        """Return their mean, m."""
        return float(np.mean(self.values))

    @property
    def large(self) -> float:
        """Return the largest, m."""
        return float(np.max(self.values))

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return the next values (count,), m."""
        values = np.asarray(self.values, float)
        return values[(first + np.arange(count)) % len(values)]

    def check(self, where: str) -> None:
        """Refuse an empty list, and values that are not above 0."""
        _refuse(len(self.values) == 0, "is an empty list", where, "give values in m")
        for number, value in enumerate(self.values, 1):
            _positive(value, f"{where}, value {number}")


def distribution(value: float | Distribution) -> Distribution:
    """Return a number as the distribution that always gives it, and a distribution as it is."""
    return Fixed(float(value)) if isinstance(value, int | float | np.number) else value


def running(spread: Distribution, rng: np.random.Generator, reach: float) -> Floats:
    """Return the sums 0 < s1 < s2 ... of values up to the first beyond ``reach``, m, shape (k,)."""
    if reach <= 0.0:
        return spread.draw(rng, 1)
    found: list[Floats] = []
    total, drawn = 0.0, 0
    while total <= reach:
        count = int(1.1 * (reach - total) / spread.mean) + 8
        sums = total + np.cumsum(spread.draw(rng, count, drawn))
        found.append(sums)
        total, drawn = float(sums[-1]), drawn + count
    sums = np.concatenate(found)
    return sums[: int(np.searchsorted(sums, reach, side="right")) + 1]


@dataclass(frozen=True, kw_only=True)
class Scaled:
    """Another distribution times a factor: true spacings as a section shows them."""

    spread: Distribution
    """The distribution to scale."""
    factor: float
    """Factor, -."""

    @property
    def mean(self) -> float:
        """Return the mean, m."""
        return self.factor * self.spread.mean

    @property
    def large(self) -> float:
        """Return a value that is hardly ever exceeded, m."""
        return self.factor * self.spread.large

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m."""
        return self.factor * self.spread.draw(rng, count, first)

    def check(self, where: str) -> None:
        """Refuse numbers that the scaled distribution refuses."""
        self.spread.check(where)
