"""Goodman and Bray's toppling slope: the friction angle at which the toe gives way.

Sixteen columns lean on a stepped base.  Limit equilibrium goes from the top column to the toe:
column n is pushed by P(n) and pushes the next by the force it needs to stay, the larger of

    toppling   [P(n) (M - dx tan phi) + (W/2) (y sin a - dx cos a)] / L
    sliding    P(n) - W (cos a tan phi - sin a) / (1 - tan2 phi)

with its height y, weight W, the base dip a and the lever arms M and L of the two pushes.  The slope
is at its limit where the toe column just needs nothing more: tan phi = 0.7855, 38.15 degrees.
"""

import numpy as np
from scipy.optimize import brentq

from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, box, problem
from clast.verification.variants import EACH_PROCESS, LAGGED, Variant

DIP = np.radians(30.0)
"""Dip of the base planes; the columns lean by as much, rad."""
WIDTH, RISE = 10.0, 1.0
"""Width of a column and rise of the base between columns, m."""
COLUMNS, CREST = 16, 10
"""Number of columns, and the one at the crest, from the toe."""
STEP_OF_FACE, STEP_OF_TOP = 5.0, 5.0
"""Steps between the tops of columns below and above the crest, m."""
UNIT_WEIGHT, GRAVITY = 25e3, 9.81
STEP, DURATION, DAMPED = 5e-3, 2.5, 0.98
"""Step and duration, s, and share of velocity kept from step to step."""
WATCHED = 0.5
"""Time at the end over which the toe is watched, s."""
MOVING = 1e-4
"""A toe that moves further than this in the time watched has given way, m."""
LOWEST, HIGHEST, BISECTIONS = 36.0, 41.0, 4
"""Friction angles that the limit is sought between, degrees."""
AT_ONCE = "the weight comes at once and finds the joints without shear force; bisected to 0.3"
MODES = (3, 10, 3)
"""Columns that stay, topple and slide by limit equilibrium."""
SHOWN = 37.5
"""Friction angle at which the modes of failure are looked at, degrees."""


def height(column: int) -> float:
    """Return the height of a column from the toe, 1 to 16, m: 4 to 40 and down to 4."""
    if column <= CREST:
        return column * (STEP_OF_FACE - RISE)
    return height(CREST) - (column - CREST) * (STEP_OF_TOP + RISE)


def push_at_toe(friction: float) -> float:
    """Return the force that the toe column needs to stay, N/m, for tan phi = ``friction``."""
    push = needed = 0.0
    for column in range(COLUMNS, 0, -1):
        y = height(column)
        weight = UNIT_WEIGHT * WIDTH * y
        above = y - STEP_OF_TOP if column >= CREST else y
        below = y - STEP_OF_FACE if column <= CREST else y
        turning = 0.5 * weight * (y * np.sin(DIP) - WIDTH * np.cos(DIP))
        topple = (push * (above - WIDTH * friction) + turning) / below if below > 0.0 else -np.inf
        holds = np.cos(DIP) * friction - np.sin(DIP)
        needed = max(topple, push - weight * holds / (1.0 - friction**2))
        push = max(0.0, needed)
    return float(needed)


def limit_angle() -> float:
    """Return the friction angle of limit equilibrium, degrees."""
    return float(np.degrees(np.arctan(brentq(push_at_toe, 0.7, 0.85))))


def place(along: float, up: float) -> tuple[float, float]:
    """Return the coordinates of a point given along and perpendicular to the base, m."""
    cosine, sine = float(np.cos(DIP)), float(np.sin(DIP))
    return along * cosine - up * sine, along * sine + up * cosine


def slope(friction_angle: float = SHOWN) -> Model:
    """Return the stepped base and its columns; ``friction_angle`` in degrees."""
    builder = InputBuilder()
    build(builder, friction_angle)
    return builder.build()


def build(builder: InputBuilder, friction_angle: float) -> None:
    """Add the stepped base and its columns, each with a measured point, to a builder."""
    builder.title, builder.gravity = "Toppling slope", (0.0, -GRAVITY)
    builder.add_rock("rock", young=20e9, poisson=0.25, density=UNIT_WEIGHT / GRAVITY)
    builder.add_joint("default", friction_angle=friction_angle)
    right, high = COLUMNS * WIDTH, COLUMNS * RISE
    corners = [(-2 * WIDTH, -WIDTH), (right + 2 * WIDTH, -WIDTH), (right + 2 * WIDTH, high)]
    for column in range(COLUMNS, 0, -1):
        corners += [(column * WIDTH, column * RISE), ((column - 1) * WIDTH, column * RISE)]
    corners += [(0.0, 0.0), (-2 * WIDTH, 0.0)]
    builder.block(name="base", vertices=[place(*corner) for corner in corners], fixed=True)
    for column in range(1, COLUMNS + 1):
        left, low = (column - 1) * WIDTH, column * RISE
        top = low + height(column)
        outline = box(left, low, left + WIDTH, top)
        builder.block(name=str(column), vertices=[place(*corner) for corner in outline])
        middle = place(left + 0.5 * WIDTH, low + 0.5 * height(column))
        builder.measured_point(str(column), middle, block=str(column))


def loaded(friction_angle: float, variant: Variant) -> Run:
    """Return the run of the slope under its weight."""
    return variant.run(
        slope(friction_angle),
        step=STEP,
        end=DURATION,
        p=1e9,
        max_displacement=0.05,
        dynamic_ratio=DAMPED,
    )


def toe_movement(run: Run) -> float:
    """Return how far the toe moved in the time watched, m."""
    toe = run.history("1")
    watched = toe.displacement[toe.time >= DURATION - WATCHED]
    return float(np.hypot(*(watched[-1] - watched[0])))


def bracket(variant: Variant) -> tuple[list[float], list[float]]:
    """Return friction angles, degrees, and the toe's movement, m, while closing in on the limit."""
    low, high = LOWEST, HIGHEST
    angles: list[float] = []
    moved: list[float] = []
    for _ in range(BISECTIONS):
        angles.append(0.5 * (low + high))
        moved.append(toe_movement(loaded(angles[-1], variant)))
        low, high = (angles[-1], high) if moved[-1] > MOVING else (low, angles[-1])
    return [*angles, 0.5 * (low + high)], moved


def modes(run: Run) -> Floats:
    """Return how many columns stay, topple and slide.

    Those that stay move less than a hundredth of the largest movement; of the others those topple
    which turn by more than a tenth of the largest rotation.
    """
    names = [str(column) for column in range(1, COLUMNS + 1)]
    moved = np.array([np.hypot(*run.history(name).displacement[-1]) for name in names])
    turned = np.array([abs(run.history(name).rotation[-1]) for name in names])
    moves, turns = moved > 0.01 * moved.max(), turned > 0.1 * turned.max()
    return np.array([(~moves).sum(), (moves & turns).sum(), (moves & ~turns).sum()], float)


def failure(trial: Trial) -> None:
    """Compare how many columns stay, topple and slide."""
    counts = modes(loaded(SHOWN, trial.variant))
    for name, count, known in zip(("stay", "topple", "slide"), counts, MODES, strict=True):
        quantity = f"columns that {name} at {SHOWN:g} degrees"
        trial.absolute(quantity, "", count, known, 0.0, "a count")


@problem(set_up=slope, variants=EACH_PROCESS, quick=(LAGGED,), briefly=failure)
def toppling(trial: Trial) -> None:
    """Goodman and Bray's toppling slope.

    Sixteen columns of 10 m width and 4 to 40 m height on a stepped base that dips 30 degrees, slope
    92.5 m high, face at 56.6 degrees, 25 kN/m3, loaded by their weight at once; E = 20 GPa, p = 1
    GPa, h = 5 ms, dynamic_ratio 0.98, 2.5 s. The friction angle of all joints is bisected until the
    toe moves.

    Exact: tan phi = 0.7855 (38.15 degrees); columns 16 to 14 stay, 13 to 4 topple, 3 to 1 slide.
    Source: limit equilibrium of Goodman & Bray (1976), solved here.
    """
    angles, moved = bracket(trial.variant)
    exact = limit_angle()
    trial.absolute("friction angle at the limit", "degrees", angles[-1], exact, 1.0, AT_ONCE)
    labels = "friction angle, degrees", "movement, m"
    chart = trial.chart("movement of the toe in the last 0.5 s", *labels, log="y")
    chart.exact("limit equilibrium", (exact, exact), (1e-9, 1.0))
    chart.computed(angles[:-1], np.maximum(moved, 1e-9))
    failure(trial)
