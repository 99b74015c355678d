"""A block at rest on its contact springs: its penetration, and its contact forces.

Penalty: each of the n corners is pressed in by W / (n p).  The augmented Lagrangian law solves k
times a step and hands the contact force of one solve to the next as a multiplier; the inertia of
the step resists every solve anew.  With b = p h2/(2 m), m the mass per contact, the gap of the
solves falls as 1, (1 + b), ... backwards, and the remaining share of the penalty's penetration is

    b / ((1 + b)^k - 1),        1/k for small b.

Static steps of the convex process carry multipliers over, and nothing remains.  The contact force
is the weight with either law.
"""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Model, Trial, problem
from clast.verification.variants import BOTH_LAWS, CONVEX, CONVEX_MULTIPLIERS, MULTIPLIERS, Variant

GRAVITY = 9.8
MASS = 2700.0
WEIGHT = MASS * GRAVITY
"""Weight of the block of 1 m2, N/m."""
CONTACTS = 2
STIFFNESSES = (2e8, 6e8, 2e9)
"""Normal stiffnesses p, N/m per m; p h2/m = 0.15 to 1.5."""
STEP, DURATION = 1e-3, 0.3
TOLERANCE = 1e-6
REASON = "at rest after 0.3 s, velocities being dropped after every step"


def block_on_floor() -> Model:
    """Return a block of 1 m x 1 m on a fixed floor."""
    builder = new_model("Block at rest", gravity=GRAVITY, young=5e15, density=MASS)
    builder.block(name="floor", vertices=box(-1, -0.5, 2, 0), fixed=True)
    builder.block(name="block", vertices=box(0, 0, 1, 1))
    return builder.build()


def rest(stiffness: float, variant: Variant) -> tuple[float, float, float]:
    """Return penetration, m, contact force, N/m, of the block at rest, and the last step, s."""
    run = variant.static(
        block_on_floor(), step=STEP, end=DURATION, p=stiffness, max_displacement=0.01
    )
    memory, step = run.state.memory, float(run.steps["step"][-1])
    return float(-memory.gap.mean()), float(memory.normal_force.sum()), step


def exact_penetration(stiffness: float, variant: Variant, step: float) -> float:
    """Return the penetration at rest, m, where the mass term has a step, s."""
    penalty = WEIGHT / (CONTACTS * stiffness)
    if variant is CONVEX_MULTIPLIERS:
        return 0.0
    solves = variant.contact_law.get("solves", 1)
    stiff = stiffness * step**2 / (2.0 * MASS / CONTACTS)
    return float(penalty * stiff / ((1.0 + stiff) ** solves - 1.0))


@problem(set_up=block_on_floor, variants=BOTH_LAWS, quick=(MULTIPLIERS,))
def penetration(trial: Trial) -> None:
    """Penetration of a block at rest.

    A block of 1 m x 1 m rests on a fixed floor; rho = 2700 kg/m3, g = 9.8 m/s2, h = 1 ms, static
    (dynamic_ratio = 0). The block is stiff, so that only the contacts give.

    Exact: contact force W; penetration W/(n p) with the penalty law, times b/((1 + b)^4 - 1) with
    four solves of the augmented Lagrangian law, b = p h2/(2m), h that of the mass term, and 0 where
    the convex process carries multipliers over.
    Source: equilibrium; geometric series of the solves of a step.
    """
    penetrations, step = [], STEP
    for stiffness in STIFFNESSES:
        penetration, force, step = rest(stiffness, trial.variant)
        penetrations.append(penetration)
        exact = exact_penetration(stiffness, trial.variant, step)
        at = f"at p = {stiffness:.0e}"
        if exact:
            trial.relative(f"penetration {at}", "m", penetration, exact, TOLERANCE, REASON)
        else:
            tolerance = TOLERANCE * exact_penetration(stiffness, CONVEX, step)
            trial.absolute(f"penetration {at}", "m", penetration, exact, tolerance, REASON)
        trial.relative(f"contact force {at}", "N/m", force, WEIGHT, TOLERANCE, REASON)
    if trial.variant is CONVEX_MULTIPLIERS:
        return
    fine = np.geomspace(STIFFNESSES[0], STIFFNESSES[-1], 50)
    labels = ("normal stiffness p, N/m per m", "penetration, m")
    chart = trial.chart("penetration at rest", *labels, log="xy")
    label = "W/(n p), four solves" if "solves" in trial.variant.contact_law else "W/(n p)"
    chart.exact(label, fine, [exact_penetration(p, trial.variant, step) for p in fine])
    chart.computed(STIFFNESSES, penetrations)
