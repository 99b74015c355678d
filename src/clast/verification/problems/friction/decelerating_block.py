"""A block thrown down an incline that is flatter than its friction angle: it stops and stays."""

from __future__ import annotations

import numpy as np

from clast.pictures.verification import Chart, curve, exact_curve
from clast.verification.problems import InputBuilder, Model, PointHistory, Trial, problem
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE, Variant

GRAVITY = 9.8
SLOPE = np.radians(20.0)
FRICTION_ANGLE = 30.0
SPEED = 1.0
"""Speed down the slope at the start, m/s."""
DECELERATION = GRAVITY * float(np.cos(SLOPE) * np.tan(np.radians(FRICTION_ANGLE)) - np.sin(SLOPE))
"""Deceleration, m/s2."""
DURATION = 1.5
WATCHED = 0.5
"""Time at the end over which the block must stay, s."""
STEP = 1e-3

FRICTION = GRAVITY * float(np.cos(SLOPE) * np.tan(np.radians(FRICTION_ANGLE)))
"""Deceleration by friction alone, m/s2."""
LATE = (
    1.1 * 2.0 * STEP * FRICTION / SPEED,
    "friction one step late leaves a speed of h g cos a tan phi: 1.06 % of the displacement",
)
TOLERANCES = {
    LAGGED.name: LATE,
    OPEN_CLOSE.name: LATE,
    CONVEX.name: (5e-4, "friction inside the solve: as on the incline"),
    EULER.name: LATE,
}
"""Tolerance of the stopping distance by variant, and its reason."""


def slope_with_block() -> Model:
    """Return a fixed wedge at 20 degrees and a block of 1 m x 0.5 m sliding down it."""
    along = np.array([np.cos(SLOPE), np.sin(SLOPE)])
    up = np.array([-along[1], along[0]])
    builder = InputBuilder(title="Decelerating block", gravity=(0.0, -GRAVITY))
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=FRICTION_ANGLE)
    builder.block(name="slope", vertices=[0 * along, (4 * along[0], 0), 4 * along], fixed=True)
    low = 2.5 * along
    corners = [low, low + along, low + along + 0.5 * up, low + 0.5 * up]
    u, v = -SPEED * along
    builder.block(name="block", vertices=corners, velocity=(u, v, 0.0))
    builder.measured_point("centroid", low + 0.5 * along + 0.25 * up, block="block")
    return builder.build()


def way(history: PointHistory) -> np.ndarray:
    """Return the displacement down the slope over time, m."""
    return -history.displacement @ np.array([np.cos(SLOPE), np.sin(SLOPE)])


def _chart(variant: Variant, time: np.ndarray, moved: np.ndarray) -> Chart:
    """Return the way over time."""
    stop = SPEED / DECELERATION
    fine = np.linspace(0.0, DURATION, 151)
    sliding = np.minimum(fine, stop)
    return Chart(
        title="displacement down the slope",
        x_label="time, s",
        y_label="displacement, m",
        curves=(
            exact_curve(
                "v₀ t − a t²/2 until it stops",
                fine,
                SPEED * sliding - DECELERATION * sliding**2 / 2,
            ),
            curve(variant.name, time[::75], moved[::75]),
        ),
    )


@problem(set_up=slope_with_block, variants=(LAGGED, EULER, OPEN_CLOSE, CONVEX), quick=(CONVEX,))
def decelerating_block(trial: Trial) -> None:
    """Decelerating block.

    A block of 1 m x 0.5 m slides at 1 m/s down a slope of 20 degrees with a friction angle of 30
    degrees; g = 9.8 m/s2, h = 1 ms, p = 0.1 GPa. It stops and stays.

    Exact: v0^2 / (2 g (cos a tan phi - sin a)); creep 0.
    Source: Newton's law of a sliding block.
    """
    model = slope_with_block()
    history = trial.variant.run(
        model, step=STEP, end=DURATION, normal_stiffness=1e8, max_displacement=0.01
    ).history("centroid")
    moved = way(history)
    watched = moved[history.time >= DURATION - WATCHED]
    creep = float(np.ptp(watched)) / WATCHED
    exact = SPEED**2 / (2.0 * DECELERATION)
    tolerance, reason = TOLERANCES[trial.variant.name]
    trial.relative("stopping distance", "m", moved[-1], exact, tolerance, reason)
    trial.absolute(
        "creep after it has stopped", "m/s", creep, 0.0, 1e-9, "vibration of the springs dies"
    )
    trial.charts.append(_chart(trial.variant, history.time, moved))
