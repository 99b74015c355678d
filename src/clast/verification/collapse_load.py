"""Limits of equilibrium, found by loading a system slowly and seeing whether it keeps moving.

Velocities are dropped after every step (dynamic_ratio = 0).  A system with an equilibrium then
comes to rest; one without fails, or, with a process that cannot take long steps, moves by d = theta
a h2 in every step, a being the acceleration of its unbalanced force, which stays above a small
share of gravity.
"""

from __future__ import annotations

import math
from collections.abc import Callable

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


def unbalanced(
    model: Model,
    variant: Variant,
    *,
    normal_stiffness: float,
    step: float,
    steps: int,
    max_displacement: float,
    unit: float | None = None,
) -> float:
    """Return the largest unbalanced acceleration of the measured points at the end, over g.

    Without gravity ``unit``, m/s2, is the reference.

    It is inf for a run that has failed, and for one whose points have moved by more than
    ``max_displacement``, m: blocks that move far may come to rest somewhere else.
    """
    method = variant.method(
        model,
        normal_stiffness=normal_stiffness,
        max_displacement=max_displacement,
        dynamic_ratio=0.0,
    )
    end = steps * step
    run = simulate(model, method, Schedule(step=step, end=end, every=end))
    if any(event.kind == "fails" for event in run.report.events):
        return math.inf
    ways = [run.history(name).displacement[-1] for name in model.measured_points.name]
    if float(np.hypot(*np.array(ways).T).max()) > max_displacement:
        return math.inf
    moved = [
        run.history(name).displacement[-1] - run.history(name).displacement[-1 - LAST]
        for name in model.measured_points.name
    ]
    a_step = float(np.hypot(*np.array(moved).T).max()) / LAST
    gravity = float(np.hypot(*model.gravity)) if unit is None else unit
    return a_step / (method.integrator.theta * step**2 * gravity)


def standing(
    model: Model,
    variant: Variant,
    *,
    normal_stiffness: float,
    step: float,
    steps: int,
    max_displacement: float,
    unit: float | None = None,
) -> bool:
    """Return whether the blocks of a static run stand at its end; arguments as of unbalanced()."""
    moving = unbalanced(
        model,
        variant,
        normal_stiffness=normal_stiffness,
        step=step,
        steps=steps,
        max_displacement=max_displacement,
        unit=unit,
    )
    return moving < AT_REST


def limit(holds: Callable[[float], bool], low: float, high: float, bisections: int) -> Bracket:
    """Return the bracket of the value between ``low``, which fails, and ``high``, which holds.

    Both ends are those of the search where no value between them was tried on that side.
    """
    for _ in range(bisections):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return Bracket(low, high)
