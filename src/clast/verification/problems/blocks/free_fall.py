"""A block thrown into the air: no contact, so the time integration alone is tested."""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Model, Trial, problem
from clast.verification.variants import CONVEX, EULER, LAGGED, OPEN_CLOSE

GRAVITY = 9.8
DURATION = 1.0
STEPS = (5e-3, 2e-2)
THROWN = (3.0, 4.0, 0.5)
"""Velocity (u, v), m/s, and spin, rad/s, of the thrown block."""
ROUND_OFF = "round-off of up to 200 additions"


def block_in_the_air(velocity: tuple[float, float, float] = THROWN) -> Model:
    """Return a block of 1 m x 1 m with a velocity (u, v, omega) in m/s and rad/s."""
    builder = new_model("Free fall", gravity=GRAVITY, young=50e9, density=2700.0)
    builder.block(name="block", vertices=box(0, 0, 1, 1), velocity=velocity)
    builder.measured_point("centroid", (0.5, 0.5))
    return builder.build()


@problem(set_up=block_in_the_air, variants=(LAGGED, EULER, CONVEX, OPEN_CLOSE), quick=(LAGGED,))
def free_fall(trial: Trial) -> None:
    """Free fall and projectile.

    A block falls from rest, and another is thrown with (3, 4) m/s and a spin of 0.5 rad/s; g = 9.8
    m/s2, steps of 5 and 20 ms.

    Exact: (u t, v t - g t^2/2); backward Euler ends g t h/2 below.
    Source: Galilei; the sum of n steps of backward Euler.
    """
    u, v, _ = THROWN
    parabola = GRAVITY * DURATION**2 / 2.0
    time = np.linspace(0.0, DURATION, 101)
    chart = trial.chart("path of the throw", "range, m", "height, m")
    chart.exact("parabola", u * time, v * time - GRAVITY * time**2 / 2.0)
    for step in STEPS:
        fall, throw = (
            trial.variant.run(
                block_in_the_air(velocity), step=step, end=DURATION, p=1e9, max_displacement=0.5
            ).history("centroid")
            for velocity in ((0.0, 0.0, 0.0), THROWN)
        )
        dropped, speed = -fall.displacement[-1, 1], -fall.velocity[-1, 1]
        along, up = throw.displacement[-1]
        at = f"after 1 s, h = {1e3 * step:g} ms"
        if trial.variant.integrator == "backward-euler":
            excess, low = f"beyond the parabola {at}", GRAVITY * DURATION * step / 2.0
            below = v * DURATION - parabola - up
            trial.relative(f"fall {excess}", "m", dropped - parabola, low, 1e-8, ROUND_OFF)
            trial.relative(f"throw {excess}", "m", below, low, 1e-8, ROUND_OFF)
        else:
            height = v * DURATION - parabola
            trial.relative(f"fall {at}", "m", dropped, parabola, 1e-10, ROUND_OFF)
            trial.relative(f"height of throw {at}", "m", up, height, 1e-10, ROUND_OFF)
        trial.relative(f"speed of fall {at}", "m/s", speed, GRAVITY * DURATION, 1e-10, ROUND_OFF)
        trial.relative(f"range of throw {at}", "m", along, u * DURATION, 1e-10, ROUND_OFF)
        every = max(1, len(throw.time) // 20)
        chart.computed(
            *throw.displacement[::every].T, label=f"{trial.variant.name}, h = {1e3 * step:g} ms"
        )
