"""A rock that falls flat bounces to rest."""

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Trial, problem
from clast.verification.rocks import FLOOR, GRAVITY, PATHS, SQUARE, falling, picture, rock_at

FALL = 3.0
"""Height of the fall, m."""
RESTITUTIONS = (0.3, 0.5, 0.8)


@problem(
    set_up=lambda: picture([(-2, 0), (2, 0)], SQUARE, (0, 3.5)), variants=(PATHS,), quick=(PATHS,)
)
def rock_rest(trial: Trial) -> None:
    """Bounces to rest.

    A square of 1 m falls flat from 3 m. Rebounds slower than 1e-4 (g r)^1/2 are none, so rest comes
    a little before the sum of all bounces.

    Exact: t = (2 s/g)^1/2 (1 + R_n)/(1 - R_n); the height of the centroid is half the side.
    Source: sum of a geometric series.
    """
    for restitution in RESTITUTIONS:
        surface = {"normal_restitution": restitution, "friction_angle": 30.0}
        one = falling(FLOOR, surface, rock_at(SQUARE, (0, 0.5 + FALL))).follow(1)
        exact = np.sqrt(2.0 * FALL / GRAVITY) * (1 + restitution) / (1 - restitution)
        of, late = f"R_n = {restitution:g}", "slowest rebounds and first steps at rest"
        trial.relative(f"time of rest, {of}", "s", one.course.clock[0], exact, 2e-3, late)
        place = "the contact bears within 1e-9 of the radius"
        trial.absolute(f"height, {of}", "m", one.state[1], 0.5, 1e-8, place)
        is_at_rest = float(one.course.tally[2] == path.REST)
        trial.absolute(f"at rest, {of}", "", is_at_rest, 1.0, 0.0, "yes or no")
