"""Tables of time: factors of loads that are linear between instants and constant outside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clast.model.arrays import Floats, Ints

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
