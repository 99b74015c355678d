"""A block on a plane held by a tensioned bolt: the least force that holds it."""

from functools import partial

import numpy as np

from clast.verification.problems import Model, StaticRun, Trial, new_model, problem
from clast.verification.variants import EACH_PROCESS

GRAVITY, DENSITY = 9.81, 2600.0
DIP, FRICTION = np.radians(35.0), np.radians(30.0)
WEIGHT, LENGTH = 600e3, 8.0
"""Weight of the block, N/m, and its length along the plane, m."""
HEIGHT = WEIGHT / (DENSITY * GRAVITY * LENGTH)
ALONG = np.array([np.cos(DIP), np.sin(DIP)])
"""Direction up the plane."""
UP = np.array([-ALONG[1], ALONG[0]])
FACTORS = (1.0, 1.25, 1.5)
"""Factors of safety."""
SPAN = 0.03
"""Half of the range of the bolt's force that is searched as a share of the exact one."""
RESOLUTION = "bisected to 0.004"
ASIDE = 0.01
"""Share by which the force is raised or lowered to see whether the block holds."""
STATIC = StaticRun(p=2e9, step=4e-3, steps=200)


def reduced(factor: float) -> float:
    """Return tan phi/F."""
    return float(np.tan(FRICTION)) / factor


def steepest(factor: float) -> float:
    """Return the angle to the plane at which the least force holds, rad."""
    return float(np.arctan(reduced(factor)))


def exact_force(factor: float, angle: float) -> float:
    """Return the force that just holds the block, N/m."""
    friction = reduced(factor)
    lacking = WEIGHT * (np.sin(DIP) - np.cos(DIP) * friction)
    return float(lacking / (np.cos(angle) + np.sin(angle) * friction))


def bolted(
    force: float = exact_force(1.0, steepest(1.0)),
    factor: float = 1.0,
    angle: float = steepest(1.0),
) -> Model:
    """Return the plane, a wall above it, and the block on it with its bolt."""
    toe = 2.0 * ALONG
    head, up = toe + LENGTH * ALONG, HEIGHT * UP
    builder = new_model("Bolted block", gravity=GRAVITY, young=20e9, density=DENSITY)
    builder.add_joint(friction_angle=float(np.degrees(np.arctan(reduced(factor)))))
    foot, right = head + 2.0 * ALONG, head + 6.0 * ALONG
    corner = np.array([right[0], 0.0])
    builder.block(
        name="slope", vertices=[0.0 * toe, corner, right, right + up, foot + up, foot], fixed=True
    )
    builder.block(name="block", vertices=[toe, head, head + up, toe + up])
    middle = toe + 0.5 * LENGTH * ALONG + 0.5 * up
    builder.add_bolt_kind("cable", stiffness=2e7, pretension=force)
    displacement = np.cos(angle) * ALONG - np.sin(angle) * UP
    builder.bolt(middle, middle + 8.0 * displacement, kind="cable", pretension_is="jacked")
    builder.measured_point("block", middle, block="block")
    return builder.build()


@problem(set_up=bolted, variants=EACH_PROCESS, few=(FACTORS[:1],))
def bolted_block(trial: Trial, factors: tuple[float, ...] = FACTORS) -> None:
    """A block held by a tensioned bolt.

    A block of 600 kN/m on a plane of 35 degrees with a friction of 30 degrees; a jack holds the
    force of its bolt, which is bisected. p = 2 GPa, h = 4 ms, static (dynamic_ratio = 0).

    Exact: T = W (sin a - cos a tan phi/F)/(cos b + sin b tan phi/F).
    Source: limit equilibrium, as in Wyllie & Mah (2004).
    """
    forces = []
    for factor in factors:
        for angle in (steepest(factor), 0.0):
            exact = exact_force(factor, angle)
            held = partial(bolted, factor=factor, angle=angle)
            ends = exact * (1.0 - SPAN), exact * (1.0 + SPAN)
            force = STATIC.limit(trial.variant, held, *ends)
            place = f"F = {factor:g}, {np.degrees(angle):.4g} degrees to the plane"
            trial.relative(f"least force, {place}", "N/m", force, exact, 0.01, RESOLUTION)
            if angle > 0.0:
                forces.append(force)
    for angle in (steepest(1.0), 0.0):
        exact = exact_force(1.0, angle)
        for share, wanted in ((1.0 + ASIDE, 1.0), (1.0 - ASIDE, 0.0)):
            stays_there = float(STATIC.stands(bolted(share * exact, 1.0, angle), trial.variant))
            what = f"holds at {share:g} T, {np.degrees(angle):.4g} degrees to the plane"
            trial.absolute(what, "", stays_there, wanted, 0.0, "1: holds, 0: slides")
    fine = np.linspace(1.0, 1.5, 41)
    exact_fine = np.array([exact_force(one, steepest(one)) for one in fine])
    chart = trial.chart("least force at the best angle", "factor of safety", "force, kN/m")
    chart.exact("limit equilibrium", fine, 1e-3 * exact_fine)
    chart.computed(factors, 1e-3 * np.array(forces))
