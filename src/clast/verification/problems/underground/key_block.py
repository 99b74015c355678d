"""A key block in a tunnel roof, held by friction under horizontal stress.

A wedge of weight W, narrower above, hangs between two blocks that are pressed against it by the
horizontal force H.  Its sides lean by a from the vertical.  At the limit of sliding each side
carries N with the shear force N tan phi, which gives

    H = N cos(phi - a)/cos phi,   W = 2 N sin(phi - a)/cos phi,   W = 2 H tan(phi - a).
"""

from functools import partial

import numpy as np

from clast.verification.problems import Model, StaticRun, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS

GRAVITY, DENSITY = 9.8, 2600.0
TOP, BOTTOM, HEIGHT = 1.0, 1.6, 2.0
"""Widths of the wedge above and below, and its height, m."""
LEAN = float(np.arctan(0.5 * (BOTTOM - TOP) / HEIGHT))
"""Angle a of its sides with the vertical, rad: 8.5 degrees."""
WEIGHT = DENSITY * GRAVITY * 0.5 * (TOP + BOTTOM) * HEIGHT
FRICTION_ANGLES = (25.0, 35.0, 45.0)
"""Friction angles of the sides, degrees."""
BISECTED = "bisected to 2 %; loaded by weight and force at once"
STATIC = StaticRun(p=4e8, step=4e-3, steps=300)


def exact_force(friction_angle: float) -> float:
    """Return the horizontal force H that just holds the wedge, N/m."""
    return float(0.5 * WEIGHT / np.tan(np.radians(friction_angle) - LEAN))


def roof(force: float = 2e5, friction_angle: float = 35.0) -> Model:
    """Return wedge, two blocks that slide on rails without friction, and their forces."""
    builder = new_model(
        "Key block", gravity=GRAVITY, young=20e9, density=DENSITY, friction_angle=0.0
    )
    pairs = [("wedge", "left"), ("wedge", "right")]
    builder.add_joint("sides", friction_angle=friction_angle, between=pairs)
    half_top, half_low, out = 0.5 * TOP, 0.5 * BOTTOM, 2.5
    wedge = [(-half_low, 0.0), (half_low, 0.0), (half_top, HEIGHT), (-half_top, HEIGHT)]
    builder.block(name="wedge", vertices=wedge)
    right = [(half_low, 0.0), (out, 0.0), (out, HEIGHT), (half_top, HEIGHT)]
    left = [(-out, 0.0), (-half_low, 0.0), (-half_top, HEIGHT), (-out, HEIGHT)]
    builder.block(name="right", vertices=right)
    builder.block(name="left", vertices=left)
    for name, low in (("lower", -0.3), ("upper", HEIGHT)):
        for side, edge in (("left", -3.0), ("right", 1.1)):
            corners = box(edge, low, edge + 1.9, low + 0.3)
            builder.block(name=f"{name} rail, {side}", vertices=corners, fixed=True)
    pressure = force / HEIGHT
    builder.line_load((out, 0.0), (out, HEIGHT), (-pressure, 0.0), block="right")
    builder.line_load((-out, HEIGHT), (-out, 0.0), (pressure, 0.0), block="left")
    builder.measured_point("wedge", (0.0, 0.5 * HEIGHT), block="wedge")
    return builder.build()


@problem(set_up=roof, variants=EACH_PROCESS, quick=())
def key_block(trial: Trial, angles: tuple[float, ...] = FRICTION_ANGLES) -> None:
    """Key block in a tunnel roof.

    A wedge 1 m wide above, 1.6 m below and 2 m high hangs between two blocks on frictionless rails
    that are pressed against it; the force is bisected. p = 0.4 GPa, h = 4 ms, static (dynamic_ratio
    = 0).

    Exact: W = 2 H tan(phi - a).
    Source: equilibrium of the wedge with friction mobilised on both sides (Brady & Brown).
    """
    for angle in angles:
        exact = exact_force(angle)
        pressed = partial(roof, friction_angle=angle)
        force = STATIC.limit(trial.variant, pressed, 0.84 * exact, 1.16 * exact)
        quantity = f"force at the limit, phi = {angle:g} degrees"
        trial.relative(quantity, "N/m", force, exact, 0.03, BISECTED)
    fine = np.linspace(20.0, 50.0, 61)
    chart = trial.chart("force that holds the wedge", "friction angle, degrees", "H / W")
    chart.exact("1/(2 tan(φ − a))", fine, [exact_force(a) / WEIGHT for a in fine])
    chart.computed(angles, np.array(trial.computed) / WEIGHT)
