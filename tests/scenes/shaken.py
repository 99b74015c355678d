"""Bricks with bonds, loads and a fixed point on a floor, in an earthquake: all that runs carry."""

from __future__ import annotations

import numpy as np

import clast

STEPS = 60
STEP = 2e-3
PROCESSES = ("modified", "open-close", "convex")
LAWS = ("penalty", "augmented-lagrangian")


def shaken() -> clast.ModelBuilder:
    """Bricks with bonds, loads and a fixed point on a floor, in an earthquake."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("granite", young=5e9, poisson=0.2, density=2600.0)
    builder.add_joint(friction_angle=30.0, cohesion=1e3, tensile_strength=2e2)
    builder.block(vertices=[(-4, -1), (4, -1), (4, 0), (-4, 0)], name="floor", fixed=True)
    for row in range(3):
        for column in range(4):
            x = column + 0.5 * (row % 2) - 2.0
            y = 0.5 * row
            builder.block(
                vertices=[(x, y), (x + 1, y), (x + 1, y + 0.5), (x, y + 0.5)],
                name=f"{row}-{column}",
            )
    builder.block(
        vertices=[(0, 1.7), (0.4, 1.7), (0.4, 2.1), (0, 2.1)], name="falls", velocity=(1, -2, 3)
    )
    builder.add_amplitude("ramp", [0.0, 0.05, 0.1], [0.2, 1.0, 0.5])
    builder.point_load((-1.6, 0.25), (1e3, -2e3), block="0-0", amplitude="ramp")
    builder.pressure((0, 1.7), (0.3, 1.7), [2e3, 5e2], amplitude="ramp")
    builder.measured_point("top", (0.3, 2.0), block="falls")
    time = np.linspace(0.0, 0.5, 51)
    acceleration = np.stack([3.0 * np.sin(40.0 * time), np.cos(30.0 * time)], axis=1)
    builder.ground_motion = clast.InertialForce(clast.Accelerogram(time, acceleration))
    return builder


def shaken_case(process: str, law: str) -> clast.Case:
    """Return 60 steps of these bricks, with a frame every seven and a half."""
    stiffness = {"modified": 2e7, "open-close": 2e7, "convex": 5e9}[process]
    return shaken().case(
        step=STEP,
        end=STEPS * STEP,
        every=7.5 * STEP,
        process=process,
        contact_law={"name": law, "normal_stiffness": stiffness},
    )
