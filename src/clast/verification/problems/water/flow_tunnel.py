"""Inflow to a tunnel below a lake, against wells and their images."""

import numpy as np

from clast.actions.flow import water_at
from clast.model.model import Bools
from clast.rockmass import JointSet, cut
from clast.rockmass.domain import Circle, Domain, Opening
from clast.verification.fixtures import CUT, box, cut_rock, into_rock
from clast.verification.problems import Floats, InputBuilder, Model, Trial, problem

RADIUS, DEPTH = 2.0, 12.0
"""Radius of the tunnel, and depth of its middle below the bed of the lake, m."""
HALF, DEEP = 20.0, 24.0
"""Half the width of the model, and its height, m."""
APERTURE, VISCOSITY, WEIGHT = 2e-4, 1e-3, 9810.0
FALL = 10.0
"""Head of the lake over that in the tunnel, m."""
SPACINGS = (1.0, 0.5)
"""Distances of joints, m."""
IMAGE = float(np.sqrt(DEPTH**2 - RADIUS**2))
"""Depth of the well, and height of its image, whose lines of one head the tunnel is, m."""


def exact_inflow(spacing: float) -> float:
    """Return 2 pi K h/ln((h0 + d)/r), m2/s, with K = rho g a^3/(12 mu s)."""
    conductivity = WEIGHT * APERTURE**3 / (12.0 * VISCOSITY * spacing)
    return 2.0 * np.pi * conductivity * FALL / float(np.log((DEPTH + IMAGE) / RADIUS))


def exact_head(at: Floats) -> Floats:
    """Return the head above that of the lake at points (m, 2), m, shape (m,)."""
    x, y = at.T
    ratio = (x**2 + (y - IMAGE) ** 2) / (x**2 + (y + IMAGE) ** 2)
    return np.asarray(-0.5 * FALL * np.log(ratio) / np.log((DEPTH + IMAGE) / RADIUS))


def in_wall(at: Floats) -> Bools:
    """Return which points (m, 2) lie in the wall of the tunnel, shape (m,)."""
    return np.asarray(np.hypot(at[:, 0], at[:, 1] + DEPTH) < 1.05 * RADIUS)


def tunnel(spacing: float = 1.0) -> Model:
    """Return the tunnel in rock with two sets of joints, with the exact heads on its outline."""
    sets = [
        JointSet(name="level", angle=0.0, spacing=spacing, origin=(0.0, 0.41 * spacing)),
        JointSet(name="upright", angle=90.0, spacing=spacing, origin=(0.21 * spacing, 0.0)),
    ]
    domain = Domain(boundary=box(-HALF, -DEEP, HALF, 0.0), smallest_block=0.0, smallest_edge=0.0)
    circle = Circle(center=(0.0, -DEPTH), radius=RADIUS, chords=64)
    opening = Opening(name="tunnel", shape=circle, excavated=True)
    rock_mass = cut(domain, sets, openings=[opening])

    def begun() -> InputBuilder:
        builder = cut_rock("Tunnel below a lake", rock_mass, aperture=APERTURE)
        builder.flow = {"viscosity": VISCOSITY, "confined": True}
        return builder

    flow = begun().build().flow
    assert flow is not None and flow.network is not None
    network, builder = flow.network, begun()
    places = network.at[network.outer]
    wall = in_wall(places)
    walls = [(at - 1e-4, at + 1e-4) for at in places[wall]]
    builder.flow_boundary("tunnel", edges=walls, head=-FALL, presses=False)
    for at, head in zip(places[~wall], exact_head(places[~wall]), strict=True):
        builder.flow_boundary(edges=[(at - 1e-4, at + 1e-4)], head=float(head), presses=False)
    return builder.build()


@problem(set_up=tunnel, variants=(CUT,), quick=(CUT,))
def flow_tunnel(trial: Trial) -> None:
    """Inflow to a tunnel.

    A tunnel of radius 2 m lies 12 m below the bed of a lake, in rock with two sets of joints at
    right angles; the head in it is 10 m lower. On the outline of the model are the heads of a well
    and its image.

    Exact: Q = 2 pi K h/ln((h0 + d)/r), d^2 = h0^2 - r^2, K = rho g a^3/(12 mu s).
    Source: image wells; Goodman et al. (1965) for deep tunnels.
    Not run with: modified and open-close and convex: nothing moves.
    """
    for spacing, tolerance in zip(SPACINGS, (0.01, 0.003), strict=True):
        inflow = -into_rock(tunnel(spacing))["tunnel"] / exact_inflow(spacing)
        quantity = f"inflow over the exact one, joints {spacing:g} m apart"
        reason = f"{RADIUS / spacing:g} joints to a radius; of second order in their distance"
        trial.relative(quantity, "-", inflow, 1.0, tolerance, reason)
    model = tunnel(SPACINGS[-1])
    water = water_at(model, 0.0)
    at = water.network.at + model.origin
    above = np.flatnonzero((np.abs(at[:, 0]) < 0.51 * SPACINGS[-1]) & (at[:, 1] > RADIUS - DEPTH))
    head = water.solved.pressure[above] / WEIGHT + at[above, 1]
    fine = np.linspace(RADIUS - DEPTH, 0.0, 41)
    chart = trial.chart("head above the tunnel", "height y, m", "head, m")
    chart.exact("image wells", fine, exact_head(np.stack([0.0 * fine, fine], axis=1)))
    chart.computed(at[above, 1], head)
