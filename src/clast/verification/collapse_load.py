"""Limits of equilibrium, found by loading a system slowly and seeing whether it keeps moving.

Velocities are dropped after every step (dynamic_ratio = 0).  A system with an equilibrium then
comes to rest; one without fails, or, with a process that cannot take long steps, moves by d = theta
a h2 in every step, a being the acceleration of its unbalanced force, which stays above a small
share of gravity.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from clast.model.model import Model
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import Bracket
from clast.verification.variants import Variant

AT_REST = 5e-4
"""Unbalanced acceleration over g below which a system holds."""
LAST = 20
"""Steps at the end that are looked at."""


@dataclass(frozen=True, kw_only=True)
class StaticRun:
    """Numbers of the static runs that show whether the blocks of a model stand."""

    p: float
    """Normal stiffness, N/m per m."""
    step: float
    """Step, s."""
    steps: int
    """Number of steps."""
    max_displacement: float = 0.02
    """Largest displacement of a step, and of blocks that stand, m."""
    bisections: int = 4
    """Halvings of the range in which a limit is searched."""
    unit: float | None = None
    """Acceleration of reference, m/s2; gravity if None."""

    def unbalanced(self, model: Model, variant: Variant) -> float:
        """Return the largest unbalanced acceleration of measured points at the end, over ``unit``.

        It is inf for a run that has failed, and for one whose points have moved by more than
        ``max_displacement``: blocks that move far may come to rest somewhere else.
        """
        numbers = {"p": self.p, "max_displacement": self.max_displacement}
        method = variant.method(model, **numbers, dynamic_ratio=0.0)
        end = self.steps * self.step
        run = simulate(model, method, Schedule(step=self.step, end=end, every=end))
        if any(event.kind == "fails" for event in run.report.events):
            return math.inf
        points = [run.history(name).displacement for name in model.measured_points.name]
        if max(float(np.hypot(*one[-1])) for one in points) > self.max_displacement:
            return math.inf
        a_step = max(float(np.hypot(*(one[-1] - one[-1 - LAST]))) for one in points) / LAST
        unit = float(np.hypot(*model.gravity)) if self.unit is None else self.unit
        return a_step / (method.integrator.theta * self.step**2 * unit)

    def stands(self, model: Model, variant: Variant) -> bool:
        """Return whether the blocks of a model stand at the end."""
        return self.unbalanced(model, variant) < AT_REST

    def limit(
        self, variant: Variant, loaded: Callable[[float], Model], low: float, high: float
    ) -> Bracket:
        """Return the bracket of the value between ``low``, which fails, and ``high``, which stands.

        ``loaded`` makes the model of a value.
        """
        return limit(lambda value: self.stands(loaded(value), variant), low, high, self.bisections)


def limit(holds: Callable[[float], bool], low: float, high: float, bisections: int) -> Bracket:
    """Return the bracket of the value between ``low``, which fails, and ``high``, which holds.

    Both ends are those of the search where no value between them was tried on that side.
    """
    for _ in range(bisections):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return Bracket(low, high)
