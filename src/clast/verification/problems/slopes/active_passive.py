"""Two-block slide: an active block pushes a passive one (two-wedge analysis).

The upper block stands on a plane of dip a, the lower one on a flatter plane of dip b, with a
vertical joint between them and the friction angle phi everywhere.  As they begin to slide the upper
block sinks along the joint, so friction there pushes the lower block down.  With all joints at
their limit, the push of the joint turns by phi from the horizontal and the reactions of the planes
by phi from their normals:

    E = W1 sin(a - phi) cos(phi)/cos(a - 2 phi),    E = W2 sin(phi - b) cos(phi)/cos(2 phi - b)

for the upper and for the lower block; the slope is at its limit where both are equal.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from clast.inputs.builder import ModelBuilder
from clast.model.model import Model
from clast.pictures.verification import Chart, curve, exact_curve
from clast.verification.limits import AT_REST, limit, unbalanced
from clast.verification.problem import Comparison, Outcome, Problem, absolute
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE, Variant

STEEP, FLATS = 50.0, (0.0, 5.0, 10.0)
"""Dip of the upper plane, and dips of the lower plane that are run, degrees."""
LENGTH, WIDTH, CROWN = 4.0, 2.0, 1.0
"""Horizontal lengths of the lower and the upper block, and height of the latter's left side, m."""
CUT = 0.1
"""Length by which the toe of the upper block is cut off, m, so that it may sink along the joint."""
STEP, STEPS = 4e-3, 300
BISECTIONS, SPAN = 4, 2.0
"""Bisections of the friction angle, and the half of what is searched, degrees."""
RESOLUTION = f"bisected to {2 * SPAN / 2**BISECTIONS:.2g} degrees"


def outlines(flat: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the corners of base, upper and lower block, m; the joint stands at x = 0."""
    steep, gentle = np.tan(np.radians(STEEP)), np.tan(np.radians(flat))
    top = WIDTH * steep + CROWN
    cut = CUT * steep
    upper = np.array([(-CUT, cut), (0.0, cut), (0.0, top), (-WIDTH, top), (-WIDTH, WIDTH * steep)])
    fall = LENGTH * gentle
    lower = np.array([(0.0, 0.0), (LENGTH, -fall), (LENGTH, top - fall), (0.0, top)])
    left, right = -WIDTH - 1.0, LENGTH + 2.0
    base = np.array([(left, -2.5), (right, -2.5), (right, -right * gentle), (0.0, 0.0)])
    return np.vstack([base, (left, -left * steep)]), upper, lower


def area(corners: np.ndarray) -> float:
    """Return the area of a polygon, m2."""
    x, y = corners.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def exact_limit(flat: float) -> float:
    """Return the friction angle at the limit, degrees."""
    _, upper, lower = outlines(flat)
    a, b = np.radians(STEEP), np.radians(flat)

    def missing(phi: float) -> float:
        push = area(upper) * np.sin(a - phi) / np.cos(a - 2.0 * phi)
        resistance = area(lower) * np.sin(phi - b) / np.cos(2.0 * phi - b)
        return float(push - resistance)

    return float(np.degrees(brentq(missing, b, 0.5 * a)))


def slope(flat: float = FLATS[1], friction_angle: float = 20.0) -> Model:
    """Return the base with both blocks; angles in degrees."""
    base, upper, lower = outlines(flat)
    builder = ModelBuilder(title="Active and passive block", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=friction_angle)
    builder.block(name="base", vertices=base, fixed=True)
    builder.block(name="upper", vertices=upper)
    builder.block(name="lower", vertices=lower)
    for name, corners in (("upper", upper), ("lower", lower)):
        builder.measured_point(name, corners.mean(axis=0), block=name)
    return builder.build()


def holds(flat: float, friction_angle: float, variant: Variant) -> bool:
    """Return whether both blocks stay."""
    moving = unbalanced(
        slope(flat, friction_angle),
        variant,
        normal_stiffness=5e8,
        step=STEP,
        steps=STEPS,
        max_displacement=0.02,
    )
    return moving < AT_REST


def examine(flats: tuple[float, ...], variant: Variant) -> Outcome:
    """Compare the friction angle at the limit for some dips of the lower plane, degrees."""
    rows: list[Comparison] = []
    found = []
    for flat in flats:
        exact = exact_limit(flat)

        def stays(friction_angle: float, flat: float = flat) -> bool:
            return holds(flat, friction_angle, variant)

        found.append(limit(stays, exact - SPAN, exact + SPAN, BISECTIONS))
        quantity = f"friction angle at the limit, lower plane at {flat:g} degrees"
        rows.append(absolute(quantity, "degrees", found[-1], exact, 0.25, RESOLUTION))
    fine = np.linspace(-2.0, 12.0, 29)
    chart = Chart(
        title="friction angle at the limit",
        x_label="dip of the lower plane, degrees",
        y_label="friction angle, degrees",
        curves=(
            exact_curve("both blocks at their limit", fine, [exact_limit(flat) for flat in fine]),
            curve(variant.name, flats, found),
        ),
    )
    return Outcome(tuple(rows), (chart,))


PROBLEM = Problem(
    name="active-passive",
    title="Active and passive block",
    text="A block on a plane of 50 degrees pushes one of 4 m length on a flatter plane; the "
    "friction angle of all joints is bisected. p = 0.5 GPa, h = 4 ms, static (dynamic_ratio = 0).",
    formula="W1 sin(a - phi)/cos(a - 2 phi) = W2 sin(phi - b)/cos(2 phi - b)",
    source="two-wedge limit equilibrium with friction mobilised in all joints",
    set_up=slope,
    examine=lambda variant: examine(FLATS, variant),
    variants=(LAGGED, OPEN_CLOSE, CONVEX),
    quick=(),
)
