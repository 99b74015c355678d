"""A ring under two opposite point loads, and under a pressure all round it.

A ring of the radius R under two opposite loads P becomes shorter and wider by

    v = P R^3/(E I) (pi/4 - 2/pi) + P R pi/4 (1/(E A) + 1/(k G A)),
    w = P R^3/(E I) (2/pi - 1/2) - P R/(2 E A) + P R/(2 k G A),

with M = P R/pi under the loads and P R (1/2 - 1/pi) at the sides, where N = -P/2.  Under a pressure
p on its outer face, of the radius R + t/2,

    N = -p (R + t/2),    u = N R/(E A).

Moments have a kink under a point load.  The trapezoidal rule adds l^2/12 of it to the energy where
the load is at a joint, 1.2 % with 48 segments, and takes half of that off where it is in the middle
of a segment.
"""

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

RADIUS, THICKNESS = 3.0, 0.15
"""Radius of the middle, and thickness, m."""
YOUNG, POISSON = 30e9, 0.2
LOAD, PRESSURE = 1e3, 1e5
"""N/m and Pa."""
SEGMENTS = 48
KINK = "the kink of the moment under the load, by the trapezoidal rule: 0.6 % in the middle"
JOINT = "the same at a joint: 1.2 % with 48 segments"
MIDDLE = "moments of joints, l/2 from the load"
ROUND = "a polygon of 48 sides: 0.2 %"


def scene(phase: float = 0.5, segments: int = SEGMENTS) -> Model:
    """Return a ring with loads above and below: in the middle of segments, or (0) at joints."""
    builder, _angle = ring(phase, segments)
    middle = float(np.cos(np.pi / segments)) if phase else 1.0
    quarter = segments // 4
    for name, block, sign in (("top", quarter, -1.0), ("bottom", 3 * quarter, 1.0)):
        at = (0.0, -sign * RADIUS * middle)
        for beside in (block, block + (phase == 0.0)):
            builder.point_load(at, (0.0, 0.5 * sign * LOAD), block=f"ring/{beside}")
        builder.measured_point(name, at, block=f"ring/{block}")
    for name, block, side in (("right", segments, 1.0), ("left", 2 * quarter, -1.0)):
        builder.measured_point(name, (side * RADIUS * middle, 0.0), block=f"ring/{block}")
    return builder.build()


def pressed(segments: int = SEGMENTS) -> Model:
    """Return a ring with a pressure on its outer face."""
    builder, angle = ring(0.0, segments)
    outlines = builder.build()
    for k in range(segments):
        name = f"ring/{k + 1}"
        outer = outlines.polygon(outlines.block_name.index(name))[:2].tolist()
        builder.pressure(tuple(outer[0]), tuple(outer[1]), PRESSURE, block=name)
        at = RADIUS * np.array([np.cos(angle[k]), np.sin(angle[k])])
        builder.measured_point(f"at {k}", (float(at[0]), float(at[1])), block=name)
    return builder.build()


def ring(phase: float, segments: int) -> tuple[InputBuilder, Floats]:
    """Return a ring, whose first corner is so many segments above +x, and angles of corners."""
    builder = new_model("Ring of a lining", young=YOUNG, density=2500.0, poisson=POISSON)
    far = 4.0 * RADIUS
    builder.block(name="far", vertices=box(far, -1.0, far + 1.0, 1.0), fixed=True)
    angle = 2.0 * np.pi * (np.arange(segments) + phase) / segments
    points = [(RADIUS * float(np.cos(one)), RADIUS * float(np.sin(one))) for one in angle]
    builder.lining(
        "ring",
        polyline=[*points, points[0]],
        side="middle",
        thickness=THICKNESS,
        segment=2.0 * np.pi * RADIUS / segments,
        young=YOUNG,
        poisson=POISSON,
    )
    return builder, angle


def settled(variant: Variant, model: Model) -> Run:
    """Return the run."""
    return variant.static(model, step=0.1, end=2.0, p=1e10, max_displacement=0.1)


def _motions(run: Run) -> tuple[float, float]:
    displacement = {name: run.history(name).displacement[-1] for name in run.point_name}
    return (
        float((displacement["bottom"] - displacement["top"])[1]),
        float((displacement["right"] - displacement["left"])[0]),
    )


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE, PASSES))
def lining_ring(trial: Trial) -> None:
    """Ring of a lining.

    A ring of 3 m radius and 0.15 m, of 48 segments, under two opposite loads of 1 kN/m in the
    middle of segments or at joints (also with 96), and under 100 kPa on its outer face. Static
    (dynamic_ratio = 0), h = 0.1 s.

    Exact: v = P R^3/(E I) (pi/4 - 2/pi) + ...;  N = -p (R + t/2).
    Source: Castigliano: bending, normal force and shear of a thin ring.
    """
    # By how much a ring under two loads becomes shorter, and wider, m.
    area, bending = YOUNG * THICKNESS, YOUNG * THICKNESS**3 / 12.0
    shear = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * THICKNESS
    cube = LOAD * RADIUS**3 / bending
    along, across = LOAD * RADIUS / area, LOAD * RADIUS / shear
    shorter = cube * (np.pi / 4.0 - 2.0 / np.pi) + np.pi / 4.0 * (along + across)
    exact = shorter, cube * (2.0 / np.pi - 0.5) - 0.5 * along + 0.5 * across
    lining = None
    for phase, segments, tolerance, why, where in (
        (0.5, SEGMENTS, 1e-2, KINK, "in segments"),
        (0.0, SEGMENTS, 1.3e-2, JOINT, "at joints"),
        (0.0, 2 * SEGMENTS, 4e-3, JOINT, "at joints, 96 segments"),
    ):
        run = settled(trial.variant, scene(phase, segments))
        for name, computed, value in zip(("shorter", "wider"), _motions(run), exact, strict=True):
            trial.relative(f"{name}, loads {where}", "m", computed, value, tolerance, why)
        lining = run.lining("ring") if segments == SEGMENTS else lining
    assert lining is not None
    moment, normal = lining.moment[-1], lining.normal_force[-1]
    top, side = LOAD * RADIUS / np.pi, -LOAD * RADIUS * (0.5 - 1.0 / np.pi)
    trial.relative("moment under a load", "N", float(moment.max()), top, 1e-2, MIDDLE)
    trial.relative("moment at a side", "N", float(moment.min()), side, 1e-2, MIDDLE)
    trial.relative("N at a side", "N/m", float(normal.min()), -0.5 * LOAD, 1e-2, MIDDLE)
    run = settled(trial.variant, pressed())
    around, angle = run.lining("ring"), 2.0 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    force = -PRESSURE * (RADIUS + 0.5 * THICKNESS)
    computed = float(around.normal_force[-1].mean())
    trial.relative("N under pressure", "N/m", computed, force, 5e-3, ROUND)
    displacements = np.array([run.history(f"at {k}").displacement[-1] for k in range(SEGMENTS)])
    inwards = float(
        (displacements * np.stack([np.cos(angle), np.sin(angle)], axis=1)).sum(axis=1).mean()
    )
    closed = force * RADIUS / (YOUNG * THICKNESS)
    trial.relative("u under pressure", "m", inwards, closed, 5e-3, ROUND)
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    labels = "along the ring from the right side, m", "moment, N"
    chart = trial.chart("moment along the ring", *labels)
    values = LOAD * RADIUS * (1.0 / np.pi - 0.5 * np.abs(np.cos(turn)))
    chart.exact("P R (1/π − |cos|/2)", RADIUS * turn, values)
    chart.computed(lining.along, moment)
