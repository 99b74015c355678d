"""How the error falls with the step: observed order of convergence."""

from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from clast.verification.problems import Trial, problem
from clast.verification.problems.blocks import pendulum
from clast.verification.problems.contact import bounce
from clast.verification.variants import CONVEX, LAGGED, WITH_EULER, Variant

AMPLITUDE, SWUNG = 60.0, 0.5
"""Amplitude of the pendulum, degrees, and time of its swing, s."""
WEIGHT = 9.8
"""Acceleration of gravity, m/s2."""
PRESSED = 1.0 / bounce.FREQUENCY
"""Time that the block presses on its contact springs, s: 1/w."""
NUMBERS = (50, 100)
"""Numbers of steps."""
REASON = "the order is that of the limit of small steps"


def exact_angle() -> float:
    """Return the angle of the pendulum after its swing, rad, integrated by scipy to 1e-11."""
    factor = pendulum.GRAVITY * pendulum.ARM / pendulum.INERTIA
    swing = solve_ivp(
        lambda _, state: (state[1], -factor * np.sin(state[0])),
        (0.0, SWUNG),
        (np.radians(AMPLITUDE), 0.0),
        rtol=1e-11,
        atol=1e-13,
    )
    return float(swing.y[0, -1])


def angle(steps: int, variant: Variant) -> float:
    """Return the computed angle of the pendulum, rad."""
    run = variant.run(
        pendulum.hung_block(AMPLITUDE), step=SWUNG / steps, end=SWUNG, p=1e9, max_displacement=0.3
    )
    return float(np.radians(AMPLITUDE) + run.history("centroid").rotation[-1])


def exact_depth() -> float:
    """Return how deep the block presses in, m: (g/w2) (1 - cos(w t))."""
    turned = bounce.FREQUENCY * PRESSED
    return float(WEIGHT / bounce.FREQUENCY**2 * (1.0 - np.cos(turned)))


def depth(steps: int, variant: Variant) -> float:
    """Return the computed depth, m, of a block that is put down and let go."""
    model = bounce.block_above_floor(0.0)
    still = np.zeros_like(model.velocity)
    model = replace(model, velocity=still, gravity=np.array([0.0, -WEIGHT]))
    run = variant.run(
        model, step=PRESSED / steps, end=PRESSED, p=bounce.STIFFNESS, max_displacement=0.1
    )
    return -float(run.history("centroid").displacement[-1, 1])


MOTIONS = {"swing": (angle, exact_angle), "press": (depth, exact_depth)}
"""Computed and exact value of each motion."""


@problem(set_up=lambda: pendulum.hung_block(AMPLITUDE), variants=WITH_EULER, quick=(LAGGED, CONVEX))
def order(trial: Trial) -> None:
    """Order of convergence in the step.

    A pendulum let go at 60 degrees swings for 0.5 s, and a block let go on its contact springs
    presses on them for 1/w; both with 50 and with 100 steps. The order of sliding with friction
    that lags is in the problem friction-lag.

    Exact: error proportional to h: order 1.
    Source: pendulum integrated by scipy; (g/w2) (1 - cos(w t)).
    """
    chart = trial.chart("error over the number of steps", "steps", "relative error", log="xy")
    chart.exact("1/(2 n)", NUMBERS, 0.5 / np.array(NUMBERS))
    for name, (computed, exact) in MOTIONS.items():
        error = np.array([abs(computed(n, trial.variant) / exact() - 1.0) for n in NUMBERS])
        order = float(np.log2(error[0] / error[1]))
        trial.absolute(f"order of the {name}", "", order, 1.0, 0.1, REASON)
        chart.computed(NUMBERS, error, name)
