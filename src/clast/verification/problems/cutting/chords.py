"""Circular openings of straight chords: equal area.

A regular polygon of n corners at the radius R has the area n/2 R2 sin(2 pi/n), less than its
circle.  clast moves the corners out to R = r sqrt(2 pi/(n sin(2 pi/n))), so that the opening has
the area of the circle of the radius r that is asked for.
"""

from __future__ import annotations

import numpy as np

from clast.model.model import Model
from clast.pictures.verification import Chart, curve, exact_curve
from clast.rockmass import Circle, Cut, JointSet, Opening, cut
from clast.verification.cut_blocks import CUT, areas, drawing_of, rectangle
from clast.verification.problem import Comparison, Outcome, Problem, relative
from clast.verification.variants import Variant

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


def examine(variant: Variant) -> Outcome:
    """Compare the radius of the corners, and the rock that is left about the opening."""
    rows: list[Comparison] = []
    void = np.pi * RADIUS**2
    for chords in CHORDS:
        at = f"with {chords} chords"
        exact = exact_factor(chords)
        rows.append(
            relative(
                f"radius of the corners over r {at}", "", factor(chords), exact, 1e-12, "formula"
            )
        )
        found = SIDE**2 - float(areas(around(chords)).sum())
        rows.append(relative(f"area of the opening {at}", "m2", found, void, 1e-9, ROUND_OFF))
    fine = list(range(6, 80))
    chart = Chart(
        title="corners of equal area",
        x_label="chords n",
        y_label="radius of the corners over r",
        curves=(
            exact_curve("equal area", fine, [exact_factor(n) for n in fine]),
            exact_curve("inscribed", fine, np.ones(len(fine))),
            curve(variant.name, fine[::6], [factor(n) for n in fine[::6]]),
        ),
    )
    return Outcome(tuple(rows), (chart,))


def _drawing() -> Model:
    return drawing_of(around(16), "A circular opening of 16 chords")


PROBLEM = Problem(
    name="chords",
    title="Circular openings of straight chords",
    text="A circular opening of radius 2 m with 16, 32 and 64 chords is void in rock of 8 m x 8 m "
    "with bedding.",
    formula="area of the opening pi r2; corners at r sqrt(2 pi/(n sin(2 pi/n))): 1.013002, "
    "1.003222, 1.000804 r",
    source="area of a regular polygon",
    set_up=_drawing,
    examine=examine,
    variants=(CUT,),
    quick=(CUT,),
)
