"""A problem with a known answer, and the result of running it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import Enum
from inspect import cleandoc
from typing import Any

from clast.errors import RunStopped
from clast.model.model import Model
from clast.pictures.verification import Chart, Curve, curve, exact_curve
from clast.verification.variants import CONVEX, Variant


class Verdict(Enum):
    """The verdict of a row; the value is the word in the table."""

    PASS = "pass"
    MISS = "MISS"
    KNOWN = "known to fail"


class Measure(Enum):
    """How computed and exact value are compared."""

    RELATIVE = "relative"
    ABSOLUTE = "absolute"


class Bracket(float):
    """The result of a bisection: the middle of the bracket, which is the number, and both ends."""

    low: float
    """Lower end."""
    high: float
    """Upper end."""

    def __new__(cls, one: float, other: float) -> Bracket:
        """Return the bracket between two values, in any order."""
        self = super().__new__(cls, 0.5 * (one + other))
        self.low, self.high = min(one, other), max(one, other)
        return self

    def apart(self, exact: float) -> float:
        """Return by how much the bracket misses a value: 0 where it holds it."""
        return max(0.0, self.low - exact) + min(0.0, self.high - exact)


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One computed quantity beside its exact value."""

    quantity: str
    """The compared quantity."""
    unit: str
    """Unit of both values."""
    computed: float
    """Value that clast computed; a Bracket where it was bisected."""
    exact: float
    """Value of the formula."""
    measure: Measure
    """How the error is measured."""
    tolerance: float
    """Largest error that passes, -, or in ``unit`` where absolute; from the end of a bracket."""
    reason: str
    """The reason for the tolerance."""

    @property
    def error(self) -> float:
        """Difference of computed and exact value, over the exact one where relative.

        A bracket that holds the exact value has none.
        """
        computed = self.computed
        if isinstance(computed, Bracket):
            difference = computed.apart(self.exact)
        else:
            difference = computed - self.exact
        return difference / abs(self.exact) if self.measure is Measure.RELATIVE else difference

    @property
    def holds(self) -> bool:
        """True where the error is within the tolerance."""
        return abs(self.error) <= self.tolerance  # false for nan


@dataclass(frozen=True, kw_only=True)
class Row(Comparison):
    """A line of the table: a comparison, its problem and variant, and its verdict."""

    problem: str
    """Name of the problem."""
    variant: str
    """Name of the variant."""
    known_failure: str = ""
    """Why this quantity is known to miss its tolerance with this variant; empty where it is not."""

    @property
    def verdict(self) -> Verdict:
        """Whether the tolerance holds."""
        if self.holds:
            return Verdict.PASS
        return Verdict.KNOWN if self.known_failure else Verdict.MISS

    def as_dict(self) -> dict[str, Any]:
        """Return the row as plain numbers and texts, ready for JSON."""
        computed = self.computed
        bracket = [computed.low, computed.high] if isinstance(computed, Bracket) else None
        return {
            "problem": self.problem,
            "quantity": self.quantity,
            "unit": self.unit,
            "computed": float(computed),
            "bracket": bracket,
            "exact": self.exact,
            "error": self.error,
            "error_is": self.measure.value,
            "tolerance": self.tolerance,
            "reason": self.reason,
            "variant": self.variant,
            "verdict": self.verdict.value,
            "known_failure": self.known_failure,
        }


class Plot:
    """Curves of a chart, drawn one after the other."""

    def __init__(self, variant: str, curves: list[Curve]) -> None:
        """Draw the curves of a variant into a list."""
        self._variant, self._curves = variant, curves

    def exact(self, label: str, x: Any, y: Any) -> None:
        """Draw values of a formula."""
        self._curves.append(exact_curve(label, x, y))

    def computed(self, x: Any, y: Any, of: str = "", *, label: str = "") -> None:
        """Draw computed values, labelled by the variant after ``of``, or by a label alone."""
        label = label or (f"{of}, {self._variant}" if of else self._variant)
        self._curves.append(curve(label, x, y))


class Trial:
    """A run of a problem with one variant: collects computed values beside exact ones."""

    def __init__(self, variant: Variant) -> None:
        """Begin with no values."""
        self.variant = variant
        self.rows: list[Comparison] = []
        self.charts: list[Chart] = []

    def relative(
        self, quantity: str, unit: str, computed: float, exact: float, tolerance: float, reason: str
    ) -> None:
        """Add a value, compared by (computed - exact) / |exact|."""
        self._add(quantity, unit, computed, exact, tolerance, reason, Measure.RELATIVE, abs(exact))

    def absolute(
        self, quantity: str, unit: str, computed: float, exact: float, tolerance: float, reason: str
    ) -> None:
        """Add a value, compared by computed - exact, in ``unit``."""
        self._add(quantity, unit, computed, exact, tolerance, reason, Measure.ABSOLUTE, 1.0)

    def _add(
        self,
        quantity: str,
        unit: str,
        computed: float,
        exact: float,
        tolerance: float,
        reason: str,
        measure: Measure,
        size: float,
    ) -> None:
        if isinstance(computed, Bracket):
            # its width is given beside the error, and is no part of it
            tolerance = max(0.0, tolerance - 0.5 * (computed.high - computed.low) / size)
        else:
            computed = float(computed)
        self.rows.append(
            Comparison(
                quantity=quantity,
                unit=unit,
                computed=computed,
                exact=float(exact),
                measure=measure,
                tolerance=float(tolerance),
                reason=reason,
            )
        )

    @property
    def computed(self) -> list[float]:
        """Computed values, row by row."""
        return [row.computed for row in self.rows]

    def chart(self, title: str, x_label: str, y_label: str, *, log: str = "") -> Plot:
        """Add a chart, whose curves its Plot draws; ``log`` names axes with a logarithmic scale."""
        curves: list[Curve] = []
        scales: dict[str, Any] = {f"{axis}_scale": "log" for axis in log}
        chart = Chart(title=title, x_label=x_label, y_label=y_label, curves=curves, **scales)
        self.charts.append(chart)
        return Plot(self.variant.name, curves)


@dataclass(frozen=True)
class KnownFailure:
    """A quantity that is known to miss its tolerance with one variant, and why."""

    variant: Variant
    """Variant that misses."""
    quantity: str
    """Beginning of the quantity's text."""
    reason: str
    """Cause, in the method, of the failure."""


@dataclass(frozen=True, kw_only=True)
class Findings:
    """Rows and charts of one problem run with one variant."""

    problem: Problem
    variant: Variant
    rows: tuple[Row, ...]
    charts: tuple[Chart, ...]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A problem with a closed-form answer."""

    name: str
    """Name on the command line."""
    title: str
    """Title."""
    text: str
    """The computed quantities, in one paragraph."""
    formula: str
    """The exact answer."""
    source: str
    """Where the formula comes from."""
    left_out: str = ""
    """Processes that it is not run with, and why; empty where it is run with all."""
    set_up: Callable[[], Model]
    """The system at the start, for the figure."""
    examine: Callable[..., object]
    """Run the problem with a trial and the cases."""
    variants: tuple[Variant, ...]
    """The variants of a full run."""
    quick: tuple[Variant, ...] = (CONVEX,)
    """The variants where time is short."""
    cases: tuple[Any, ...] = ()
    """The cases run; all that are the defaults of ``examine`` if empty."""
    few: tuple[Any, ...] = ()
    """The cases where time is short; all of them if empty."""
    briefly: Callable[[Trial], object] | None = None
    """The part of ``examine`` that is run where time is short; all of it if None."""
    known_failures: tuple[KnownFailure, ...] = ()
    """The known misses."""

    def brief(self) -> Problem:
        """Return the problem with its variants and cases where time is short."""
        examine = self.briefly or self.examine
        return replace(self, variants=self.quick, cases=self.few, examine=examine)

    def findings(self, variant: Variant) -> Findings:
        """Run the problem with a variant; a run that stops is a row that misses."""
        trial = Trial(variant)
        try:
            self.examine(trial, *self.cases)
        except RunStopped as stopped:
            trial = Trial(variant)
            trial.absolute("runs that stopped before their end", "", 1.0, 0.0, 0.0, str(stopped))
        rows = tuple(self._row(comparison, variant) for comparison in trial.rows)
        return Findings(problem=self, variant=variant, rows=rows, charts=tuple(trial.charts))

    def run(self, variant: Variant) -> list[Row]:
        """Run the problem with a variant and return its rows."""
        return list(self.findings(variant).rows)

    def _row(self, comparison: Comparison, variant: Variant) -> Row:
        reason = " ".join(
            known.reason
            for known in self.known_failures
            if known.variant == variant and comparison.quantity.startswith(known.quantity)
        )
        name = self.name
        return Row(**vars(comparison), problem=name, variant=variant.name, known_failure=reason)


FIELDS = {"Exact": "formula", "Source": "source", "Not run with": "left_out"}
"""Last sections of the docstring of a problem, and the fields that they fill."""
SECTION = re.compile(rf"\n+({'|'.join(FIELDS)}): ")


def problem(**settings: Any) -> Callable[[Callable[..., None]], Problem]:
    """Make a problem of the function that examines it; ``settings`` as of Problem.

    The function's name is that of the problem; its docstring is title, text and FIELDS.
    """

    def of(examine: Callable[..., None]) -> Problem:
        head, *sections = re.split(SECTION, cleandoc(examine.__doc__ or ""))
        title, _, text = head.partition("\n\n")
        texts = dict(zip(map(FIELDS.__getitem__, sections[::2]), sections[1::2], strict=True))
        texts = {field: " ".join(words.split()).removesuffix(".") for field, words in texts.items()}
        fields: dict[str, Any] = {**texts, "text": " ".join(text.split())}
        fields["name"] = examine.__name__.replace("_", "-")
        fields["title"] = " ".join(title.split()).removesuffix(".")
        return Problem(examine=examine, **fields, **settings)

    return of


def fixed_failures(findings: Iterable[Findings]) -> list[KnownFailure]:
    """Return the known failures of which not one quantity fails any more."""
    return [
        known
        for each in findings
        for known in each.problem.known_failures
        if known.variant == each.variant
        and not any(row.quantity.startswith(known.quantity) and not row.holds for row in each.rows)
    ]


def misses(rows: Iterable[Row]) -> list[Row]:
    """Return the rows that miss their tolerance without being known to."""
    return [row for row in rows if row.verdict is Verdict.MISS]
