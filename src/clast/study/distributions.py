"""Values of a parameter of a study: distributions, lists and ranges of values.

Each is written as its class is called, in Python, on the command line and in ``study.toml``:

    normal(35, 5, low=15, high=70)

All but lists give the value that belongs to a probability p in (0, 1), so that every sampling can
draw from them.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, Field, dataclass, fields
from typing import Any, ClassVar

import numpy as np
from scipy import special

from clast import spelling
from clast.errors import CaseError, shortened

Value = float | int | str | bool
"""A value that a key of a case may be set to."""
MOST_VALUES = 1_000_000
"""Most values of a list or a range."""
COUNTED = "first, last and how many: range(20, 40, 5) is 20, 25, 30, 35, 40"
"""Remedy of a range without a count."""
QUADRATURE = 4000
"""Points by which mean and standard deviation of a truncated distribution are integrated."""


class Distribution:
    """Things that all of them have in common: how they are written."""

    WORD: ClassVar[str] = ""
    """How it is called in texts."""
    LISTED: ClassVar[bool] = False
    """True where it is a list of values, each of which is run in a sweep."""
    CONTINUOUS: ClassVar[bool] = True
    """True where it may be correlated with others."""

    def __str__(self) -> str:
        return f"{self.WORD}({', '.join(_arguments(self))})"

    def quantile(self, p: float) -> Value:
        """Return the value below which the variable lies with probability ``p``, 0 < p < 1."""
        raise NotImplementedError

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        p = (np.arange(QUADRATURE) + 0.5) / QUADRATURE
        values = np.array([self.quantile(float(one)) for one in p], np.float64)
        return float(values.mean()), float(values.std())


@dataclass(frozen=True)
class Normal(Distribution):
    """A normal distribution, truncated where limits are given.

    Raises CaseError for a standard deviation that is not positive and for limits out of order.
    """

    WORD: ClassVar[str] = "normal"
    mean: float
    """Mean of the distribution before it is truncated."""
    sd: float
    """Its standard deviation."""
    low: float | None = None
    """Least value; None: none."""
    high: float | None = None
    """Largest value; None: none."""

    def __post_init__(self) -> None:
        _check_numbers(self)
        _check_positive(self, "sd")
        _check_order(self, "low", "high")
        if not self._shares[1] - self._shares[0] > 1e-12:
            raise _bad(self, "has no probability between its limits", "move low or high")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        below, above = self._shares
        found = self.mean + self.sd * float(special.ndtri(below + p * (above - below)))
        return _within(found, self.low, self.high)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        whole = self.low is None and self.high is None
        return (self.mean, self.sd) if whole else super().moments

    @property
    def _shares(self) -> tuple[float, float]:
        """Probability below each of the limits."""
        return _shares(self.low, self.high, lambda x: (x - self.mean) / self.sd)


@dataclass(frozen=True)
class Lognormal(Distribution):
    """A lognormal distribution by its own mean and standard deviation, truncated by limits.

    Raises CaseError for a mean or a standard deviation that is not positive.
    """

    WORD: ClassVar[str] = "lognormal"
    mean: float
    """Mean of the variable itself, not of its logarithm, before it is truncated."""
    sd: float
    """Standard deviation of the variable itself."""
    low: float | None = None
    """Least value; None: none."""
    high: float | None = None
    """Largest value; None: none."""

    def __post_init__(self) -> None:
        _check_numbers(self)
        _check_positive(self, "mean", "sd")
        _check_order(self, "low", "high")
        if not self._shares[1] - self._shares[0] > 1e-12:
            raise _bad(self, "has no probability between its limits", "move low or high")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        below, above = self._shares
        location, scale = self._logarithm
        found = math.exp(location + scale * float(special.ndtri(below + p * (above - below))))
        return _within(found, self.low, self.high)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        whole = self.low is None and self.high is None
        return (self.mean, self.sd) if whole else super().moments

    @property
    def _logarithm(self) -> tuple[float, float]:
        """Mean and standard deviation of the logarithm."""
        variance = math.log1p((self.sd / self.mean) ** 2)
        return math.log(self.mean) - 0.5 * variance, math.sqrt(variance)

    @property
    def _shares(self) -> tuple[float, float]:
        """Probability below each of the limits."""
        location, scale = self._logarithm

        def score(x: float) -> float:
            return (math.log(x) - location) / scale if x > 0.0 else -math.inf

        return _shares(self.low, self.high, score)


@dataclass(frozen=True)
class Uniform(Distribution):
    """All values between two limits alike.  Raises CaseError for limits out of order."""

    WORD: ClassVar[str] = "uniform"
    low: float
    """Least value."""
    high: float
    """Largest value."""

    def __post_init__(self) -> None:
        _check_numbers(self)
        _check_order(self, "low", "high")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        return self.low + p * (self.high - self.low)

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        return 0.5 * (self.low + self.high), (self.high - self.low) / math.sqrt(12.0)


@dataclass(frozen=True)
class Triangular(Distribution):
    """A triangular distribution.  Raises CaseError for numbers out of order."""

    WORD: ClassVar[str] = "triangular"
    low: float
    """Least value."""
    mode: float
    """Most likely value."""
    high: float
    """Largest value."""

    def __post_init__(self) -> None:
        _check_numbers(self)
        _check_order(self, "low", "high")
        if not self.low <= self.mode <= self.high:
            raise _bad(self, "has its mode outside of its limits", "order them: low, mode, high")

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
class Beta(Distribution):
    """A beta distribution between two limits.  Raises CaseError for shapes that are not positive.

    Its mean is low + (high - low) a/(a + b).
    """

    WORD: ClassVar[str] = "beta"
    a: float
    """First shape, -."""
    b: float
    """Second shape, -."""
    low: float = 0.0
    """Least value."""
    high: float = 1.0
    """Largest value."""

    def __post_init__(self) -> None:
        _check_numbers(self)
        _check_positive(self, "a", "b")
        _check_order(self, "low", "high")

    def quantile(self, p: float) -> float:
        """Return the value below which the variable lies with probability ``p``."""
        share = float(special.betaincinv(self.a, self.b, p))
        return self.low + (self.high - self.low) * share

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation."""
        a, b, width = self.a, self.b, self.high - self.low
        mean = self.low + width * a / (a + b)
        return mean, width * math.sqrt(a * b / (a + b + 1.0)) / (a + b)


@dataclass(frozen=True)
class Discrete(Distribution):
    """Some values with their probabilities.  Raises CaseError where they do not sum up to 1."""

    WORD: ClassVar[str] = "discrete"
    CONTINUOUS: ClassVar[bool] = False
    values: Sequence[Value]
    """The values: numbers, texts, or true and false."""
    probabilities: Sequence[float] | None = None
    """Their probabilities; None: all alike."""

    def __post_init__(self) -> None:
        _check_list(self, self.values)
        object.__setattr__(self, "values", tuple(self.values))
        if self.probabilities is None:
            return
        object.__setattr__(self, "probabilities", tuple(self.probabilities))
        given = self.probabilities
        if len(given) != len(self.values):
            what = f"has {len(given)} probabilities for {len(self.values)} values"
            raise _bad(self, what, "give one for each")
        if not all(_is_number(one) and one >= 0.0 for one in given):
            raise _bad(self, "has invalid probabilities", "give numbers from 0 to 1")
        if abs(math.fsum(given) - 1.0) > 1e-6:
            what = f"has probabilities that sum up to {math.fsum(given):.6g}"
            raise _bad(self, what, "let them sum up to 1")

    def quantile(self, p: float) -> Value:
        """Return the value whose share of (0, 1), in their order, ``p`` lies in."""
        if self.probabilities is None:
            return self.values[min(int(p * len(self.values)), len(self.values) - 1)]
        for value, limit in zip(self.values, np.cumsum(self.probabilities), strict=True):
            if p < limit:
                return value
        return self.values[-1]

    @property
    def moments(self) -> tuple[float, float]:
        """Mean and standard deviation.  Raises CaseError for texts."""
        if not all(_is_number(one) for one in self.values):
            raise _bad(self, "has no mean", "give numbers, or another sampling")
        weights = self.probabilities or [1.0 / len(self.values)] * len(self.values)
        numbers = np.array(self.values, np.float64)
        mean = float(np.dot(weights, numbers))
        return mean, math.sqrt(float(np.dot(weights, (numbers - mean) ** 2)))


@dataclass(frozen=True)
class Values(Distribution):
    """A list of values, each of which is run.  Raises CaseError for an empty one."""

    WORD: ClassVar[str] = "values"
    LISTED: ClassVar[bool] = True
    CONTINUOUS: ClassVar[bool] = False
    values: Sequence[Value]
    """The values."""

    def __post_init__(self) -> None:
        _check_list(self, self.values)
        object.__setattr__(self, "values", tuple(self.values))

    def __len__(self) -> int:
        return len(self.values)

    def at(self, number: int) -> Value:
        """Return a value by its number, from 0."""
        return self.values[number]


@dataclass(frozen=True)
class Range(Distribution):
    """Values at equal distances, the first and the last included, each of which is run.

    Raises CaseError for a count that is none.
    """

    WORD: ClassVar[str] = "range"
    LISTED: ClassVar[bool] = True
    CONTINUOUS: ClassVar[bool] = False
    first: float
    """First value."""
    last: float
    """Last value."""
    count: int
    """How many, at least 2."""

    def __post_init__(self) -> None:
        _check_numbers(self)
        if not isinstance(self.count, int) or not 2 <= self.count <= MOST_VALUES:
            raise _bad(self, "has no count from 2 to 1,000,000", COUNTED)

    def __len__(self) -> int:
        return self.count

    def at(self, number: int) -> float:
        """Return a value by its number, from 0."""
        share = number / (self.count - 1)
        # 12 digits: 0.3 in place of 0.30000000000000004
        return float(f"{(1.0 - share) * self.first + share * self.last:.12g}")


@dataclass(frozen=True)
class Numbered(Distribution):
    """The number of the run: a seed of its own for each, as in ``domain.seed``.

    Raises CaseError for a first number that is not a whole number.
    """

    WORD: ClassVar[str] = "numbered"
    CONTINUOUS: ClassVar[bool] = False
    first: int = 1
    """Value of the first run."""

    def __post_init__(self) -> None:
        if not isinstance(self.first, int) or isinstance(self.first, bool) or self.first < 0:
            raise _bad(self, "has no whole number to begin with", "e.g. numbered(1)")


@dataclass(frozen=True)
class Times(Distribution):
    """The value of the case, multiplied by one from a distribution or a list."""

    WORD: ClassVar[str] = "times"
    factor: Distribution
    """The factor, -."""

    def __post_init__(self) -> None:
        if not isinstance(self.factor, Distribution) or isinstance(self.factor, Times | Numbered):
            raise _bad(self, "needs a distribution or a list", "e.g. times(normal(1, 0.1))")


def _arguments(one: Distribution) -> list[str]:
    """Return the numbers of a distribution as they are written, defaults left out."""
    written = []
    named = False
    for entry in fields(one):  # type: ignore[arg-type]
        value = getattr(one, entry.name)
        if value == entry.default:
            named = True
            continue
        text = str(value) if isinstance(value, Distribution) else _text(value)
        written.append(f"{entry.name}={text}" if named else text)
    return written


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, value))}]"
    return {True: "true", False: "false"}[value] if isinstance(value, bool) else repr(value)


def _bad(one: Distribution, what: str, remedy: str) -> CaseError:
    """Return the error of a distribution whose numbers do not fit together."""
    return CaseError(f"{one.WORD} {what}", remedy=remedy)


def _is_number(value: Any) -> bool:
    is_real = isinstance(value, int | float | np.floating | np.integer)
    return is_real and not isinstance(value, bool) and math.isfinite(value)


def _check_numbers(one: Distribution) -> None:
    """Raise CaseError where a field is not a number, and make floats of them."""
    for entry in fields(one):  # type: ignore[arg-type]
        value = getattr(one, entry.name)
        if value is None and entry.default is None:
            continue
        if not _is_number(value):
            what = f"has {shortened(repr(value))} for {entry.name}"
            raise _bad(one, what, "give a number")
        if entry.name != "count":
            object.__setattr__(one, entry.name, float(value))


def _check_positive(one: Distribution, *names: str) -> None:
    for name in names:
        if not getattr(one, name) > 0.0:
            what = f"has {name} {getattr(one, name):g}, which is not positive"
            raise _bad(one, what, "give a positive number; set a constant value in the case")


def _check_order(one: Distribution, first: str, second: str) -> None:
    low, high = getattr(one, first), getattr(one, second)
    if low is not None and high is not None and not low < high:
        raise _bad(one, f"goes from {low:g} to {high:g}", "let low be less than high")


def _check_list(one: Distribution, values: Any) -> None:
    """Raise CaseError for a value that is not a list of numbers and texts, or an empty one."""
    if isinstance(values, str) or not isinstance(values, Sequence | np.ndarray):
        raise _bad(one, "needs a list", "e.g. [20, 30, 40]")
    if not 0 < len(values) <= MOST_VALUES:
        raise _bad(one, f"has {len(values)} values", "give 1 to 1,000,000 of them")
    for value in values:
        if not isinstance(value, str | bool) and not _is_number(value):
            what = f"has {shortened(repr(value))} among its values"
            raise _bad(one, what, "give numbers or texts")


def _within(value: float, low: float | None, high: float | None) -> float:
    value = value if low is None else max(value, low)
    return value if high is None else min(value, high)


def _shares(
    low: float | None, high: float | None, score: Callable[[float], float]
) -> tuple[float, float]:
    """Return the probability below each of two limits of a normal variable by its score."""
    below = 0.0 if low is None else float(special.ndtr(score(low)))
    above = 1.0 if high is None else float(special.ndtr(score(high)))
    return below, above


KINDS: dict[str, type[Any]] = {
    one.WORD: one
    for one in (
        Normal,
        Lognormal,
        Uniform,
        Triangular,
        Beta,
        Discrete,
        Values,
        Range,
        Numbered,
        Times,
    )
}
"""Word -> class."""


def parsed(text: str, where: str) -> Distribution:
    """Return the distribution or list that a text says; raises CaseError naming place and remedy.

    A number, a list in brackets and a text in quotes are lists: ``[20, 30]``.
    """
    remedy = 'e.g. "normal(35, 5)", "uniform(20, 40)" or "[20, 30, 40]"'
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        what = f"'{shortened(text)}' is not a valid distribution"
        raise CaseError(what, where=where, remedy=remedy) from None
    return _made(tree, where, remedy)


def _made(tree: ast.expr, where: str, remedy: str) -> Distribution:
    """Return the value of an expression."""
    if not isinstance(tree, ast.Call):
        value = _plain(tree, where)
        return _of_kind(Values, {"values": value if isinstance(value, list) else [value]}, where)
    word = tree.func.id if isinstance(tree.func, ast.Name) else ""
    if word not in KINDS:
        said = spelling.advice(word, KINDS, kind="distribution")
        what = f"there is no distribution '{shortened(word or ast.unparse(tree.func))}'"
        raise CaseError(what, where=where, remedy=said)
    kind = KINDS[word]
    names = [one.name for one in fields(kind)]
    if len(tree.args) > len(names):
        what = f"{word} has {len(tree.args)} numbers, but at most {len(names)}"
        raise CaseError(what, where=where, remedy=f"write {usage(kind)}")
    given = dict(zip(names, tree.args, strict=False))
    for one in tree.keywords:
        if one.arg not in names or one.arg in given:
            what = f"{word} has no '{shortened(str(one.arg))}' left to be given"
            raise CaseError(what, where=where, remedy=f"write {usage(kind)}")
        given[one.arg] = one.value
    missing = [one.name for one in fields(kind) if one.default is MISSING and one.name not in given]
    if missing:
        what = f"{word} lacks {', '.join(missing)}"
        raise CaseError(what, where=where, remedy=f"write {usage(kind)}")
    values = {
        name: _made(one, where, remedy) if name == "factor" else _plain(one, where)
        for name, one in given.items()
    }
    return _of_kind(kind, values, where)


def _of_kind(kind: type[Any], values: Mapping[str, Any], where: str) -> Any:
    """Return a distribution of a kind; its errors name the place of its text."""
    try:
        return kind(**values)
    except CaseError as error:
        raise CaseError(error.what, where=where, remedy=error.remedy) from None


def usage(kind: type[Any]) -> str:
    """Return how a distribution is written: normal(mean, sd, low=..., high=...)."""
    return f"{kind.WORD}({', '.join(_usage_of(one) for one in fields(kind))})"


def _usage_of(one: Field[Any]) -> str:
    return one.name if one.default is MISSING else f"{one.name}=..."


def _plain(tree: ast.expr, where: str) -> Any:
    """Return a number, a text or a list of these."""
    if isinstance(tree, ast.List | ast.Tuple):
        return [_plain(one, where) for one in tree.elts]
    if isinstance(tree, ast.Name) and tree.id in ("true", "false"):
        return tree.id == "true"
    try:
        return ast.literal_eval(tree)
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        raise CaseError(
            f"'{shortened(ast.unparse(tree))}' is not a number",
            where=where,
            remedy="write numbers; texts in quotes",
        ) from None
