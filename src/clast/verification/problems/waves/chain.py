"""Blocks that are tied to a wall and to each other swing for ever, by the midpoint scheme.

n blocks of mass m along a line, each tied to the one before by a joint of the stiffness K, swing in
their lowest mode with

    w = 2 sqrt(K/m) sin(pi/(2 (2 n + 1))),    x_j ~ sin(j pi/(2 n + 1))

(Thomson 1993).  A scheme that takes its forces half way keeps their energy, and takes w for

    w_h = (2/h) atan(w h/2)

so that its error is one of the period alone, (w h)^2/12: of second order in h.
"""

import numpy as np

from clast.verification.problems import Model, Run, Trial, box, new_model, problem
from clast.verification.variants import HALF_WAY, MIDPOINT, Variant

BLOCKS, DENSITY = 3, 2500.0
"""Number of blocks of 1 m x 1 m, and their density, kg/m3."""
JOINT, RIGID = 1e9, 1e14
"""Stiffness of the joints, Pa/m, and Young's modulus of blocks that give way by next to nothing."""
SPEED = 0.01
"""Largest velocity at the start, m/s."""
CIRCULAR = float(2.0 * np.sqrt(JOINT / DENSITY) * np.sin(0.5 * np.pi / (2 * BLOCKS + 1)))
"""w, 1/s."""
PERIOD = 2.0 * np.pi / CIRCULAR
STEPS, PERIODS, FEW = 20, 200, 20
"""Steps a period, and periods; FEW where time is short."""
ORDERS, LATER = (20, 40), 1.1
"""Steps a period between which the order is taken, of the displacement after so many periods."""


def model_of_chain() -> Model:
    """Return the blocks, with the velocities of the lowest mode, and the wall."""
    builder = new_model("Chain", young=RIGID, density=DENSITY, poisson=0.0)
    builder.add_joint(
        friction_angle=30.0,
        cohesion=1e12,
        tensile_strength=1e12,
        normal_stiffness=JOINT,
        shear_stiffness=JOINT,
    )
    builder.block(name="wall", vertices=box(-1, 0, 0, 1), fixed=True)
    for j in range(1, BLOCKS + 1):
        speed = SPEED * np.sin(j * np.pi / (2 * BLOCKS + 1))
        builder.block(name=f"block {j}", vertices=box(j - 1, 0, j, 1), velocity=(speed, 0, 0))
    builder.measured_point("end", (BLOCKS, 0.5), block=f"block {BLOCKS}")
    return builder.build()


def swung(steps: int, periods: float, variant: Variant) -> Run:
    """Return the run over some periods with so many steps in each."""
    return variant.run(
        model_of_chain(), step=PERIOD / steps, end=periods * PERIOD, p=JOINT, max_displacement=0.05
    )


def displacement(steps: int, variant: Variant) -> float:
    """Return the displacement of the end after ``LATER`` periods, in units of its peak."""
    moved = swung(steps, LATER, variant).history("end").displacement[-1, 0]
    return float(moved / (SPEED * np.sin(BLOCKS * np.pi / (2 * BLOCKS + 1)) / CIRCULAR))


def counted(run: Run) -> float:
    """Return the circular frequency, 1/s, of the zero crossings of the end."""
    history = run.history("end")
    x, time = history.displacement[:, 0], history.time
    at = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    crossing = time[at] - x[at] * (time[at + 1] - time[at]) / (x[at + 1] - x[at])
    return float(2.0 * np.pi * (len(at) - 1) / (crossing[-1] - crossing[0]))


@problem(set_up=model_of_chain, variants=HALF_WAY, quick=(MIDPOINT,), few=(FEW,))
def chain(trial: Trial, periods: int = PERIODS) -> None:
    """Chain of bonded blocks that swings for ever.

    3 bonded blocks of 1 m with joints of 1 GPa/m, the first tied to a wall, with the velocities of
    their lowest mode; 20 steps a period, 200 periods. The default scheme, with forces at the end of
    a step, has lost all of this energy by then.

    Exact: energy kept; w_h = (2/h) atan(w h/2), w = 2 sqrt(K/m) sin(pi/(2 (2 n + 1))).
    Source: Thomson (1993), fixed-free chain; implicit midpoint rule on it.
    """
    run = swung(STEPS, periods, trial.variant)
    energy = run.energy
    held = energy["kinetic"] + energy["elastic"] + energy["contact"]
    lost = 1.0 - held / held[0]
    quantity = f"largest change of energy in {periods} periods, of it"
    reason = "gaps are measured anew in each step, and blocks are not quite rigid"
    trial.absolute(quantity, "", float(np.abs(lost).max()), 0.0, 1e-5, reason)
    step = PERIOD / STEPS
    trial.relative(
        f"frequency by {STEPS} steps a period",
        "1/s",
        counted(run),
        float(2.0 / step * np.arctan(0.5 * CIRCULAR * step)),
        1e-4,
        "the instants of zero crossings are interpolated; blocks are not quite rigid",
    )
    exact = np.sin(2.0 * np.pi * LATER)
    missed = [abs(displacement(steps, trial.variant) - exact) for steps in ORDERS]
    order = float(np.log2(missed[0] / missed[1]))
    trial.absolute("order in h", "", order, 2.0, 0.1, "the order is that of small steps")
    cycles = np.arange(len(lost)) / STEPS
    chart = trial.chart("energy gained", "periods", "gain / energy at the start")
    chart.exact("kept", cycles[[0, -1]], np.zeros(2))
    chart.computed(cycles[:: 10 * STEPS], -lost[:: 10 * STEPS])
