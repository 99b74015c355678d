"""Blocks under water: one rests on the bottom with less weight, one that is lighter rises."""

from clast.verification.problems import InputBuilder, Model, Run, Trial, box, problem
from clast.verification.variants import CONVEX_MULTIPLIERS, EACH_PROCESS, Variant

GRAVITY, WATER = 9.8, 1000.0
HEAVY, LIGHT = 2500.0, 800.0
"""Densities of the blocks, kg/m3."""
SIZE = (1.5, 1.0)
"""Width and height of a block, m."""
AREA = SIZE[0] * SIZE[1]
RISING = (WATER - LIGHT) * GRAVITY / LIGHT
"""Acceleration of the light block, m/s2."""
ABOVE = 0.5
"""Where the light block begins over the bottom, m: all its faces are outer ones."""
DURATION = 0.5


def under_water(density: float, above: float) -> Model:
    """Return a block of a density, kg/m3, in a basin, ``above`` m over its bottom."""
    width, height = SIZE
    builder = InputBuilder(title="Block under water", gravity=(0.0, -GRAVITY))
    builder.add_rock("bottom", young=5e9, poisson=0.2, density=HEAVY)
    builder.add_rock("block", young=5e9, poisson=0.2, density=density)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="bottom", vertices=box(-1, -1, width + 1, 0), rock="bottom", fixed=True)
    builder.block(name="block", vertices=box(0, above, width, above + height), rock="block")
    builder.water(height + 5.0, density=WATER, acts_on="faces" if above else "both")
    builder.measured_point("middle", (0.5 * width, above + 0.5 * height), block="block")
    return builder.build()


def run_of(model: Model, variant: Variant, dynamic_ratio: float) -> Run:
    """Return the run of a block."""
    return variant.run(
        model, step=2e-3, end=DURATION, p=5e8, max_displacement=0.05, dynamic_ratio=dynamic_ratio
    )


@problem(set_up=lambda: under_water(HEAVY, 0.0), variants=(*EACH_PROCESS, CONVEX_MULTIPLIERS))
def submerged_block(trial: Trial) -> None:
    """Blocks under water.

    A block of 1.5 m x 1 m lies on a fixed bottom under 5 m of water, with water on all faces and in
    the joint: with 2500 kg/m3 it rests; with 800 kg/m3, 0.5 m over the bottom, it rises. p = 0.5
    GPa, h = 2 ms.

    Exact: N = (rho - rho_w) g A; a = (rho_w - rho) g/rho.
    Source: Archimedes.
    """
    rests = run_of(under_water(HEAVY, 0.0), trial.variant, 0.0)
    rises = run_of(under_water(LIGHT, ABOVE), trial.variant, 1.0)
    carries = float(rests.state.memory.normal_force.sum())
    history = rises.history("middle")
    quantity, reason = "force on the bottom", "the water follows the block, which shrinks by 4e-6"
    trial.relative(quantity, "N/m", carries, (HEAVY - WATER) * GRAVITY * AREA, 1e-4, reason)
    trial.relative(
        "displacement of the block that rises",
        "m",
        float(history.displacement[-1, 1]),
        0.5 * RISING * DURATION**2,
        1e-3,
        "water follows the block from step to step",
    )
    time = history.time[::10]
    chart = trial.chart("a light block under water", "time, s", "displacement up, m")
    chart.exact("a t²/2", history.time, 0.5 * RISING * history.time**2)
    chart.computed(time, history.displacement[::10, 1])
