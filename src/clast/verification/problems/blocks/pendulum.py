"""A block hung on a fixed point swings as a physical pendulum."""

import numpy as np
from scipy.special import ellipk

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, Model, PointHistory, Trial, problem
from clast.verification.variants import LAGGED, WITH_EULER, Variant

GRAVITY, DENSITY = 9.8, 2700.0
WIDTH, HEIGHT = 0.5, 2.0
ARM = 0.5 * HEIGHT
"""Distance l of the centroid from the fixed point, m."""
INERTIA = (WIDTH**2 + HEIGHT**2) / 12.0 + ARM**2
"""I_O/m, m2."""
AMPLITUDES = (1.0, 60.0)
"""Angles at which the block is let go, degrees."""
STEP = 2e-3
SMALL = float(2.0 * np.pi * np.sqrt(INERTIA / (GRAVITY * ARM)))
"""Period of small amplitudes, s."""
GROWS = "constant acceleration lets the amplitude grow, by pi w h/4 a half-swing and more"
TOLERANCES = {1.0: (5e-5, "the formula neglects a^2/16 = 2e-5"), 60.0: (4e-3, GROWS)}
"""Tolerance of the period by amplitude, and its reason."""


def exact_period(amplitude: float) -> float:
    """Return the period, s, of a swing of ``amplitude``, degrees."""
    parameter = np.sin(0.5 * np.radians(amplitude)) ** 2
    return float(4.0 * np.sqrt(INERTIA / (GRAVITY * ARM)) * ellipk(parameter))


def hung_block(amplitude: float = 30.0) -> Model:
    """Return a block of 0.5 m x 2 m hung on the middle of its top, turned by ``amplitude``."""
    turn = np.radians(amplitude)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    half = 0.5 * WIDTH
    corners = np.array(box(-half, -HEIGHT, half, 0.0))
    builder = new_model("Pendulum", gravity=GRAVITY, young=50e9, density=DENSITY)
    builder.block(name="block", vertices=corners @ rotation.T)
    builder.fixed_point((0.0, 0.0))
    builder.measured_point("centroid", rotation @ np.array([0.0, -ARM]))
    return builder.build()


def swing(amplitude: float, variant: Variant) -> PointHistory:
    """Return the motion of the block, let go at ``amplitude``, degrees, over 1.27 periods."""
    return variant.run(
        hung_block(amplitude),
        step=STEP,
        end=1.27 * exact_period(amplitude),
        p=1e9,
        max_displacement=0.1,
    ).history("centroid")


def period(time: Floats, angle: Floats) -> float:
    """Return the time, s, between the first and the third passage through the vertical."""
    before = np.flatnonzero(angle[:-1] * angle[1:] < 0.0)
    share = angle[before] / (angle[before] - angle[before + 1])
    passage = time[before] + share * (time[before + 1] - time[before])
    return float(passage[2] - passage[0])


def exact_growth(variant: Variant) -> float:
    """Return by which share the time scheme lets a small amplitude grow in half a swing."""
    if variant.integrator == "backward-euler":
        return 0.0
    return float(0.25 * np.pi * STEP * np.sqrt(GRAVITY * ARM / INERTIA))


@problem(set_up=hung_block, variants=WITH_EULER, quick=(LAGGED,), few=(AMPLITUDES[:1],))
def pendulum(trial: Trial, amplitudes: tuple[float, ...] = AMPLITUDES) -> None:
    """Pendulum.

    A block of 0.5 m x 2 m is hung on a fixed point in the middle of its top and let go at 1 and at
    60 degrees; g = 9.8 m/s2, h = 2 ms. The period is taken between the first and the third passage
    through the vertical.

    Exact: T = 2 pi sqrt(I_O/(m g l)) small, 4 sqrt(I_O/(m g l)) K(sin(a/2)) large.
    Source: physical pendulum; complete elliptic integral by scipy.
    """
    periods = []
    for amplitude in amplitudes:
        history = swing(amplitude, trial.variant)
        angle = np.radians(amplitude) + history.rotation
        exact = SMALL if amplitude == AMPLITUDES[0] else exact_period(amplitude)
        tolerance, reason = TOLERANCES[amplitude]
        periods.append(period(history.time, angle))
        quantity = f"period at {amplitude:g} degrees"
        trial.relative(quantity, "s", periods[-1], exact, tolerance, reason)
        if amplitude == AMPLITUDES[0]:
            growth = -angle.min() / angle[0] - 1.0
            quantity = "growth of the amplitude in half a swing"
            trial.absolute(
                quantity, "", growth, exact_growth(trial.variant), 2e-5, "of first order in h"
            )
    fine = np.linspace(0.0, 1.1 * AMPLITUDES[-1], 100)
    chart = trial.chart("period of the pendulum", "amplitude, degrees", "period, s")
    chart.exact("4 sqrt(I/(m g l)) K", fine, [exact_period(angle) for angle in fine])
    chart.computed(amplitudes, periods)
