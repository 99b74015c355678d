"""Circular openings of straight chords: equal area."""

import numpy as np

from clast.rockmass import Circle, Cut, JointSet, Opening, cut
from clast.verification.fixtures import CUT, areas, drawing_of, rectangle
from clast.verification.problems import Trial, problem

SIDE, CENTER, RADIUS = 8.0, (3.0, 4.0), 2.0
"""Side of the domain, centre and radius of the opening, m."""
CHORDS = (16, 32, 64)
"""Numbers of chords."""
ROUND_OFF = "round-off; corners lie on the exact outline"


def exact_factor(chords: int) -> float:
    """Return the radius of the corners over that of the circle."""
    return float(np.sqrt(2.0 * np.pi / (chords * np.sin(2.0 * np.pi / chords))))


def circle(chords: int) -> Circle:
    """Return the opening."""
    return Circle(center=CENTER, radius=RADIUS, chords=chords)


def factor(chords: int) -> float:
    """Return the radius that clast puts the corners at over that of the circle; their mean."""
    return float(np.hypot(*(circle(chords).corners("") - CENTER).T).mean()) / RADIUS


def around(chords: int) -> Cut:
    """Return the rock about the opening, cut by one set."""
    tunnel = Opening(name="tunnel", shape=circle(chords), excavated=True)
    bedding = JointSet(name="bedding", angle=10.0, spacing=1.0)
    return cut(rectangle(SIDE, SIDE), [bedding], openings=[tunnel])


@problem(
    set_up=lambda: drawing_of(around(16), "A circular opening of 16 chords"),
    variants=(CUT,),
    quick=(CUT,),
)
def chords(trial: Trial) -> None:
    """Circular openings of straight chords.

    A circular opening of radius 2 m with 16, 32 and 64 chords is void in rock of 8 m x 8 m with
    bedding.

    Exact: area of the opening pi r2; corners at r sqrt(2 pi/(n sin(2 pi/n))): 1.013002, 1.003222,
    1.000804 r.
    Source: area of a regular polygon.
    """
    void = np.pi * RADIUS**2
    for chords in CHORDS:
        at = f"with {chords} chords"
        exact = exact_factor(chords)
        quantity = f"radius of the corners over r {at}"
        trial.relative(quantity, "", factor(chords), exact, 1e-12, "formula")
        opened = SIDE**2 - float(areas(around(chords)).sum())
        trial.relative(f"area of the opening {at}", "m2", opened, void, 1e-9, ROUND_OFF)
    fine = list(range(6, 80))
    chart = trial.chart("corners of equal area", "chords n", "radius of the corners over r")
    chart.exact("equal area", fine, [exact_factor(n) for n in fine])
    chart.exact("inscribed", fine, np.ones(len(fine)))
    chart.computed(fine[::6], [factor(n) for n in fine[::6]])
