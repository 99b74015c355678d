"""Semicircular arches: the thinnest that stands, and the point load under which one collapses."""

from functools import partial

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.verification.fixtures import box, new_model
from clast.verification.limit_analysis import (
    add_voussoirs,
    joint_ends,
    largest_factor,
    reserve,
    voussoirs_between,
)
from clast.verification.problems import Floats, Model, StaticRun, Trial, limit, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

GRAVITY, DENSITY = 9.8, 2400.0
RADIUS, VOUSSOIRS = 5.0, 20
"""Mean radius R, m, and number of voussoirs: joints at the crown and at 54 degrees from it."""
FRICTION_ANGLE = 50.0
"""Friction angle, degrees, of the thinnest arch, in which no joint slips."""
MILANKOVITCH = 0.1075
"""t/R of the thinnest arch."""
LOW, HIGH = 0.1045, 0.1105
"""t/R that are searched."""


def semicircle(
    title: str, share: float, friction_angle: float
) -> tuple[InputBuilder, dict[str, Floats]]:
    """Begin an arch with t/R = ``share`` on a fixed base; return its builder and middles, m."""
    reach = RADIUS * (1.0 + share)
    builder = new_model(title, gravity=GRAVITY, young=50e9, density=DENSITY)
    builder.add_joint(friction_angle=friction_angle)
    builder.block(name="base", vertices=box(-reach, -0.5, reach, 0), fixed=True)
    return builder, add_voussoirs(builder, *joint_ends(RADIUS, share, 180.0, VOUSSOIRS))


def safety(share: float, voussoirs: int = VOUSSOIRS) -> float:
    """Return the reserve of an arch, N/m over rho g: not negative where it stands."""
    ends = joint_ends(RADIUS, share, 180.0, voussoirs)
    blocks = voussoirs_between(*ends, FRICTION_ANGLE)
    return reserve(blocks, blocks.body_force((0.0, -1.0)))


def exact_limit(voussoirs: int = VOUSSOIRS) -> float:
    """Return t/R of the thinnest arch of so many voussoirs."""
    return limit(lambda share: safety(share, voussoirs) > 0.0, LOW, HIGH, 20)


def model_of_arch(share: float = 0.12) -> Model:
    """Return a fixed base and the voussoirs of an arch with t/R = ``share``."""
    builder, _ = semicircle("Semicircular arch", share, FRICTION_ANGLE)
    crown = float(joint_ends(RADIUS, share, 180.0, VOUSSOIRS)[1][VOUSSOIRS // 2, 1])
    builder.measured_point("crown", (0.0, crown), block="10")
    return builder.build()


@problem(set_up=model_of_arch, variants=(OPEN_CLOSE, CONVEX), few=(2,))
def arch(trial: Trial, bisections: int = 4) -> None:
    """Thinnest semicircular arch.

    Twenty voussoirs on a semicircle of 5 m mean radius under their weight; the thickness is
    bisected. E = 50 GPa, p = 10 GPa, phi = 50 degrees, h = 4 ms, static (dynamic_ratio = 0).

    Exact: t/R = 0.1075 without joints; 0.10735 with joints every 9 degrees.
    Source: Milankovitch (1907), Heyman (1969); with joints by linear programming (scipy).
    Not run with: modified: in steps this long one pass and four throw the voussoirs, p h2/m being
    far above 6.
    """
    static = StaticRun(p=1e10, step=4e-3, steps=300, bisections=bisections)
    thinnest = static.limit(trial.variant, model_of_arch, LOW, HIGH)
    exact, width = exact_limit(), (HIGH - LOW) / 2**bisections
    quantity, reason = f"t/R of {VOUSSOIRS} voussoirs", f"bisected to {width:.1g}; "
    reason += "joints and blocks give a little"
    trial.relative(quantity, "", thinnest, exact, 1.5 * width / exact, reason)
    quantity, reason = "t/R of an arch without joints", "hinges only at joints: 0.15 % less"
    tolerance = 0.01 + width / MILANKOVITCH
    trial.relative(quantity, "", thinnest, MILANKOVITCH, tolerance, reason)
    shares = np.linspace(0.102, 0.113, 12)
    labels = "t/R", "least end force of a joint, N/(ρ g)"
    chart = trial.chart("reserve of the line of thrust", *labels)
    chart.exact("by linear programming", shares, [safety(one) for one in shares])
    chart.computed((thinnest,), (0.0,), "limit")


SHARE, ROUGH = 0.15, 45.0
"""t/R of the loaded arch, and its friction angle, degrees."""
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
    blocks = voussoirs_between(*joints(), ROUGH)
    weight = blocks.body_force((0.0, -DENSITY * GRAVITY))
    load = blocks.force_at(place - 1, loaded_point(place), np.array([0.0, -1.0]))
    return largest_factor(blocks, weight, load)


def loaded_arch(place: int = PLACES[1], load: float = 2e4) -> Model:
    """Return a fixed base and the voussoirs, one of them with a load, N/m."""
    builder, middles = semicircle("Loaded arch", SHARE, ROUGH)
    for name, middle in middles.items():
        builder.measured_point(name, middle, block=name)
    builder.point_load(tuple(loaded_point(place)), (0.0, -load), block=str(place))
    return builder.build()


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
    static = StaticRun(p=1e10, step=2e-2, steps=200)
    for place in places:
        exact = exact_load(place)
        load = static.limit(trial.variant, partial(loaded_arch, place), 1.06 * exact, 0.93 * exact)
        quantity = f"largest load on voussoir {place}"
        trial.relative(quantity, "N/m", load, exact, 0.015, RESOLUTION)
    chart = trial.chart("largest load", "distance from the crown over R", "load, kN/m")
    every = range(11, 17)
    distances = {place: -loaded_point(place)[0] / RADIUS for place in every}
    exact_loads = [1e-3 * exact_load(place) for place in every]
    chart.exact("linear programming", list(distances.values()), exact_loads)
    computed = [1e-3 * load for load in trial.computed]
    chart.computed([distances[place] for place in places], computed)
