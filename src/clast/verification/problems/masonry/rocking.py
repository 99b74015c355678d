"""A rocking block: the time of its fall, and the loss of an impact (Housner 1963).

A block b wide and h high stands tilted by t0 on one corner and is let go.  With the half diagonal
R, tan a = b/h and the moment of inertia I_O about the corner it falls back by

    I_O t'' = -m g R sin(a - t),

which is integrated here.  It then strikes the floor with its other corner; its moment of momentum
about that corner is the same just before and after, so that it goes on turning with the share

    r = 1 - (m R2/I_O) (1 - cos 2a)

of its rate.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, KnownFailure, Model, Trial, problem
from clast.verification.variants import BOTH_LAWS, MULTIPLIERS

GRAVITY, WIDTH, HEIGHT = 9.8, 0.5, 2.0
RADIUS = 0.5 * float(np.hypot(WIDTH, HEIGHT))
"""Half diagonal R, m."""
SLENDERNESS = float(np.arctan2(WIDTH, HEIGHT))
"""Angle a at which the block stands on its corner in balance, rad."""
INERTIA = 4.0 / 3.0 * RADIUS**2
"""I_O/m, m2."""
KEPT = 1.0 - RADIUS**2 / INERTIA * (1.0 - np.cos(2.0 * SLENDERNESS))
"""Share r of the rate that an impact leaves."""
TILT = 0.5 * SLENDERNESS
"""Tilt at the start t0, rad."""
DURATION = 1.0
EARLY = "first order in h; the corner stands on a spring"
SHARED = "the impact takes some steps, in which the corner that leaves still carries"


def exact_fall() -> tuple[Floats, Floats, float]:
    """Return time, s, and tilt, rad, until the block strikes, and its rate then, rad/s."""

    def strikes(_: float, state: Floats) -> float:
        return float(state[0])

    strikes.terminal = True  # type: ignore[attr-defined]
    fall = solve_ivp(
        lambda _, state: (state[1], -GRAVITY * RADIUS / INERTIA * np.sin(SLENDERNESS - state[0])),
        (0.0, 10.0),
        (TILT, 0.0),
        events=strikes,
        max_step=0.01,
        rtol=1e-10,
        atol=1e-12,
    )
    return fall.t, fall.y[0], float(fall.y[1, -1])


def tilted_block() -> Model:
    """Return a block standing on its right lower corner, tilted to the right, on a fixed floor."""
    turn = np.array([[np.cos(TILT), np.sin(TILT)], [-np.sin(TILT), np.cos(TILT)]])
    corners = np.array(box(-WIDTH, 0.0, 0.0, HEIGHT))
    builder = new_model(
        "Rocking block", gravity=GRAVITY, young=50e9, density=2700.0, friction_angle=60.0
    )
    builder.block(name="floor", vertices=box(-2, -0.4, 1.5, 0), fixed=True)
    builder.block(name="block", vertices=corners @ turn.T)
    builder.measured_point("centroid", corners.mean(axis=0) @ turn.T, block="block")
    return builder.build()


def exact_next_tilt() -> float:
    """Return how far the block tilts to the other side after the impact, rad."""

    def height(tilt: float) -> float:
        return float(np.cos(SLENDERNESS - tilt) - np.cos(SLENDERNESS))

    return float(brentq(lambda tilt: height(tilt) - KEPT**2 * height(TILT), 0.0, TILT))


@problem(
    set_up=tilted_block,
    variants=BOTH_LAWS,
    known_failures=(
        KnownFailure(
            MULTIPLIERS,
            "tilt after the impact",
            "four solves make the contact four times as stiff: w h is 1.3, and one pass "
            "takes more out of the impact (see bounce); with half the step the error is 1.5 %",
        ),
    ),
)
def rocking(trial: Trial) -> None:
    """Rocking block.

    A block of 0.5 m x 2 m, tilted on its corner by half of the angle at which it would fall over,
    is let go, falls back and rocks on to the other corner; p = 1 GPa, h = 1 ms, friction angle 60
    degrees.

    Exact: I_O t'' = -m g R sin(a - t) until the impact, which leaves 1 - (m R2/I_O)(1 - cos 2a) =
    0.9118 of the rate.
    Source: Housner (1963); the fall integrated by scipy.
    """
    history = trial.variant.run(
        tilted_block(), step=1e-3, end=DURATION, p=1e9, max_displacement=0.02
    ).history("centroid")
    # to the right is clockwise: the block turns back counter-clockwise
    time, tilt = history.time, TILT - history.rotation
    strike = int(np.flatnonzero(tilt <= 0.0)[0])
    rate = float(np.gradient(tilt, time)[:strike].min())
    fall, fallen, exact_rate = exact_fall()
    after = exact_next_tilt()
    trial.relative("time of the fall", "s", time[strike], fall[-1], 0.01, EARLY)
    trial.relative("rate at the impact", "rad/s", rate, exact_rate, 0.01, EARLY)
    trial.relative("tilt after the impact", "rad", -tilt.min(), after, 0.05, SHARED)
    chart = trial.chart("tilt of the block", "time, s", "tilt, rad")
    chart.exact("until the impact", fall, fallen)
    chart.exact("Housner: largest tilt after it", (0.5, DURATION), 2 * [-after])
    chart.computed(time[::30], tilt[::30])
