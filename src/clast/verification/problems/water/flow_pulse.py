"""A rise of pressure at the end of a joint travels along it as heat along a bar."""

import math

import numpy as np

from clast.results.result_tables import FrameFlow
from clast.verification.problems import Floats, InputBuilder, Model, Trial, box, problem
from clast.verification.variants import CONVEX, Variant

LENGTH, APERTURE = 10.0, 1e-4
VISCOSITY, BULK, PRESSURE = 1e-3, 2e9, 1e5
DURATION = 1e-3
"""Time of the comparison, s."""
DIFFUSIVITY = APERTURE**2 * BULK / (12.0 * VISCOSITY)
"""D, m2/s."""
STEPS = ((50, 0.2), (200, 0.05))
"""Steps, and longest pieces of the joint, m."""


def exact_pressure(x: Floats) -> Floats:
    """Return p0 erfc(x/2 sqrt(D t)), Pa, at distances from the end, m."""
    width = 2.0 * math.sqrt(DIFFUSIVITY * DURATION)
    return PRESSURE * np.array([math.erfc(one / width) for one in x])


def joint(longest: float = 0.2) -> Model:
    """Return two fixed blocks with a joint between them in pieces up to ``longest``, m."""
    builder = InputBuilder(title="Pulse", gravity=(0.0, 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(aperture=APERTURE)
    builder.block(name="floor", vertices=box(0, -1, LENGTH, 0), fixed=True)
    builder.block(name="roof", vertices=box(0, 0, LENGTH, 1), fixed=True)
    builder.flow = {
        "state": "transient",
        "initial": "dry",
        "longest": longest,
        "viscosity": VISCOSITY,
        "bulk_modulus": BULK,
    }
    builder.flow_boundary("left", side="left", pressure=PRESSURE)
    return builder.build()


def flow_of(variant: Variant, steps: int, longest: float) -> FrameFlow:
    """Return the water after the time of the comparison."""
    step = DURATION / steps
    run = variant.run(joint(longest), step=step, end=DURATION, p=1e9, max_displacement=0.1)
    return run.flow()


@problem(set_up=joint, variants=(CONVEX,))
def flow_pulse(trial: Trial) -> None:
    """Pulse of pressure in a joint.

    The pressure at one end of a full joint of 0.1 mm and 10 m rises by 0.1 MPa and stays. Water is
    compressed, the joint stays as wide as it is. Compared after 1 ms is the largest error along the
    joint, in 50 steps with pieces of 0.2 m and in 200 with 0.05 m.

    Exact: p = p0 erfc(x/2 sqrt(D t)), D = a^2 K/(12 mu).
    Source: diffusion into a half space (Carslaw & Jaeger 1959).
    Not run with: modified and open-close: nothing moves.
    """
    flows = [flow_of(trial.variant, *one) for one in STEPS]
    for (steps, _), flow, tolerance in zip(STEPS, flows, (5e-3, 1e-3), strict=True):
        missed = np.abs(flow.pressure[:, 0] - exact_pressure(flow.start[:, 0])).max()
        quantity = f"largest error over p0, {steps} steps"
        reason = "first order in time, second in the length of pieces"
        trial.absolute(quantity, "-", float(missed) / PRESSURE, 0.0, tolerance, reason)
    fine = np.linspace(0.0, LENGTH, 201)
    chart = trial.chart("pressure after 1 ms", "distance, m", "pressure, Pa")
    chart.exact("erfc", fine, exact_pressure(fine))
    chart.computed(flows[-1].start[::4, 0], flows[-1].pressure[::4, 0])
