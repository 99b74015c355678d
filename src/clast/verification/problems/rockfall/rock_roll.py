"""Polygons roll down a slope from blow to blow; a round rock against its resistance.

A regular polygon of n corners that turns about one of them strikes with the next.  After a plastic
blow its spin is k w, k = (I + m r2 cos(2 pi/n))/(I + m r2); from blow to blow its centroid falls by
the edge times sin a.
"""

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Trial, problem
from clast.verification.problems.rockfall.rock_slide import down
from clast.verification.rocks import (
    GRAVITY,
    PATHS,
    blows_of,
    falling,
    picture,
    regular,
    rock_at,
    turned,
)

SLOPE, RADIUS, SPIN = np.radians(10.0), 0.5, 2.0
POLYGONS, BLOWS = (6, 8, 16), 6
ARM, ROUND, WAY = 0.04, 240, 2.0
"""Moment arm of rolling resistance, m, corners of the round rock, and its way, m."""
CLEAR = 1e-9
"""Height of the fall to the first contact, m."""


@problem(
    set_up=lambda: picture(
        np.array([-3 * down(10.0)[0], 3 * down(10.0)[0]]),
        turned(regular(8), -SLOPE),
        RADIUS * np.cos(np.pi / 8) * down(10.0)[1],
    ),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_roll(trial: Trial) -> None:
    """Rolling of polygons and of a round rock.

    Regular polygons of 6, 8 and 16 corners, r = 0.5 m, R_n = 0 and no slip, roll down a slope of
    10 degrees from a spin of 2 rad/s: the spin after six blows. One of 240 corners rolls over 2 m
    with a rolling resistance of 0.04 m.

    Exact: w'2 = k2 (w2 + 2 m g l sin a/(I + m r2)), l the edge; round: v2 = v0^2 + 2 s 2/3 g
    (sin a - cos a d/r).
    Source: angular momentum about the corner that is struck.
    """
    way, out = down(10.0)
    surface = {"normal_restitution": 0.0, "friction_angle": 89.9}
    line = np.array([-5 * way, 30 * way])
    for count in POLYGONS:
        shape = turned(regular(count, RADIUS), -SLOPE)
        moves = -SPIN * np.array([-shape[0, 1], shape[0, 0]])
        start = (RADIUS * np.cos(np.pi / count) + CLEAR) * out
        source = rock_at(shape, start, velocity=(-moves).tolist(), spin=-SPIN)
        one = falling(line, surface, source).follow(1)
        mass, inertia, _ = one.rock.numbers
        about = inertia + mass * RADIUS**2
        share = (inertia + mass * RADIUS**2 * np.cos(2.0 * np.pi / count)) / about
        edge = 2.0 * RADIUS * np.sin(np.pi / count)
        square = SPIN**2
        for _ in range(BLOWS):
            square = share**2 * (square + 2.0 * mass * GRAVITY * edge * np.sin(SLOPE) / about)
        rows = blows_of(one)
        found = -rows[rows[:, path.LOST] > 1.0][BLOWS - 1, path.AFTER + 2]
        quantity = f"spin after {BLOWS} blows, n = {count}"
        trial.relative(quantity, "rad/s", found, np.sqrt(square), 1e-4, "steps of second order")
    shape = turned(regular(ROUND, RADIUS), -SLOPE)
    start = (RADIUS * np.cos(np.pi / ROUND) + CLEAR) * out
    source = rock_at(shape, start, velocity=way.tolist(), spin=-1.0 / RADIUS)
    place = {"name": "2 m", "x": float(start[0] + WAY * way[0])}
    resists = {**surface, "rolling_resistance": ARM}
    rocks = falling(line, resists, source, collector=[place])
    speed = rocks.follow(1).course.passed[rocks.stations.index("2 m"), path.FAST]
    pull = 2.0 / 3.0 * GRAVITY * (np.sin(SLOPE) - np.cos(SLOPE) * ARM / RADIUS)
    exact, reason = 1.0 + 2.0 * WAY * pull, "blows of 240 corners"
    trial.relative("v2 of a round rock", "m2/s2", speed**2, exact, 0.05, reason)
