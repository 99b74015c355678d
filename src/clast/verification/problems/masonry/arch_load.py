"""The point load under which a semicircular arch collapses."""

from functools import partial

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.limit_analysis import (
    add_voussoirs,
    joint_ends,
    largest_factor,
    voussoirs_between,
)
from clast.verification.problems import Floats, Model, StaticRun, Trial, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

GRAVITY, DENSITY, FRICTION_ANGLE = 9.8, 2400.0, 45.0
RADIUS, SHARE, VOUSSOIRS = 5.0, 0.15, 20
"""Mean radius R, m, thickness over R and number of voussoirs."""
PLACES = (11, 13, 15)
"""Loaded voussoirs, from the right springing: next to the crown, and nearer the left haunch."""
RESOLUTION = "bisected to 0.81 %; joints give a little"


def joints() -> tuple[Floats, Floats]:
    """Return the inner and outer ends of all joints from right to left, m (k, 2)."""
    return joint_ends(RADIUS, SHARE, 180.0, VOUSSOIRS)


def loaded_point(place: int) -> Floats:
    """Return the middle of the back of a voussoir, m (2,)."""
    outer = joints()[1]
    return np.asarray(0.5 * (outer[place - 1] + outer[place]))


def exact_load(place: int) -> float:
    """Return the largest load on a voussoir, N/m."""
    blocks = voussoirs_between(*joints(), FRICTION_ANGLE)
    weight = blocks.body_force((0.0, -DENSITY * GRAVITY))
    load = blocks.force_at(place - 1, loaded_point(place), np.array([0.0, -1.0]))
    return largest_factor(blocks, weight, load)


def loaded_arch(place: int = PLACES[1], load: float = 2e4) -> Model:
    """Return a fixed base and the voussoirs, one of them with a load, N/m."""
    reach = RADIUS * (1.0 + SHARE)
    builder = new_model(
        "Loaded arch", gravity=GRAVITY, young=50e9, density=DENSITY, friction_angle=FRICTION_ANGLE
    )
    builder.block(name="base", vertices=box(-reach, -0.5, reach, 0), fixed=True)
    for name, middle in add_voussoirs(builder, *joints()).items():
        builder.measured_point(name, middle, block=name)
    x, y = loaded_point(place)
    builder.point_load((x, y), (0.0, -load), block=str(place))
    return builder.build()


STATIC = StaticRun(p=1e10, step=2e-2, steps=200)


@problem(set_up=loaded_arch, variants=(OPEN_CLOSE, CONVEX), quick=())
def arch_load(trial: Trial, places: tuple[int, ...] = PLACES) -> None:
    """Point load on an arch.

    A semicircle of twenty voussoirs, 5 m of mean radius and t/R = 0.15, carries its weight and a
    load on one voussoir, which is bisected; phi = 45 degrees, E = 50 GPa, p = 10 GPa, h = 20 ms,
    static (dynamic_ratio = 0).

    Exact: the largest load with N1, N2 >= 0 and |V| <= (N1 + N2) tan phi in all joints.
    Source: limit analysis by linear programming (scipy), after Heyman (1982).
    Not run with: modified: in steps this long one pass and four throw the voussoirs, p h2/m being
    far above 6.
    """
    for place in places:
        exact = exact_load(place)
        load = STATIC.limit(trial.variant, partial(loaded_arch, place), 1.06 * exact, 0.93 * exact)
        quantity = f"largest load on voussoir {place}"
        trial.relative(quantity, "N/m", load, exact, 0.015, RESOLUTION)
    every = range(11, 17)
    chart = trial.chart("largest load", "distance from the crown over R", "load, kN/m")
    chart.exact(
        "linear programming",
        [-loaded_point(place)[0] / RADIUS for place in every],
        [1e-3 * exact_load(place) for place in every],
    )
    chart.computed(
        [-loaded_point(place)[0] / RADIUS for place in places],
        [1e-3 * row.computed for row in trial.rows],
    )
