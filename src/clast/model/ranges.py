"""Names and numbers that can be meant at all, once for case files and for scripts.

The ranges are far wider than rock and masonry need: they exclude numbers that no system of units
explains, and keep the products that the equations make of these numbers (E A / h2, rho L4, ...)
within the range of floating-point numbers.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from clast.errors import ModelError, shortened


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

STEPS_MAX = 1e12
"""Most steps of a run: four months at 10 microseconds each."""
PASSES_MAX = 1000
"""Most passes, solves and renewals within a step."""
ITERATIONS_MAX = 1_000_000
"""Most iterations of one solution."""


def check_size(value: float, limits: AllowedRange, where: str, remedy: str) -> None:
    """Raise ModelError for a number outside its range."""
    fault = limits.fault(value)
    if fault is not None:
        raise ModelError(fault, where=where, remedy=remedy)


CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\ud800-\udfff]")
"""Characters that names do not have: they break files, terminals and pictures."""
NAME_LENGTH_MAX = 200
"""Most characters of a name."""


def check_names(kind: str, names: Sequence[str]) -> None:
    """Refuse names that are not text, blank, too long, not printable, or there twice."""
    if not all(isinstance(name, str) for name in names):
        wrong = next(name for name in names if not isinstance(name, str))
        raise ModelError(
            f"{shortened(repr(wrong))} is not a valid name",
            where=kind,
            remedy='give names as text, e.g. "1"',
        )
    for number, name in enumerate(names, start=1):
        check_text(name, f"{kind} {number}")
    if len(set(names)) < len(names):
        ordered = sorted(names)
        twice = next(name for name, after in pairwise(ordered) if name == after)
        raise ModelError(
            f"there are two {kind}s with that name",
            where=f"{kind} '{shortened(twice)}'",
            remedy="rename one of them",
        )


def check_text(name: str, label: str) -> None:
    """Refuse a name that is blank, too long or not printable; ``label`` names its owner."""
    for what, bad in (
        ("has no name", lambda name: not name.strip()),
        (
            f"has a name of more than {NAME_LENGTH_MAX} characters",
            lambda n: len(n) > NAME_LENGTH_MAX,
        ),
        ("has a name with a character that cannot be printed", CONTROL.search),
    ):
        if bad(name):
            raise ModelError(
                what,
                where=f"{label} {shortened(repr(name))}",
                remedy="give it a short name of letters, digits and blanks",
            )
