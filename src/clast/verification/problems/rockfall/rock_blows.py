"""A rock strikes a level, a falling and a rising slope: four blows by an integration of its own."""

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Floats, Trial, problem
from clast.verification.problems.rockfall.rock_impact import exact_blow
from clast.verification.rocks import (
    DENSITY,
    GRAVITY,
    PATHS,
    SQUARE,
    blows_of,
    falling,
    picture,
    rock_at,
    turned,
)

PROFILE = np.array([(0.0, 10.0), (10.0, 10.0), (25.0, 2.0), (125.0, 22.0)])
START, TURN = np.array([2.0, 14.0, 0.3, 14.0, 0.0, 1.0]), 0.3
"""Place, m, angle, rad, velocity, m/s, and spin, rad/s."""
BLOWS = 4
SURFACES = ((0.5, 0.0, 20.0), (0.5, 0.7, 60.0), (0.35, 0.85, 25.0))
"""R_n, R_t and friction angle, degrees."""
FINE = 1e-4
"""Interval in which a touch is looked for, s."""


def after(state: Floats, time: float) -> Floats:
    """Return the state after free flight."""
    pull = np.array([0.0, -GRAVITY])
    place = state[:2] + time * state[3:5] + 0.5 * time**2 * pull
    speed = state[3:5] + time * pull
    return np.array([*place, state[2] + time * state[5], *speed, state[5]])


def heights(state: Floats) -> Floats:
    """Return the heights of the four corners above the profile, m."""
    x, y = (state[:2] + turned(SQUARE, state[2])).T
    return np.asarray(y - np.interp(x, *PROFILE.T))


def exact_path(normal: float, tangential: float, tan: float) -> Floats:
    """Return time, velocity and spin after each blow, (BLOWS, 4)."""
    state, clock, rows = START, 0.0, []
    for _ in range(BLOWS):
        time = 1e-6
        while heights(after(state, time)).min() > 0.0:
            time += FINE
        low, high = time - FINE, time
        for _ in range(60):
            middle = 0.5 * (low + high)
            above = heights(after(state, middle)).min() > 0.0
            low, high = (middle, high) if above else (low, middle)
        there = after(state, low)
        corner = turned(SQUARE, there[2])[heights(there).argmin()]
        k = np.searchsorted(PROFILE[:, 0], there[0] + corner[0]) - 1
        slope = float(np.arctan2(*(PROFILE[k + 1] - PROFILE[k])[::-1]))
        along = [*turned(there[None, 3:5], -slope)[0], there[5]]
        arm = turned(corner[None], -slope)[0]
        moves = exact_blow((DENSITY, DENSITY / 6.0), arm, along, normal, tan, tangential)
        state = np.array([*there[:3], *turned(moves[None, :2], slope)[0], moves[2]])
        clock += low
        rows.append([clock, *state[3:]])
    return np.array(rows)


@problem(
    set_up=lambda: picture(PROFILE, turned(SQUARE, TURN), START[:2]),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_blows(trial: Trial) -> None:
    """Four blows on three slopes.

    A square of 1 m thrown at 14 m/s falls on a level slope, on one that falls and on one that
    rises, with friction alone and with R_t = 0.7 and 0.85. Compared are times and velocities of
    its first four blows, as in the first verification of RocFall but with a rigid rock in place
    of a point.

    Exact: parabola and constant spin up to the touch, bisected, of the corner that is deepest;
    the blow as in rock-impact.
    Source: independent integration.
    """
    chart = trial.chart("velocity after blows", "time, s", "m/s")
    for normal, tangential, phi in SURFACES:
        surface = {"normal_restitution": normal, "friction_angle": phi}
        surface["tangential_restitution"] = tangential
        moves = {"velocity": START[3:5].tolist(), "spin": float(START[5])}
        source = rock_at(turned(SQUARE, TURN), START[:2], **moves)
        rows = blows_of(falling(PROFILE, surface, source).follow(1))[:BLOWS]
        exact = exact_path(normal, tangential, float(np.tan(np.radians(phi))))
        late = np.abs(rows[:, path.CLOCK] - exact[:, 0]).max()
        wrong = np.abs(rows[:, path.AFTER : path.FACE] - exact[:, 1:]).max()
        which = f"R_n = {normal:g}, R_t = {tangential:g}"
        reason = "round-off, larger by each blow"
        trial.absolute(f"largest error of times, {which}", "s", late, 0.0, 1e-9, reason)
        trial.absolute(f"largest error of velocities, {which}", "m/s", wrong, 0.0, 1e-7, reason)
        chart.exact(f"vertical, {which}", exact[:, 0], exact[:, 2])
        chart.computed(rows[:, path.CLOCK], rows[:, path.AFTER + 1], which)
