"""The modulus of a jointed rock mass."""

import numpy as np

from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

YOUNG = 10e9
SPACING, WIDTH, BLOCKS = 0.5, 1.0, 6
"""Height s of a block, its width b, m, and their number."""
PRESSURE = 1e4
"""Pressure on top, Pa."""
RATIOS = (0.1, 1.0, 10.0)
"""E/(k s): how much softer joints are than rock."""
AT_REST = "at rest; Poisson's ratio 0, so that nothing holds the blocks sideways"


def column(ratio: float = 1.0) -> Model:
    """Return a floor and a column under pressure, without gravity; ``ratio`` is E/(k s)."""
    builder = new_model("Jointed rock", young=YOUNG, density=2500.0, poisson=0.0)
    stiffness = YOUNG / (ratio * SPACING)
    builder.add_joint(
        "default", friction_angle=30.0, normal_stiffness=stiffness, shear_stiffness=stiffness
    )
    builder.block(name="floor", vertices=box(-0.5, -0.4, 1.5, 0), fixed=True)
    for k in range(BLOCKS):
        low, high = k * SPACING, (k + 1) * SPACING
        builder.block(name=str(k + 1), vertices=box(0, low, WIDTH, high))
    top = BLOCKS * SPACING
    builder.line_load((WIDTH, top), (0.0, top), (0.0, -PRESSURE), block=str(BLOCKS))
    for k in (1, BLOCKS):
        builder.measured_point(str(k), (0.5 * WIDTH, (k - 0.5) * SPACING), block=str(k))
    return builder.build()


@problem(set_up=column, variants=(OPEN_CLOSE, CONVEX))
def jointed_rock(trial: Trial, ratios: tuple[float, ...] = RATIOS) -> None:
    """Modulus of a jointed rock mass.

    Six blocks of 1 m x 0.5 m on each other are compressed by 10 kPa; E = 10 GPa, nu = 0, joints
    from ten times stiffer to ten times softer than the rock; h = 2 ms, static (dynamic_ratio = 0).

    Exact: 1/E_m = 1/E + 1/(k s).
    Source: rock and joints in series (Goodman 1989).
    Not run with: modified: one pass and four throw the blocks: p h2/m is up to 640.
    """
    moduli = []
    for ratio in ratios:
        run = trial.variant.static(column(ratio), step=2e-3, end=0.2, p=1e9, max_displacement=0.01)
        low, high = (run.history(name).displacement[-1, 1] for name in ("1", str(BLOCKS)))
        moduli.append(float(PRESSURE * (BLOCKS - 1) * SPACING / (low - high)))
        quantity = f"modulus at E/(k s) = {ratio:g}"
        trial.relative(quantity, "Pa", moduli[-1], YOUNG / (1.0 + ratio), 1e-5, AT_REST)
    fine = np.geomspace(0.05, 20.0, 60)
    chart = trial.chart("modulus of the rock mass", "E/(k s)", "Eₘ/E", log="x")
    chart.exact("1/(1 + E/(k s))", fine, 1.0 / (1.0 + fine))
    chart.computed(ratios, np.array(moduli) / YOUNG)
