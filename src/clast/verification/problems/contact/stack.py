"""A stack of blocks at rest: every joint carries the weight above it."""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, Model, State, Trial, problem
from clast.verification.variants import BOTH_LAWS

GRAVITY = 9.8
STIFFNESS = 1e9
"""Normal stiffness p, N/m per m."""
WIDTHS = (2.0, 2.0, 1.5, 1.5, 1.0)
"""Widths of the blocks from below, m; all are 1 m high."""
CONTACTS = (2, 4, 2, 4, 2)
"""Contacts n of the joint below each block."""
STEP, DURATION = 1e-3, 1.2
TOLERANCE = 1e-6
REASON = "what is left of the vibration after 1.2 s"


def model_of_stack() -> Model:
    """Return five blocks on a fixed floor, some as wide as the one below."""
    builder = new_model(
        "Stack at rest", gravity=GRAVITY, young=50e9, density=2700.0, friction_angle=30.0
    )
    builder.block(name="floor", vertices=box(-2, -0.5, 2, 0), fixed=True)
    for k, width in enumerate(WIDTHS):
        half = 0.5 * width
        builder.block(vertices=box(-half, k, half, k + 1))
    return builder.build()


def joint_loads(model: Model, state: State) -> tuple[Floats, Floats]:
    """Return the normal force, N/m, and the mean penetration, m, of the joint below each block."""
    memory = state.memory
    upper = np.maximum(model.vertex_block[memory.vertex], memory.block) - 1
    count = np.bincount(upper, minlength=len(WIDTHS))
    force = np.bincount(upper, memory.normal_force, len(WIDTHS)).astype(np.float64)
    depth = np.bincount(upper, -memory.gap, len(WIDTHS)).astype(np.float64)
    return force, depth / count


@problem(set_up=model_of_stack, variants=BOTH_LAWS)
def stack(trial: Trial) -> None:
    """Stack of blocks at rest.

    Five blocks of 1 m height, 2, 2, 1.5, 1.5 and 1 m wide, are put on each other and on a fixed
    floor; rho = 2700 kg/m3, g = 9.8 m/s2, p = 1 GPa, h = 1 ms. After 1.2 s they are at rest.

    Exact: sum of N of a joint = weight W above it; penetration W/(n p) with the penalty law.
    Source: equilibrium.
    """
    model = model_of_stack()
    run = trial.variant.run(model, step=STEP, end=DURATION, p=STIFFNESS, max_displacement=0.01)
    force, penetration = joint_loads(model, run.state)
    weight = np.cumsum(GRAVITY * model.mass[:0:-1])[::-1]
    exact = weight / (np.array(CONTACTS) * STIFFNESS)
    for k in range(len(WIDTHS)):
        name = "base reaction" if k == 0 else f"normal force of joint {k}"
        trial.relative(name, "N/m", force[k], weight[k], TOLERANCE, REASON)
    for k in range(len(WIDTHS) if trial.variant.contact_law["name"] == "penalty" else 0):
        name = f"penetration of joint {k}, {CONTACTS[k]} contacts"
        trial.relative(name, "m", penetration[k], exact[k], TOLERANCE, REASON)
    joints = np.arange(len(WIDTHS))
    chart = trial.chart("normal force of the joints", "joint, from below", "normal force, kN/m")
    chart.exact("weight above", joints, 1e-3 * weight)
    chart.computed(joints, 1e-3 * force)
