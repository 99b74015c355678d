"""A joint on springs under columns that cannot turn, with water under pressure at its left end."""

from __future__ import annotations

from typing import Any

import numpy as np

import clast
from clast.actions.flow import JointWater

LENGTH, HEIGHT, VISCOSITY = 10.0, 2.0, 1e-3
"""Of the joint and its columns, m; Pa s."""
WIDE, NARROW, STIFFNESS = 1.1e-4, 1e-5, 1e9
"""Apertures at its ends, m, and normal stiffness, Pa/m."""
STRESS = 3e5
"""Normal stress of the columns on the joint, Pa."""
FLOW = STIFFNESS * (WIDE**4 - NARROW**4) / (48.0 * VISCOSITY * LENGTH)
"""What flows through it: q = -a^3/(12 mu) dp/dx with dp = k_n da, m2/s."""


def model_of(columns: int, angle: float = 0.0, order: Any = None, mirrored: bool = False) -> Any:
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

    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
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


def at_rest(model: Any, **given: Any) -> clast.Run:
    """Return a static run of a model."""
    return clast.simulate(model, **{"end": 1.0, "step": 0.1, "dynamic_ratio": 0.0, **given})


def water_of(run: clast.Run) -> JointWater:
    """Return the water at the end of a run."""
    (water,) = [one for one in run.state.actions if isinstance(one, JointWater)]
    return water


def through(run: clast.Run) -> float:
    """Return what flows through the joint, m2/s."""
    given = water_of(run).solved.given
    return float(given[given > 0.0].sum())
