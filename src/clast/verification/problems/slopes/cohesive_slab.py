"""Plane failure held by the cohesion of the joint, however plane and slab are cut.

A slab of weight W lies on a plane of dip a and length A.  With its strength divided by F it is at
its limit where

    F = (c A + W cos a tan phi)/(W sin a).

Cohesion acts on all of the plane at once and goes on acting while the joint slips (ideally
plastic), so neither pieces of the plane nor pieces of the slab play any part, nor does the inertia
of weight that comes on at once.

Two wedges: an upper block on a plane of dip a pushes a lower one on a flatter plane of dip b
through a vertical joint of height H.  As they begin to slide the upper block sinks along the joint.
With t = tan phi/F and c/F at work in all joints, the equilibrium of each of the two blocks gives
the normal force E of the joint; F is where both give the same (``pushes``).
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from clast.verification.fixtures import new_model
from clast.verification.problems import AT_REST, Model, StaticRun, Trial, limit, problem
from clast.verification.problems.slopes.active_passive import STEEP, area, outlines
from clast.verification.variants import CONVEX, EACH_PROCESS, Variant

GRAVITY, DENSITY = 9.8, 2500.0
DIP, FRICTION = np.radians(40.0), np.tan(np.radians(30.0))
LENGTH, HEIGHT = 12.0, 0.75
"""Length of the slab along the plane and its height across it, m."""
WEIGHT = DENSITY * GRAVITY * LENGTH * HEIGHT
FACTOR = 1.3
"""Factor of safety with the strength that is given."""
COHESION = WEIGHT * (FACTOR * float(np.sin(DIP)) - FRICTION * float(np.cos(DIP))) / LENGTH
CUTS = ((1, 1), (6, 1), (12, 1), (5, 6), (12, 3), (1, 6))
"""Pieces of the plane and of the slab."""
STEPS = 300
DYNAMIC_STEP, DYNAMIC_STEPS = 1e-3, 600
SPAN = 0.02
"""Half of the range of the strength that is searched as a share of it."""
RESOLUTION = "bracket of 0.5 %"
WEDGE_FRICTION, WEDGE_COHESION, FLAT = float(np.tan(np.radians(25.0))), 5e3, 5.0
"""tan phi and cohesion, Pa, of the joints of two wedges, and dip of the lower plane, degrees."""
WEDGES = "bracket of 1 %"
SLAB = StaticRun(p=2e9, step=2e-3, steps=STEPS, bisections=3)
WEDGE = StaticRun(p=5e8, step=8e-3, steps=STEPS, bisections=3)


def slab(pieces: tuple[int, int], divided_by: float = 1.0) -> Model:
    """Return a slab on a plane, cut into so many pieces, the strength of its joints divided."""
    up, out = np.array([np.cos(DIP), np.sin(DIP)]), np.array([-np.sin(DIP), np.cos(DIP)])
    builder = new_model("Slab with cohesion", gravity=GRAVITY, young=5e9, density=DENSITY)
    angle = float(np.degrees(np.arctan(FRICTION / divided_by)))
    builder.add_joint(friction_angle=angle, cohesion=COHESION / divided_by)
    parts = (-2.0, LENGTH + 2.0, -2.0, 0.0, pieces[0]), (0.0, LENGTH, 0.0, HEIGHT, pieces[1])
    for name, (first, last, low, high, count) in zip(("plane", "slab"), parts, strict=True):
        at = np.linspace(first, last, count + 1)
        for k, (a, b) in enumerate(pairwise(at), 1):
            corners = [
                a * up + low * out,
                b * up + low * out,
                b * up + high * out,
                a * up + high * out,
            ]
            builder.block(name=f"{name} {k}", vertices=corners, fixed=name == "plane")
            if name == "slab":
                builder.measured_point(f"slab {k}", 0.25 * sum(corners), block=f"slab {k}")
    return builder.build()


def stands_shaken(model: Model, variant: Variant) -> bool:
    """Return whether the blocks stay where weight comes on at once, with its inertia.

    Steps keep the velocity; a block that slides at its limit gains none, one that fails gains it
    evenly.
    """
    end = DYNAMIC_STEPS * DYNAMIC_STEP
    run = variant.run(model, step=DYNAMIC_STEP, end=end, p=2e9, max_displacement=0.02)
    gained = [
        run.history(name).velocity[-1] - run.history(name).velocity[DYNAMIC_STEPS // 2]
        for name in model.measured_points.name
    ]
    mean = float(np.hypot(*np.array(gained).T).max()) / (0.5 * end)
    return mean < AT_REST * GRAVITY


Check = Callable[[Model, Variant], bool]
"""Says whether a model stands, by a variant."""


def factor_of_slab(pieces: tuple[int, int], variant: Variant, check: Check) -> float:
    """Return the divisor of the strength at which the slab begins to slide."""

    def holds(share: float) -> bool:
        return check(slab(pieces, FACTOR / share), variant)

    return FACTOR / limit(holds, 1.0 - SPAN, 1.0 + SPAN, 3)


def pushes(divided_by: float) -> tuple[float, float]:
    """Return the force E in the joint of two wedges, N/m, by the upper and by the lower one."""
    _, upper, lower = outlines(FLAT)
    t, c = WEDGE_FRICTION / divided_by, WEDGE_COHESION / divided_by
    long = [float(np.hypot(*(upper[0] - upper[-1]))), float(np.hypot(*(lower[1] - lower[0])))]
    height = float(upper[2, 1] - upper[1, 1])
    weights = [DENSITY * GRAVITY * area(one) for one in (upper, lower)]
    thrusts = []
    # the upper block is pushed back and up by the joint, the lower one onwards and down
    for dip, along, weight, side in zip(
        np.radians([STEEP, FLAT]), long, weights, (1, -1), strict=True
    ):
        sine, cosine = np.sin(dip), np.cos(dip)
        matrix = [[sine - t * cosine, -side], [cosine + t * sine, side * t]]
        right = [c * along * cosine, weight - c * along * sine - side * c * height]
        thrusts.append(float(np.linalg.solve(matrix, right)[1]))
    return thrusts[0], thrusts[1]


def wedges(divided_by: float = 1.0) -> Model:
    """Return the two wedges with the strength of all joints divided."""
    (back, front), upper, lower = outlines(FLAT)
    base = np.vstack([back[:1], front[1:], back[3:]])
    builder = new_model("Two wedges with cohesion", gravity=GRAVITY, young=20e9, density=DENSITY)
    angle = float(np.degrees(np.arctan(WEDGE_FRICTION / divided_by)))
    builder.add_joint(friction_angle=angle, cohesion=WEDGE_COHESION / divided_by)
    builder.block(name="base", vertices=base, fixed=True)
    for name, corners in (("upper", upper), ("lower", lower)):
        builder.block(name=name, vertices=corners)
        builder.measured_point(name, corners.mean(axis=0), block=name)
    return builder.build()


@problem(set_up=lambda: slab(CUTS[0]), variants=EACH_PROCESS, quick=())
def cohesive_slab(trial: Trial, cuts: tuple[tuple[int, int], ...] = CUTS) -> None:
    """Plane failure and two wedges with the cohesion of their joints.

    A slab of 12 m x 0.75 m on a plane of 40 degrees, phi = 30 degrees, c for F = 1.3, with the
    plane in 1 to 12 pieces and the slab in 1 to 6; p = 2 GPa, h = 2 ms static (dynamic_ratio = 0),
    h = 1 ms with inertia. Two wedges on planes of 50 and 5 degrees, phi = 25 degrees, c = 5 kPa; p
    = 0.5 GPa, h = 8 ms. The factor by which the strength is divided is bisected.

    Exact: F = (c A + W cos a tan phi)/(W sin a).
    Source: limit equilibrium of Hoek & Bray (1974); two-wedge limit equilibrium.
    """
    factors = []
    for pieces in cuts:
        plane, block = pieces
        factors.append(factor_of_slab(pieces, trial.variant, SLAB.stands))
        quantity = f"factor of safety, plane in {plane}, slab in {block}"
        trial.relative(quantity, "-", factors[-1], FACTOR, 0.01, RESOLUTION)
    if trial.variant is CONVEX:
        for plane, block in cuts[:2]:
            factor = factor_of_slab((plane, block), trial.variant, stands_shaken)
            quantity = f"the same, plane in {plane}, slab in {block}, weight with its inertia"
            trial.relative(quantity, "-", factor, FACTOR, 0.01, RESOLUTION)
    exact, ends = (
        float(brentq(lambda factor: np.subtract(*pushes(factor)), 0.8, 3.0)),
        (1.0 - 2.0 * SPAN, 1.0 + 2.0 * SPAN),
    )
    factor = exact / WEDGE.limit(trial.variant, lambda share: wedges(exact / share), *ends)
    trial.relative("factor of safety of two wedges", "-", factor, exact, 0.02, WEDGES)
    number = np.arange(len(cuts))
    chart = trial.chart("factor of safety", "number of the cut", "factor of safety")
    chart.exact("Hoek & Bray", number, np.full(len(cuts), FACTOR))
    chart.computed(number, factors)
