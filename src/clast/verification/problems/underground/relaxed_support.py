"""A prop is taken out from under a block, and its force let go little by little."""

from dataclasses import replace

import numpy as np

from clast.run.excavation import excavated
from clast.run.run_state import RunState
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS

GRAVITY = 9.8
RELAX, RELAX_TIME = 0.3, 0.5
"""Share r that ends at once, and the time T of the rest, s."""
STEP, SETTLING = 1e-3, 0.5


def propped() -> Model:
    """Return a block on a prop of its width, over a fixed floor far below."""
    builder = new_model("Prop taken out", gravity=GRAVITY, young=5e10, density=2500.0, poisson=0.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="floor", vertices=box(-1, -1, 2, 0), fixed=True)
    builder.block(name="prop", vertices=box(0, 0, 1, 4))
    builder.block(name="block", vertices=box(0, 4, 1, 5))
    builder.measured_point("block", (0.5, 4.5), block="block")
    return builder.build()


@problem(set_up=propped, variants=EACH_PROCESS)
def relaxed_support(trial: Trial) -> None:
    """Prop that is taken out slowly.

    A block of 1 m x 1 m settles on a prop, static; then the prop is excavated: three tenths of its
    load ends at once, the rest within 0.5 s. p = 1 GPa, h = 1 ms.

    Exact: s = g (r t^2/2 + (1 - r) t^3/(6 T)).
    Source: kinematics.
    """
    model = propped()
    numbers = {"p": 1e9, "max_displacement": 0.05}
    still = trial.variant.method(model, **numbers, dynamic_ratio=0.0)
    kept: list[RunState] = []
    settled = Schedule(step=STEP, end=SETTLING, every=SETTLING)
    simulate(model, still, settled, keep=kept.append)
    method = trial.variant.method(model, **numbers)
    at_rest = replace(kept[-1].state, velocity=np.zeros_like(kept[-1].state.velocity))
    prop = model.blocks_called(["prop"])
    left, state = excavated(model, method, at_rest, prop, RELAX, RELAX_TIME)
    end = SETTLING + RELAX_TIME
    rest = Schedule(step=STEP, end=end, every=end)
    run = simulate(left, method, rest, begin=replace(kept[-1], state=state))
    history = run.history("block")
    time = history.time - SETTLING
    fallen = history.displacement[0, 1] - history.displacement[:, 1]
    late = (1.0 - RELAX) * time**3 / (6.0 * RELAX_TIME)
    exact = np.asarray(GRAVITY * (0.5 * RELAX * time**2 + late))
    half = len(time) // 2
    why = "forces of a step are those at its end: first order in h"
    trial.relative("fall at T/2", "m", float(fallen[half]), float(exact[half]), 5e-3, why)
    trial.relative("fall at T", "m", float(fallen[-1]), float(exact[-1]), 5e-3, why)
    chart = trial.chart("fall of the block", "time after the excavation, s", "fall, m")
    chart.exact("formula", time, exact)
    chart.exact("without relaxation", time, 0.5 * GRAVITY * time**2)
    chart.computed(time[::25], fallen[::25])
