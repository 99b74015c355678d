"""A block strains to and fro: damping by mass and elasticity, adapted to it, and by stops.

A free block of length L that is pressed lengthwise and let go strains with

    w^2 = 12 E/(rho L^2)

Damping with the ratio z takes from each peak to the next the share exp(-d) of the height,

    d = 2 pi z/sqrt(1 - z^2),    z = c/(2 w) by mass, s w/2 by elasticity

(Clough & Penzien 1993).  Adaptive damping finds w from the motion.  Kinetic damping stops the block
where it passes its equilibrium, at T/4, and takes all the energy that it began with.
"""

from typing import Any

import numpy as np

from clast.actions.action import Action
from clast.actions.damping import Adaptive, Kinetic, Rayleigh
from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, box, problem
from clast.verification.variants import CONVEX, LAGGED, MIDPOINT, OPEN_CLOSE, Variant

YOUNG, DENSITY, LENGTH, PRESSED = 2e9, 2000.0, 2.0, -1e5
"""E, Pa, rho, kg/m3, length, m, and stress at the start, Pa."""
CIRCULAR = float(np.sqrt(12.0 * YOUNG / (DENSITY * LENGTH**2)))
"""w, 1/s."""
PERIOD = 2.0 * np.pi / CIRCULAR
RATIO, STEPS, PERIODS = 0.05, 200, 3
"""Damping ratio z, steps a period, periods."""
DAMPINGS: dict[str, Action] = {
    "by mass": Rayleigh(mass=2.0 * RATIO * CIRCULAR),
    "by elasticity": Rayleigh(stiffness=2.0 * RATIO / CIRCULAR),
    "adaptive": Adaptive(ratio=RATIO),
}
DECREMENT = float(2.0 * np.pi * RATIO / np.sqrt(1.0 - RATIO**2))
"""d, -."""
TURNED = 2.0 * np.pi / STEPS
"""w h, by which a step turns the motion, rad."""
END_FORCES = 0.5 * np.pi * TURNED
"""Phase that forces at the end of a step add to d: pi w h/2."""
AT_END = f"forces at the end of a step add pi w h/2 = {END_FORCES:.3f}, which the answer has"
NOT_ADDED = "peaks are those of parabolas through three steps"


def block() -> Model:
    """Return the block, pressed along x."""
    builder = InputBuilder(title="Damped block", gravity=(0.0, 0.0))
    stress = (PRESSED, 0.0, 0.0)
    builder.add_rock("rock", young=YOUNG, poisson=0.0, density=DENSITY, initial_stress=stress)
    half = 0.5 * LENGTH
    builder.block(name="block", vertices=box(-half, 0, half, 1))
    builder.measured_point("face", (half, 0.5), block="block")
    return builder.build()


def strained(damping: Action, variant: Variant, periods: float) -> Run:
    """Return the run of some periods with a damping."""
    numbers: dict[str, Any] = {"p": YOUNG, "max_displacement": 0.1, "damping": damping}
    return variant.run(block(), step=PERIOD / STEPS, end=periods * PERIOD, **numbers)


def decrement(run: Run) -> float:
    """Return the mean of ln(peak/next peak) of the face's distance from its equilibrium."""
    away = swing(run)
    top = np.flatnonzero((away[1:-1] > away[:-2]) & (away[1:-1] >= away[2:])) + 1
    # heights of parabolas through three points
    before, peak, after = away[top - 1], away[top], away[top + 1]
    height = peak + (after - before) ** 2 / (8.0 * (2.0 * peak - before - after))
    return float(np.log(height[0] / height[-1]) / (len(height) - 1))


def swing(run: Run) -> Floats:
    """Return how far the face is from its equilibrium, m, shape (t,)."""
    rest = -PRESSED / YOUNG * 0.5 * LENGTH
    return np.asarray(run.history("face").displacement[:, 0] - rest)


@problem(set_up=block, variants=(MIDPOINT, CONVEX, LAGGED, OPEN_CLOSE), quick=(MIDPOINT,))
def damped_block(trial: Trial) -> None:
    """A block that strains to and fro, damped in four ways.

    A free block of 2 m x 1 m (E = 2 GPa, nu = 0, 2000 kg/m3) with 0.1 MPa in it at the start,
    damped with 5 % of critical by mass, by elasticity and adaptively, over 3 periods of 200 steps;
    and stopped by kinetic damping. Steps in which adaptive damping acts take forces at their end,
    whatever the scheme.

    Exact: ln of peaks = 2 pi z/sqrt(1 - z^2), z = c/(2 w) or s w/2; stops at T/4, with nothing
    left.
    Source: Clough & Penzien (1993), free damped vibration.
    """
    time = np.linspace(0.0, PERIODS, 200)
    height = -PRESSED / YOUNG * 0.5 * LENGTH * 1e3
    even = -height * np.exp(-RATIO * 2.0 * np.pi * time) * np.cos(2.0 * np.pi * time)
    chart = trial.chart("distance from equilibrium", "periods", "distance, mm")
    chart.exact("formula", time, even)
    half_way = trial.variant.integrator == "midpoint"
    for name, damping in DAMPINGS.items():
        run = strained(damping, trial.variant, PERIODS)
        # steps that carry a share of the velocities take forces at their end by any scheme
        kept = half_way and not isinstance(damping, Adaptive)
        exact, reason = (DECREMENT, NOT_ADDED) if kept else (DECREMENT + END_FORCES, AT_END)
        trial.relative(f"decrement, {name}", "", decrement(run), exact, 5e-3, reason)
        every = STEPS // 8
        cycles = run.history("face").time[::every] / PERIOD
        chart.computed(cycles, 1e3 * swing(run)[::every], name)
    stopped = strained(Kinetic(), trial.variant, 1.0)
    energy = stopped.energy
    whole = energy["elastic"][0]
    moving = stopped.history("face")
    first = float(moving.time[1 + np.argmax(np.diff(energy["damping"]) > 0.5 * whole)])
    taken, what = float(energy["damping"][-1]), "energy that kinetic damping takes"
    left = whole if half_way else whole * (1.0 - 0.25 * np.pi * TURNED)
    trial.relative(what, "J/m", taken, left, 5e-3, "the steps before and after the peak")
    trial.absolute(
        "kinetic damping stops, over the period",
        "",
        first / PERIOD,
        0.25,
        3.0 / STEPS,
        "the step after that in which the energy has fallen",
    )
