"""A block slides over a surface that is cut into blocks."""

from functools import partial

import numpy as np

from clast.verification.problems import Model, Trial, box, new_model, problem
from clast.verification.variants import (
    CONVEX,
    CONVEX_MULTIPLIERS,
    LAGGED,
    MULTIPLIERS,
    OPEN_CLOSE,
    Variant,
)

GRAVITY, DENSITY = 9.8, 2500.0
YOUNG, STIFFNESS = 5e9, 2e8
"""Young's modulus, Pa, and p, N/m per m."""
LENGTH, HEIGHT = 0.8, 0.4
"""Sides of the block that slides, m."""
MASS = DENSITY * LENGTH * HEIGHT
START, TOTAL = 0.13, 4.8
"""Where the block begins on the surface, and how long that is, m."""
STEP = 1e-3
SPEED, TIME = 5.0, 0.6
SLOPE, FRICTION_ANGLE, SLIDING_TIME = 30.0, 20.0, 1.0
PUSH, STATIC_STEP, STATIC_TIME = 0.5 * MASS * GRAVITY, 5e-3, 8.0
SEARCHED = 1.0
"""Time from which the push is looked at, s; convex steps leap before, for an equilibrium."""
PRESSED_IN = MASS * GRAVITY / (2.0 * STIFFNESS)
"""Penetration of the block at rest on two corners, m."""
LOW = 0.9
"""Step that is not an obstacle, in units of this."""
PIECES, PUSHED_OVER = (1, 4, 16), 5
"""Numbers of blocks that the surface is cut into: for sliding, and for pushing."""
CLOSED, OPEN = 0.0, 0.01
"""Width of the joints, m."""
LAG = "friction that lags by a step"
ROUND = "the block is borne by other corners at each joint, and tilts by its penetration"


def rest_on(
    pieces: int,
    *,
    joint: float = CLOSED,
    loose: bool = False,
    slope: float = 0.0,
    friction_angle: float = 0.0,
    speed: float = 0.0,
    push: float = 0.0,
    rise: float = 0.0,
) -> Model:
    """Return a block on a surface of ``pieces`` blocks with open ``joint``s, m.

    They are fixed, or ``loose`` on a bed; the surface falls by ``slope``, degrees, to the right.
    The block moves along it at ``speed``, m/s, or is pushed with ``push``, N/m.  Every second piece
    is higher by ``rise``, m.
    """
    down = np.radians(slope)
    turn = np.array([[np.cos(down), np.sin(down)], [-np.sin(down), np.cos(down)]])

    def turned_box(x: float, y: float, width: float, height: float) -> np.ndarray:
        left, right, low, top = x, x + width, y, y + height
        return np.array(box(left, low, right, top)) @ turn.T

    builder = new_model(
        "Seams", gravity=GRAVITY, young=YOUNG, density=DENSITY, friction_angle=friction_angle
    )
    width = (TOTAL - (pieces - 1) * joint) / pieces
    for k in range(pieces):
        high = 0.5 + rise * (k % 2)
        outline = turned_box(k * (width + joint), -0.5, width, high)
        builder.block(name=f"piece {k + 1}", vertices=outline, fixed=not loose)
    if loose:
        builder.block(name="bed", vertices=turned_box(-1.0, -1.0, TOTAL + 2.0, 0.5), fixed=True)
    along = turn @ (1.0, 0.0)
    corners = turned_box(START, 0.0, LENGTH, HEIGHT)
    builder.block(name="block", vertices=corners, velocity=(*(speed * along), 0.0))
    middle = turn @ (START + 0.5 * LENGTH, 0.5 * HEIGHT)
    if push:
        low = turn @ (START + 0.5 * LENGTH, 0.05)
        builder.point_load(low, push * along, block="block")
    builder.measured_point("centroid", middle, block="block")
    return builder.build()


def distance_on(
    model: Model,
    variant: Variant,
    *,
    step: float,
    end: float,
    since: float = 0.0,
    dynamic_ratio: float = 1.0,
) -> float:
    """Return how far the block goes, m, from ``since`` to ``end``, s, in steps of ``step``, s."""
    run = variant.run(
        model, step=step, end=end, p=STIFFNESS, max_displacement=0.02, dynamic_ratio=dynamic_ratio
    )
    displacement = run.history("centroid").displacement
    return float(np.hypot(*(displacement[-1] - displacement[round(since / step)])))


def static_distance(model: Model, variant: Variant, since: float = 0.0) -> float:
    """Return how far the block is pushed from ``since``, s, on, m, each step beginning at rest."""
    return distance_on(
        model, variant, step=STATIC_STEP, end=STATIC_TIME, since=since, dynamic_ratio=0.0
    )


@problem(
    set_up=partial(rest_on, 4, speed=SPEED),
    variants=(LAGGED, MULTIPLIERS, OPEN_CLOSE, CONVEX, CONVEX_MULTIPLIERS),
    few=((4,),),
)
def seams(trial: Trial, pieces: tuple[int, ...] = PIECES) -> None:
    """Block on a surface that is cut into blocks.

    A block of 0.8 m x 0.4 m slides over a surface of 4.8 m that is one block, 4 or 16: without
    friction at 5 m/s, the blocks fixed with closed joints or loose on a bed with joints open by 10
    mm; down a slope of 30 degrees with phi = 20; and pushed with half its weight over steps of 0,
    0.9 and 5 of its penetration, each step of time beginning at rest. p = 0.2 GPa, h = 1 ms (5 ms).

    Exact: v t;  (g/2)(sin a - cos a tan phi) t2;  F h t/(2 m).
    Source: Newton's law with Coulomb friction: flush blocks are one surface.
    """
    for number in pieces:
        for name, joint, loose in (("", CLOSED, False), (", open joints, loose", OPEN, True)):
            model = rest_on(number, joint=joint, loose=loose, speed=SPEED)
            displacement = distance_on(model, trial.variant, step=STEP, end=TIME)
            quantity = f"displacement without friction, {number} blocks{name}"
            trial.relative(quantity, "m", displacement, SPEED * TIME, 1e-3, ROUND)
        model = rest_on(number, slope=SLOPE, friction_angle=FRICTION_ANGLE)
        displacement = distance_on(model, trial.variant, step=STEP, end=SLIDING_TIME)
        quantity = f"displacement down the slope, {number} blocks"
        # How far a block slides down the slope, m.
        a, phi = np.radians(SLOPE), np.radians(FRICTION_ANGLE)
        pull = GRAVITY * (np.sin(a) - np.cos(a) * np.tan(phi))
        trial.relative(quantity, "m", displacement, float(0.5 * pull * SLIDING_TIME**2), 5e-3, LAG)
    free = 0.5 * PUSH / MASS * STATIC_STEP * (STATIC_TIME - SEARCHED)
    edge = TOTAL / PUSHED_OVER - START - LENGTH
    steps = [(0.0, free, SEARCHED), (LOW, free, SEARCHED), (5.0, edge, 0.0)]
    if trial.variant in (MULTIPLIERS, CONVEX_MULTIPLIERS):
        del steps[1]  # they leave less penetration, so that this is a step already
    for share, exact, since in steps:
        model = rest_on(PUSHED_OVER, push=PUSH, rise=share * PRESSED_IN)
        quantity = f"displacement when pushed over a step of {share:g} penetrations"
        trial.relative(
            quantity, "m", static_distance(model, trial.variant, since), exact, 1e-3, ROUND
        )
