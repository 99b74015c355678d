"""A block on two planes: how its weight is shared."""

import numpy as np

from clast.verification.problems import Model, Trial, new_model, problem
from clast.verification.variants import BOTH_LAWS, MULTIPLIERS, Variant

GRAVITY = 9.8
DIP_A, DIPS_B = 30.0, (40.0, 50.0, 60.0)
"""Dip of the left plane, and dips of the right one, degrees."""
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


def computed_shares(dip_b: float, variant: Variant) -> tuple[float, float]:
    """Return the normal forces of both planes over the weight."""
    model = trough(dip_b)
    memory = variant.static(model, step=1e-3, end=0.2, p=5e8, max_displacement=0.01).state.memory
    owner, edge = model.vertex_block[memory.vertex], memory.block
    weight = float(model.mass[2] * GRAVITY)
    left, right = (
        float(memory.normal_force[(owner == plane) | (edge == plane)].sum()) / weight
        for plane in (0, 1)
    )
    return left, right


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
        forces.append(computed_shares(dip, trial.variant))
        for plane, one, other in zip(("left", "right"), forces[-1], exact_shares(dip), strict=True):
            quantity = f"force on the {plane} plane, right dip {dip:g} degrees"
            trial.relative(quantity, "W", one, other, 1e-4, SETTLED)
    fine = np.linspace(10.0, 70.0, 61)
    exact, values = np.array([exact_shares(dip) for dip in fine]), np.array(forces)
    chart = trial.chart(
        "forces on the planes", "dip of the right plane, degrees", "normal force / weight"
    )
    chart.exact("left plane", fine, exact[:, 0])
    chart.exact("right plane", fine, exact[:, 1])
    chart.computed(np.repeat(DIPS_B, 2), values.ravel())
