"""Direct shear of a joint with cohesion: peak, then residual."""

import numpy as np

from clast.verification.problems import Model, Run, Trial, box, new_model, problem
from clast.verification.variants import BOTH_LAWS, Variant

GRAVITY, DENSITY = 9.8, 2500.0
LENGTH, HEIGHT = 1.0, 0.1
"""Length A of the joint and height of the block on it, m."""
PRESSURE = 100e3
"""Pressure on top of the block, Pa."""
FRICTION_ANGLE, COHESION = 30.0, 40e3
NORMAL = DENSITY * GRAVITY * LENGTH * HEIGHT + PRESSURE * LENGTH
RESIDUAL = NORMAL * float(np.tan(np.radians(FRICTION_ANGLE)))
PEAK = RESIDUAL + COHESION * LENGTH
"""Shear forces, N/m."""
SHARES = (0.5, 0.9, 0.99, 0.999, 1.001, 1.01, 1.1)
"""Shear forces applied, as shares of the peak."""
FEW = (0.5, 0.999, 1.001, 1.1)
"""The same where time is short."""
STEP, RAMP, DURATION = 3e-4, 0.015, 0.06
"""Step, time in which the pull comes on, after the pressure, as in a test, and end, s."""


def sheared_block(force: float = PEAK) -> Model:
    """Return a flat block on a fixed one, pressed down and pulled by ``force``, N/m, at its foot.

    Pulled at its foot it has no tendency to tilt, and with Poisson's ratio 0 the pressure does not
    stretch it along the joint: shear is the same all over the joint, whose bonds break where it is
    largest.
    """
    builder = new_model("Direct shear", gravity=GRAVITY, young=50e9, density=DENSITY, poisson=0.0)
    builder.add_joint(friction_angle=FRICTION_ANGLE, cohesion=COHESION, residual_cohesion=0.0)
    builder.block(name="base", vertices=box(-0.5, -0.2, 2, 0), fixed=True)
    builder.block(name="block", vertices=box(0, 0, LENGTH, HEIGHT))
    builder.line_load((0, HEIGHT), (LENGTH, HEIGHT), (0.0, -PRESSURE))
    pull = builder.add_amplitude("pull", [0.0, RAMP], [0.0, 1.0])
    builder.point_load((0.5 * LENGTH, 0.0), (force, 0.0), block="block", amplitude=pull)
    return builder.build()


def sheared(force: float, variant: Variant) -> Run:
    """Return the run under a shear force, N/m; velocities are dropped after every step."""
    return variant.static(
        sheared_block(force), step=STEP, end=DURATION, p=2e8, max_displacement=0.01
    )


@problem(set_up=sheared_block, variants=BOTH_LAWS, few=(FEW,))
def direct_shear(trial: Trial, shares: tuple[float, ...] = SHARES) -> None:
    """Direct shear of a joint with cohesion.

    A block of 1 m x 0.1 m under a pressure of 0.1 MPa is pulled along a fixed one with seven forces
    up to 1.1 times the peak; phi = 30 degrees, c = 40 kPa, nu = 0, p = 0.2 GPa, h = 0.3 ms, static
    (dynamic_ratio = 0).

    Exact: peak N tan phi + c A, residual N tan phi.
    Source: Coulomb.
    """
    memories = [sheared(share * PEAK, trial.variant).state.memory for share in shares]
    carried = [abs(float(memory.shear_force.sum())) for memory in memories]
    held = [bool(memory.bonded.all()) for memory in memories]
    largest_held = max(s for s, holds in zip(shares, held, strict=True) if holds)
    smallest_slipped = min(s for s, holds in zip(shares, held, strict=True) if not holds)
    peak = 0.5 * (largest_held + smallest_slipped) * PEAK
    trial.relative("peak", "N/m", peak, PEAK, 1e-3, "bracketed by forces of 0.999 and 1.001 of it")
    trial.relative("residual", "N/m", carried[-1], RESIDUAL, 2e-5, "inertia tilts it by 2e-5 rad")
    trial.relative("force carried at half the peak", "N/m", carried[0], 0.5 * PEAK, 1e-5, "at rest")
    chart = trial.chart("shear force carried", "force applied / peak", "force carried / peak")
    values = (0.0, 1.0, RESIDUAL / PEAK, RESIDUAL / PEAK)
    chart.exact("N tan φ + c A, then N tan φ", (0.0, 1.0, 1.0, SHARES[-1]), values)
    chart.computed(shares, np.array(carried) / PEAK)
