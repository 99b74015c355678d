"""Blocks at rest on their contact springs: penetration, and contact forces.

A block on the floor: by the penalty law each of its n corners is pressed in by W / (n p).  The
augmented Lagrangian law solves k times a step and hands the contact force of one solve to the next
as a multiplier; the inertia of the step resists every solve anew.  With b = p h2/(2 m), m the mass
per contact, the gap of the solves falls as 1, (1 + b), ... backwards, and the remaining share of
the penalty's penetration is

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
STIFFNESSES = (2e8, 6e8, 2e9)
"""Normal stiffnesses p of its two contacts, N/m per m; p h2/m = 0.15 to 1.5."""
AT_REST = "at rest after 0.3 s, velocities being dropped after every step"


def block_on_floor() -> Model:
    """Return a block of 1 m x 1 m on a fixed floor."""
    builder = new_model("Block at rest", gravity=GRAVITY, young=5e15, density=MASS)
    builder.block(name="floor", vertices=box(-1, -0.5, 2, 0), fixed=True)
    builder.block(name="block", vertices=box(0, 0, 1, 1))
    return builder.build()


def rest(stiffness: float, variant: Variant) -> tuple[float, float, float]:
    """Return penetration, m, contact force, N/m, of the block at rest, and the last step, s."""
    run = variant.static(block_on_floor(), step=1e-3, end=0.3, p=stiffness, max_displacement=0.01)
    memory, step = run.state.memory, float(run.steps["step"][-1])
    return float(-memory.gap.mean()), float(memory.normal_force.sum()), step


def exact_penetration(stiffness: float, variant: Variant, step: float) -> float:
    """Return the penetration at rest, m, where the mass term has a step, s."""
    penalty = WEIGHT / (2 * stiffness)
    if variant is CONVEX_MULTIPLIERS:
        return 0.0
    solves = variant.contact_law.get("solves", 1)
    stiff = stiffness * step**2 / (2.0 * MASS / 2)
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
    penetrations, step = [], 0.0
    for stiffness in STIFFNESSES:
        penetration, force, step = rest(stiffness, trial.variant)
        penetrations.append(penetration)
        exact = exact_penetration(stiffness, trial.variant, step)
        at = f"at p = {stiffness:.0e}"
        if exact:
            trial.relative(f"penetration {at}", "m", penetration, exact, 1e-6, AT_REST)
        else:
            tolerance = 1e-6 * exact_penetration(stiffness, CONVEX, step)
            trial.absolute(f"penetration {at}", "m", penetration, exact, tolerance, AT_REST)
        trial.relative(f"contact force {at}", "N/m", force, WEIGHT, 1e-6, AT_REST)
    if trial.variant is CONVEX_MULTIPLIERS:
        return
    fine = np.geomspace(STIFFNESSES[0], STIFFNESSES[-1], 50)
    labels = ("normal stiffness p, N/m per m", "penetration, m")
    chart = trial.chart("penetration at rest", *labels, log="xy")
    label = "W/(n p), four solves" if "solves" in trial.variant.contact_law else "W/(n p)"
    chart.exact(label, fine, [exact_penetration(p, trial.variant, step) for p in fine])
    chart.computed(STIFFNESSES, penetrations)


WIDTHS = (2.0, 2.0, 1.5, 1.5, 1.0)
"""Widths of the blocks of a stack from below, m; all are 1 m high."""
CONTACTS = (2, 4, 2, 4, 2)
"""Contacts n of the joint below each block."""
VIBRATION = "what is left of the vibration after 1.2 s"


def model_of_stack() -> Model:
    """Return five blocks on a fixed floor, some as wide as the one below."""
    builder = new_model(
        "Stack at rest", gravity=GRAVITY, young=50e9, density=MASS, friction_angle=30.0
    )
    builder.block(name="floor", vertices=box(-2, -0.5, 2, 0), fixed=True)
    for k, width in enumerate(WIDTHS):
        half = 0.5 * width
        builder.block(vertices=box(-half, k, half, k + 1))
    return builder.build()


@problem(set_up=model_of_stack, variants=BOTH_LAWS)
def stack(trial: Trial) -> None:
    """Stack of blocks at rest.

    Five blocks of 1 m height, 2, 2, 1.5, 1.5 and 1 m wide, are put on each other and on a fixed
    floor; rho = 2700 kg/m3, g = 9.8 m/s2, p = 1 GPa, h = 1 ms. After 1.2 s they are at rest.

    Exact: sum of N of a joint = weight W above it; penetration W/(n p) with the penalty law.
    Source: equilibrium.
    """
    model = model_of_stack()
    run = trial.variant.run(model, step=1e-3, end=1.2, p=1e9, max_displacement=0.01)
    memory, count = run.state.memory, len(WIDTHS)
    # the joint below each block: its normal force, N/m, and its mean penetration, m
    upper = np.maximum(model.vertex_block[memory.vertex], memory.block) - 1
    force = np.bincount(upper, memory.normal_force, count).astype(np.float64)
    penetration = np.bincount(upper, -memory.gap, count) / np.bincount(upper, minlength=count)
    weight = np.cumsum(GRAVITY * model.mass[:0:-1])[::-1]
    exact = weight / (np.array(CONTACTS) * 1e9)
    for k in range(count):
        name = "base reaction" if k == 0 else f"normal force of joint {k}"
        trial.relative(name, "N/m", force[k], weight[k], 1e-6, VIBRATION)
    for k in range(count if trial.variant.contact_law["name"] == "penalty" else 0):
        name = f"penetration of joint {k}, {CONTACTS[k]} contacts"
        trial.relative(name, "m", penetration[k], exact[k], 1e-6, VIBRATION)
    joints = np.arange(count)
    chart = trial.chart("normal force of the joints", "joint, from below", "normal force, kN/m")
    chart.exact("weight above", joints, 1e-3 * weight)
    chart.computed(joints, 1e-3 * force)


DIP_A, DIPS_B = 30.0, (40.0, 50.0, 60.0)
"""Dip of the left plane of a trough, and dips of the right one, degrees."""
DEPTH = 1.0
"""Depth of the trough, m."""
SETTLED = "at rest; the block turns by about 1e-5 on its springs"


def trough(dip_b: float = 45.0) -> Model:
    """Return two fixed planes and a triangular block that fills the trough between them."""
    a, b = DEPTH / np.tan(np.radians(DIP_A)), DEPTH / np.tan(np.radians(dip_b))
    builder = new_model("Block on two planes", gravity=GRAVITY, young=50e9, density=2600.0)
    below = -0.3
    left = [(-a - 0.3, below), (0.0, below), (0.0, 0.0), (-a, DEPTH), (-a - 0.3, DEPTH)]
    right = [(0.0, below), (b + 0.3, below), (b + 0.3, DEPTH), (b, DEPTH), (0.0, 0.0)]
    builder.block(name="left", vertices=left, fixed=True)
    builder.block(name="right", vertices=right, fixed=True)
    # the lowest corner is cut off, so that each plane carries two corners
    share = 0.2
    corners = [(-share * a, share * DEPTH), (share * b, share * DEPTH), (b, DEPTH), (-a, DEPTH)]
    builder.block(name="block", vertices=corners)
    return builder.build()


def exact_shares(dip_b: float) -> tuple[float, float]:
    """Return the normal forces of both planes over the weight."""
    a, b = np.radians(DIP_A), np.radians(dip_b)
    return float(np.sin(b) / np.sin(a + b)), float(np.sin(a) / np.sin(a + b))


@problem(set_up=trough, variants=BOTH_LAWS, quick=(MULTIPLIERS,))
def two_planes(trial: Trial) -> None:
    """Block on two planes.

    A block of 1 m depth in a trough of two planes without friction, the left one dipping 30 degrees
    and the right one 40, 50 and 60; p = 0.5 GPa, h = 1 ms, static (dynamic_ratio = 0).

    Exact: N_a = W sin b/sin(a + b), N_b = W sin a/sin(a + b).
    Source: equilibrium.
    """
    forces = []
    for dip in DIPS_B:
        # The normal forces of both planes over the weight.
        model = trough(dip)
        memory = trial.variant.static(
            model, step=1e-3, end=0.2, p=5e8, max_displacement=0.01
        ).state.memory
        owner, edge = model.vertex_block[memory.vertex], memory.block
        weight = float(model.mass[2] * GRAVITY)
        left, right = (
            float(memory.normal_force[(owner == plane) | (edge == plane)].sum()) / weight
            for plane in (0, 1)
        )
        forces.append((left, right))
        for plane, one, other in zip(("left", "right"), forces[-1], exact_shares(dip), strict=True):
            quantity = f"force on the {plane} plane, right dip {dip:g} degrees"
            trial.relative(quantity, "W", one, other, 1e-4, SETTLED)
    fine = np.linspace(10.0, 70.0, 61)
    exact, values = np.array([exact_shares(dip) for dip in fine]), np.array(forces)
    labels = "dip of the right plane, degrees", "normal force / weight"
    chart = trial.chart("forces on the planes", *labels)
    chart.exact("left plane", fine, exact[:, 0])
    chart.exact("right plane", fine, exact[:, 1])
    chart.computed(np.repeat(DIPS_B, 2), values.ravel())
