"""One or two records as the motion of the ground in the plane, with notes on their reading."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clast.errors import CaseError, shortened
from clast.inputs.records.columns import check_sizes, doubted_times
from clast.inputs.records.conversion import CONVERSIONS, Samples
from clast.inputs.records.formats import READERS, format_of
from clast.inputs.records.series import UNITS, RecordSeries

NAME_LENGTH_MAX = 60
"""Most characters of a file's name in a note."""
UNIT_RATIO_MAX = 5.0
"""A unit that is off by more than this factor is another one than a heading names."""


@dataclass(frozen=True, kw_only=True)
class Component:
    """The acceleration that a record stands for, and how it was read."""

    samples: Samples
    """Acceleration, m/s2."""
    quantity: str
    """Quantity of the file: acceleration, velocity or displacement."""
    note: str
    """How it was read, in a sentence."""
    doubt: str | None
    """The doubt that the heading of a file of columns raises, or None."""


def component(
    path: Path,
    *,
    format: str = "auto",
    quantity: str | None = None,
    unit: str | None = None,
    unit_else: str | None = None,
    scale: float = 1.0,
) -> Component:
    """Return the acceleration that a file stands for; raises CaseError with place and remedy.

    Quantity and unit are those of the file where they are None, ``unit_else`` is the unit where
    neither says it, ``scale`` a factor on the values.  The place begins with the key of the case
    file, or with the file and its line.
    """
    chosen = format_of(path) if format == "auto" else format
    series = READERS[chosen](path)
    if quantity is not None and series.quantity not in (None, quantity):
        what = f"is {quantity}, but the heading of {series.name} says {series.quantity}"
        raise CaseError(what, where="quantity", remedy="leave quantity out, or name another file")
    of = quantity or series.quantity or "acceleration"
    known = _unit(series, of, unit, unit_else)
    check_sizes(series.time, series.values, series.name)
    values = scale * UNITS[of][known] * series.values
    check_sizes(series.time, values, series.name)
    try:
        samples = CONVERSIONS[of](series.time, values)
    except CaseError as error:
        raise CaseError(error.what, where=series.name, remedy=error.remedy) from None
    source = "as the file says" if unit is None and series.unit else "as the case says"
    name = shortened(path.name, NAME_LENGTH_MAX)
    doubt = doubted_times(series.time, name)
    size = abs(scale) * UNITS["acceleration"].get(known, 0.0)
    if is_other_unit(series, size):
        doubt = (
            f'unit is "{known}" and scale {scale:g}, but the heading of {name} says that '
            f"accelerations are in {series.guess[0]}: correct unit if so"  # type: ignore[index]
        )
    return Component(
        samples=samples,
        quantity=of,
        note=f"{name}: {chosen}, {len(series.time)} values every {samples.interval:g} s, {of} in "
        f"{known}, {source}",
        doubt=doubt,
    )


def is_other_unit(series: RecordSeries, size: float) -> bool:
    """Return whether the heading names another unit of acceleration than one of a size, m/s2."""
    if series.guess is None or size == 0.0:
        return False
    return not series.guess[1] / UNIT_RATIO_MAX <= size <= series.guess[1] * UNIT_RATIO_MAX


def _unit(series: RecordSeries, quantity: str, given: str | None, other: str | None) -> str:
    """Return the unit of a record, which must be one of its quantity."""
    unit, known = given or series.unit or other, UNITS[quantity]
    listed = ", ".join(f'"{name}"' for name in known)
    if unit is None:
        what = f"is missing: {series.name} does not give the unit of its {quantity}"
        raise CaseError(what, where="unit", remedy=f"give unit = one of {listed}")
    if unit not in known:
        home = next(name for name, units in UNITS.items() if unit in units)
        # A unit must not change the quantity that the heading gives.
        change = "" if series.quantity else f', or quantity = "{home}"'
        what = f"{unit} is not a valid unit of {quantity}"
        raise CaseError(what, where="unit", remedy=f"give one of {listed}{change}")
    if given and series.unit in known and known[series.unit] != known[unit]:
        what = f"is {unit}, but the heading of {series.name} says {series.unit}"
        remedy = "leave unit out; scale is a factor on all values"
        raise CaseError(what, where="unit", remedy=remedy)
    return unit


def along(samples: Samples, direction: tuple[float, float]) -> Samples:
    """Return one component as motion (x, y) along a direction, whose length does not matter."""
    unit = np.array(direction, np.float64) / np.hypot(*direction)
    return replace(samples, acceleration=samples.acceleration[:, :1] * unit)


def together(first: Component, second: Component) -> tuple[Samples, str | None]:
    """Return the sum of two motions (x, y), and a note where one was longer.

    The shorter has no acceleration after its end.  Raises CaseError where they are not of one
    quantity, or do not begin at the same instant with the same interval.
    """
    if first.quantity != second.quantity:
        what = f"is {second.quantity}, but the first component is {first.quantity}"
        raise CaseError(what, where="vertical", remedy="give both as the same quantity")
    one, other = first.samples, second.samples
    count = min(len(one.time), len(other.time))
    apart = float(np.abs(one.time[:count] - other.time[:count]).max())
    # Share of an interval by which the instants of two components may be apart
    if apart > 0.01 * min(one.interval, other.interval):
        raise CaseError(
            f"begins at {other.time[0]:g} s with a value every {other.interval:g} s, the first "
            f"component at {one.time[0]:g} s with one every {one.interval:g} s",
            where="vertical",
            remedy="give both with the same first instant and interval",
        )
    longer = one if len(one.time) >= len(other.time) else other
    total = np.zeros((max(len(one.acceleration), len(other.acceleration)), 2))
    for samples in (one, other):
        total[: len(samples.acceleration)] += samples.acceleration
    both = replace(longer, acceleration=total)
    missing = abs(len(one.time) - len(other.time))
    if not missing:
        return both, None
    which = "the vertical component" if longer is one else "the first component"
    return both, f"{which} ends {missing} value(s) before the other: 0 m/s2 from there on"
