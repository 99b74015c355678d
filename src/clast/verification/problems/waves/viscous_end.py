"""A wave runs along a bar of blocks into a viscous end."""

import numpy as np

from clast.verification.problems import BONDED, Floats, Model, Run, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS, Variant

YOUNG, DENSITY = 50e9, 2700.0
SPEED = float(np.sqrt(YOUNG / DENSITY))
"""Wave speed c of the bar, whose rock has no Poisson's ratio, m/s."""
BLOCKS = 32
"""Number of blocks of 1 m x 1 m."""
WAVE_LENGTH = 20.0
"""Length of the wave, m: 20 blocks."""
SOURCE, GAUGE = 10.0, 21.5
"""Middle of the wave at the start, and where it is recorded, m."""
HEIGHT_OF_BELL = 0.01
"""Largest velocity, m/s."""
DURATION = 43.0 / SPEED
DASHPOTS = (1.0, 0.9, 0.5, 0.0)
"""Dashpots a, in units of rho c; the last is the free end."""
PARTED = 0.5 * (GAUGE - SOURCE + 2.0 * BLOCKS - SOURCE - GAUGE) / SPEED
"""When the wave has passed the gauge and its reflection has not arrived, s."""


def bell(place: float) -> float:
    """Return the velocity at the start, m/s, at a place along the bar, m."""
    offset = (place - SOURCE) / WAVE_LENGTH
    return HEIGHT_OF_BELL * float(np.cos(np.pi * offset)) ** 2 if abs(offset) < 0.5 else 0.0


def bar(dashpot: float) -> Model:
    """Return a bar with a wave that runs to the right, to an end with a dashpot in rho c."""
    builder = new_model("Viscous end", young=YOUNG, density=DENSITY, poisson=0.0)
    builder.add_joint(**BONDED)
    for k in range(BLOCKS):
        speed = bell(k + 0.5)
        builder.block(
            name=str(k),
            vertices=box(k, 0, k + 1, 1),
            velocity=(speed, 0.0, 0.0),
            initial_stress=(-DENSITY * SPEED * speed, 0.0, 0.0),
        )
    if dashpot > 0.0:
        builder.viscous_boundary(side="right", normal=dashpot)
    builder.measured_point("gauge", (GAUGE, 0.5), block=str(int(GAUGE)))
    return builder.build()


def run(dashpot: float, variant: Variant) -> Run:
    """Return the run until the wave would be back at its start."""
    return variant.run(bar(dashpot), step=2.5e-5, end=DURATION, p=1e13, max_displacement=0.01)


def returned(one: Run) -> Floats:
    """Return the velocities, m/s, that come back past the gauge."""
    history = one.history("gauge")
    return np.asarray(history.velocity[history.time > PARTED, 0])


@problem(set_up=lambda: bar(1.0), variants=EACH_PROCESS, few=((1.0, 0.0),))
def viscous_end(trial: Trial, dashpots: tuple[float, ...] = DASHPOTS) -> None:
    """Viscous end of a bar.

    A bar of 32 blocks of 1 m x 1 m, bonded, without gravity; a bell of velocity 20 m long, 10 mm/s
    high, runs to the right, to dashpots of a rho c: a = 1, 0.9, 0.5, and 0, a free end. E = 50 GPa,
    nu = 0, rho = 2700 kg/m3, p = 10 TPa, h = 25 us.

    Exact: the stress (a - 1)/(a + 1) comes back, nothing with a = 1.
    Source: Lysmer & Kuhlemeyer (1969).
    """
    runs = {dashpot: run(dashpot, trial.variant) for dashpot in dashpots}
    whole = returned(runs[0.0])
    for dashpot in dashpots[:-1]:
        back = returned(runs[dashpot])
        count = min(len(back), len(whole))
        # velocity comes back with the sign that stress has not
        share = -float(back[:count] @ whole[:count] / (whole[:count] @ whole[:count]))
        exact = (dashpot - 1.0) / (dashpot + 1.0)
        quantity = f"reflected stress, a = {dashpot:g}"
        trial.absolute(quantity, "", share, exact, 0.01, "20 blocks a wave length")
    held = np.sum([runs[1.0].energy[key] for key in ("kinetic", "elastic", "contact")], axis=0)
    left = float(held[-1] / held[0])
    trial.absolute("energy left, a = 1", "", left, 0.0, 0.01, "20 blocks a wave length")
    balance = runs[1.0].energy["boundary"][-1] / runs[1.0].energy["kinetic"][0] / 2.0
    quantity = "energy through the boundary, a = 1"
    trial.absolute(quantity, "", balance, 1.0, 0.12, "the scheme takes the rest")
    time = np.linspace(0.0, DURATION, 300)
    chart = trial.chart("velocity at the gauge", "time, ms", "velocity, mm/s")
    for dashpot, one in runs.items():
        echo = -(dashpot - 1.0) / (dashpot + 1.0)
        there = np.array([bell(GAUGE - SPEED * t) for t in time])
        back = np.array([echo * bell(2.0 * BLOCKS - GAUGE - SPEED * t) for t in time])
        chart.exact(f"a = {dashpot:g}", 1e3 * time, 1e3 * (there + back))
        history = one.history("gauge")
        velocity = history.velocity[::20, 0]
        chart.computed(1e3 * history.time[::20], 1e3 * velocity, f"a = {dashpot:g}")
