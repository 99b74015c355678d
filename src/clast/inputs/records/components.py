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
from clast.model.model import Floats

SAME = 0.01
"""Share of an interval by which the instants of two components may be apart."""
LONGEST_NAME = 60
"""Most characters of a file's name in a note."""
DEFAULT_QUANTITY = "acceleration"
OTHER_UNIT = 5.0
"""A unit that is off by more than this factor is another one than a heading names."""


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """The keys of a record in the case file."""

    path: Path
    """The file."""
    format: str = "auto"
    """Its format, or "auto"."""
    quantity: str | None = None
    """acceleration, velocity, displacement; None for that of the file."""
    unit: str | None = None
    """Its unit; None for that of the file."""
    unit_else: str | None = None
    """Its unit where neither ``unit`` nor the file says it, or None."""
    scale: float = 1.0
    """Factor on its values."""


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


def component(wanted: Wanted) -> Component:
    """Return the acceleration that a file stands for; raises CaseError with place and remedy.

    The place begins with the key of the case file, or with the file and its line.
    """
    chosen = format_of(wanted.path) if wanted.format == "auto" else wanted.format
    series = READERS[chosen](wanted.path)
    quantity = _quantity(series, wanted.quantity)
    unit = _unit(series, quantity, wanted)
    factor = wanted.scale * UNITS[quantity][unit]
    check_sizes(series.time, series.values, series.name)
    values = factor * series.values
    check_sizes(series.time, values, series.name)
    try:
        samples = CONVERSIONS[quantity](series.time, values)
    except CaseError as error:
        raise CaseError(error.what, where=series.name, remedy=error.remedy) from None
    source = "as the file says" if wanted.unit is None and series.unit else "as the case says"
    name = shortened(wanted.path.name, LONGEST_NAME)
    note = (
        f"{name}: {chosen}, {len(series.time)} values every {samples.interval:g} s, {quantity} in "
        f"{unit}, {source}"
    )
    return Component(
        samples=samples,
        quantity=quantity,
        note=note,
        doubt=_doubt(series, wanted, unit, name) or doubted_times(series.time, name),
    )


def _doubt(series: RecordSeries, wanted: Wanted, unit: str, name: str) -> str | None:
    """Return the doubt that the heading of columns raises about the unit, or None."""
    size = abs(wanted.scale) * UNITS["acceleration"].get(unit, 0.0)
    if series.guess is None or size == 0.0:
        return None
    named, meant = series.guess
    if meant / OTHER_UNIT <= size <= meant * OTHER_UNIT:
        return None
    return (
        f'unit is "{unit}" and scale {wanted.scale:g}, but the heading of {name} says that '
        f"accelerations are in {named}: correct unit if so"
    )


def _quantity(series: RecordSeries, wanted: str | None) -> str:
    """Return the quantity of a record; case and file must not contradict each other."""
    if wanted is not None and series.quantity not in (None, wanted):
        what = f"is {wanted}, but the heading of {series.name} says {series.quantity}"
        raise CaseError(what, where="quantity", remedy="leave quantity out, or name another file")
    return wanted or series.quantity or DEFAULT_QUANTITY


def _unit(series: RecordSeries, quantity: str, wanted: Wanted) -> str:
    """Return the unit of a record, which must be one of its quantity."""
    unit, known = wanted.unit or series.unit or wanted.unit_else, UNITS[quantity]
    listed = ", ".join(f'"{name}"' for name in known)
    if unit is None:
        what = f"is missing: {series.name} does not give the unit of its {quantity}"
        raise CaseError(what, where="unit", remedy=f"give unit = one of {listed}")
    if unit not in known:
        other = next(name for name, units in UNITS.items() if unit in units)
        # A unit must not change the quantity that the heading gives.
        change = "" if series.quantity else f', or quantity = "{other}"'
        what = f"{unit} is not a valid unit of {quantity}"
        raise CaseError(what, where="unit", remedy=f"give one of {listed}{change}")
    if wanted.unit and series.unit in known and known[series.unit] != known[unit]:
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
    if apart > SAME * min(one.interval, other.interval):
        raise CaseError(
            f"begins at {other.time[0]:g} s with a value every {other.interval:g} s, the first "
            f"component at {one.time[0]:g} s with one every {one.interval:g} s",
            where="vertical",
            remedy="give both with the same first instant and interval",
        )
    longer = one if len(one.time) >= len(other.time) else other
    total = replace(longer, acceleration=_sum(one.acceleration, other.acceleration))
    missing = abs(len(one.time) - len(other.time))
    if not missing:
        return total, None
    which = "the vertical component" if longer is one else "the first component"
    return total, f"{which} ends {missing} value(s) before the other: 0 m/s2 from there on"


def _sum(first: Floats, second: Floats) -> Floats:
    """Return the sum of two arrays of rows (x, y); the shorter ends in zeros."""
    total = np.zeros((max(len(first), len(second)), 2))
    total[: len(first)] += first
    total[: len(second)] += second
    return total
