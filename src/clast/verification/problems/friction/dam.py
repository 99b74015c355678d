"""A dam of one block under the triangular pressure of water on its face.

With water to the height h the thrust is F = w h2/2, w being the unit weight of water, at h/3 above
the base.  The base, with corners at heel and toe a width B apart, carries

    N = W/2 -+ M/B,    M = F h/3 = w h3/6

at them and F along it.  The dam slides where tan phi = F/W, and tips where M = W B/2.
"""

from functools import partial

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, Model, StaticRun, Trial, problem
from clast.verification.variants import EACH_PROCESS, Variant

GRAVITY, DENSITY, WATER = 9.81, 2400.0, 1000.0
WIDTH, HEIGHT = 3.0, 10.0
"""Width and height of the dam, m."""
WEIGHT = DENSITY * GRAVITY * WIDTH * HEIGHT
LEVELS = (2.0, 4.0, 6.0, 8.0)
"""Heights of the water at which the reaction of the base is compared, m."""
SLIDES_AT = (5.0, 8.0)
"""Heights at which the friction angle is bisected, m."""
ROUGH = 45.0
"""Friction angle with which the dam tips before it slides, degrees."""
STEPS, STIFFNESS = 300, 2e9
STEP, FINE = 1e-2, 4e-3
"""Steps, s: a dam close to tipping sinks back slowly; one that slides chatters in long steps."""
SPAN, SHARE = 2.0, 0.04
"""Half of the range searched, in degrees and as a share of the height of the water."""
RESOLUTION = "bisected to 0.12 degrees"
TIPS = "bisected to 0.25 %; heel and toe are springs"
LEANS = "heel and toe are springs: the dam leans by 1e-4, and its weight acts beside its middle"
SLIDES = StaticRun(p=STIFFNESS, step=FINE, steps=STEPS, bisections=5)
TIPS_OVER = StaticRun(p=STIFFNESS, step=STEP, steps=STEPS, bisections=5)


def thrust(level: float) -> float:
    """Return the thrust of water to a height, m, N/m."""
    return 0.5 * WATER * GRAVITY * level**2


def exact_reactions(level: float) -> tuple[float, float]:
    """Return the forces at heel and toe, N/m."""
    moved = thrust(level) * level / 3.0 / WIDTH
    return 0.5 * WEIGHT - moved, 0.5 * WEIGHT + moved


def exact_angle(level: float) -> float:
    """Return the friction angle at the limit of sliding, degrees."""
    return float(np.degrees(np.arctan(thrust(level) / WEIGHT)))


def exact_height() -> float:
    """Return the height of the water at which the dam tips, m."""
    return float(np.cbrt(3.0 * WEIGHT * WIDTH / (WATER * GRAVITY)))


def model_of_dam(level: float = 8.0, friction_angle: float = ROUGH) -> Model:
    """Return a fixed foundation and the dam on it, with water to its left."""
    builder = new_model(
        "Dam", gravity=GRAVITY, young=20e9, density=DENSITY, friction_angle=friction_angle
    )
    builder.block(name="foundation", vertices=box(-2.0, -2.0, WIDTH + 2.0, 0.0), fixed=True)
    builder.block(name="dam", vertices=box(0.0, 0.0, WIDTH, HEIGHT))
    builder.pressure((0.0, 0.0), (0.0, level), (WATER * GRAVITY * level, 0.0), block="dam")
    builder.measured_point("heel", (0.0, 0.0), block="dam")
    builder.measured_point("crest", (0.0, HEIGHT), block="dam")
    return builder.build()


def reactions(level: float, variant: Variant) -> Floats:
    """Return the normal forces at heel and toe and the force along the base, N/m, shape (3,)."""
    model = model_of_dam(level)
    memory = variant.static(
        model, step=STEP, end=STEPS * STEP, p=STIFFNESS, max_displacement=0.02
    ).state.memory
    heel = int(model.block_start[1])
    at = [memory.vertex == heel, memory.vertex == heel + 1]
    normal = [float(memory.normal_force[here].sum()) for here in at]
    # the upper edge of the foundation runs to the left, against the water
    along = float(memory.shear_force[at[0] | at[1]].sum())
    return np.array([*normal, along])


def compare_reactions(trial: Trial) -> None:
    """Compare the reactions of the base."""
    forces = np.array([reactions(level, trial.variant) for level in LEVELS])
    for level, (heel, toe, along) in zip(LEVELS, forces, strict=True):
        exact = exact_reactions(level)
        water = f"water {level:g} m high"
        trial.relative(f"force at the heel, {water}", "N/m", heel, exact[0], 2e-3, LEANS)
        trial.relative(f"force at the toe, {water}", "N/m", toe, exact[1], 5e-4, LEANS)
        trial.relative(f"force along the base, {water}", "N/m", along, thrust(level), 1e-4, LEANS)
    fine = np.linspace(0.0, exact_height(), 41)
    exact_lines = np.array([exact_reactions(level) for level in fine])
    chart = trial.chart("normal force at heel and toe", "height of the water, m", "force, kN/m")
    chart.exact("W/2 - M/B", fine, 1e-3 * exact_lines[:, 0])
    chart.exact("W/2 + M/B", fine, 1e-3 * exact_lines[:, 1])
    chart.computed(LEVELS, 1e-3 * forces[:, 0], "heel")
    chart.computed(LEVELS, 1e-3 * forces[:, 1], "toe")


@problem(set_up=model_of_dam, variants=EACH_PROCESS, briefly=compare_reactions)
def dam(trial: Trial) -> None:
    """Dam under the pressure of water.

    A block of 3 m x 10 m on a foundation, with the triangular pressure of water on its left face as
    a [[pressure]]; the friction angle at which it slides and the height of the water that tips it
    are bisected. p = 2 GPa, h = 10 ms, for sliding 4 ms, static.

    Exact: N = W/2 -+ w h^3/(6 B) at heel and toe; tan phi = w h^2/(2 W); tips at w h^3/6 = W B/2.
    Source: equilibrium of a rigid block.
    """
    compare_reactions(trial)
    # Compare at which friction angle the dam slides, and at which height of the water it tips.
    angles = []
    for level in SLIDES_AT:
        exact = exact_angle(level)
        loaded = partial(model_of_dam, level)
        angles.append(SLIDES.limit(trial.variant, loaded, exact - SPAN, exact + SPAN))
        quantity = f"friction angle at the limit, water {level:g} m high"
        trial.absolute(quantity, "degrees", angles[-1], exact, 0.15, RESOLUTION)
    tips = exact_height()
    ends = (1.0 + SHARE) * tips, (1.0 - SHARE) * tips
    highest = TIPS_OVER.limit(trial.variant, model_of_dam, *ends)
    trial.relative("height of the water that tips the dam", "m", highest, tips, 5e-3, TIPS)
    fine = np.linspace(0.0, exact_height(), 41)
    labels = "height of the water, m", "friction angle, degrees"
    chart = trial.chart("friction angle at the limit of sliding", *labels)
    chart.exact("tan φ = F/W", fine, [exact_angle(level) for level in fine])
    chart.computed(SLIDES_AT, angles)
