"""Convergence and confinement: the load on a lining that comes after part of the relaxation.

A hole in an elastic plate under the pressure p all round closes by u = p/k_g as all of its support
is taken away.  After the share beta of it comes a lining of the stiffness k_s = E t/(R_m R_o), R_m
and R_o being the radii of its middle and of its outer face; it takes the rest up to

    p_s = (1 - beta) p k_s/(k_s + k_g).

k_g and beta are those of the same plate without a lining: of blocks that are joined by stiff
springs.  The joint to the rock is smooth: blocks as large as segments strain as wholes, and would
strain a lining that sticks to them with them.
"""

import itertools

import numpy as np

from clast.model.stages import Stage
from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, box, problem
from clast.verification.variants import CONVEX, CONVEX_MULTIPLIERS, OPEN_CLOSE, PASSES, Variant

RADII = (2.0, 2.5, 3.2, 4.2, 5.5, 7.5, 10.0, 11.0)
"""Radii of the rings of blocks, the last of which is fixed, m."""
SECTORS = 32
PRESSURE, ROCK = 1e6, 2e9
"""Stress in situ and Young's modulus of the rock, Pa."""
THICKNESS, YOUNG = 0.2, 20e9
RELAXED, LASTING = 0.4, 100.0
"""Share of the support that ends at once, and time within which the rest does, s."""
STEP = 2.0
REASON = "the plate has corners where it has blocks, and the lining bends a little at them"


def scene(segments: int | None = SECTORS, relaxed: float = RELAXED) -> Model:
    """Return a plate with a core to take out, and a lining of so many segments, None: without."""
    builder = InputBuilder(
        title="Convergence and confinement",
        gravity=(0.0, 0.0),
        in_situ={"stress": [-PRESSURE, -PRESSURE, 0.0]},
    )
    builder.add_rock("rock", young=ROCK, poisson=0.2, density=2500.0)
    stiff = {"normal_stiffness": 1e12, "shear_stiffness": 1e12}
    builder.add_joint("default", friction_angle=45.0, cohesion=1e9, tensile_strength=1e9, **stiff)
    builder.block(name="core", vertices=[_corner(RADII[0], k) for k in range(SECTORS)])
    for ring, (inside, outside) in enumerate(itertools.pairwise(RADII)):
        for k in range(SECTORS):
            corners = box(inside, k, outside, k + 1)
            builder.block(
                name=f"{ring}, {k}",
                vertices=[_corner(*one) for one in corners],
                fixed=ring == len(RADII) - 2,
            )
    builder.opening("tunnel", ["core"])
    for k in range(SECTORS):
        middle = 0.5 * (np.array(_corner(RADII[0], k)) + _corner(RADII[0], k + 1))
        builder.measured_point(f"at {k}", (float(middle[0]), float(middle[1])), block=f"0, {k}")
    if segments:
        builder.add_joint("smooth", normal_stiffness=1e13, shear_stiffness=1e8)
        builder.lining(
            "shell",
            opening="tunnel",
            thickness=THICKNESS,
            segment=2.0 * np.pi * RADII[0] / segments,
            young=YOUNG,
            poisson=0.2,
            joint="smooth",
            stage="line",
        )
    return builder.build()


def _corner(radius: float, k: float) -> tuple[float, float]:
    angle = 2.0 * np.pi * (k % SECTORS) / SECTORS
    return float(radius * np.cos(angle)), float(radius * np.sin(angle))


def dug(variant: Variant, segments: int | None, relaxed: float = RELAXED) -> Run:
    """Return the run: the core is taken out, and the plate lined after the first step."""
    stages = (
        Stage(
            name="dig",
            until="time",
            time=STEP,
            excavate=("tunnel",),
            relax=relaxed,
            relax_time=LASTING,
        ),
        Stage(name="line", until="time", time=LASTING + 6.0 * STEP),
    )
    end = LASTING + 10.0 * STEP
    return variant.static(
        scene(segments), step=STEP, end=end, stages=stages, p=1e12, max_displacement=0.1
    )


def closures(run: Run) -> Floats:
    """Return the mean closure of the hole over time, m, shape (t,)."""
    angle = 2.0 * np.pi * (np.arange(SECTORS) + 0.5) / SECTORS
    displacements = np.array([run.history(f"at {k}").displacement for k in range(SECTORS)])
    outwards = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return -np.asarray((displacements * outwards[:, None]).sum(axis=2).mean(axis=0))


@problem(set_up=scene, variants=(CONVEX, CONVEX_MULTIPLIERS, OPEN_CLOSE, PASSES), quick=())
def lining_confinement(trial: Trial) -> None:
    """Convergence and confinement.

    A plate of 7 rings of 32 blocks with joints of 1 TPa/m, under 1 MPa in situ, with a hole of 2 m
    that is lined by 0.2 m of concrete after 0.4 or 0.7 of the support has ended, by 32 segments or
    by 48, which have their ends elsewhere than the blocks. Static (dynamic_ratio = 0), h = 2 s.

    Exact: p_s = (1 - beta) p k_s/(k_s + k_g).
    Source: Panet & Guenot (1982), linear ground.
    """
    outer = RADII[0] * float(np.cos(0.5 * np.pi / SECTORS))
    stiffness = YOUNG * THICKNESS / ((outer - 0.5 * THICKNESS) * outer)
    free = {relaxed: closures(dug(trial.variant, None, relaxed)) for relaxed in (RELAXED, 0.7)}
    whole = float(free[RELAXED][-1])
    rock = PRESSURE / whole
    chart = trial.chart("pressure on the lining as the hole closes", "closure, µm", "pressure, kPa")
    ends = 1e6 * whole * np.array([0.8, 1.0]), 1e-3 * PRESSURE * np.array([0.2, 0.0])
    chart.exact("ground without its relaxation", *ends)
    for segments, relaxed in ((SECTORS, RELAXED), (SECTORS, 0.7), (48, RELAXED)):
        run = dug(trial.variant, segments, relaxed)
        share = float(free[relaxed][1]) / whole
        exact = (1.0 - share) * PRESSURE * stiffness / (stiffness + rock)
        lining = run.lining("shell")
        pressure = -lining.normal_force.mean(axis=1) / outer
        name = f"pressure on {segments} segments after {share:.3f}"
        trial.relative(name, "Pa", float(pressure[-1]), exact, 2e-2, REASON)
        label = f"{segments} segments after {share:.2f}"
        chart.computed(1e6 * closures(run), 1e-3 * pressure, label=label)
