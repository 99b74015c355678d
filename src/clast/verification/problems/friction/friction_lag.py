"""The error of a friction force that is one step old on the incline at 45 degrees.

Over the slide the normal force rises from nothing to N.  Each step takes friction from the normal
force of the step before, so the friction impulse falls short by h N tan(phi) and the block is
faster by h g cos 45 tan(phi) ever after: the way is longer by the share

    (2h/t) tan(phi) / (1 - tan(phi))

of first order in the step h.  It is measured against the same process with friction in the solve.
"""

from __future__ import annotations

import numpy as np

from clast.pictures.verification import Chart, curve, exact_curve
from clast.verification.problems import Trial, problem
from clast.verification.problems.friction.incline import computed_way, exact_way, model_of_incline
from clast.verification.variants import CONVEX, CONVEX_LAGGED, IMPLICIT, LAGGED, Variant

ANGLES = (20.0, 35.0)
DURATION = 0.3
STEPS = (1e-3, 0.5e-3)
WITHOUT_LAG = {LAGGED: IMPLICIT, CONVEX_LAGGED: CONVEX}
"""The same process with friction in the solve."""
REASON = "the steps that find the contact add or miss a few %, less with smaller h"


def exact_excess(friction_angle: float, step: float) -> float:
    """Return by which share the way grows with friction one ``step``, s, old."""
    friction = np.tan(np.radians(friction_angle))
    return float(2.0 * step / DURATION * friction / (1.0 - friction))


def computed_excess(friction_angle: float, step: float, variant: Variant) -> float:
    """Return by which share of the exact way lagged friction slides further."""
    lagged, implicit = (
        0.5 * sum(computed_way(friction_angle, step, one, DURATION))
        for one in (variant, WITHOUT_LAG[variant])
    )
    return (lagged - implicit) / exact_way(friction_angle, DURATION)


def _chart(variant: Variant, excess: np.ndarray) -> Chart:
    """Return the excess (angles, steps), %, over the friction angle."""
    fine = np.linspace(0.0, 40.0, 81)
    exact = (
        exact_curve(
            f"(2h/t) tan/(1-tan), h = {1e3 * step:g} ms",
            fine,
            [100.0 * exact_excess(angle, step) for angle in fine],
        )
        for step in STEPS
    )
    computed = (
        curve(f"{variant.name}, h = {1e3 * step:g} ms", ANGLES, values)
        for step, values in zip(STEPS, excess.T, strict=True)
    )
    return Chart(
        title="excess of the displacement after 0.3 s",
        x_label="friction angle, degrees",
        y_label="excess of the displacement, %",
        curves=(*exact, *computed),
    )


@problem(set_up=model_of_incline, variants=(LAGGED, CONVEX_LAGGED), quick=())
def friction_lag(trial: Trial) -> None:
    """Friction one step old.

    The block on the incline again: with friction taken from the last step's normal force it slides
    too far, by a share that follows from the impulse missing in one step.

    Exact: excess = (2h/t) tan(phi)/(1 - tan(phi)), order 1 in h.
    Source: impulse of the missing friction force.
    Not run with: open-close: its sliding friction is that of the solve before, not of the step
    before, and has no formula of this kind.
    """
    found = []
    for angle in ANGLES:
        excess = [computed_excess(angle, step, trial.variant) for step in STEPS]
        found.append(excess)
        for step, computed in zip(STEPS, excess, strict=True):
            quantity = f"excess of the displacement at {angle:g} degrees, h = {1e3 * step:g} ms"
            exact = exact_excess(angle, step)
            trial.relative(quantity, "", computed, exact, 0.05, REASON)
        order = np.log2(excess[0] / excess[1])
        quantity = f"order of the excess in h at {angle:g} degrees"
        trial.absolute(quantity, "", order, 1.0, 0.1, REASON)
    trial.charts.append(_chart(trial.variant, 100.0 * np.array(found)))
