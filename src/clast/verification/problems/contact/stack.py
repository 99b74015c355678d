"""A stack of blocks at rest: every joint carries the weight above it.

The normal forces of a joint add up to the weight W of the blocks above it, those on the floor to
the weight of the stack.  Where n contacts share the joint, each spring of stiffness p is pressed
in by W / (n p): n = 2 corners of the narrower block, n = 4 where the blocks are equally wide and
their corners coincide.
"""

from __future__ import annotations

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model
from clast.model.state import State
from clast.pictures.verification import Chart, curve, exact_curve
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import Comparison, Outcome, Problem, relative
from clast.verification.variants import (
    CONVEX,
    CONVEX_MULTIPLIERS,
    EULER,
    LAGGED,
    MULTIPLIERS,
    OPEN_CLOSE,
    Variant,
)

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


def stack() -> Model:
    """Return five blocks on a fixed floor, some as wide as the one below."""
    builder = InputBuilder(title="Stack at rest", gravity=(0.0, -GRAVITY))
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="floor", vertices=[(-2, -0.5), (2, -0.5), (2, 0), (-2, 0)], fixed=True)
    for k, width in enumerate(WIDTHS):
        half = 0.5 * width
        builder.block(vertices=[(-half, k), (half, k), (half, k + 1), (-half, k + 1)])
    return builder.build()


def joint_loads(model: Model, state: State) -> tuple[Floats, Floats]:
    """Return the normal force, N/m, and the mean penetration, m, of the joint below each block."""
    memory = state.memory
    upper = np.maximum(model.vertex_block[memory.vertex], memory.block) - 1
    count = np.bincount(upper, minlength=len(WIDTHS))
    force = np.bincount(upper, memory.normal_force, len(WIDTHS)).astype(np.float64)
    depth = np.bincount(upper, -memory.gap, len(WIDTHS)).astype(np.float64)
    return force, depth / count


def examine(variant: Variant) -> Outcome:
    """Compare forces and penetrations of all joints with the weight above them."""
    model = stack()
    method = variant.method(model, normal_stiffness=STIFFNESS, max_displacement=0.01)
    run = simulate(model, method, Schedule(step=STEP, end=DURATION, every=DURATION))
    force, penetration = joint_loads(model, run.state)
    weight = np.cumsum(GRAVITY * model.mass[:0:-1])[::-1]
    exact = weight / (np.array(CONTACTS) * STIFFNESS)
    rows: list[Comparison] = []
    for k in range(len(WIDTHS)):
        name = "base reaction" if k == 0 else f"normal force of joint {k}"
        rows.append(relative(name, "N/m", force[k], weight[k], TOLERANCE, REASON))
    for k in range(len(WIDTHS) if variant.contact_law["name"] == "penalty" else 0):
        name = f"penetration of joint {k}, {CONTACTS[k]} contacts"
        rows.append(relative(name, "m", penetration[k], exact[k], TOLERANCE, REASON))
    joints = np.arange(len(WIDTHS))
    chart = Chart(
        title="normal force of the joints",
        x_label="joint, from below",
        y_label="normal force, kN/m",
        curves=(
            exact_curve("weight above", joints, 1e-3 * weight),
            curve(variant.name, joints, 1e-3 * force),
        ),
    )
    return Outcome(tuple(rows), (chart,))


PROBLEM = Problem(
    name="stack",
    title="Stack of blocks at rest",
    text="Five blocks of 1 m height, 2, 2, 1.5, 1.5 and 1 m wide, are put on each other and on a "
    "fixed floor; rho = 2700 kg/m3, g = 9.8 m/s2, p = 1 GPa, h = 1 ms. After 1.2 s they are at "
    "rest.",
    formula="sum of N of a joint = weight W above it; penetration W/(n p) with the penalty law",
    source="equilibrium",
    set_up=stack,
    examine=examine,
    variants=(LAGGED, EULER, OPEN_CLOSE, MULTIPLIERS, CONVEX, CONVEX_MULTIPLIERS),
    quick=(CONVEX,),
)
