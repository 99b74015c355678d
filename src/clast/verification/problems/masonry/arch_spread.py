"""An arch whose support moves: the least thrust as it spreads, the greatest as it narrows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clast.model.ground_motion import Accelerogram, MovingBase
from clast.pictures.verification import curve, exact_curve
from clast.verification.limit_analysis import least
from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, problem
from clast.verification.problems.masonry.arch_push import (
    DENSITY,
    GRAVITY,
    OPPENHEIM,
    Arch,
    add_arch,
)
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, OPEN_CLOSE, Variant

ARCHES = (
    OPPENHEIM,
    Arch(name="semicircle of 21"),
    Arch(name="semicircle of 21, t/R = 0.2, phi = 30 degrees", share=0.2, friction_angle=30.0),
)
SPREAD, DURATION, STEPS = 2e-3, 1.0, (2e-2, 5e-2)
"""Way of the support, m, in so many seconds, and the time steps, s."""
MOVING = "right abutment"
TOLERANCE = 5e-3
WHY = "the support moves by 2 mm, which changes the arch by 0.1 to 0.3 %"


def limit_thrust(arch: Arch, sense: float) -> float:
    """Return the least thrust of an arch, N/m, or with a ``sense`` of -1 the greatest."""
    blocks = arch.blocks()
    springing = blocks.joints[0]
    # what the first joint presses the fixed support outwards with, by N1, N2 and V
    thrust = np.zeros(3 * len(blocks.joints))
    thrust[:3] = -springing.normal[0], -springing.normal[0], -springing.along[0]
    weight = blocks.body_force((0.0, -DENSITY * GRAVITY))
    return sense * least(blocks, weight, sense * thrust)


def on_moving_support(arch: Arch = OPPENHEIM, spread: float = SPREAD) -> Model:
    """Return an arch whose right support moves out by ``spread``, m, in a second."""
    most = 8.0 * spread / DURATION**2
    across = np.array([0.0, most, -most, 0.0])
    record = Accelerogram(
        time=DURATION * np.array([0.0, 0.25, 0.75, 1.0]),
        acceleration=np.stack([across, np.zeros(4)], axis=1),
    )
    builder = InputBuilder(title="Arch on a support that moves", gravity=(0.0, -GRAVITY))
    builder.ground_motion = MovingBase(record)
    builder.add_rock("stone", young=50e9, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=arch.friction_angle)
    add_arch(builder, arch, carried=MOVING)
    return builder.build()


def thrust_of(run: Run, frame: int = -1) -> float:
    """Return the outward thrust of the arch on the right support, N/m."""
    contacts, support = run.contacts(frame), run.model.block_name.index(MOVING)
    across = contacts.force[:, 0]
    on, off = contacts.vertex_block == support, contacts.edge_block == support
    return float(across[on].sum() - across[off].sum())


def moved(arch: Arch, spread: float, step: float, variant: Variant) -> Run:
    """Return the static run of an arch on a support that moves."""
    model = on_moving_support(arch, spread)
    return variant.run(
        model,
        step=step,
        end=DURATION,
        every=DURATION / 20,
        normal_stiffness=1e10,
        max_displacement=0.02,
        dynamic_ratio=0.0,
    )


def way_of(run: Run) -> Floats:
    """Return how far the support has moved in each frame, m, shape (k,)."""
    motion = run.model.ground_motion
    times = run.block(MOVING).time
    return np.array([motion.anchor_displacement(time)[0] for time in times])


@problem(
    set_up=on_moving_support,
    variants=(OPEN_CLOSE, CONVEX, CONVEX_MULTIPLIERS),
    quick=(CONVEX,),
    few=(ARCHES[:1], STEPS[1:]),
)
def arch_spread(
    trial: Trial, arches: Sequence[Arch] = ARCHES, steps: Sequence[float] = STEPS
) -> None:
    """Arch on a support that gives way.

    The right support of an arch moves out, or in, by 2 mm in a second, static (dynamic_ratio = 0).
    Oppenheim's arch and two semicircles; E = 50 GPa, p = 10 GPa, h = 20 and 50 ms.

    Exact: the least and the greatest thrust with N1, N2 >= 0 and |V| <= (N1 + N2) tan phi in all
    joints.
    Source: limit analysis by linear programming (scipy); Heyman (1995).
    Not run with: modified: in steps this long one pass and four throw the voussoirs, p h2/m being
    far above 6.
    """
    runs: list[Run] = []
    for arch in arches:
        for sense, which in ((1.0, "least"), (-1.0, "greatest")):
            exact = limit_thrust(arch, sense)
            for step in steps:
                run = moved(arch, sense * SPREAD, step, trial.variant)
                runs.append(run)
                quantity = f"{which} thrust, {arch.name}, h = {1e3 * step:g} ms"
                trial.relative(quantity, "N/m", thrust_of(run), exact, TOLERANCE, WHY)
    first = runs[0]
    ways = [float(run_way) for run_way in way_of(first)]
    limits = [limit_thrust(arches[0], sense) for sense in (1.0, -1.0)]
    trial.chart(
        f"thrust, {arches[0].name}",
        "displacement of the support, mm",
        "thrust, kN/m",
        exact_curve("least", (0.0, 1e3 * SPREAD), [1e-3 * limits[0]] * 2),
        exact_curve("greatest", (0.0, 1e3 * SPREAD), [1e-3 * limits[1]] * 2),
        curve(
            trial.variant.name,
            [1e3 * way for way in ways],
            [1e-3 * thrust_of(first, frame) for frame in range(len(ways))],
        ),
    )
