"""A block bounces on its contact springs.

A block of mass m that lands flat on n springs of stiffness p swings with w = sqrt(n p/m) and leaves
after half a swing.  With the force of the end of the step a time scheme damps it: theta = 1/2 of
that force in the displacement (constant acceleration) or all of it (theta = 1, backward Euler)
multiplies the amplitude by (1 + theta (w h)2)^(-1/2) each step.  The restitution, the speed after
over the speed before, is about

    exp(-pi w h (theta_in + theta_out)/4)

with the theta of closing and of opening: exp(-pi w h/4) with constant acceleration, exp(-pi w h/2)
with backward Euler.  A single bounce scatters about it with the share of a step at which the block
arrives.  The convex process has a restitution of its own (see restitution).
"""

import numpy as np

from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import EULER, LAGGED, OPEN_CLOSE, PASSES, Variant

SPEED = 0.1
"""Speed of the block before it lands, m/s."""
STIFFNESS = 1e7
"""Stiffness p of each contact spring, N/m per m; the block is 5,000 times stiffer."""
DENSITY = 2700.0
FREQUENCY = float(np.sqrt(2.0 * STIFFNESS / DENSITY))
"""Circular frequency w of the block of 1 m2 on two springs, 1/s."""
STEPS = (0.05, 0.1, 0.2, 0.5)
"""w h."""
FEW = STEPS[2:]
"""w h where time is short."""
THETAS = {LAGGED.name: 1.0, PASSES.name: 1.0, OPEN_CLOSE.name: 1.0, EULER.name: 2.0}
"""theta_in + theta_out by variant."""
ARRIVALS = np.arange(8) / 8.0
"""Shares of a step at which the block arrives."""


def block_above_floor(gap: float = 0.1) -> Model:
    """Return a block of 1 m x 1 m moving down towards a fixed floor ``gap``, m, below it."""
    builder = new_model("Bounce", young=5000.0 * STIFFNESS, density=DENSITY)
    builder.block(name="floor", vertices=box(-1, -0.5, 2, 0), fixed=True)
    builder.block(name="block", vertices=box(0, gap, 1, 1 + gap), velocity=(0.0, -SPEED, 0.0))
    builder.measured_point("centroid", (0.5, 0.5 + gap), block="block")
    return builder.build()


def restitution_of(step: float, arrival: float, variant: Variant) -> float:
    """Return the restitution of a block that lands ``arrival`` of a ``step``, s, into a step."""
    run = variant.run(
        block_above_floor(SPEED * step * (1.0 + arrival)),
        step=step,
        end=1.5 * np.pi / FREQUENCY + 8.0 * step,
        p=STIFFNESS,
        max_displacement=0.1,
    )
    return float(run.history("centroid").velocity[-1, 1]) / SPEED


def exact_restitution(step: float, variant: Variant) -> float:
    """Return the restitution for w h = ``step``."""
    return float(np.exp(-0.25 * np.pi * step * THETAS[variant.name]))


@problem(
    set_up=block_above_floor,
    variants=(LAGGED, PASSES, EULER, OPEN_CLOSE),
    quick=(LAGGED,),
    few=(FEW,),
)
def bounce(trial: Trial, steps: tuple[float, ...] = STEPS) -> None:
    """Bounce on the contact springs.

    A block of 1 m x 1 m lands flat on a fixed floor at 0.1 m/s without gravity; p = 10 MPa, rho =
    2700 kg/m3. The restitution comes from the numerical damping of the time scheme; it is averaged
    over eight instants of arrival within a step.

    Exact: exp(-pi w h (theta_in + theta_out)/4), w = sqrt(2 p/m): exp(-pi w h/4) with constant
    acceleration, exp(-pi w h/2) with backward Euler.
    Source: spectral radius of the time scheme for an undamped oscillator.
    Not run with: convex: it has a restitution of its own, which the problem restitution compares.
    """
    trial.rows, computed = [], []
    for step in steps:
        restitutions = [
            restitution_of(step / FREQUENCY, arrival, trial.variant) for arrival in ARRIVALS
        ]
        computed.append(restitutions)
        quantity = f"restitution at w h = {step:g}, mean of 8 arrivals"
        exact = exact_restitution(step, trial.variant)
        reason = "the formula neglects (w h)^2"
        trial.absolute(quantity, "", float(np.mean(restitutions)), exact, 0.3 * step**2, reason)
    fine = np.linspace(0.0, max(STEPS), 51)
    chart = trial.chart("restitution", "ω h", "speed after / speed before")
    values = [exact_restitution(step, trial.variant) for step in fine]
    chart.exact(f"exp(-{0.25 * THETAS[trial.variant.name]:g} π ω h)", fine, values)
    chart.computed(np.repeat(steps, len(ARRIVALS)), np.ravel(computed))
