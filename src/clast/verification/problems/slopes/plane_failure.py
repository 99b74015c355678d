"""Plane failure of a slope with water in a tension crack (Hoek & Bray)."""

from functools import partial

import numpy as np

from clast.verification.problems import Model, StaticRun, Trial, new_model, problem
from clast.verification.variants import EACH_PROCESS

GRAVITY, DENSITY, WATER = 9.81, 2600.0, 1000.0
DIP = np.radians(25.0)
LENGTH, DEPTH = 10.0, 3.0
"""Length of the slab along the plane and its vertical thickness, m."""
ALONG = np.array([np.cos(DIP), np.sin(DIP)])
"""Direction up the plane."""
WEIGHT = DENSITY * GRAVITY * LENGTH * DEPTH * float(np.cos(DIP))
LEVELS = (0.0, 0.5, 1.0)
"""Height of the water in the crack over its depth."""
SPAN = 2.0
"""Half of the range of the friction angle that is searched, degrees."""
STATIC = StaticRun(p=2e9, step=4e-3, steps=300)


def pressures(level: float) -> tuple[float, float]:
    """Return the mean pressure on the plane and on the crack, Pa.

    Pressure grows from the water table down to the foot of the crack and falls from there to zero
    at the toe; each is applied as its mean, which has the same resultant.
    """
    foot = WATER * GRAVITY * level * DEPTH
    return 0.5 * foot, 0.5 * foot * level


def exact_limit(level: float) -> float:
    """Return the friction angle at the limit, degrees."""
    on_plane, on_crack = pressures(level)
    uplift, push = on_plane * LENGTH, on_crack * DEPTH
    drives = WEIGHT * np.sin(DIP) + push * np.cos(DIP)
    presses = WEIGHT * np.cos(DIP) - uplift - push * np.sin(DIP)
    return float(np.degrees(np.arctan2(drives, presses)))


def slab(level: float = 1.0, friction_angle: float = 35.0) -> Model:
    """Return a fixed slope and the slab on it with its water pressures."""
    toe = 2.0 * ALONG
    head, up = toe + LENGTH * ALONG, np.array([0.0, DEPTH])
    builder = new_model(
        "Plane failure", gravity=GRAVITY, young=20e9, density=DENSITY, friction_angle=friction_angle
    )
    right = head + 1.0 * ALONG
    builder.block(name="slope", vertices=[0 * toe, (right[0], 0.0), right], fixed=True)
    builder.block(name="slab", vertices=[toe, head, head + up, toe + up])
    on_plane, on_crack = pressures(level)
    if level > 0.0:
        lifts = on_plane * np.array([-ALONG[1], ALONG[0]])
        builder.line_load(toe, head, lifts, block="slab")
        builder.line_load(head, head + up, (-on_crack, 0.0), block="slab")
    builder.measured_point("slab", toe + 0.5 * LENGTH * ALONG + 0.5 * up, block="slab")
    return builder.build()


@problem(set_up=slab, variants=EACH_PROCESS, quick=())
def plane_failure(trial: Trial, levels: tuple[float, ...] = LEVELS) -> None:
    """Plane failure with water in a tension crack.

    A slab of 10 m x 3 m on a plane of 25 degrees with water in the crack behind it and on the
    plane; the friction angle is bisected. p = 2 GPa, h = 4 ms, static (dynamic_ratio = 0).

    Exact: tan phi = (W sin a + V cos a)/(W cos a - U - V sin a).
    Source: limit equilibrium of Hoek & Bray (1974), without cohesion.
    """
    for level in levels:
        exact, loaded = exact_limit(level), partial(slab, level)
        angle = STATIC.limit(trial.variant, loaded, exact - SPAN, exact + SPAN)
        quantity = f"friction angle at the limit, water at {level:g} of the crack"
        trial.absolute(quantity, "degrees", angle, exact, 0.25, "bisected to 0.25 degrees")
    fine = np.linspace(0.0, 1.0, 41)
    labels = "height of the water / depth of the crack", "friction angle, degrees"
    chart = trial.chart("friction angle at the limit", *labels)
    chart.exact("Hoek & Bray", fine, [exact_limit(level) for level in fine])
    chart.computed(levels, trial.computed)
