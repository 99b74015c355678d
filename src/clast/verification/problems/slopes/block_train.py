"""Blocks one above the other on a plane, each with its own friction: motion, forces, safety.

Blocks of weight W_i lie on a plane of dip a and push each other through smooth joints.  Where each
would slide faster than the one below it they move as one,

    acceleration = g (sin a - cos a sum(W_i tan phi_i)/sum(W_i)),

and the joint below block k carries

    E_k = sum over the blocks above it of W_i (sin a - cos a tan phi_i - acceleration/g).

With all friction divided by F they are at their limit where

    F = cos a sum(W_i tan phi_i)/(sin a sum(W_i)),

and there the joints carry the same sum with tan phi_i/F and without acceleration.
"""

import numpy as np

from clast.verification.problems import Model, Run, StaticRun, Trial, new_model, problem
from clast.verification.variants import EACH_PROCESS, Variant

GRAVITY, DENSITY = 9.8, 2500.0
DIP = float(np.radians(35.0))
LENGTHS = (2.0, 1.0, 3.0)
"""Lengths of the blocks along the plane, from the highest to the lowest, m."""
HEIGHT = 0.5
ANGLES = (15.0, 20.0, 30.0)
"""Friction angle of the plane below each block, degrees."""
WEIGHTS = DENSITY * GRAVITY * HEIGHT * np.array(LENGTHS)
FRICTION = np.tan(np.radians(ANGLES))
STEP, DURATION = 1e-3, 0.5
SPAN = 0.02
"""Half of the range of the friction that is searched as a share of it."""
RESOLUTION = "bracket of 0.5 %"
SHEAR = "shear springs give way before the plane slides; forces at the end of a step"
CLOSING = "the joints swing about their forces until the step has damped it"
STATIC = StaticRun(p=3e8, step=STEP, steps=600, bisections=3)


def acceleration() -> float:
    """Return the acceleration of all blocks down the plane, m/s2."""
    mean = float(WEIGHTS @ FRICTION / WEIGHTS.sum())
    return GRAVITY * (float(np.sin(DIP)) - float(np.cos(DIP)) * mean)


def pushes(friction: np.ndarray, gained: float) -> np.ndarray:
    """Return the forces of the joints below all blocks but the lowest, N/m.

    ``friction`` (3,) are tan phi, ``gained`` is the acceleration, m/s2.
    """
    each = WEIGHTS * (np.sin(DIP) - np.cos(DIP) * friction - gained / GRAVITY)
    return np.asarray(np.cumsum(each)[:-1])


def factor() -> float:
    """Return the factor of safety."""
    return float(np.cos(DIP) * (WEIGHTS @ FRICTION) / (np.sin(DIP) * WEIGHTS.sum()))


def train(divided_by: float = 1.0) -> Model:
    """Return the plane and the blocks on it, the friction divided."""
    along = np.array([np.cos(DIP), np.sin(DIP)])
    out = np.array([-along[1], along[0]])
    builder = new_model(
        "Blocks on a plane", gravity=GRAVITY, young=5e9, density=DENSITY, poisson=0.0
    )
    builder.add_joint(friction_angle=0.0)
    for number, tangent in enumerate(FRICTION, 1):
        angle = float(np.degrees(np.arctan(tangent / divided_by)))
        builder.add_joint(f"under {number}", friction_angle=angle, between=[("plane", str(number))])
    foot = -6.0 * along
    builder.block(
        name="plane",
        vertices=[foot, foot - 2.0 * out, 8.0 * along - 2.0 * out, 8.0 * along],
        fixed=True,
    )
    low = sum(LENGTHS)
    for number, length in enumerate(LENGTHS, 1):
        high, low = low, low - length
        corners = [
            low * along,
            high * along,
            high * along + HEIGHT * out,
            low * along + HEIGHT * out,
        ]
        builder.block(name=str(number), vertices=corners)
        builder.measured_point(str(number), np.mean(corners, axis=0), block=str(number))
    return builder.build()


def forces_between(run: Run) -> np.ndarray:
    """Return the normal forces between blocks that follow each other, N/m, at the end of a run."""
    memory, block = run.state.memory, run.model.vertex_block
    ends = np.sort(np.stack([block[memory.vertex], memory.block], axis=1), axis=1)
    return np.array(
        [
            memory.normal_force[(ends == (k, k + 1)).all(axis=1)].sum()
            for k in range(1, len(LENGTHS))
        ]
    )


def slide(variant: Variant) -> Run:
    """Return the run of the blocks that slide."""
    return variant.run(train(), step=STEP, end=DURATION, p=1e9, max_displacement=0.02)


@problem(set_up=train, variants=EACH_PROCESS)
def block_train(trial: Trial) -> None:
    """Blocks that push each other down a plane.

    Three blocks of 2, 1 and 3 m x 0.5 m on a plane of 35 degrees, with 15, 20 and 30 degrees of
    friction below them from above, and smooth joints between them. p = 1 GPa, h = 1 ms; the factor
    of safety is bisected, p = 0.3 GPa, static (dynamic_ratio = 0).

    Exact: a = g (sin a - cos a sum(W tan phi)/sum W), E = sum of W (sin a - cos a tan phi - a/g), F
    = cos a sum(W tan phi)/(sin a sum W).
    Source: equilibrium and motion of blocks in a row.
    """
    run = slide(trial.variant)
    histories = [run.history(str(k)) for k in range(1, 1 + len(LENGTHS))]
    for number, history in enumerate(histories, 1):
        displacement = float(np.hypot(*history.displacement[-1]))
        exact = 0.5 * acceleration() * DURATION**2
        trial.relative(f"displacement of block {number}", "m", displacement, exact, 0.01, SHEAR)
    exact_pushes = pushes(FRICTION, acceleration())
    for number, (force, exact) in enumerate(zip(forces_between(run), exact_pushes, strict=True), 1):
        quantity = f"force between blocks {number} and {number + 1}"
        trial.relative(quantity, "N/m", force, exact, 0.01, CLOSING)
    safety = factor() / STATIC.limit(
        trial.variant, lambda share: train(factor() / share), 1.0 - SPAN, 1.0 + SPAN
    )
    trial.relative("factor of safety", "-", safety, factor(), 0.01, RESOLUTION)
    time = histories[0].time
    chart = trial.chart("displacement of the middle block", "time, s", "displacement, m")
    chart.exact("all together", time, 0.5 * acceleration() * time**2)
    chart.exact(
        "each alone", time, 0.5 * GRAVITY * (np.sin(DIP) - np.cos(DIP) * FRICTION[1]) * time**2
    )
    chart.computed(time[::25], np.hypot(*histories[1].displacement[::25].T))
