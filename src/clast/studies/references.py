"""A run beside the displacements that its case knows from elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.case.case_file import Case
from clast.results import Run

Vector = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """How far a measured point is from where a reference has it."""

    point: str
    """Measured point."""
    time: float
    """Time of the reference, s."""
    reference: Vector
    """Displacement (u, v) of the reference, m."""
    computed: Vector | None
    """Displacement (u, v) of the run at that time, m; None where the run ended before."""
    source: str
    """Where the reference comes from."""

    @property
    def distance(self) -> float | None:
        """Distance between computed and reference, m."""
        if self.computed is None:
            return None
        return float(np.hypot(*np.subtract(self.computed, self.reference)))

    @property
    def relative(self) -> float | None:
        """Distance over the length of the reference, -; None for a reference of zero."""
        length = float(np.hypot(*self.reference))
        if self.distance is None or length == 0.0:
            return None
        return self.distance / length

    def as_text(self) -> str:
        """Return the error in words: in % of the reference, or in m where that is zero."""
        if self.distance is None:
            return "not reached"
        if self.relative is None:
            return f"{self.distance:.3g} m"
        return f"{100.0 * self.relative:.3g} %"

    def as_dict(self) -> dict[str, Any]:
        """Return the deviation as plain numbers and texts, ready for JSON."""
        computed = None if self.computed is None else list(self.computed)
        return {
            "point": self.point,
            "time": self.time,
            "reference": list(self.reference),
            "computed": computed,
            "distance": self.distance,
            "relative": self.relative,
            "source": self.source,
        }


def deviations(case: Case, run: Run) -> tuple[Deviation, ...]:
    """Return how far a run of a case is from each of its references."""
    return tuple(
        Deviation(
            point=reference.point,
            time=reference.time or case.time.end,
            reference=reference.displacement,
            computed=displacement_at(run, reference.point, reference.time or case.time.end),
            source=reference.source,
        )
        for reference in case.reference
    )


def displacement_at(run: Run, point: str, time: float) -> Vector | None:
    """Return the displacement (u, v) of a measured point, m, at a time, s, between steps linear.

    None where the run ended before.
    """
    history = run.history(point)
    if history.time[-1] < time * (1.0 - 1e-9):
        return None
    u, v = (float(np.interp(time, history.time, each)) for each in history.displacement.T)
    return u, v
