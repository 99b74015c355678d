"""A pile is struck by a thrown block: where the energy goes, step by step.

Every step the ledger adds up stored energy (motion, strain, height, contact springs), the work of
loads, energy consumed by friction and energy removed by the time integration.  The remainder must
be round-off, and the stored energy must never exceed the start and the work of the loads.
"""

from __future__ import annotations

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.model.model import Model
from clast.pictures.verification import Chart, curve, exact_curve
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import KnownFailure, Outcome, Problem, absolute
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
VELOCITY = (3.0, 1.0, -2.0)
"""Velocity (u, v), m/s, and spin, rad/s, of the thrown block."""
STEP, DURATION = 1e-3, 0.5
STORED = ("kinetic", "elastic", "gravity", "contact", "fixed_points")
"""Entries of the ledger that make up the stored energy."""
FOUND_INSIDE = (
    "springs put on vertices that have already invaded store energy that nobody paid, up to "
    "p h2/(2m) of the impact's"
)


def struck_pile() -> Model:
    """Return a turned block thrown against a pile of three on a fixed floor."""
    builder = InputBuilder(title="Struck pile", gravity=(0.0, -GRAVITY))
    builder.add_rock("granite", young=5e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="floor", vertices=[(-3, -0.5), (4, -0.5), (4, 0), (-3, 0)], fixed=True)
    for k in range(3):
        left = 0.05 * k
        corners = [(left, k), (left + 1, k), (left + 1, k + 1), (left, k + 1)]
        builder.block(name=f"pile {k + 1}", vertices=corners)
    thrown = [(-0.5, 1.2), (-0.4, 2.0), (-1.2, 2.1), (-1.3, 1.3)]
    builder.block(name="thrown", vertices=thrown, velocity=VELOCITY)
    return builder.build()


def examine(variant: Variant) -> Outcome:
    """Compare the ledger of every step with closure and decay."""
    model = struck_pile()
    method = variant.method(model, normal_stiffness=1e8, max_displacement=0.02)
    ledger = simulate(model, method, Schedule(step=STEP, end=DURATION, every=DURATION)).energy
    stored = np.sum([ledger[entry] for entry in STORED], axis=0) - ledger["loads"]
    start = stored[0]
    total = (stored + ledger["friction"] + ledger["impacts"] + ledger["numerical"]) / start
    reason = "of the energy at the start"
    rows = (
        absolute(
            "largest change of the ledger's sum", "", np.abs(total - 1.0).max(), 0.0, 1e-6, reason
        ),
        absolute("largest energy created", "", (stored / start - 1.0).max(), 0.0, 1e-6, reason),
    )
    chart = Chart(
        title="energy over that of the start",
        x_label="time, s",
        y_label="energy / energy at the start",
        curves=(
            exact_curve("sum of the ledger", ledger["time"], np.ones(len(stored))),
            curve(f"sum, {variant.name}", ledger["time"][::25], total[::25]),
            curve(f"stored, {variant.name}", ledger["time"][::25], stored[::25] / start),
        ),
    )
    return Outcome(rows, (chart,))


PROBLEM = Problem(
    name="energy",
    title="Energy of a struck pile",
    text="A turned block of 0.65 m2 is thrown at 3 m/s against a pile of three blocks of 1 m2; "
    "phi = 30 degrees, p = 0.1 GPa, h = 1 ms, 0.5 s.",
    formula="stored + friction + impacts + numerical - loads = constant; stored - loads never "
    "above its start",
    source="first law of thermodynamics",
    set_up=struck_pile,
    examine=examine,
    variants=(LAGGED, EULER, OPEN_CLOSE, CONVEX, MULTIPLIERS, CONVEX_MULTIPLIERS),
    quick=(CONVEX,),
    known_failures=tuple(
        KnownFailure(variant=variant, quantity="largest energy created", reason=FOUND_INSIDE)
        for variant in (LAGGED, EULER)
    ),
)
