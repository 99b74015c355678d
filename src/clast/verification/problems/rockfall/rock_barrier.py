"""A barrier takes its capacity, and holds rocks with less energy."""

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Trial, problem
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

SPEED = 20.0
ENERGY = 0.5 * DENSITY * SPEED**2
SHARES = (0.1, 0.4, 0.9, 2.0)
"""Capacity over the energy of the throw."""


@problem(
    set_up=lambda: picture([(-2, 0), (8, 0)], turned(SQUARE, 0.3), (0, 3)),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_barrier(trial: Trial) -> None:
    """Energy taken by a barrier.

    A square of 1 m is thrown at 20 m/s against a barrier with 0.1 to 2 times its energy as
    capacity. Compared is the speed behind it over that before, and whether it is held.

    Exact: (1 - C/E)^1/2, E the kinetic energy at the hit; held where C > E.
    Source: energy.
    """
    for share in SHARES:
        source = rock_at(turned(SQUARE, 0.3), (0, 3), velocity=[SPEED, 0.0])
        fence = {"name": "fence", "x": 5.0, "height": 4.0, "capacity": share * ENERGY}
        surface = {"normal_restitution": 0.5, "tangential_restitution": 0.5}
        one = falling(FLOOR, surface, source, barrier=[fence]).follow(1)
        hit = blows_of(one)
        hit = hit[hit[:, path.BARRIER] == 0.0][0]
        before, after = hit[path.BEFORE : path.AFTER], hit[path.AFTER : path.FACE]
        had = 0.5 * DENSITY * (before[0] ** 2 + before[1] ** 2 + before[2] ** 2 / 6.0)
        found = np.hypot(*after[:2]) / np.hypot(*before[:2])
        exact = np.sqrt(max(0.0, 1.0 - share * ENERGY / had))
        of, reason = f"C = {share:g} E of the throw", "round-off"
        trial.absolute(f"speed behind over before, {of}", "", found, exact, 1e-12, reason)
        held = float(one.course.tally[2] == path.HELD)
        trial.absolute(f"held, {of}", "", held, float(share > 1.0), 0.0, "yes or no")
        left = one.course.ledger[path.BY_BARRIERS] - min(share * ENERGY, had)
        trial.absolute(f"energy taken, {of}", "J", left, 0.0, 1e-6, reason)
