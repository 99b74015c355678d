"""A block thrown down an incline that is flatter than its friction angle: it stops and stays."""

import numpy as np

from clast.verification.problems import Model, Trial, new_model, problem
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE, WITH_EULER

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
    builder = new_model("Decelerating block", gravity=GRAVITY, young=50e9, density=2700.0)
    builder.add_joint(friction_angle=FRICTION_ANGLE)
    builder.block(name="slope", vertices=[0 * along, (4 * along[0], 0), 4 * along], fixed=True)
    low = 2.5 * along
    corners = [low, low + along, low + along + 0.5 * up, low + 0.5 * up]
    u, v = -SPEED * along
    builder.block(name="block", vertices=corners, velocity=(u, v, 0.0))
    builder.measured_point("centroid", low + 0.5 * along + 0.25 * up, block="block")
    return builder.build()


@problem(set_up=slope_with_block, variants=WITH_EULER)
def decelerating_block(trial: Trial) -> None:
    """Decelerating block.

    A block of 1 m x 0.5 m slides at 1 m/s down a slope of 20 degrees with a friction angle of 30
    degrees; g = 9.8 m/s2, h = 1 ms, p = 0.1 GPa. It stops and stays.

    Exact: v0^2 / (2 g (cos a tan phi - sin a)); creep 0.
    Source: Newton's law of a sliding block.
    """
    history = trial.variant.run(
        slope_with_block(), step=STEP, end=DURATION, p=1e8, max_displacement=0.01
    ).history("centroid")
    moved = -history.displacement @ np.array([np.cos(SLOPE), np.sin(SLOPE)])
    watched = moved[history.time >= DURATION - WATCHED]
    creep = float(np.ptp(watched)) / WATCHED
    exact = SPEED**2 / (2.0 * DECELERATION)
    tolerance, reason = TOLERANCES[trial.variant.name]
    trial.relative("stopping distance", "m", moved[-1], exact, tolerance, reason)
    quantity = "creep after it has stopped"
    trial.absolute(quantity, "m/s", creep, 0.0, 1e-9, "vibration of the springs dies")
    fine = np.linspace(0.0, DURATION, 151)
    sliding = np.minimum(fine, SPEED / DECELERATION)
    slid = SPEED * sliding - DECELERATION * sliding**2 / 2
    chart = trial.chart("displacement down the slope", "time, s", "displacement, m")
    chart.exact("v₀ t − a t²/2 until it stops", fine, slid)
    chart.computed(history.time[::75], moved[::75])
