"""The same path moved, mirrored, over a profile in pieces, and over blocks."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from clast.case.case_file import Case
from clast.trajectory import path
from clast.trajectory.campaign import Campaign
from clast.verification.problems import Floats, Trial, problem
from clast.verification.rocks import (
    PATHS,
    SURFACE,
    blows_of,
    falling,
    picture,
    regular,
    rock_at,
    turned,
)

PROFILE = np.array(
    [
        *[(0, 60.1), (20.3, 58.2), (30.7, 40), (45.1, 38.3), (50.9, 20.7), (52.3, 15.1)],
        *[(70.9, 10.3), (101.3, 0.7), (140.1, 0.3)],
    ]
)
START, VELOCITY, SPIN, TURN = np.array([18.1, 62.3]), np.array([4.0, 0.0]), 3.0, 0.4
GROUND = {"normal_restitution": 0.5, "tangential_restitution": 0.6, "friction_angle": 17.0}
BLOWS = 4
SHIFTS = ((64.3, -32.7), (4123.7, 1024.1))
"""Displacements, m."""
SHAPE = turned(regular(5), TURN)


def thrown(profile: Floats, start: Floats, shape: Floats, side: float = 1.0) -> Campaign:
    """Return a rock that is thrown to one side."""
    moves = {"velocity": (VELOCITY * [side, 1.0]).tolist(), "spin": side * SPIN}
    return falling(profile, GROUND, rock_at(shape, start, **moves))


def cut_up(profile: Floats, shares: tuple[float, ...] = (0.25, 0.5, 1.0)) -> Floats:
    """Return a profile with more points on its segments."""
    points = [profile[:1]]
    for one, other in pairwise(profile):
        points.append(one + np.array(shares)[:, None] * (other - one))
    return np.concatenate(points)


def over_blocks() -> Campaign:
    """Return the rock over fixed blocks, one below each segment."""
    content = thrown(PROFILE, START, SHAPE)
    blocks = [
        {"rock": SURFACE, "fixed": True, "vertices": [(x, -9.0), (u, -9.0), (u, v), (x, y)]}
        for (x, y), (u, v) in pairwise(PROFILE.tolist())
    ]
    moves = {"velocity": VELOCITY.tolist(), "spin": SPIN, "length": 1.0, "density": 2500.0}
    source = rock_at(SHAPE, START, name="rock", rocks=content.count, **moves)
    rock = {"young": 1e9, "poisson": 0.2, "density": 2500.0}
    tables = {"rockfall": {}, "surface": {SURFACE: GROUND}, "source": [source], "block": blocks}
    case = {"time": {"step": 1e-3, "end": 1.0}, "rock": {SURFACE: rock}, **tables}
    return Case.validated(case, "case").campaign()


def mirrored(points: Floats) -> Floats:
    """Return points with the other sign of x, in the other order."""
    return np.asarray(points[::-1] * [-1.0, 1.0])


WAYS: dict[str, Callable[[], Campaign]] = {
    "moved by 72 m": lambda: thrown(PROFILE + SHIFTS[0], START + SHIFTS[0], SHAPE),
    "moved by 4.2 km": lambda: thrown(PROFILE + SHIFTS[1], START + SHIFTS[1], SHAPE),
    "mirrored": lambda: thrown(mirrored(PROFILE), START * [-1, 1], mirrored(SHAPE), -1.0),
    "in 24 pieces": lambda: thrown(cut_up(PROFILE), START, SHAPE),
    "over blocks": over_blocks,
}


@problem(
    set_up=lambda: picture(PROFILE, SHAPE, START),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_moved(trial: Trial) -> None:
    """One path, however it is drawn.

    A pentagon falls down eight slopes, and the same moved, mirrored, over a profile with more
    points, and over fixed blocks in place of the profile. Compared are the times and, without
    their sides, the velocities of the first four blows: paths are chaotic, so that round-off is
    some 100 times larger after each blow.

    Exact: the same path.
    Source: invariance.
    """
    rows = blows_of(thrown(PROFILE, START, SHAPE).follow(1))[:BLOWS]
    reason = "round-off, larger by each blow"
    for way, make in WAYS.items():
        found = blows_of(make().follow(1))[:BLOWS]
        late = np.abs(found - rows)[:, path.CLOCK].max()
        moves = slice(path.AFTER, path.FACE)
        wrong = np.abs(np.abs(found[:, moves]) - np.abs(rows[:, moves])).max()
        limit = 1e-9 if "km" not in way else 1e-7
        trial.absolute(f"largest error of times, {way}", "s", late, 0.0, limit, reason)
        trial.absolute(f"of velocities, {way}", "m/s, rad/s", wrong, 0.0, 10 * limit, reason)
