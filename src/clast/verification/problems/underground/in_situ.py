"""Rock under in-situ stress in which nothing was dug stays as it is."""

from __future__ import annotations

import numpy as np

from clast.inputs.in_situ import Overburden
from clast.model.surroundings import InSituStress
from clast.pictures.verification import curve, exact_curve
from clast.rockmass import Domain, Exponential, JointSet, cut
from clast.verification.problem import Comparison, Trial, absolute, problem, relative
from clast.verification.problems import InputBuilder, Model, Run
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE, Variant

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
    boundary = np.array([(0.0, 0.0), (WIDTH, 0.0), (WIDTH, HEIGHT), (0.0, HEIGHT)])
    found = cut(Domain(boundary=boundary), sets=sets, seed=seed)
    builder = InputBuilder(title="In-situ stress", gravity=(0.0, -GRAVITY if weighed else 0.0))
    builder.add_rock("rock", young=50e9, poisson=0.25, density=DENSITY)
    builder.add_joint("default", friction_angle=60.0, cohesion=1e8)
    builder.blocks(vertices=found.vertices, start=found.block_start)
    builder.in_situ = Overburden(k0=RATIO) if weighed else InSituStress(stress=STRESS)
    return builder.build()


def stay(model: Model, variant: Variant) -> Run:
    """Return a run of a rock mass in which nothing is dug."""
    end = STEPS * STEP
    return variant.run(model, step=STEP, end=end, normal_stiffness=5e10, max_displacement=0.02)


def moved(run: Run) -> float:
    """Return the largest displacement of a vertex over the size of the rock mass."""
    return float(np.abs(run.state.vertices - run.model.vertices).max()) / SIZE


def compare_uniform(seed: int, variant: Variant) -> list[Comparison]:
    """Compare a rock mass under uniform stress."""
    run = stay(rock_mass(seed), variant)
    changed = float(np.abs(run.state.stress - np.array(STRESS)).max()) / LARGEST
    under = f"uniform stress, cut {seed}"
    return [
        absolute(f"displacement over size, {under}", "", moved(run), 0.0, 1e-12, IN_BALANCE),
        absolute(f"change of stress over stress, {under}", "", changed, 0.0, 1e-12, IN_BALANCE),
    ]


def compare_weight(seed: int, variant: Variant) -> tuple[list[Comparison], Run]:
    """Compare a rock mass under its weight; return its run, too."""
    run = stay(rock_mass(seed, weighed=True), variant)
    area = run.model.area
    mean = float(area @ run.state.stress[:, 1] / area.sum())
    under = f"weight, cut {seed}"
    rows = [
        absolute(f"displacement over size, {under}", "", moved(run), 0.0, 1e-6, STAIR),
        relative(f"mean vertical stress, {under}", "Pa", mean, -0.5 * WEIGHED, 1e-5, STAIR),
    ]
    return rows, run


@problem(set_up=rock_mass, variants=(LAGGED, OPEN_CLOSE, CONVEX), quick=(CONVEX,), few=(SEEDS[:1],))
def in_situ(trial: Trial, seeds: tuple[int, ...] = SEEDS) -> None:
    """Rock under in-situ stress.

    A box of 30 m x 20 m, cut into some 36 to 93 blocks by two sets of joints at angles by chance,
    under a uniform stress (-5, -10, 2) MPa without gravity, and under its own weight with k0 = 0.5:
    after 100 steps of 1 ms nothing has moved. E = 50 GPa, p = 50 GPa.

    Exact: no displacement, the stress of the start; mean vertical stress rho g H/2.
    Source: equilibrium of a uniform stress, and of a stress that grows with depth.
    """
    curves = []
    for seed in seeds:
        trial.rows += compare_uniform(seed, trial.variant)
        found, run = compare_weight(seed, trial.variant)
        trial.rows += found
        middle = np.array([run.model.polygon(b).mean(axis=0) for b in range(run.model.block_count)])
        label = f"cut {seed}, {trial.variant.name}"
        curves.append(curve(label, 1e-6 * run.state.stress[:, 1], middle[:, 1]))
    trial.chart(
        f"vertical stress of the blocks, {trial.variant.name}",
        "stress, MPa",
        "height, m",
        exact_curve("ρ g z", (-1e-6 * WEIGHED, 0.0), (0.0, HEIGHT)),
        *curves,
    )
