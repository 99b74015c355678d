"""A block at rest on its contact springs: how deep it sinks in, and what it weighs there.

Penalty: each of the n corners is pressed in by W / (n p), so that the contact force is W for any p.
"""

from __future__ import annotations

import numpy as np

from clast.model import Model
from clast.model_builder import ModelBuilder
from clast.pictures.verification import Chart, curve, exact_curve
from clast.simulate import Schedule, simulate
from clast.verification.problem import Comparison, Outcome, Problem, relative
from clast.verification.variants import CONVEX, EULER, LAGGED, PASSES, Variant

GRAVITY = 9.8
WEIGHT = 2700.0 * GRAVITY
"""Weight of the block of 1 m2, N/m."""
CONTACTS = 2
STIFFNESSES = (1e8, 1e9, 5e9)
"""Normal stiffnesses p, N/m per m; p h2/m = 0.07 to 3.7."""
STEP, DURATION = 1e-3, 0.6
TOLERANCE = 1e-6
REASON = "at rest after 0.6 s, velocities being dropped after every step"


def block_on_floor() -> Model:
    """Return a block of 1 m x 1 m on a fixed floor."""
    builder = ModelBuilder(title="Block at rest", gravity=(0.0, -GRAVITY))
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.block(name="floor", vertices=[(-1, -0.5), (2, -0.5), (2, 0), (-1, 0)], fixed=True)
    builder.block(name="block", vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    return builder.build()


def rest(stiffness: float, variant: Variant) -> tuple[float, float]:
    """Return penetration, m, and contact force, N/m, of the block at rest."""
    model = block_on_floor()
    method = variant.method(
        model, normal_stiffness=stiffness, max_displacement=0.01, dynamic_ratio=0.0
    )
    memory = simulate(model, method, Schedule(step=STEP, end=DURATION, every=DURATION)).state.memory
    return float(-memory.gap.mean()), float(memory.normal_force.sum())


def exact_penetration(stiffness: float) -> float:
    """Return the penetration at rest, m."""
    return WEIGHT / (CONTACTS * stiffness)


def examine(variant: Variant) -> Outcome:
    """Compare penetration and contact force over the stiffness."""
    rows: list[Comparison] = []
    found = []
    for stiffness in STIFFNESSES:
        penetration, force = rest(stiffness, variant)
        found.append(penetration)
        exact = exact_penetration(stiffness)
        at = f"at p = {stiffness:.0e}"
        rows.append(relative(f"penetration {at}", "m", penetration, exact, TOLERANCE, REASON))
        rows.append(relative(f"contact force {at}", "N/m", force, WEIGHT, TOLERANCE, REASON))
    fine = np.geomspace(STIFFNESSES[0], STIFFNESSES[-1], 50)
    chart = Chart(
        title="penetration at rest",
        x_label="normal stiffness p, N/m per m",
        y_label="penetration, m",
        curves=(
            exact_curve("W/(n p)", fine, WEIGHT / (CONTACTS * fine)),
            curve(variant.name, STIFFNESSES, found),
        ),
        x_scale="log",
        y_scale="log",
    )
    return Outcome(tuple(rows), (chart,))


PROBLEM = Problem(
    name="penetration",
    title="Penetration of a block at rest",
    text="A block of 1 m x 1 m rests on a fixed floor; rho = 2700 kg/m3, g = 9.8 m/s2, h = 1 ms, "
    "static (dynamic_ratio = 0).",
    formula="penetration W/(n p) with the penalty law; contact force W",
    source="equilibrium",
    set_up=block_on_floor,
    examine=examine,
    variants=(LAGGED, PASSES, EULER, CONVEX),
    quick=(LAGGED,),
)
