"""Which numbers can be meant at all, once for case files and for scripts.

The ranges are far wider than rock and masonry need: they exclude numbers that no system of units
explains, and keep the products that the equations make of these numbers (E A / h2, rho L4, ...)
within the range of floating-point numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from clast.errors import ModelError


@dataclass(frozen=True)
class AllowedRange:
    """Sizes that a quantity can have, and its unit."""

    low: float
    """Smallest size other than 0."""
    high: float
    """Largest size."""
    unit: str
    """Unit, as messages write it."""

    def fault(self, value: float) -> str | None:
        """Return the fault in the size of a number, or None; 0 is not judged."""
        size = abs(value)
        if size == 0.0 or self.low <= size <= self.high:
            return None
        if not math.isfinite(size):
            return f"must be a finite number, not {value:g}"
        side, limit = ("small", self.low) if size < self.low else ("large", self.high)
        bound = "at least" if size < self.low else "at most"
        unit = f" {self.unit}" if self.unit else ""
        return f"{value:g}{unit} is too {side} to be intended: {bound} {limit:g}{unit}"


MODULUS = AllowedRange(1e-6, 1e24, "Pa")
STRESS = AllowedRange(0.0, 1e24, "Pa")
DENSITY = AllowedRange(1e-12, 1e12, "kg/m3")
STIFFNESS = AllowedRange(1e-6, 1e36, "N/m per m")
JOINT_STIFFNESS = AllowedRange(1e-6, 1e30, "Pa/m")
LENGTH = AllowedRange(1e-12, 1e18, "m")
COORDINATE = AllowedRange(0.0, 1e18, "m")
INTERVAL = AllowedRange(1e-15, 1e12, "s")
RATE = AllowedRange(1e-12, 1e15, "1/s")
TIME = AllowedRange(0.0, 1e18, "s")
ACCELERATION = AllowedRange(0.0, 1e9, "m/s2")
SPEED = AllowedRange(0.0, 1e9, "m/s or rad/s")
FORCE = AllowedRange(0.0, 1e24, "N/m")
FACTOR = AllowedRange(0.0, 1e12, "")

TOLERANCE = AllowedRange(1e-14, 1e15, "")

MOST_STEPS = 1e12
"""Most steps of a run: four months at 10 microseconds each."""
MOST_PASSES = 1000
"""Most passes, solves and renewals within a step."""
MOST_ITERATIONS = 1_000_000
"""Most iterations of one solution."""


def check_size(value: float, limits: AllowedRange, where: str, remedy: str) -> None:
    """Raise ModelError for a number outside its range."""
    fault = limits.fault(value)
    if fault is not None:
        raise ModelError(fault, where=where, remedy=remedy)
