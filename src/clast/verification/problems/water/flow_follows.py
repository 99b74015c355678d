"""A joint on springs under columns that cannot turn, with water under pressure at its left end."""

from typing import Any

import numpy as np

from clast.actions.flow import JointWater
from clast.verification.problems import InputBuilder, Model, Run, Trial, problem
from clast.verification.variants import CONVEX, Variant

LENGTH, HEIGHT, VISCOSITY = 10.0, 2.0, 1e-3
"""Of the joint and its columns, m; Pa s."""
WIDE, NARROW, STIFFNESS = 1.1e-4, 1e-5, 1e9
"""Apertures at its ends, m, and normal stiffness, Pa/m."""
STRESS = 3e5
"""Normal stress of the columns on the joint, Pa."""
FLOW = STIFFNESS * (WIDE**4 - NARROW**4) / (48.0 * VISCOSITY * LENGTH)
"""What flows through it: q = -a^3/(12 mu) dp/dx with dp = k_n da, m2/s."""


COLUMNS = (25, 50)


def model_of(
    columns: int = COLUMNS[-1], angle: float = 0.0, order: Any = None, mirrored: bool = False
) -> Model:
    """Return the columns on their base, turned by an angle, degrees, the blocks in some order.

    Mirrored, the joint is wide at its right end.
    """
    cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    across = np.array([[cosine, sine], [-sine, cosine]])

    def at(*points: tuple[float, float]) -> list[list[float]]:
        local = np.array(points)
        return ((local if not mirrored else local * [-1.0, 1.0]) @ across).tolist()

    def block(*corners: tuple[float, float]) -> list[list[float]]:
        return at(*corners)[:: -1 if mirrored else 1]

    builder = InputBuilder(title="A joint that opens", gravity=(0.0, 0.0))
    for name in ("base", "upper"):
        builder.add_rock(name, young=50e9, poisson=0.0, density=2600.0)
    builder.add_joint(friction_angle=0.0, normal_stiffness=STIFFNESS)
    builder.add_joint(
        "bed",
        between_rocks=[("base", "upper")],
        friction_angle=0.0,
        normal_stiffness=STIFFNESS,
        aperture=NARROW + STRESS / STIFFNESS,
        residual_aperture=1e-7,
        maximum_aperture=1e-2,
    )
    base = block((0.0, -1.0), (LENGTH, -1.0), (LENGTH, 0.0), (0.0, 0.0))
    builder.block(name="base", rock="base", vertices=base, fixed=True)
    edge = np.linspace(0.0, LENGTH, columns + 1)
    push = (STRESS * LENGTH / columns) * (np.array([0.0, -1.0]) @ across)
    for number in range(columns) if order is None else order:
        first, last = edge[number : number + 2].tolist()
        outline = block((first, 0.0), (last, 0.0), (last, HEIGHT), (first, HEIGHT))
        name, (middle,) = f"column {number}", at((0.5 * (first + last), 0.5 * HEIGHT))
        builder.block(name=name, rock="upper", vertices=outline)
        builder.point_load(middle, push.tolist(), block=name)
        direction = across[0].tolist()
        builder.link(middle, block=name, direction=direction, x="rigid", rotation="rigid")
    builder.flow = {"coupling": "steady", "viscosity": VISCOSITY}
    pressure = STIFFNESS * (WIDE - NARROW)
    for name, x, value in (("wide", 0.0, pressure), ("narrow", LENGTH, 0.0)):
        line = [at((x, -1.0), (x, HEIGHT))]
        builder.flow_boundary(name, edges=line, pressure=value)
    return builder.build()


def at_rest(model: Model, *, variant: Variant = CONVEX, **given: Any) -> Run:
    """Return a static run of a model."""
    given = {"end": 1.0, "step": 0.1, "dynamic_ratio": 0.0, **given}
    return variant.run(model, p=STIFFNESS, max_displacement=0.02, **given)


def water_of(run: Run) -> JointWater:
    """Return the water at the end of a run."""
    (water,) = [one for one in run.state.actions if isinstance(one, JointWater)]
    return water


def through(run: Run) -> float:
    """Return what flows through the joint, m2/s."""
    return float(run.inflow("wide")["into_rock"][-1])


@problem(set_up=lambda: model_of(10), variants=(CONVEX,), cases=(COLUMNS,), few=(COLUMNS[-1:],))
def flow_follows(trial: Trial, columns: tuple[int, ...] = COLUMNS) -> None:
    """Steady flow through a joint that its pressure opens.

    A joint of 10 m on springs of 1 GPa/m under columns that cannot turn, 25 or 50 of them; water of
    100 kPa keeps its left end 11 times as wide as its right end. Equilibria and steady flow follow
    each other, ``coupling = "steady"``, until they agree.

    Exact: q = k_n (a1^4 - a2^4)/(48 mu L): a^4 falls evenly along the joint.
    Source: cubic law with dp = k_n da.
    Not run with: modified and open-close: equilibria are the same for every process.
    """
    chart = trial.chart("aperture along the joint", "distance, m", "aperture, mm")
    fine = np.linspace(0.0, LENGTH, 101)
    fourth = np.interp(fine, [0.0, LENGTH], [WIDE**4, NARROW**4])
    chart.exact("fourth root of a line", fine, 1e3 * fourth**0.25)
    for number in columns:
        run = at_rest(model_of(number), variant=trial.variant)
        reason = "each column has one aperture, of first order in its width"
        quantity = f"flow over the exact one, {number} columns"
        trial.relative(quantity, "-", through(run) / FLOW, 1.0, 0.5 / number, reason)
        flow = run.flow()
        middle, aperture = 0.5 * (flow.start + flow.end)[:, 0], flow["aperture"].mean(axis=1)
        chart.computed(middle, 1e3 * aperture, label=f"{number} columns")
