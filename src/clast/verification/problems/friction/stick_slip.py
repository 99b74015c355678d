"""Stick-slip of a slider that a spring draws over a floor.

A spring of stiffness k draws a block with the normal force N, its far end at a speed V.  Friction
is mu_s while the block stands and mu_k while it slides.  It stands until the spring carries mu_s N,
slides as half a swing about mu_k N, and stands again: whatever V, the force of the spring falls by

    2 (mu_s - mu_k) N,

its stretch by that over k, and from there it rises by k V to the next slip.  The far end is a load
k V t here, and the spring is anchored in a fixed block: the block feels k (V t - x) either way.

The weight comes on in a static stage.  Put on at once in a dynamic one it has N swing between 0 and
twice the weight, which forces half way through the step do not damp: the block then slips while N
is small.
"""

from collections.abc import Sequence

import numpy as np

from clast.model.stages import TIME, Stage
from clast.verification.problems import Floats, Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, EACH_PROCESS, MIDPOINT, Variant

GRAVITY, DENSITY = 9.8, 2500.0
LENGTH, HEIGHT = 1.0, 0.1
"""Size of the block, m."""
STATIC, KINETIC = 35.0, 20.0
"""Friction angles, degrees."""
SPRING, SPEED = 2e5, 0.01
"""Stiffness of the spring, N/m per m, and speed of its far end, m/s."""
NORMAL = DENSITY * GRAVITY * LENGTH * HEIGHT
MU_S, MU_K = (float(np.tan(np.radians(one))) for one in (STATIC, KINETIC))
STEP, REST, SOON, END = 3e-4, 0.02, 0.12, 0.47
"""Step, end of the static stage, time when the spring is drawn to START, and end, s."""
START = 0.8
"""Force of the spring at first, in units of mu_s N; from there on its far end moves steadily."""
FIRST = "the stretch goes on until the block is as fast as V: (V/w)^2/2 a = 15 um of 8.6 mm"
SWING = "forces of the end of a step take 1.6 w h = 1.4 % of the way back of a half swing"


def far_end(time: Sequence[float] | Floats) -> Floats:
    """Return where the far end of the spring is, m, (t,), from where it carries nothing on."""
    at = START * MU_S * NORMAL / SPRING
    return np.interp(time, [REST, SOON, END], [0.0, at, at + SPEED * (END - SOON)])


def slider() -> Model:
    """Return a flat block on a fixed one, anchored by a spring and drawn by a load that grows."""
    builder = new_model("Stick-slip", gravity=GRAVITY, young=50e9, density=DENSITY, poisson=0.0)
    builder.add_joint(friction_angle=STATIC, kinetic_friction_angle=KINETIC)
    builder.block(name="floor", vertices=box(-3, -0.2, 4, 0), fixed=True)
    builder.block(name="anchor", vertices=box(-3.6, -0.2, -3.1, 0.2), fixed=True)
    builder.block(name="block", vertices=box(0, 0, LENGTH, HEIGHT))
    builder.add_bolt_kind("spring", stiffness=SPRING, compression=True)
    middle = 0.5 * LENGTH
    builder.bolt((middle, 1e-3), (-3.5, 1e-3), kind="spring", name="spring")
    times = [0.0, REST, SOON, END]
    pull = builder.add_amplitude("pull", times, far_end(times).tolist())
    builder.point_load((middle, 0.0), (SPRING, 0.0), block="block", amplitude=pull)
    builder.measured_point("foot", (middle, 0.0), block="block")
    return builder.build()


def drawn(variant: Variant) -> tuple[Floats, Floats]:
    """Return time, s, and the force of the spring, N/m, (t,) each."""
    weight = Stage(name="weight", until=TIME, time=REST, dynamic_ratio=0.0)
    stages = (weight, Stage(name="pull", until=TIME, time=END - REST))
    history = variant.run(
        slider(), step=STEP, end=END, stages=stages, p=1e9, max_displacement=0.01
    ).history("foot")
    return history.time, SPRING * (far_end(history.time) - history.displacement[:, 0])


def turns(force: Floats) -> tuple[Floats, Floats]:
    """Return the largest forces before slips and the least ones after them, N/m."""
    high, falls = [float(force[0])], False
    low: list[float] = []
    for one in map(float, force):
        if falls and one > low[-1] + 0.2 * MU_K * NORMAL:
            high, falls = [*high, one], False
        elif not falls and one < high[-1] - 0.2 * MU_K * NORMAL:
            low, falls = [*low, one], True
        elif falls:
            low[-1] = min(low[-1], one)
        else:
            high[-1] = max(high[-1], one)
    return np.array(high), np.array(low)


@problem(
    set_up=slider, variants=(*EACH_PROCESS, CONVEX_MULTIPLIERS, MIDPOINT), quick=(CONVEX, MIDPOINT)
)
def stick_slip(trial: Trial) -> None:
    """Stick-slip of a slider on a spring.

    A block of 1 m x 0.1 m is drawn by a spring of 0.2 MN/m per m at 10 mm/s; friction angles are 35
    degrees at rest and 20 degrees in motion; the weight comes on in a static stage. p = 1 GPa, h =
    0.3 ms.

    Exact: the spring's force falls from mu_s N by 2 (mu_s - mu_k) N.
    Source: half a swing about mu_k N; Bowden & Leben 1939.
    """
    time, force = drawn(trial.variant)
    high, low = turns(force)
    fall = 2.0 * (MU_S - MU_K) * NORMAL
    first = MU_S * NORMAL
    trial.relative("force at the first slip", "N/m", high[0], first, 0.01, FIRST)
    trial.relative("fall", "N/m", float(high[0] - low[0]), fall, 0.01, SWING)
    chart = trial.chart("force of the spring", "time, s", "force, N/m")
    chart.exact("μₛ N", (0.0, END), (first, first))
    chart.exact("(2 μₖ − μₛ) N", (0.0, END), (first - fall,) * 2)
    chart.computed(time[::4], force[::4])
