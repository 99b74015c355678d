"""A lintel on two piers, one of which settles: it turns, and its reactions stay."""

import numpy as np

from clast.verification.problems import Model, Run, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

DENSITY, GRAVITY = 2500.0, 9.8
SPAN, LENGTH, HEIGHT = 5.0, 6.0, 0.5
"""Distance of the edges, length and height of the lintel, m."""
SETTLEMENT, DURATION = 0.03, 3.0
WEIGHT = DENSITY * GRAVITY * LENGTH * HEIGHT
TILT = "the middle of the lintel is 0.25 m above the edges, and moves by 1.5 mm as it turns"


def scene(side: float = 1.0) -> Model:
    """Return lintel and piers; the right pier settles, or the left one where ``side`` is -1."""
    builder = new_model(
        "Settling pier", gravity=GRAVITY, young=5e9, density=DENSITY, friction_angle=30.0
    )
    # else friction holds a thrust, which has an arm as soon as the edges are not level
    builder.add_joint("smooth", friction_angle=0.0, between=[("lintel", "soft")])
    half = 0.5 * SPAN
    for name, x in (("firm", -side * half), ("soft", side * half)):
        builder.block(name=name, vertices=[(x, 0.0), (x - 0.3, -1.0), (x + 0.3, -1.0)], fixed=True)
    end = 0.5 * LENGTH
    builder.block(name="lintel", vertices=box(-end, 0.0, end, HEIGHT))
    table = builder.add_amplitude("settlement", [0.0, DURATION], [0.0, -SETTLEMENT])
    builder.motion(name="settlement", block="soft", y={"displacement": table}, ease=0.2)
    builder.measured_point("middle", (0.0, 0.0), block="lintel")
    return builder.build()


def settled(variant: Variant, side: float = 1.0, step: float = 5e-3) -> Run:
    """Return the run."""
    return variant.static(scene(side), step=step, end=3.3, p=1e9, max_displacement=0.02)


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE, PASSES))
def settling_pier(trial: Trial) -> None:
    """A lintel on two piers, one of which settles.

    A lintel of 6 x 0.5 m lies on edges 5 m apart, one of which, smooth, settles by 30 mm in 3 s;
    static (dynamic_ratio = 0), h = 5 ms; also mirrored, and in other steps. Reactions are compared
    after it; while it settles, static steps of open-close and modified keep their mass term 2
    M/h^2, so that it carries 11.2 kN/m less in them, as the picture shows.

    Exact: reactions W/2 each, tan r = s/L.
    Source: statics.
    """
    run = settled(trial.variant)
    cases = (("", 1.0, run), (", mirrored", -1.0, settled(trial.variant, -1.0)))
    for name, side, one in (*cases, (", steps of 8 ms", 1.0, settled(trial.variant, step=8e-3))):
        soft, firm = one.reaction("settlement").force[-1], one.reaction("fixed blocks").force[-1]
        trial.relative(f"reaction of the soft pier{name}", "N/m", soft[1], 0.5 * WEIGHT, 1e-3, TILT)
        trial.relative(f"reaction of the firm pier{name}", "N/m", firm[1], 0.5 * WEIGHT, 1e-3, TILT)
        quantity = f"rotation{name}"
        computed = -side * float(np.tan(one.history("middle").rotation[-1]))
        trial.relative(quantity, "rad", computed, SETTLEMENT / SPAN, 1e-3, TILT)
    total = run.reaction("settlement").force[-1] + run.reaction("fixed blocks").force[-1]
    off = float(np.hypot(*(total - [0.0, WEIGHT])))
    trial.absolute("sum of reactions less weight", "N/m", off, 0.0, 1e-4 * WEIGHT, TILT)
    history, soft = run.history("middle"), run.reaction("settlement")
    chart = trial.chart("reaction of the pier that settles", "rotation, 1/1000", "force, kN/m")
    chart.exact("W/2", np.array([0.0, 6.0]), np.full(2, 0.5e-3 * WEIGHT))
    chart.computed(-1e3 * history.rotation[1::15], 1e-3 * soft.force[1::15, 1])
