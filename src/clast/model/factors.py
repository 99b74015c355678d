"""Tables of time: factors of loads that are linear between instants and constant outside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import ModelError, shortened
from clast.model import ranges

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NO_FACTOR = -1
"""Number of the factor of a load that is constant."""


@dataclass(frozen=True, kw_only=True)
class Factor:
    """A factor over time, linear between its instants, constant before and after them."""

    name: str
    """Name by which loads refer to it."""
    time: Floats
    """Instants, s, rising, shape (k,)."""
    value: Floats
    """Factor at the instants, -, shape (k,)."""

    def __repr__(self) -> str:
        first, last = self.time[0], self.time[-1]
        return f"Factor('{self.name}', {len(self.time)} instants from {first:g} to {last:g} s)"

    def at(self, time: float) -> float:
        """Return the factor, -, at a time, s."""
        return float(np.interp(time, self.time, self.value))


def factors_at(factors: Sequence[Factor], number: Ints, time: float) -> Floats:
    """Return the factor, -, of each load at a time, s, from the number of its factor, shape (k,).

    It is 1 where the number is NO_FACTOR.
    """
    return np.array([1.0, *(factor.at(time) for factor in factors)])[number - NO_FACTOR]


def checked_factor(name: str, time: Any, value: Any) -> Factor:
    """Return a factor of what a script or a case file gives; raise ModelError with the remedy."""
    where = f"table '{shortened(str(name))}'"
    instants = _numbers(time, f"{where}, time", ranges.TIME)
    values = _numbers(value, f"{where}, value", ranges.FACTOR)
    if len(instants) != len(values):
        raise ModelError(
            f"has {len(values)} values for {len(instants)} instants",
            where=f"{where}, value",
            remedy="give one value for each instant",
        )
    if len(instants) < 2:
        raise ModelError(
            f"has {len(instants)} instants",
            where=f"{where}, time",
            remedy="give at least 2; a load that is constant needs no table",
        )
    for k in np.flatnonzero(np.diff(instants) <= 0.0)[:1]:
        raise ModelError(
            f"instant {k + 2}, {instants[k + 1]:g} s, is not after instant {k + 1}, "
            f"{instants[k]:g} s",
            where=f"{where}, time",
            remedy="order the instants by time, each once (for a jump, 1e-9 s apart)",
        )
    return Factor(name=name, time=instants, value=values)


def _numbers(values: Any, where: str, limits: ranges.Range) -> Floats:
    """Return finite numbers as an array, shape (k,), or say that they are none."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.zeros((0, 0))
    if array.ndim != 1:
        raise ModelError(
            f"{shortened(repr(values))} is no list of numbers",
            where=where,
            remedy="give it as a list, e.g. [0.0, 1.0]",
        )
    for k in np.flatnonzero(~np.isfinite(array))[:1]:
        raise ModelError(
            f"number {k + 1}, {array[k]:g}, is not finite",
            where=where,
            remedy="give finite numbers: instants in s, values as factors of the load",
        )
    for number in array:
        ranges.check_size(float(number), limits, where, "give instants in s, values as factors")
    return array
