"""Two-block slide: an active block pushes a passive one (two-wedge analysis).

The upper block stands on a plane of dip a, the lower one on a flatter plane of dip b, with a
vertical joint between them and the friction angle phi everywhere.  As they begin to slide the upper
block sinks along the joint, so friction there pushes the lower block down.  With all joints at
their limit, the push of the joint turns by phi from the horizontal and the reactions of the planes
by phi from their normals:

    E = W1 sin(a - phi) cos(phi)/cos(a - 2 phi),    E = W2 sin(phi - b) cos(phi)/cos(2 phi - b)

for the upper and for the lower block; the slope is at its limit where both are equal.  Where both
planes and the joint (phi_j) have friction angles of their own, it is (Sarma 1979)

    W1 sin(a - phi_1)/cos(a - phi_1 - phi_j) = W2 sin(phi_2 - b)/cos(phi_2 + phi_j - b).
"""

from functools import partial

import numpy as np
from scipy.optimize import brentq

from clast.verification.problems import Model, StaticRun, Trial, new_model, problem
from clast.verification.variants import EACH_PROCESS

STEEP, FLATS = 50.0, (0.0, 5.0, 10.0)
"""Dip of the upper plane, and dips of the lower plane that are run, degrees."""
LENGTH, WIDTH, CROWN = 4.0, 2.0, 1.0
"""Horizontal lengths of the lower and the upper block, and height of the latter's left side, m."""
CUT = 0.1
"""Length by which the toe of the upper block is cut off, m, so that it may sink along the joint."""
OWN = (35.0, 15.0, 25.0)
"""Friction angles of upper plane, lower plane and joint where each has its own, degrees."""
STEP, STEPS = 4e-3, 300
SPAN = 2.0
"""Half of the range of the friction angle that is searched, degrees."""
STATIC = StaticRun(p=5e8, step=4e-3, steps=300)


def outlines(flat: float) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray, np.ndarray]:
    """Return the corners of both parts of the base, upper and lower block, m.

    The joint stands at x = 0, where the base is cut, too.
    """
    steep, gentle = np.tan(np.radians(STEEP)), np.tan(np.radians(flat))
    top = WIDTH * steep + CROWN
    cut = CUT * steep
    upper = np.array([(-CUT, cut), (0.0, cut), (0.0, top), (-WIDTH, top), (-WIDTH, WIDTH * steep)])
    fall = LENGTH * gentle
    lower = np.array([(0.0, 0.0), (LENGTH, -fall), (LENGTH, top - fall), (0.0, top)])
    left, right = -WIDTH - 1.0, LENGTH + 2.0
    back = np.array([(left, -2.5), (0.0, -2.5), (0.0, 0.0), (left, -left * steep)])
    front = np.array([(0.0, -2.5), (right, -2.5), (right, -right * gentle), (0.0, 0.0)])
    return (back, front), upper, lower


def area(corners: np.ndarray) -> float:
    """Return the area of a polygon, m2."""
    x, y = corners.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def missing(flat: float, angles: tuple[float, float, float]) -> float:
    """Return by how much the push of the upper block exceeds the resistance of the lower one, m2.

    Friction angles of upper plane, lower plane and joint in degrees; forces over the unit weight.
    """
    _, upper, lower = outlines(flat)
    a, b = np.radians(STEEP), np.radians(flat)
    of_upper, of_lower, of_joint = np.radians(angles)
    push = area(upper) * np.sin(a - of_upper) / np.cos(a - of_upper - of_joint)
    resistance = area(lower) * np.sin(of_lower - b) / np.cos(of_lower + of_joint - b)
    return float(push - resistance)


def exact_limit(flat: float) -> float:
    """Return the friction angle at the limit, degrees."""
    return float(brentq(lambda phi: missing(flat, (phi, phi, phi)), flat, 0.5 * STEEP))


def own_friction(share: float) -> tuple[float, float, float]:
    """Return the friction angles of upper plane, lower plane and joint with a share of each tan."""
    upper, lower, joint = np.degrees(np.arctan(share * np.tan(np.radians(OWN)))).tolist()
    return upper, lower, joint


def exact_factor(flat: float) -> float:
    """Return the factor of safety where planes and joint have friction of their own."""
    return float(brentq(lambda factor: missing(flat, own_friction(1.0 / factor)), 0.7, 3.0))


def slope(flat: float = FLATS[1], angles: tuple[float, float, float] = (20.0, 20.0, 20.0)) -> Model:
    """Return the base with both blocks; dip and friction angles as for ``missing``."""
    (back, front), upper, lower = outlines(flat)
    builder = new_model("Active and passive block", gravity=9.8, young=20e9, density=2500.0)
    builder.add_joint(friction_angle=angles[2])
    builder.add_joint("steep", friction_angle=angles[0], between=[("back", "upper")])
    builder.add_joint("flat", friction_angle=angles[1], between=[("front", "lower")])
    builder.block(name="back", vertices=back, fixed=True)
    builder.block(name="front", vertices=front, fixed=True)
    builder.block(name="upper", vertices=upper)
    builder.block(name="lower", vertices=lower)
    for name, corners in (("upper", upper), ("lower", lower)):
        builder.measured_point(name, corners.mean(axis=0), block=name)
    return builder.build()


def alike(flat: float, friction_angle: float) -> Model:
    """Return base and blocks with one friction angle, degrees."""
    return slope(flat, (friction_angle, friction_angle, friction_angle))


@problem(set_up=slope, variants=EACH_PROCESS, quick=())
def active_passive(trial: Trial, flats: tuple[float, ...] = FLATS) -> None:
    """Active and passive block.

    A block on a plane of 50 degrees pushes one of 4 m length on a flatter plane; the friction angle
    of all joints is bisected. Then the planes have 35 and 15 degrees, the joint 25, and all are
    multiplied. p = 0.5 GPa, h = 4 ms, static (dynamic_ratio = 0).

    Exact: W1 sin(a - phi_1)/cos(a - phi_1 - phi_j) = W2 sin(phi_2 - b)/cos(phi_2 + phi_j - b).
    Source: two-wedge limit equilibrium with friction mobilised in all joints; Sarma (1979).
    """
    for flat in flats:
        exact, loaded = exact_limit(flat), partial(alike, flat)
        angle = STATIC.limit(trial.variant, loaded, exact - SPAN, exact + SPAN)
        quantity = f"friction angle at the limit, lower plane at {flat:g} degrees"
        trial.absolute(quantity, "degrees", angle, exact, 0.25, "bisected to 0.25 degrees")
    flat = flats[-1]
    factor = exact_factor(flat)
    share = STATIC.limit(
        trial.variant, lambda share: slope(flat, own_friction(share / factor)), 0.96, 1.04
    )
    quantity = f"friction by that at the limit, own for each plane, lower plane at {flat:g} degrees"
    trial.relative(quantity, "", share, 1.0, 0.02, "bisected to 0.5 %")
    fine = np.linspace(-2.0, 12.0, 29)
    labels = "dip of the lower plane, degrees", "friction angle, degrees"
    chart = trial.chart("friction angle at the limit", *labels)
    chart.exact("both blocks at their limit", fine, [exact_limit(flat) for flat in fine])
    chart.computed(flats, trial.computed[:-1])
