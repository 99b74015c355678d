"""A corner of a rock strikes a floor: an oblique, eccentric blow with friction.

With a, b, c the inverse masses of the contact along the normal, across, and along the tangent, the
impulses N and T change its velocities by a N + b T and b N + c T.  N gives the normal velocity
-R_n u_n, T the share 1 - R_t of the impulse that stops
the slip, at most N tan(phi).
"""

from collections.abc import Sequence
from itertools import product

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Floats, Trial, problem
from clast.verification.rocks import (
    DENSITY,
    FLOOR,
    PATHS,
    SQUARE,
    blows_of,
    falling,
    picture,
    rock_at,
    turned,
)

GAP, SPEED = 0.002, 4.0
"""Gap of the lowest corner, m, and speed of falling, m/s."""
GRID = ((8, 30, 44), (0, 6, -6), (0, 6, -6), (0.0, 0.35, 0.8), (0, 20, 45))
"""Angle of the rock, degrees, velocity, m/s, spin, rad/s, restitution, friction angle, degrees."""
ROUND_OFF = "round-off of the touch"


def exact_blow(
    masses: tuple[float, float],
    arm: Floats,
    velocity: Sequence[float],
    normal: float,
    tan: float,
    tangential: float = 0.0,
) -> Floats:
    """Return velocity and spin after a blow on a level floor; ``masses`` are m and I."""
    (mass, inertia), (rx, ry), (u, v, w) = masses, arm, velocity
    vn, vt, share = v + w * rx, u - w * ry, 1.0 - tangential
    a, b = 1.0 / mass + rx * rx / inertia, -rx * ry / inertia
    c = 1.0 / mass + ry * ry / inertia
    gain, slip = -(1.0 + normal) * vn, -vt
    root = a * c - share * b * b
    n, t = (c * gain - share * b * slip) / root, share * (a * slip - b * gain) / root
    if abs(t) > tan * n:
        for sign in (1.0, -1.0):
            n = gain / (a + b * sign * tan)
            t = sign * tan * n
            if n > 0.0 and sign * (vt + b * n + c * t) <= 1e-12:
                break
    return np.array([u + t / mass, v + n / mass, w + (rx * n - ry * t) / inertia])


def exact_touch(degrees: float, spin: float) -> tuple[float, Floats]:
    """Return the time at which the lowest corner touches, s, and its place about the centroid."""
    radius, lowest = np.sqrt(0.5), np.radians(225.0 + degrees)
    low, high = 0.0, 0.1
    for _ in range(100):
        time = 0.5 * (low + high)
        height = GAP - SPEED * time + radius * (np.sin(lowest + spin * time) - np.sin(lowest))
        low, high = (time, high) if height > 0.0 else (low, time)
    angle = lowest + spin * low
    return low, radius * np.array([np.cos(angle), np.sin(angle)])


@problem(
    set_up=lambda: picture([(-2, 0), (2, 0)], turned(SQUARE, np.radians(30)), (0, 0.75)),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_impact(trial: Trial) -> None:
    """Blow of a rock's corner on a floor.

    A square of 1 m falls on a corner at 4 m/s, turned by 8, 30 and 44 degrees, with velocities
    along the floor of 0 and 6 m/s to both sides, spins of 0 and 6 rad/s, R_n = 0, 0.35, 0.8 and
    friction angles of 0, 20 and 45 degrees: 243 blows. Compared are the largest errors.

    Exact: a N + b T = -(1 + R_n) u_n; T stops the slip, or |T| = N tan(phi) against it.
    Source: planar impact of a rigid body with Newton's restitution (Routh 1905).
    """
    worst = np.zeros(2)
    masses = (DENSITY, DENSITY / 6.0)
    for degrees, u, w, normal, phi in product(*GRID):
        time, arm = exact_touch(degrees, w)
        shape = turned(SQUARE, np.radians(degrees))
        moves = {"velocity": [float(u), -SPEED], "spin": float(w)}
        source = rock_at(shape, (0.0, GAP - shape[:, 1].min()), **moves)
        surface = {"normal_restitution": normal, "friction_angle": float(phi)}
        table = {"time_limit": 2.0 * time}
        rocks = falling(FLOOR, surface, source, 0.0, rockfall=table)
        blow = blows_of(rocks.follow(1))[0]
        exact = exact_blow(masses, arm, (u, -SPEED, w), normal, np.tan(np.radians(phi)))
        after = blow[path.AFTER : path.FACE]
        worst = np.maximum(worst, [abs(blow[path.CLOCK] - time), np.abs(after - exact).max()])
    trial.absolute("largest error of the time", "s", worst[0], 0.0, 1e-11, ROUND_OFF)
    trial.absolute("largest error of velocities", "m/s, rad/s", worst[1], 0.0, 1e-9, ROUND_OFF)
