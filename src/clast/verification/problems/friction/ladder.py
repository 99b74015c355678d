"""A ladder leans on a wall: the friction angle at which it slips.

With friction mu at floor and wall alike, both mobilised, equilibrium of a ladder with its foot at
(x, 0), its head at (0, y) and its centroid at a distance s from the wall asks for

    mu^2 s + mu y = x - s.

A thin ladder, s = x/2, slips where its angle with the floor is 90 degrees - 2 phi.
"""

from functools import partial

import numpy as np

from clast.verification.problems import Model, StaticRun, Trial, box, new_model, problem
from clast.verification.variants import EACH_PROCESS

LENGTH, WIDTH = 4.0, 0.2
"""Length and width of the ladder, m."""
ANGLES = (45.0, 55.0, 65.0)
"""Angles with the floor, degrees."""
SPAN = 2.0
"""Half of the range of the friction angle that is searched, degrees."""
STATIC = StaticRun(p=3e7, step=4e-3, steps=300)


def outline(angle: float, width: float = WIDTH) -> np.ndarray:
    """Return the corners (foot, back, head, front) of a ladder at ``angle``, degrees, m (4, 2)."""
    along = np.array([-np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    across = np.array([along[1], -along[0]])
    corners = np.array([0 * along, width * across, LENGTH * along + width * across, LENGTH * along])
    return corners - np.array([corners[:, 0].min(), corners[:, 1].min()])


def exact_limit(angle: float, width: float = WIDTH) -> float:
    """Return the friction angle at which a ladder slips, degrees, by its angle and width, m."""
    corners = outline(angle, width)
    foot = corners[np.argmin(corners[:, 1])]
    head = corners[np.argmin(corners[:, 0])]
    s = corners[:, 0].mean()
    roots = np.roots([s, head[1], s - foot[0]])
    return float(np.degrees(np.arctan(roots.max())))


def model_of_ladder(angle: float = ANGLES[1], friction_angle: float = 20.0) -> Model:
    """Return floor, wall and ladder; angles in degrees."""
    builder = new_model(
        "Ladder", gravity=9.8, young=10e9, density=600.0, poisson=0.3, friction_angle=friction_angle
    )
    builder.block(name="floor", vertices=box(0, -0.5, 5, 0), fixed=True)
    builder.block(name="wall", vertices=box(-0.5, -0.5, 0, 5), fixed=True)
    corners = outline(angle)
    builder.block(name="ladder", vertices=corners)
    builder.measured_point("centroid", corners.mean(axis=0), block="ladder")
    return builder.build()


@problem(set_up=model_of_ladder, variants=EACH_PROCESS, quick=())
def ladder(trial: Trial, angles: tuple[float, ...] = ANGLES) -> None:
    """Ladder against a wall.

    A ladder of 4 m x 0.2 m leans on a wall; the friction angle of floor and wall is bisected until
    it slips. p = 30 MPa, h = 4 ms, static (dynamic_ratio = 0).

    Exact: mu^2 s + mu y = x - s with foot (x, 0), head (0, y) and centroid s; thin: angle = 90
    degrees - 2 phi.
    Source: equilibrium with friction mobilised at both ends.
    """
    for angle in angles:
        exact, loaded = exact_limit(angle), partial(model_of_ladder, angle)
        angle_at_limit = STATIC.limit(trial.variant, loaded, exact - SPAN, exact + SPAN)
        quantity = f"friction angle at the limit, ladder at {angle:g} degrees"
        trial.absolute(quantity, "degrees", angle_at_limit, exact, 0.25, "bisected to 0.2 degrees")
    fine = np.linspace(40.0, 70.0, 31)
    labels = "angle of the ladder with the floor, degrees", "friction angle, degrees"
    chart = trial.chart("friction angle at the limit", *labels)
    chart.exact("equilibrium", fine, [exact_limit(angle) for angle in fine])
    chart.exact("thin: (90 - angle)/2", fine, 0.5 * (90.0 - fine))
    chart.computed(angles, trial.computed)
