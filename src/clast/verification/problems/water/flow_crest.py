"""A joint that rises to a crest and falls again, between two levels: none, some or full flow."""

import numpy as np

from clast.verification.fixtures import CUT, into_rock
from clast.verification.problems import InputBuilder, Model, Trial, problem

APERTURE, VISCOSITY, WEIGHT = 2e-4, 1e-3, 9810.0
CREST, LOW = 1.0, 0.4
"""Height of the crest above both ends of the joint, and level behind it, m."""
BELOW, ABOVE = (0.1, 0.4, 0.7, 0.99), (1.2, 1.5, 1.8, 2.4)
"""Levels before it that do not reach the crest, and that do, m."""
CAPACITY = WEIGHT * APERTURE**3 / (12.0 * VISCOSITY * np.sqrt(2.0))
"""What either half carries by its own fall, m2/s."""


def exact_flow(level: float) -> float:
    """Return what flows over the crest, m2/s: by the head above it, or above that of full flow."""
    return float(CAPACITY * max(level - max(CREST, 0.5 * (level + LOW)), 0.0))


def crest(level: float = 1.5, longest: float | None = None) -> Model:
    """Return two blocks on a roof-shaped base, the joint below them between two levels, m."""
    builder = InputBuilder(title="Crest", gravity=(0.0, -9.81))
    builder.add_rock("rock", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(aperture=0.0)
    builder.add_joint("bed", aperture=APERTURE)
    base = [(0.0, -1.0), (2.0, -1.0), (2.0, 0.0), (1.0, CREST), (0.0, 0.0)]
    beds = ["", "", "bed", "bed", ""]
    builder.block(name="base", vertices=base, edge_joint=beds, fixed=True)
    for name, side in (("left", 0.0), ("right", 2.0)):
        corners = [(side, 0.0), (1.0, CREST), (1.0, 3.0), (side, 3.0)]
        corners = corners if side == 0.0 else corners[::-1]
        builder.block(name=name, vertices=corners, fixed=True)
    builder.flow = {"viscosity": VISCOSITY, "longest": longest}
    builder.flow_boundary("before", side="left", head=level)
    builder.flow_boundary("behind", side="right", head=LOW)
    return builder.build()


@problem(set_up=crest, variants=(CUT,), quick=(CUT,))
def flow_crest(trial: Trial) -> None:
    """Flow over a crest.

    A joint of 0.2 mm rises by 1 m to a crest and falls by as much, between a level of 0.4 m behind
    it and several before it. Below the crest both columns are at rest; above it water runs over,
    and down a joint that is not full, until the fall from end to end fills it. Also in pieces.

    Exact: q = C rho g max(h1 - max(c, (h1 + h2)/2), 0) with the C of either half.
    Source: hydrostatics and the cubic law; pressures are not below zero.
    Not run with: modified and open-close and convex: nothing moves.
    """
    for level in (*BELOW, *ABOVE):
        for longest, name in ((None, ""), (0.3, ", in pieces")):
            flow = into_rock(crest(level, longest))["before"] / CAPACITY
            quantity = f"flow by capacity, level {level:g} m{name}"
            exact = exact_flow(level) / CAPACITY
            trial.absolute(quantity, "-", flow, exact, 1e-12, "rounding of pressures")
    fine = np.linspace(0.0, 2.5, 101)
    chart = trial.chart("flow over the crest", "level before it, m", "flow / capacity")
    chart.exact("formula", fine, [exact_flow(one) / CAPACITY for one in fine])
    chart.computed((*BELOW, *ABOVE), trial.computed[::2])
