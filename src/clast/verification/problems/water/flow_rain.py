"""Rain on a joint: all of it runs down while the joint can carry it, the rest runs off."""

import numpy as np

from clast.actions.flow import water_at
from clast.verification.fixtures import CUT, into_rock
from clast.verification.problems import InputBuilder, Model, Trial, box, problem

GRAVITY, DENSITY, VISCOSITY = 9.81, 1000.0, 1e-3
APERTURE, HEIGHT, WIDTH = 2e-4, 5.0, 4.0
"""Aperture and height of the joint, and width of the ground that drains into it, m."""
SHARES = (0.2, 0.7, 1.6)
"""Rain on that ground over what the joint can carry."""


def capacity() -> float:
    """Return rho g a^3/(12 mu), m2/s: the flow of an upright joint that is full."""
    return DENSITY * GRAVITY * APERTURE**3 / (12.0 * VISCOSITY)


def rained_on(share: float = 0.7) -> Model:
    """Return two blocks with a joint between them, drained below, under rain."""
    builder = InputBuilder(title="Rain on a joint", gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(aperture=APERTURE)
    builder.block(name="left", vertices=box(0, 0, 0.5 * WIDTH, HEIGHT), fixed=True)
    builder.block(name="right", vertices=box(0.5 * WIDTH, 0, WIDTH, HEIGHT), fixed=True)
    builder.flow = {"viscosity": VISCOSITY, "density": DENSITY}
    builder.flow_boundary("rain", side="top", rain=share * capacity() / WIDTH)
    builder.flow_boundary("drain", side="bottom", seepage=True)
    return builder.build()


@problem(set_up=rained_on, variants=(CUT,), quick=(CUT,))
def flow_rain(trial: Trial) -> None:
    """Rain on a joint.

    An upright joint of 0.2 mm, 5 m high and drained at its foot, takes the rain of 4 m of ground:
    0.2, 0.7 and 1.6 times what it can carry.

    Exact: s = q/(C G) with C G = rho g a^3/(12 mu); what is more runs off.
    Source: flow of a film by gravity alone, in proportion to saturation.
    Not run with: modified and open-close and convex: nothing moves.
    """
    reason = "one joint, found in a few iterations"
    for share in SHARES:
        model = rained_on(share)
        flow = into_rock(model)["rain"] / capacity()
        quantity = f"flow by capacity, rain {share:g} of it"
        trial.relative(quantity, "-", flow, min(share, 1.0), 1e-9, reason)
    model = rained_on(SHARES[1])
    water = water_at(model, 0.0)
    top = int(np.argmax(water.network.at[:, 1]))
    saturation = water.solved.saturation[top]
    trial.relative("saturation, rain 0.7", "-", saturation, SHARES[1], 1e-9, reason)
    over = water_at(rained_on(SHARES[2]), 0.0).solved.runoff.sum() / capacity()
    trial.relative("run-off by capacity, rain 1.6", "-", over, SHARES[2] - 1.0, 1e-9, reason)
    fine = np.linspace(0.0, 2.0, 41)
    chart = trial.chart("rain on a joint", "rain / capacity", "flow in the joint / capacity")
    chart.exact("min(r, 1)", fine, np.minimum(fine, 1.0))
    chart.computed(SHARES, trial.computed[: len(SHARES)])
