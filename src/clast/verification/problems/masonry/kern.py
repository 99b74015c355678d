"""A pier that is loaded off its middle, on a bed that carries no tension."""

import numpy as np

from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

WIDTH, HEIGHT = 2.0, 0.5
"""Width b and height of the pier, m."""
FORCE, BEDDING = 1e5, 1e9
"""N, N/m, and k, Pa/m."""
PARTS = 40
"""Fixed blocks of which the bed is made; their corners carry the pier."""
SHARES = (0.0, 0.1, 1.0 / 6.0, 0.25, 0.35, 0.42)
"""e/b."""
STEP, STEPS = 1e-2, 200
CORNERS = f"the bed carries at {PARTS + 1} places"
FIRST = WIDTH / PARTS
"""Distance of the places, m."""


def exact_bed(share: float) -> tuple[float, float, float]:
    """Return length in contact, m, edge pressure, Pa, and turn, rad, for e/b."""
    if share <= 1.0 / 6.0:
        turn = 12.0 * FORCE * share / (BEDDING * WIDTH**2)
        return WIDTH, FORCE / WIDTH * (1.0 + 6.0 * share), turn
    length = 3.0 * (0.5 - share) * WIDTH
    return length, 2.0 * FORCE / length, 2.0 * FORCE / (BEDDING * length**2)


def pier(share: float = 0.25) -> Model:
    """Return a bed of fixed blocks and the pier on it, with its force at e/b to the right."""
    builder = new_model("Pier on a bed", young=1e13, density=2500.0, poisson=0.0)
    builder.add_joint(friction_angle=30.0, normal_stiffness=BEDDING, shear_stiffness=BEDDING)
    half = 0.5 * WIDTH
    for k in range(PARTS):
        left, right = k * FIRST - half, (k + 1) * FIRST - half
        builder.block(name=f"bed {k + 1}", vertices=box(left, -0.2, right, 0.0), fixed=True)
    builder.block(name="pier", vertices=box(-half, 0.0, half, HEIGHT))
    builder.point_load((share * WIDTH, HEIGHT), (0.0, -FORCE), block="pier")
    builder.measured_point("edge", (half, 0.0), block="pier")
    builder.measured_point("heel", (-half, 0.0), block="pier")
    return builder.build()


@problem(set_up=pier, variants=(OPEN_CLOSE, CONVEX), few=(SHARES[2:4],))
def kern(trial: Trial, shares: tuple[float, ...] = SHARES) -> None:
    """Pier loaded off its middle.

    A stiff pier 2 m wide carries 100 kN/m at 0 to 0.42 of its width from its middle, on a bed of 1
    GPa/m without tensile strength: 40 fixed blocks, whose corners carry the pier. h = 10 ms, static
    (dynamic_ratio = 0).

    Exact: e <= b/6: edge N/b (1 + 6 e/b); beyond, contact over L = 3 (b/2 - e), edge 2 N/L, turned
    by 2 N/(k L^2).
    Source: Navier's linear pressure without tension.
    Not run with: modified: with late friction four passes create energy, and its run is stopped.
    """
    beds = []
    for share in shares:
        # The values of ``exact_bed``, computed for a pier at rest.
        run = trial.variant.static(
            pier(share), step=STEP, end=STEP * STEPS, p=BEDDING, max_displacement=0.01
        )
        edge, heel = (float(run.history(name).displacement[-1, 1]) for name in ("edge", "heel"))
        turn = (heel - edge) / WIDTH
        # from the edge to where the pier neither sinks nor rises
        length = WIDTH if heel <= 0.0 else -edge / turn
        beds.append((length, -edge * BEDDING, turn))
        exact, at = exact_bed(share), f"e/b = {share:.3g}"
        quantity = f"length in contact, {at}"
        trial.absolute(quantity, "m", beds[-1][0], exact[0], 0.5 * FIRST, CORNERS)
        trial.relative(f"edge pressure, {at}", "Pa", beds[-1][1], exact[1], 0.01, CORNERS)
        if share > 0.0:
            trial.relative(f"turn, {at}", "rad", beds[-1][2], exact[2], 0.02, CORNERS)
    fine = np.linspace(0.0, 0.43, 87)
    chart = trial.chart("pressure at the edge", "e/b", "edge pressure over N/b")
    chart.exact("Navier, no tension", fine, [exact_bed(e)[1] * WIDTH / FORCE for e in fine])
    chart.computed(shares, [each[1] * WIDTH / FORCE for each in beds])
