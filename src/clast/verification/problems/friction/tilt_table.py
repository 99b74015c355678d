"""A tilt table: the angle at which a block slides or topples."""

from functools import partial

import numpy as np

from clast.verification.problems import InputBuilder, Model, StaticRun, Trial, box, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE

GRAVITY, HEIGHT, FRICTION_ANGLE = 9.8, 1.0, 25.0
"""Height of the block, m, and its friction angle, degrees."""
WIDTHS = (0.2, 0.4, 0.5, 1.0)
"""Widths of the block, m: it topples, topples barely before it slides, slides twice."""
SPAN = 1.2
RESOLUTION = "bisected to 0.075 degrees; the corners are springs"
STATIC = StaticRun(p=2e9, step=1e-2, steps=300, bisections=5)


def exact_angle(width: float) -> float:
    """Return the tilt at which a block of a width, m, moves, degrees."""
    return min(float(np.degrees(np.arctan2(width, HEIGHT))), FRICTION_ANGLE)


def table(width: float = 0.4, tilt: float = 15.0) -> Model:
    """Return a fixed table and the block on it; gravity is tilted instead of the table."""
    down = np.radians(tilt)
    gravity = (GRAVITY * np.sin(down), -GRAVITY * np.cos(down))
    builder = InputBuilder(title="Tilt table", gravity=gravity)
    add_block(builder, width)
    return builder.build()


def add_block(builder: InputBuilder, width: float) -> None:
    """Add the fixed table and the block on it, their rock and their joint."""
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    builder.add_joint("default", friction_angle=FRICTION_ANGLE)
    builder.block(name="table", vertices=box(-1.0, -0.3, 2.0, 0.0), fixed=True)
    builder.block(name="block", vertices=box(0, 0, width, HEIGHT))
    builder.measured_point("foot", (0.0, 0.0), block="block")
    builder.measured_point("top", (0.0, HEIGHT), block="block")


@problem(set_up=table, variants=(OPEN_CLOSE, CONVEX), quick=())
def tilt_table(trial: Trial) -> None:
    """Tilt table.

    Blocks 1 m high and 0.2 to 1 m wide on a table whose tilt is bisected; the friction angle is 25
    degrees. Gravity turns instead of the table; p = 2 GPa, h = 10 ms, static (dynamic_ratio = 0); p
    h2/m is up to 740, beyond one pass.

    Exact: the smaller of atan(b/h), by which it topples, and phi, by which it slides.
    Source: equilibrium of a rigid block.
    Not run with: modified: p h2/m is far above what one pass or four tolerate.
    """
    for width in WIDTHS:
        exact = exact_angle(width)
        tilt = STATIC.limit(trial.variant, partial(table, width), exact + SPAN, exact - SPAN)
        quantity = f"tilt at which b/h = {width / HEIGHT:g} moves"
        trial.absolute(quantity, "degrees", tilt, exact, 0.1, RESOLUTION)
    fine = np.linspace(0.1, 1.2, 111)
    chart = trial.chart("tilt at which the block moves", "b/h", "tilt, degrees")
    chart.exact("the smaller of atan(b/h) and φ", fine, [exact_angle(b) for b in fine])
    chart.computed(WIDTHS, trial.computed)
