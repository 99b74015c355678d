"""Rock under in-situ stress in which nothing was dug stays as it is."""

import numpy as np

from clast.inputs.in_situ import Overburden
from clast.model.surroundings import InSituStress
from clast.rockmass import Domain, Exponential, JointSet, cut
from clast.verification.fixtures import box
from clast.verification.problems import InputBuilder, Model, Trial, problem
from clast.verification.variants import EACH_PROCESS

WIDTH, HEIGHT = 30.0, 20.0
"""Width and height of the rock, m."""
SIZE = float(np.hypot(WIDTH, HEIGHT))
STRESS = (-5e6, -10e6, 2e6)
"""Uniform stress (xx, yy, xy), Pa."""
LARGEST = 10e6
"""Its largest component, Pa."""
GRAVITY, DENSITY, RATIO = 9.8, 2700.0, 0.5
"""Gravity, m/s2, density, kg/m3, and k0."""
WEIGHED = DENSITY * GRAVITY * HEIGHT
"""Vertical stress at the bottom, Pa."""
SEEDS = (1, 2, 3)
STEP, STEPS = 1e-3, 100
IN_BALANCE = "in balance to the last bits"
STAIR = "blocks of one stress each carry a gradient in steps, which a static solution balances"


def rock_mass(seed: int = 1, *, weighed: bool = False) -> Model:
    """Return a box of rock, cut by two sets of joints at angles by chance, under stress."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, 180.0)
    sets = [
        JointSet(name="a", angle=angle, spacing=rng.uniform(2.0, 4.0)),
        JointSet(name="b", angle=angle + rng.uniform(30.0, 150.0), spacing=Exponential(mean=3.0)),
    ]
    boundary = np.array(box(0.0, 0.0, WIDTH, HEIGHT))
    rocks = cut(Domain(boundary=boundary), sets=sets, seed=seed)
    builder = InputBuilder(title="In-situ stress", gravity=(0.0, -GRAVITY if weighed else 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=DENSITY)
    builder.add_joint("default", friction_angle=60.0, cohesion=1e8)
    builder.blocks(vertices=rocks.vertices, start=rocks.block_start)
    builder.in_situ = Overburden(k0=RATIO) if weighed else InSituStress(stress=STRESS)
    return builder.build()


@problem(set_up=rock_mass, variants=EACH_PROCESS, few=(SEEDS[:1],))
def in_situ(trial: Trial, seeds: tuple[int, ...] = SEEDS) -> None:
    """Rock under in-situ stress.

    A box of 30 m x 20 m, cut into some 36 to 93 blocks by two sets of joints at angles by chance,
    under a uniform stress (-5, -10, 2) MPa without gravity, and under its own weight with k0 = 0.5:
    after 100 steps of 1 ms nothing has moved. E = 50 GPa, p = 50 GPa.

    Exact: no displacement, the stress of the start; mean vertical stress rho g H/2.
    Source: equilibrium of a uniform stress, and of a stress that grows with depth.
    """
    title = f"vertical stress of the blocks, {trial.variant.name}"
    chart = trial.chart(title, "stress, MPa", "height, m")
    chart.exact("ρ g z", (-1e-6 * WEIGHED, 0.0), (0.0, HEIGHT))
    for seed in seeds:
        uniform, weighed = (
            trial.variant.run(
                rock_mass(seed, weighed=weight),
                step=STEP,
                end=STEPS * STEP,
                p=5e10,
                max_displacement=0.02,
            )
            for weight in (False, True)
        )
        moved = [
            float(np.abs(run.state.vertices - run.model.vertices).max()) / SIZE
            for run in (uniform, weighed)
        ]
        changed = float(np.abs(uniform.state.stress - np.array(STRESS)).max()) / LARGEST
        under = f"uniform stress, cut {seed}"
        trial.absolute(f"displacement over size, {under}", "", moved[0], 0.0, 1e-12, IN_BALANCE)
        quantity = f"change of stress over stress, {under}"
        trial.absolute(quantity, "", changed, 0.0, 1e-12, IN_BALANCE)
        model, stress = weighed.model, weighed.state.stress[:, 1]
        mean, under = float(model.area @ stress / model.area.sum()), f"weight, cut {seed}"
        trial.absolute(f"displacement over size, {under}", "", moved[1], 0.0, 1e-6, STAIR)
        quantity = f"mean vertical stress, {under}"
        trial.relative(quantity, "Pa", mean, -0.5 * WEIGHED, 1e-5, STAIR)
        middle = np.array([model.polygon(b).mean(axis=0) for b in range(model.block_count)])
        chart.computed(1e-6 * stress, middle[:, 1], f"cut {seed}")
