"""A block thrown into the air: no contact, so the time integration alone is tested."""

from __future__ import annotations

import numpy as np

from clast.pictures.verification import Chart, Curve, curve, exact_curve
from clast.verification.problem import Comparison, Trial, problem, relative
from clast.verification.problems import InputBuilder, Model, PointHistory
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE, Variant

GRAVITY = 9.8
DURATION = 1.0
STEPS = (5e-3, 2e-2)
THROWN = (3.0, 4.0, 0.5)
"""Velocity (u, v), m/s, and spin, rad/s, of the thrown block."""
EXACT, DIFFERENCE = 1e-10, 1e-8
ROUND_OFF = "round-off of up to 200 additions"


def block_in_the_air(velocity: tuple[float, float, float] = THROWN) -> Model:
    """Return a block of 1 m x 1 m with a velocity (u, v, omega) in m/s and rad/s."""
    builder = InputBuilder(title="Free fall", gravity=(0.0, -GRAVITY))
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.block(name="block", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], velocity=velocity)
    builder.measured_point("centroid", (0.5, 0.5))
    return builder.build()


def flight(velocity: tuple[float, float, float], step: float, variant: Variant) -> PointHistory:
    """Return the computed flight of the centroid over 1 s."""
    model = block_in_the_air(velocity)
    return variant.run(
        model, step=step, end=DURATION, normal_stiffness=1e9, max_displacement=0.5
    ).history("centroid")


def late(step: float, variant: Variant) -> float:
    """Return how far below the parabola, m, the variant's time scheme is after 1 s."""
    return GRAVITY * DURATION * step / 2.0 if variant.integrator == "backward-euler" else 0.0


def compare(
    fall: PointHistory, throw: PointHistory, step: float, too_low: float
) -> list[Comparison]:
    """Return the rows of one step, s; ``too_low`` is the error of the time scheme's fall, m."""
    u, v, _ = THROWN
    parabola = GRAVITY * DURATION**2 / 2.0
    dropped, speed = -fall.displacement[-1, 1], -fall.velocity[-1, 1]
    along, up = throw.displacement[-1]
    at = f"after 1 s, h = {1e3 * step:g} ms"
    rows = [
        relative(f"speed of fall {at}", "m/s", speed, GRAVITY * DURATION, EXACT, ROUND_OFF),
        relative(f"range of throw {at}", "m", along, u * DURATION, EXACT, ROUND_OFF),
    ]
    if too_low == 0.0:
        return [
            relative(f"fall {at}", "m", dropped, parabola, EXACT, ROUND_OFF),
            relative(f"height of throw {at}", "m", up, v * DURATION - parabola, EXACT, ROUND_OFF),
            *rows,
        ]
    excess = f"beyond the parabola {at}"
    below = v * DURATION - parabola - up
    return [
        relative(f"fall {excess}", "m", dropped - parabola, too_low, DIFFERENCE, ROUND_OFF),
        relative(f"throw {excess}", "m", below, too_low, DIFFERENCE, ROUND_OFF),
        *rows,
    ]


def _chart(flights: tuple[Curve, ...]) -> Chart:
    """Return the path of the throw."""
    time = np.linspace(0.0, DURATION, 101)
    u, v, _ = THROWN
    parabola = exact_curve("parabola", u * time, v * time - GRAVITY * time**2 / 2.0)
    return Chart(
        title="path of the throw",
        x_label="range, m",
        y_label="height, m",
        curves=(parabola, *flights),
    )


@problem(set_up=block_in_the_air, variants=(LAGGED, EULER, CONVEX, OPEN_CLOSE), quick=(LAGGED,))
def free_fall(trial: Trial) -> None:
    """Free fall and projectile.

    A block falls from rest, and another is thrown with (3, 4) m/s and a spin of 0.5 rad/s; g = 9.8
    m/s2, steps of 5 and 20 ms.

    Exact: (u t, v t - g t^2/2); backward Euler ends g t h/2 below.
    Source: Galilei; the sum of n steps of backward Euler.
    """
    curves = []
    for step in STEPS:
        fall, throw = (
            flight((0.0, 0.0, 0.0), step, trial.variant),
            flight(THROWN, step, trial.variant),
        )
        trial.rows += compare(fall, throw, step, late(step, trial.variant))
        every = max(1, len(throw.time) // 20)
        label = f"{trial.variant.name}, h = {1e3 * step:g} ms"
        curves.append(curve(label, *throw.displacement[::every].T))
    trial.charts.append(_chart(tuple(curves)))
