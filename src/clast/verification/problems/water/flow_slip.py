"""Water in a joint takes the normal stress off it until it slips."""

from functools import partial

import numpy as np

from clast.verification.problems import (
    Bracket,
    InputBuilder,
    Model,
    StaticRun,
    Trial,
    box,
    problem,
)
from clast.verification.variants import CONVEX

GRAVITY, DENSITY = 9.81, 2600.0
WIDTH, HEIGHT = 10.0, 5.0
"""Size of the block on the joint, m."""
SHEARS = (2e5, 3e5, 5e5)
"""Forces along the joint, N/m."""
FRICTION = 30.0
"""Friction angle, degrees."""
STATIC = StaticRun(p=1e11, step=1e-2, steps=60, bisections=4)
SPAN = 0.02
"""Half of the range of the pressure that is searched as a share of it."""


def exact_pressure(shear: float) -> float:
    """Return sigma_n - tau/tan(phi), Pa, for a force along the joint, N/m."""
    return DENSITY * GRAVITY * HEIGHT - shear / WIDTH / float(np.tan(np.radians(FRICTION)))


def pushed(pressure: float, shear: float = SHEARS[1]) -> Model:
    """Return a block on a joint under a pressure, Pa, pushed by a force along it, N/m."""
    builder = InputBuilder(title="Slip by water", gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=50e9, poisson=0.0, density=DENSITY)
    builder.add_joint(friction_angle=FRICTION, aperture=2e-4)
    builder.block(name="base", vertices=box(-5, -2, WIDTH + 10, 0), fixed=True)
    builder.block(name="top", vertices=box(0, 0, WIDTH, HEIGHT))
    builder.point_load((0.5 * WIDTH, 0.0), force=(shear, 0.0), block="top")
    builder.measured_point("top", (WIDTH, 0.0), block="top")
    builder.flow = {"longest": 1.0}
    ends = [((x, 0.0), (x, HEIGHT)) for x in (0.0, WIDTH)]
    builder.flow_boundary("injection", edges=ends, pressure=pressure)
    return builder.build()


@problem(set_up=partial(pushed, 5e4), variants=(CONVEX,))
def flow_slip(trial: Trial, shears: tuple[float, ...] = SHEARS) -> None:
    """Slip of a joint by water.

    A block of 10 m x 5 m rests on a joint of 30 degrees and is pushed along it; water of one
    pressure stands in the joint. The pressure at which the block slips is bisected. p = 100 GPa,
    h = 10 ms, static.

    Exact: p = sigma_n - tau/tan(phi).
    Source: Terzaghi's effective stress with Coulomb's law.
    Not run with: modified and open-close: forces of water are the same for every process.
    """
    for shear in shears:
        exact = exact_pressure(shear)

        def at_share(share: float, shear: float = shear, exact: float = exact) -> Model:
            return pushed(exact / share, shear)

        # a smaller share is more pressure, which slips
        shares = STATIC.limit(trial.variant, at_share, 1.0 - SPAN, 1.0 + SPAN)
        found = Bracket(exact / shares.low, exact / shares.high)
        quantity = f"pressure at slip, pushed by {shear:g} N/m"
        trial.relative(quantity, "Pa", found, exact, 0.01, "bisected to 0.25 %")
    fine = np.linspace(0.0, 7e5, 41)
    chart = trial.chart("pressure at slip", "force along the joint, N/m", "pressure, Pa")
    chart.exact("σ - τ/tan φ", fine, [exact_pressure(one) for one in fine])
    chart.computed(shears, trial.computed[: len(shears)])
