"""A block on dashpots alone: it sinks with the speed at which these carry its weight."""

import numpy as np

from clast.verification.problems import Floats, Model, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS

GRAVITY, DENSITY, YOUNG = 9.8, 2500.0, 2.5e5
SIZE = (1.0, 0.2)
"""Width b and height, m."""
SHARE = 0.05
"""Dashpots, in units of rho c_p: so soft that the block itself is rigid."""
SPEED = float(np.sqrt(YOUNG / DENSITY))
"""c_p with nu = 0, m/s."""
TIME = SIZE[1] / (SHARE * SPEED)
"""Time T, s."""
STEP, DURATION = TIME / 400.0, 4.0 * TIME


def on_dashpots() -> Model:
    """Return a block with dashpots at its bottom, and nothing else that holds it."""
    width, height = SIZE
    builder = new_model("Sinking block", gravity=GRAVITY, young=YOUNG, density=DENSITY, poisson=0.0)
    builder.block(name="block", vertices=box(0, 0, width, height))
    builder.viscous_boundary(side="bottom", normal=SHARE, static="none")
    builder.measured_point("middle", (0.5 * width, 0.5 * height), block="block")
    return builder.build()


def exact_sinking(time: Floats) -> Floats:
    """Return how far the block has sunk at times, s, m."""
    return np.asarray(GRAVITY * TIME * (time - TIME * (1.0 - np.exp(-time / TIME))))


@problem(set_up=on_dashpots, variants=EACH_PROCESS)
def sinking_block(trial: Trial) -> None:
    """Block that sinks on dashpots.

    A block of 1 m x 0.2 m, 2500 kg/m3, on a viscous boundary of 0.05 rho c_p that holds nothing
    back (static = "none"), under gravity for four times T; E = 0.25 MPa, so that c_p is 10 m/s, nu
    = 0; 400 steps in T.

    Exact: v = (m g/(rho c_p b)) (1 - exp(-t/T)), T = m/(rho c_p b).
    Source: a mass on a dashpot.
    """
    run = trial.variant.run(on_dashpots(), step=STEP, end=DURATION, p=1e8, max_displacement=0.5)
    history = run.history("middle")
    sunk, speed = -history.displacement[:, 1], -float(history.velocity[-1, 1])
    weight = SIZE[0] * SIZE[1] * DENSITY * GRAVITY
    exact = float(exact_sinking(np.array([DURATION]))[0])
    final = GRAVITY * TIME * (1.0 - np.exp(-DURATION / TIME))
    taken = weight * exact - 0.5 * weight / GRAVITY * final**2
    soft = "first order in h; the block gives by a hundredth of its height"
    trial.relative("displacement", "m", float(sunk[-1]), exact, 5e-3, soft)
    trial.relative("speed", "m/s", speed, final, 5e-3, soft)
    trial.relative("energy taken", "J/m", float(run.energy["boundary"][-1]), taken, 5e-3, soft)
    chart = trial.chart("displacement of the block", "time, s", "displacement down, m")
    chart.exact("formula", history.time, exact_sinking(history.time))
    chart.computed(history.time[::80], sunk[::80])
