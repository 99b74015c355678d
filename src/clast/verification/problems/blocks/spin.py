"""A free block spins: its area shows whether the rotation rule is finite or linear.

Turned by r in a step to first order (Shi 1988) every vertex moves along its tangent, and the area
grows by 1 + r2.  After 1,000 steps of 0.01 rad that is (1 + 1e-4)^1000 - 1 = 10.5 %.  The exact
rule and the sine rule keep the area.

The third unknown of a step is d = 0.01: the angle itself with the exact rule; its sine with the
sine rule, which turns by asin d; to first order the vertices turn by atan d.
"""

from dataclasses import replace

import numpy as np

from clast.verification.fixtures import new_model
from clast.verification.problems import Floats, KnownFailure, Model, Trial, problem
from clast.verification.variants import LAGGED

SPIN = 10.0
"""Spin, rad/s."""
STEP, STEPS = 1e-3, 1000
UNKNOWN = SPIN * STEP
"""Third unknown d of a step."""
CORNERS = ((0.0, 0.0), (2.0, 0.2), (1.8, 1.1), (0.3, 1.4))
EXACT, SINE, LINEAR = (
    replace(LAGGED, name=f"modified, {rotation} rotation", rotation=rotation)
    for rotation in ("exact", "sine", "linear")
)
ANGLE_OF_STEP = {"exact": UNKNOWN, "sine": np.arcsin(UNKNOWN), "linear": np.arctan(UNKNOWN)}
"""Angle by which the vertices turn in a step, rad, by rotation rule."""
ROUND_OFF = "round-off of 1,000 steps"


def spinning_block() -> Model:
    """Return a free, uneven block that turns 10 rad/s, its corners measured."""
    builder = new_model("Spin", young=50e9, density=2700.0)
    builder.block(name="block", vertices=CORNERS, velocity=(0.0, 0.0, SPIN))
    for number, corner in enumerate(CORNERS):
        builder.measured_point(f"corner {number}", corner)
    return builder.build()


def area(outline: Floats) -> Floats:
    """Return the area of outlines (t, k, 2), m2, shape (t,)."""
    x, y = outline[:, :, 0], outline[:, :, 1]
    following = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    return 0.5 * np.sum(x * following[1] - following[0] * y, axis=1)


def angle(outline: Floats) -> float:
    """Return the angle by which the first edge has turned at the end, rad."""
    edge = outline[:, 1] - outline[:, 0]
    turned = np.unwrap(np.arctan2(edge[:, 1], edge[:, 0]))
    return float(turned[-1] - turned[0])


@problem(
    set_up=spinning_block,
    variants=(EXACT, SINE, LINEAR),
    quick=(SINE,),
    known_failures=(
        KnownFailure(
            LINEAR,
            "growth of the area",
            "each vertex moves along its tangent; kept to show why the rule is not used",
        ),
    ),
)
def spin(trial: Trial) -> None:
    """Spinning block.

    A free quadrilateral turns 10 rad/s without gravity for 1,000 steps of h = 1 ms.

    Exact: area kept; (1 + (w h)^2)^1000 - 1 = 10.5 % growth with the linear rule.
    Source: determinant of the placement of a step: 1 exact and sine, 1 + d^2 linear (Ke 1995).
    Not run with: open-close and convex: nothing touches, and all processes take the same step.
    """
    run = trial.variant.run(
        spinning_block(), step=STEP, end=STEP * STEPS, every=1.0, p=1e9, max_displacement=0.1
    )
    moved = [run.history(f"corner {k}").displacement for k in range(len(CORNERS))]
    outline = np.array(CORNERS) + np.stack(moved, axis=1)
    growth = area(outline) / area(outline)[0] - 1.0
    turned = STEPS * ANGLE_OF_STEP[trial.variant.rotation]
    trial.absolute("growth of the area", "", growth[-1], 0.0, 1e-12, ROUND_OFF)
    trial.relative("angle turned by the rule", "rad", angle(outline), turned, 1e-12, ROUND_OFF)
    quantity = "angle turned"
    trial.relative(quantity, "rad", angle(outline), SPIN * STEP * STEPS, 4e-5, "(w h)^2/3 at most")
    step = np.arange(STEPS + 1)
    by_rule = (1.0 + UNKNOWN**2) ** step - 1.0
    if trial.variant.rotation == "linear":
        quantity = "growth of the area by the rule"
        trial.relative(quantity, "", growth[-1], by_rule[-1], 1e-9, ROUND_OFF)
    chart = trial.chart("growth of the area", "step", "growth, %")
    chart.exact("(1 + d²)ⁿ − 1: linear rule", step, 100 * by_rule)
    chart.exact("0: kept", step, np.zeros(len(step)))
    chart.computed(step[::100], 100 * growth[::100])
