"""Uplift below a gravity dam: forces in its joint, with and without drains, and sliding."""

from functools import partial

import numpy as np

from clast.verification.problems import InputBuilder, Model, Run, StaticRun, Trial, problem
from clast.verification.variants import CONVEX, Variant

GRAVITY, WATER, CONCRETE = 9.81, 1000.0, 2400.0
BASE, CREST, HEIGHT, LEVEL = 10.0, 2.0, 15.0, 12.0
"""Width at base and crest, height of the dam, and level of the reservoir, m."""
DRAIN = 2.0
"""Distance of the row of drains from the heel, m."""
FRICTION = 45.0
"""Friction angle where the dam stands, degrees."""
WEIGHT = CONCRETE * GRAVITY * 0.5 * (BASE + CREST) * HEIGHT
"""W, N/m."""
THRUST = 0.5 * WATER * GRAVITY * LEVEL**2
"""H, N/m."""
STATIC = StaticRun(p=1e11, step=1e-2, steps=60, bisections=5)
SPAN = 0.04
"""Half of the range of the limit that is searched as a share of it."""


def exact_uplift(drained: bool) -> float:
    """Return U, N/m: a triangle of pressure to the toe, or to the drains."""
    return 0.5 * WATER * GRAVITY * LEVEL * (DRAIN if drained else BASE)


def dam(drained: bool = False, friction: float = FRICTION) -> Model:
    """Return a dam on rock before a reservoir; ``friction`` of its joint in degrees."""
    builder = InputBuilder(title="Uplift below a dam", gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=30e9, poisson=0.2, density=CONCRETE)
    builder.add_joint(friction_angle=friction, aperture=2e-4)
    ground = [(-5.0, -5.0), (BASE + 5.0, -5.0), (BASE + 5.0, 0.0), (-5.0, 0.0)]
    builder.block(name="rock", vertices=ground, fixed=True)
    corners = [(0.0, 0.0), (BASE, 0.0), (CREST, HEIGHT), (0.0, HEIGHT)]
    builder.block(name="dam", vertices=corners)
    builder.measured_point("heel", (0.0, 0.0), block="dam")
    builder.flow = {"longest": 1.0, "density": WATER}
    wet = [((-5.0, 0.0), (0.0, 0.0)), ((0.0, 0.0), (0.0, HEIGHT))]
    builder.flow_boundary("reservoir", edges=wet, head=LEVEL)
    if drained:
        builder.well("drains", (DRAIN, 0.0), pressure=0.0, only_outflow=True)
    return builder.build()


def at_rest(variant: Variant, drained: bool) -> Run:
    """Return the run of the dam until it rests."""
    return variant.static(dam(drained), step=1e-2, end=0.5, p=1e11, max_displacement=0.02)


WAYS = ((False, "without drains"), (True, "with drains"))


@problem(set_up=partial(dam, drained=True), variants=(CONVEX,))
def flow_uplift(trial: Trial) -> None:
    """Uplift below a dam.

    A dam of 15 m stands on rock with a joint below it, before 12 m of water: water flows through
    the joint to the toe, or to drains 2 m behind the heel. Compared are the effective forces in the
    joint. p = 100 GPa, h = 10 ms, static.

    Exact: N = W - U, U = rho g h L/2 to the toe or the drains.
    Source: linear fall of pressure in a joint of one aperture; equilibrium of the dam.
    Not run with: modified and open-close: forces of water are the same for every process.
    """
    for drained, name in WAYS:
        left = WEIGHT - exact_uplift(drained)
        run = at_rest(trial.variant, drained)
        carried = float(run.state.memory.normal_force.sum())
        reason = "the dam strains, and its faces turn with it"
        trial.relative(f"force in the joint, {name}", "N/m", carried, left, 1e-5, reason)
    flow = at_rest(trial.variant, drained=True).flow()
    fine = np.array([0.0, DRAIN, BASE])
    chart = trial.chart("pressure below the dam, drained", "distance from the heel, m", "Pa")
    chart.exact("to the drains", fine, WATER * GRAVITY * np.array([LEVEL, 0.0, 0.0]))
    chart.computed(flow["start_x"], flow.pressure[:, 0])


@problem(set_up=partial(dam, drained=True), variants=(CONVEX,))
def flow_uplift_limit(trial: Trial) -> None:
    """Sliding of a dam with uplift.

    The dam of flow-uplift: the friction of its joint is bisected at which it slides, without drains
    and with them.

    Exact: tan phi = H/(W - U), U = rho g h L/2 to the toe or the drains.
    Source: equilibrium of the dam; Coulomb's law.
    Not run with: modified and open-close: forces of water are the same for every process.
    """
    found, uplift = [], []
    for drained, name in WAYS:
        tangent = THRUST / (WEIGHT - exact_uplift(drained))

        def with_share(share: float, drained: bool = drained, tangent: float = tangent) -> Model:
            return dam(drained, float(np.degrees(np.arctan(share * tangent))))

        limit = STATIC.limit(trial.variant, with_share, 1.0 - SPAN, 1.0 + SPAN)
        quantity = f"friction at the limit over H/(W - U), {name}"
        trial.relative(quantity, "-", limit, 1.0, 0.01, "bisected to 0.25 %")
        uplift.append(exact_uplift(drained) / WEIGHT)
        found.append(limit * tangent)
    fine = np.linspace(0.0, 0.5, 51)
    chart = trial.chart("friction at the limit", "uplift / weight", "tan φ")
    chart.exact("H/(W - U)", fine, THRUST / WEIGHT / (1.0 - fine))
    chart.computed(uplift, found)
