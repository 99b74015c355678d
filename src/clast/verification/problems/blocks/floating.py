"""A raft that floats: it heaves and rolls for ever, with the periods of ship theory."""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, Model, PointHistory, Trial, problem
from clast.verification.variants import EACH_PROCESS, MIDPOINT, Variant

GRAVITY, WATER, DENSITY = 9.81, 1000.0, 500.0
BREADTH, HEIGHT = 3.0, 1.0
DRAUGHT = HEIGHT * DENSITY / WATER
METACENTRE = 0.5 * DRAUGHT + BREADTH**2 / (12.0 * DRAUGHT) - 0.5 * HEIGHT
"""Height of the metacentre above the centroid GM, m: 1.25."""
HEAVE = 2.0 * np.pi * float(np.sqrt(DRAUGHT / GRAVITY))
ROLL = 2.0 * np.pi * float(np.sqrt((BREADTH**2 + HEIGHT**2) / (12.0 * GRAVITY * METACENTRE)))
"""Periods, s: 1.419 and 1.640."""
DOWN, TILT = 0.08, np.radians(2.0)
"""By how much the raft begins too low, m, or tilted, rad."""
PERIODS, FEW = 20, 5
OF_STEP = "70 to 80 steps a period: (w h)^2/24 is 3e-4"


def raft(down: float, tilt: float) -> Model:
    """Return a raft over a fixed bed, ``down`` m too low and turned by ``tilt``, rad."""
    builder = new_model("Raft", gravity=GRAVITY, young=1e9, density=DENSITY, friction_angle=30.0)
    builder.block(name="bed", vertices=box(-6, -5, 6, -4), fixed=True)
    right, top = 0.5 * BREADTH, 0.5 * HEIGHT
    corners = np.array(box(-right, -top, right, top))
    cosine, sine = np.cos(tilt), np.sin(tilt)
    at = corners @ np.array([[cosine, sine], [-sine, cosine]]) + (0.0, top - DRAUGHT - down)
    builder.block(name="raft", vertices=at)
    builder.water(0.0, density=WATER, acts_on="faces")
    builder.measured_point("middle", at.mean(axis=0), block="raft")
    return builder.build()


def swings(time: Floats, value: Floats) -> tuple[float, float]:
    """Return period, s, and amplitude of the last swing by that of the first, of a cosine."""
    late = np.flatnonzero((value[:-1] > 0.0) & (value[1:] <= 0.0))
    zero = time[late] + np.diff(time)[late] * value[late] / (value[late] - value[late + 1])
    period = float(np.diff(zero).mean())
    last = value[time > zero[-1] - period]
    return period, float(np.ptp(last) / np.ptp(value[time < zero[0] + period]))


def moved(down: float, tilt: float, end: float, variant: Variant) -> PointHistory:
    """Return how a raft moves."""
    return variant.run(raft(down, tilt), step=2e-2, end=end, p=1e9, max_displacement=0.05).history(
        "middle"
    )


@problem(set_up=lambda: raft(DOWN, 0.0), variants=(*EACH_PROCESS, MIDPOINT), few=(FEW,))
def floating_raft(trial: Trial, periods: int = PERIODS) -> None:
    """Raft that heaves and rolls.

    A raft of 3 m x 1 m, 500 kg/m3, floats with a draught of 0.5 m over a fixed bed. It begins 8 cm
    too low, or tilted by 2 degrees, and swings for 20 periods. p = 1 GPa, h = 20 ms.

    Exact: heave 2 pi sqrt(T/g); roll 2 pi sqrt((b^2 + h^2)/(12 g GM)), GM = T/2 + b^2/(12 T) - h/2;
    no amplitude is lost or gained.
    Source: hydrostatics of ships; the water has no inertia.
    """
    for name, down, tilt, exact in (("heave", DOWN, 0.0, HEAVE), ("roll", 0.0, float(TILT), ROLL)):
        history = moved(down, tilt, (periods + 0.4) * exact, trial.variant)
        if name == "heave":
            value, label = DOWN - history.displacement[:, 1], "heave down, m"
        else:
            value, label = TILT + history.rotation, "roll, rad"
        period, left = swings(history.time, value)
        trial.relative(f"period of {name}", "s", period, exact, 2e-3, OF_STEP)
        quantity = f"{name}, amplitude after {periods} periods by that of the first"
        trial.relative(quantity, "", left, 1.0, 0.01, "pressures half way of a step")
        chart = trial.chart(name, "time, s", label)
        values = value[0] * np.cos(2.0 * np.pi * history.time[:300] / exact)
        chart.exact("cosine", history.time[:300], values)
        chart.computed(history.time[:300:6], value[:300:6])
