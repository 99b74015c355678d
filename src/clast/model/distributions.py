"""Distributions of one number: of spacings and lengths of joints, m, and of parameters of studies.

Each is written as its class is called, in Python and, with small letters, in texts of studies:

    normal(35, 5, low=15, high=70)

Studies take the value that belongs to a probability p in (0, 1) (``quantile``), joint sets draw
values above 0 (``draw``).  Numbers are checked where they are used, for either purpose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from clast.errors import CaseError, shortened
from clast.model.model import Floats

Value = float | int | str | bool | tuple[float, ...]
"""A value that a key of a case may be set to; a tuple is a place (x, y) or another vector."""
VALUES_MAX = 1_000_000
"""Values of a list or a range, at most."""
QUADRATURE_POINTS = 4000
"""Points by which mean and standard deviation of a truncated distribution are integrated."""


class Distribution:
    """The distribution of a number, or a list of values."""

    WORD: ClassVar[str] = ""
    """Its name in texts."""
    LISTED: ClassVar[bool] = False
    """True where it is a list of values, each of which is run in a sweep."""
    CONTINUOUS: ClassVar[bool] = True
    """True where it may be correlated with others."""

    def __str__(self) -> str:
        # The numbers of a distribution as they are written, defaults left out.
        texts = []
        named = False
        for entry in fields(self):  # type: ignore[arg-type]
            value = getattr(self, entry.name)
            if value == entry.default:
                named = True
                continue
            text = str(value) if isinstance(value, Distribution) else _text(value)
            texts.append(f"{entry.name}={text}" if named else text)
        return f"{self.WORD}({', '.join(texts)})"

    def quantile(self, p: float) -> Value:
        """Return the value below which the variable lies with probability ``p``, 0 < p < 1."""
        raise NotImplementedError

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        p = (np.arange(QUADRATURE_POINTS) + 0.5) / QUADRATURE_POINTS
        values = np.array([self.quantile(float(one)) for one in p], np.float64)
        return float(values.mean()), float(values.std())

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m, above 0; ``first`` have been drawn before them.

        Values of 0 and below are drawn again.
        """
        values = self._drawn(rng, count)
        while (low := values <= 0.0).any():
            values[low] = self._drawn(rng, int(low.sum()))
        return values

    def _drawn(self, rng: np.random.Generator, count: int) -> Floats:
        return np.array([self.quantile(p) for p in rng.random(count).tolist()], np.float64)

    def validate(self) -> None:
        """Raise CaseError for numbers that a parameter of a study cannot have."""


@dataclass(frozen=True)
class Continuous(Distribution):
    """Distributions of all numbers between limits; their own numbers are floats."""

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if is_number(value) and entry.name != "count":
                object.__setattr__(self, entry.name, float(value))

    def validate(self) -> None:
        """Raise CaseError for a field that is no number, a spread of 0, limits out of order."""
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not is_number(value) and not (value is None and entry.default is None):
                raise fault(self, f"has {shortened(repr(value))} for {entry.name}", "give a number")
        low, high = getattr(self, "low", None), getattr(self, "high", None)
        if low is not None and high is not None and not low < high:
            raise fault(self, f"goes from {low:g} to {high:g}", "let low be less than high")

    def _check_positive(self, *names: str) -> None:
        for name in names:
            if not getattr(self, name) > 0.0:
                what = f"has {name} {getattr(self, name):g}, which is not positive"
                remedy = "give a positive number; set a constant value in the case"
                raise fault(self, what, remedy)


@dataclass(frozen=True)
class Truncated(Continuous):
    """Distributions of a normal score, which limits truncate."""

    mean: float
    """Mean of the variable itself before it is truncated."""
    sd: float
    """Standard deviation of the variable itself before it is truncated."""
    low: float | None = None
    """Least value; None: none."""
    high: float | None = None
    """Largest value; None: none."""

    def _score(self, x: float) -> float:
        """Return the normal score of a value."""
        raise NotImplementedError

    def _at_score(self, score: Any) -> Any:
        """Return the value of a normal score, or values of several."""
        raise NotImplementedError

    def validate(self) -> None:
        """Raise CaseError as above, and where the limits leave no probability."""
        super().validate()
        self._check_positive(*(("mean", "sd") if self.WORD == "lognormal" else ("sd",)))
        below, above = self._probabilities
        if not above - below > 1e-12:
            raise fault(self, "has no probability between its limits", "move low or high")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        from scipy import special

        below, above = self._probabilities
        value = float(self._at_score(float(special.ndtri(below + p * (above - below)))))
        value = value if self.low is None else max(value, self.low)
        return value if self.high is None else min(value, self.high)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        return super().moments if self._is_limited else (self.mean, self.sd)

    @property
    def large(self) -> float:
        """A value that is hardly ever exceeded."""
        # Values further than this many standard deviations above the mean are not counted on
        value = float(self._at_score(4.0))
        return value if self.high is None else min(value, self.high)

    @property
    def _is_limited(self) -> bool:
        return self.low is not None or self.high is not None

    @property
    def _probabilities(self) -> tuple[float, float]:
        """Probability below each of the limits."""
        from scipy import special

        below = 0.0 if self.low is None else float(special.ndtr(self._score(self.low)))
        above = 1.0 if self.high is None else float(special.ndtr(self._score(self.high)))
        return below, above


@dataclass(frozen=True)
class Normal(Truncated):
    """A normal distribution, truncated where limits are given."""

    WORD: ClassVar[str] = "normal"

    def _score(self, x: float) -> float:
        return (x - self.mean) / self.sd

    def _at_score(self, score: Any) -> Any:
        return self.mean + self.sd * score

    def _drawn(self, rng: np.random.Generator, count: int) -> Floats:
        if self._is_limited:
            return super()._drawn(rng, count)
        return rng.normal(self.mean, self.sd, count)


@dataclass(frozen=True)
class Lognormal(Truncated):
    """A lognormal distribution by its own mean and standard deviation, truncated by limits.

    With s^2 = ln(1 + (sd/mean)^2) and m = ln(mean) - s^2/2, ln(value) is normal(m, s).
    """

    WORD: ClassVar[str] = "lognormal"

    @property
    def _logarithm(self) -> tuple[float, float]:
        """Mean and standard deviation of the logarithm."""
        variance = math.log1p((self.sd / self.mean) ** 2)
        return math.log(self.mean) - 0.5 * variance, math.sqrt(variance)

    def _score(self, x: float) -> float:
        mean, sd = self._logarithm
        return (math.log(x) - mean) / sd if x > 0.0 else -math.inf

    def _at_score(self, score: Any) -> Any:
        mean, sd = self._logarithm
        return math.exp(mean + sd * score)

    def _drawn(self, rng: np.random.Generator, count: int) -> Floats:
        if self._is_limited:
            return super()._drawn(rng, count)
        return np.exp(rng.normal(*self._logarithm, count))


@dataclass(frozen=True)
class Uniform(Continuous):
    """All values between two limits alike."""

    WORD: ClassVar[str] = "uniform"
    low: float
    """Least value."""
    high: float
    """Largest value."""

    @property
    def mean(self) -> float:
        """Mean."""
        return 0.5 * (self.low + self.high)

    @property
    def large(self) -> float:
        """Largest value."""
        return self.high

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        return self.low + p * (self.high - self.low)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        return self.mean, (self.high - self.low) / math.sqrt(12.0)

    def _drawn(self, rng: np.random.Generator, count: int) -> Floats:
        return rng.uniform(self.low, self.high, count)


@dataclass(frozen=True)
class Exponential(Continuous):
    """Distances between independent points (a Poisson process)."""

    WORD: ClassVar[str] = "exponential"
    mean: float
    """Mean."""

    @property
    def large(self) -> float:
        """Ten times the mean."""
        return 10.0 * self.mean

    def validate(self) -> None:
        """Raise CaseError for a mean that is not positive."""
        super().validate()
        self._check_positive("mean")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        return -self.mean * math.log1p(-p)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        return self.mean, self.mean

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return values (count,), m."""
        return rng.exponential(self.mean, count)


@dataclass(frozen=True)
class Triangular(Continuous):
    """A triangular distribution."""

    WORD: ClassVar[str] = "triangular"
    low: float
    """Least value."""
    mode: float
    """Most likely value."""
    high: float
    """Largest value."""

    def validate(self) -> None:
        """Raise CaseError for numbers out of order."""
        super().validate()
        if not self.low <= self.mode <= self.high:
            raise fault(self, "has its mode outside of its limits", "order them: low, mode, high")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        width, left = self.high - self.low, self.mode - self.low
        if p * width < left:
            return self.low + math.sqrt(p * width * left)
        return self.high - math.sqrt((1.0 - p) * width * (width - left))

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        a, b, c = self.low, self.high, self.mode
        return (a + b + c) / 3.0, math.sqrt((a * a + b * b + c * c - a * b - a * c - b * c) / 18.0)


@dataclass(frozen=True)
class Beta(Continuous):
    """A beta distribution between two limits; its mean is low + (high - low) a/(a + b)."""

    WORD: ClassVar[str] = "beta"
    a: float
    """First shape, -."""
    b: float
    """Second shape, -."""
    low: float = 0.0
    """Least value."""
    high: float = 1.0
    """Largest value."""

    def validate(self) -> None:
        """Raise CaseError for shapes that are not positive."""
        super().validate()
        self._check_positive("a", "b")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        from scipy import special

        return self.low + (self.high - self.low) * float(special.betaincinv(self.a, self.b, p))

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        a, b, width = self.a, self.b, self.high - self.low
        return self.low + width * a / (a + b), width * math.sqrt(a * b / (a + b + 1.0)) / (a + b)


@dataclass(frozen=True)
class Listed(Distribution):
    """Distributions of the values of a list."""

    CONTINUOUS: ClassVar[bool] = False
    values: Sequence[Value]
    """The values: numbers, texts, true and false, or places (x, y)."""

    def __post_init__(self) -> None:
        if _is_list(self.values):
            listed: Any = self.values
            listed = tuple(tuple(one) if _is_list(one) else one for one in listed)
            object.__setattr__(self, "values", listed)

    def validate(self) -> None:
        """Raise CaseError for anything but a list of numbers and texts that is not empty."""
        if not _is_list(self.values):
            raise fault(self, "needs a list", "e.g. [20, 30, 40]")
        if not 0 < len(self.values) <= VALUES_MAX:
            raise fault(self, f"has {len(self.values)} values", "give 1 to 1,000,000 of them")
        for value in self.values:
            if not isinstance(value, str | bool) and not is_number(value) and not is_place(value):
                what = f"has {shortened(_text(value))} among its values"
                raise fault(self, what, "give numbers, texts or places [x, y]")

    def __len__(self) -> int:
        return len(self.values)

    def at(self, number: int) -> Value:
        """Return a value by its number, from 0."""
        return self.values[number]


@dataclass(frozen=True)
class Discrete(Listed):
    """Some values with their probabilities."""

    WORD: ClassVar[str] = "discrete"
    probabilities: Sequence[float] | None = None
    """Their probabilities; None: all alike."""

    def __post_init__(self) -> None:
        super().__post_init__()
        given = self.probabilities
        if given is not None and _is_list(given):
            object.__setattr__(self, "probabilities", tuple(given))

    def validate(self) -> None:
        """Raise CaseError where the probabilities do not sum up to 1."""
        super().validate()
        given = self.probabilities
        if given is None:
            return
        if not _is_list(given):
            raise fault(self, "has invalid probabilities", "give a list of numbers from 0 to 1")
        if len(given) != len(self.values):
            what = f"has {len(given)} probabilities for {len(self.values)} values"
            raise fault(self, what, "give one for each")
        if not all(is_number(one) and one >= 0.0 for one in given):
            raise fault(self, "has invalid probabilities", "give numbers from 0 to 1")
        if abs(math.fsum(given) - 1.0) > 1e-6:
            what = f"has probabilities that sum up to {math.fsum(given):.6g}"
            raise fault(self, what, "let them sum up to 1")

    def quantile(self, p: float) -> Value:
        """Return the value whose part of (0, 1), in their order, ``p`` lies in."""
        if self.probabilities is None:
            return self.values[min(int(p * len(self.values)), len(self.values) - 1)]
        for value, limit in zip(self.values, np.cumsum(self.probabilities), strict=True):
            if p < limit:
                return value
        return self.values[-1]

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation.  Raises CaseError for texts."""
        if not all(is_number(one) for one in self.values):
            raise fault(self, "has no mean", "give numbers, or another sampling")
        weights = self.probabilities or [1.0 / len(self.values)] * len(self.values)
        numbers = np.array(self.values, np.float64)
        mean = float(np.dot(weights, numbers))
        return mean, math.sqrt(float(np.dot(weights, (numbers - mean) ** 2)))


@dataclass(frozen=True)
class Values(Listed):
    """Given values: each is run in a sweep; joints take them in their order, again and again.

    On both sides of the origin joints begin with the first.
    """

    WORD: ClassVar[str] = "values"
    LISTED: ClassVar[bool] = True

    @property
    def mean(self) -> float:
        """Mean."""
        return float(np.mean(self._numbers))

    @property
    def large(self) -> float:
        """Largest value."""
        return float(np.max(self._numbers))

    def draw(self, rng: np.random.Generator, count: int, first: int = 0) -> Floats:
        """Return the next values (count,), m."""
        return self._numbers[(first + np.arange(count)) % len(self.values)]

    @property
    def _numbers(self) -> Floats:
        return np.asarray(self.values, np.float64)


def is_number(value: Any) -> bool:
    """Return whether a value is a finite real number, no bool."""
    is_real = isinstance(value, int | float | np.floating | np.integer)
    return is_real and not isinstance(value, bool) and math.isfinite(value)


def is_place(value: Any) -> bool:
    """Return whether a value is a tuple of finite numbers: a place or another vector."""
    return isinstance(value, tuple) and len(value) > 1 and all(map(is_number, value))


def fault(one: Distribution, what: str, remedy: str) -> CaseError:
    """Return the error of a distribution whose numbers do not fit together."""
    return CaseError(f"{one.WORD} {what}", remedy=remedy)


def _is_list(values: Any) -> bool:
    return isinstance(values, Sequence | np.ndarray) and not isinstance(values, str)


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, value))}]"
    return {True: "true", False: "false"}[value] if isinstance(value, bool) else repr(value)
