"""Rows as texts, for the command line and the report."""

from __future__ import annotations

from clast.verification.problem import Bracket, Comparison, Measure, Row, Verdict

HEADINGS = ("problem", "quantity", "computed", "exact", "error", "tolerance", "variant", "verdict")
"""Headings of the table."""


def cells(row: Row) -> tuple[str, ...]:
    """Return the texts of a row, in the order of :data:`HEADINGS`."""
    return (
        row.problem,
        row.quantity,
        computed(row),
        value(row.exact, row.unit),
        error(row),
        tolerance(row),
        row.variant,
        row.verdict.value,
    )


def value(number: float, unit: str) -> str:
    """Return a number with seven digits and its unit."""
    return f"{number:.7g} {unit}".strip()


def computed(row: Comparison) -> str:
    """Return the computed value, or the result of a bisection: both ends of its bracket."""
    number = row.computed
    if isinstance(number, Bracket):
        return f"{number.low:.5g} to {number.high:.5g} {row.unit}".strip()
    return value(number, row.unit)


def error(row: Comparison) -> str:
    """Return the error, in % where it is relative."""
    if row.measure is Measure.RELATIVE:
        return f"{percent(row.error)} %"
    return f"{row.error:.3g} {row.unit}".strip()


def tolerance(row: Comparison) -> str:
    """Return the tolerance, in % where it is relative."""
    if row.measure is Measure.RELATIVE:
        return f"{percent(row.tolerance)} %"
    return value(row.tolerance, row.unit)


def percent(share: float) -> str:
    """Return a share in %, with three digits."""
    return f"{100.0 * share:.3g}"


def remark(row: Row) -> str:
    """Return why a row has its tolerance, and why it misses where that is known."""
    if row.verdict is Verdict.KNOWN:
        return f"known to fail: {row.known_failure}"
    return row.reason
