"""A rock slides down a slope, or up to rest, by the law of friction."""

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Floats, Trial, problem
from clast.verification.rocks import (
    GRAVITY,
    PATHS,
    SQUARE,
    blows_of,
    falling,
    picture,
    rock_at,
    turned,
)

SLOPES = ((30.0, 20.0), (25.0, 25.0), (10.0, 30.0))
"""Slope and friction angle, degrees."""
SPEED, WAY = 6.0, 4.0
"""Speed at the start, m/s, and way to the collector, m."""


def down(degrees: float) -> tuple[Floats, Floats]:
    """Return the unit vectors down a slope and out of it."""
    slope = np.radians(degrees)
    way = np.array([np.cos(slope), -np.sin(slope)])
    return way, np.array([-way[1], way[0]])


@problem(
    set_up=lambda: picture(
        [(-5, 5 * np.tan(np.pi / 6)), (5, -5 * np.tan(np.pi / 6))],
        turned(SQUARE, -np.pi / 6),
        0.5 * down(30.0)[1],
    ),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_slide(trial: Trial) -> None:
    """Sliding by the law of friction.

    A square of 1 m slides on a face at 6 m/s, on slopes of 30, 25 and 10 degrees with friction
    angles of 20, 25 and 30 degrees: it gets faster, keeps its speed, or stops. Compared are the
    square of the speed after 4 m, and the way to rest.

    Exact: v2 = v0^2 + 2 g s (sin a - cos a tan phi).
    Source: Coulomb's law.
    """
    for degrees, phi in SLOPES:
        way, out = down(degrees)
        slope, tan = np.radians(degrees), np.tan(np.radians(phi))
        start = (0.5 + 1e-9) * out
        shape = turned(SQUARE, -slope)
        source = rock_at(shape, start, velocity=(SPEED * way).tolist())
        surface = {"normal_restitution": 0.0, "friction_angle": phi}
        place = {"name": "4 m", "x": float(start[0] + WAY * way[0])}
        rocks = falling(np.array([-60 * way, 60 * way]), surface, source, collector=[place])
        one = rocks.follow(1)
        speed = one.course.passed[rocks.stations.index("4 m"), path.FAST]
        pull = 2.0 * GRAVITY * (np.sin(slope) - np.cos(slope) * tan)
        which = f"slope {degrees:g}, friction {phi:g} degrees"
        reason = "the first contact is a blow of 1e-9 m"
        exact = SPEED**2 + WAY * pull
        trial.relative(f"v2, {which}", "m2/s2", speed**2, exact, 2e-3, reason)
        if pull < 0.0 and len(blows_of(one)) < 100:
            run = float(np.hypot(*(one.state[:2] + rocks.origin - start)))
            trial.relative(f"way to rest, {which}", "m", run, -(SPEED**2) / pull, 1e-3, reason)
