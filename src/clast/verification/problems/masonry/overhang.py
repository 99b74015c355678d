"""Bricks piled over the edge of a table: how far they reach."""

from itertools import pairwise

import numpy as np

from clast.verification.problems import Model, StaticRun, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS

LENGTH, HEIGHT = 1.0, 0.25
"""Length and height of a brick, m."""
BRICKS = 5
HARMONIC = float(sum(1.0 / k for k in range(1, BRICKS + 1)))
SHARES = (0.95, 0.97, 0.99, 1.01, 1.03)
"""Overhangs as shares of the limit."""
BRACKETED = "bracketed by 0.99 and 1.01 of it; the joints are springs"
STATIC = StaticRun(p=2e8, step=2e-3, steps=500, max_displacement=0.01)


def pile(share: float = 0.99) -> Model:
    """Return a table with its edge at x = 0 and bricks that reach ``share`` of the limit."""
    builder = new_model("Overhang", gravity=9.8, young=20e9, density=2000.0, friction_angle=35.0)
    builder.block(name="table", vertices=box(-2, -0.5, 0, 0), fixed=True)
    reach = 0.0
    for k in range(BRICKS, 0, -1):
        reach += share * 0.5 * LENGTH / k
        low = (BRICKS - k) * HEIGHT
        left, high = reach - LENGTH, low + HEIGHT
        builder.block(name=f"brick {k}", vertices=box(left, low, reach, high))
        builder.measured_point(f"brick {k}", (reach - 0.5 * LENGTH, low + 0.5 * HEIGHT))
    return builder.build()


@problem(set_up=pile, variants=EACH_PROCESS, quick=())
def overhang(trial: Trial, shares: tuple[float, ...] = SHARES) -> None:
    """Bricks over the edge of a table.

    Five bricks of 1 m x 0.25 m, each as far over the next as it will go, and a little less or more;
    p = 0.2 GPa, h = 2 ms, static (dynamic_ratio = 0).

    Exact: reach L/2 (1 + 1/2 + ... + 1/5) = 1.14167 m.
    Source: equilibrium; the harmonic series.
    """
    standing = [STATIC.stands(pile(share), trial.variant) for share in shares]
    longest = max((s for s, stands in zip(shares, standing, strict=True) if stands), default=0.0)
    shortest = min((s for s, stands in zip(shares, standing, strict=True) if not stands), default=9)
    exact = 0.5 * LENGTH * HARMONIC
    reach = 0.5 * (longest + shortest) * exact
    disorder = sum(a < b for a, b in pairwise(standing))
    trial.relative("reach at the limit", "m", reach, exact, 0.01, BRACKETED)
    trial.absolute("longer piles that stand where shorter fall", "", disorder, 0.0, 0.0, "a count")
    chart = trial.chart("pile of five bricks", "reach / limit", "stands (1) or falls (0)")
    chart.exact("harmonic series", (0.94, 1.0, 1.0, 1.04), (1.0, 1.0, 0.0, 0.0))
    chart.computed(shares, np.array(standing, float))
