"""A block is drawn over a floor: the reaction is friction, and inertia while it gets faster."""

import numpy as np

from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

DENSITY, GRAVITY, ANGLE = 2500.0, 9.8, 30.0
WIDTH, HEIGHT = 2.0, 1.0
"""Block, m."""
SPEED, EASE, END, STEP = 0.5, 0.1, 0.3, 1e-3
MASS = DENSITY * WIDTH * HEIGHT
NORMAL = MASS * GRAVITY
FRICTION = NORMAL * float(np.tan(np.radians(ANGLE)))
PUSH = MASS * SPEED / EASE
PASSED = "four passes of the modified process leave 2e-6 of friction in steps of 2.5 ms"
ROUGH = "the block lands on its springs at first: the floor carries more than its weight, and less"
EXACT = "equations solved to 1e-10"


def scene(turns: int = 0, pieces: int = 1) -> Model:
    """Return block and floor, turned by so many quarter turns; the floor in so many pieces."""
    across = _turned((0.0, -GRAVITY), turns)
    builder = InputBuilder(title="Drawn block", gravity=(across[0], across[1]))
    builder.add_rock("stone", young=5e9, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=ANGLE)
    length = 12.0 / pieces
    for k in range(pieces):
        left = -4.0 + k * length
        builder.block(vertices=_box((left, -1.0), (length, 1.0), turns), fixed=True)
    builder.block(name="box", vertices=_box((0.0, 0.0), (WIDTH, HEIGHT), turns))
    displacement = _turned((SPEED, 0.0), turns)
    axis = int(np.abs(displacement).argmax())
    moves = {"xy"[axis]: displacement[axis]}
    builder.motion(name="winch", block="box", ease=EASE, **moves)
    return builder.build()


def pulled(variant: Variant, turns: int = 0, pieces: int = 1, step: float = STEP) -> Run:
    """Return the run."""
    return variant.run(scene(turns, pieces), step=step, end=END, p=5e9, max_displacement=0.02)


def along(run: Run, name: str, turns: int = 0) -> Floats:
    """Return a reaction over time as it is before the scene is turned, N/m, (t, 2)."""
    return np.array([_turned(force, -turns) for force in run.reaction(name).force])


def _turned(vector: tuple[float, float] | Floats, turns: int) -> tuple[float, float]:
    """Return a vector turned by quarter turns, to the last digit."""
    x, y = float(vector[0]), float(vector[1])
    for _ in range(turns % 4):
        x, y = -y, x
    return x, y


def _box(
    corner: tuple[float, float], size: tuple[float, float], turns: int
) -> list[tuple[float, float]]:
    """Return the corners of a turned rectangle, m."""
    (x, y), (w, h) = corner, size
    return [_turned(one, turns) for one in ((x, y), (x + w, y), (x + w, y + h), (x, y + h))]


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE, PASSES))
def drawn_block(trial: Trial) -> None:
    """A block that is drawn over a floor.

    A block of 2 x 1 m, 2500 kg/m3, phi = 30 degrees, is drawn at 0.5 m/s, eased over 0.1 s; also
    turned by a quarter, on a floor in pieces, and in other steps.

    Exact: R = mu N + m v/e while eased, mu N later.
    Source: Newton's second law and Coulomb's.
    """
    run = pulled(trial.variant)
    time = run.reaction("winch").time
    winch, floor = along(run, "winch"), along(run, "fixed blocks")
    eased = (time > 0.5 * STEP) & (time < EASE - 0.5 * STEP)
    later = time > EASE + 0.5 * STEP
    sums = (winch + floor)[:, 0]
    moved = run.vertices(-1)[-4:].mean(axis=0)[0] - 0.5 * WIDTH
    quantity = "R - mu N while eased, largest"
    trial.relative(quantity, "N/m", float(sums[eased].max()), PUSH, 1e-9, EXACT)
    trial.absolute("R - mu N later", "N/m", float(np.abs(sums[later]).max()), 0.0, 1e-5, EXACT)
    trial.relative("R at the end", "N/m", float(winch[-1, 0]), FRICTION, 1e-6, ROUGH)
    trial.relative("floor along", "N/m", float(floor[-1, 0]), -FRICTION, 1e-6, ROUGH)
    trial.relative("floor across", "N/m", float(floor[-1, 1]), NORMAL, 1e-6, ROUGH)
    quantity = "displacement beyond v (t - e/2)"
    trial.absolute(quantity, "m", moved - SPEED * (END - 0.5 * EASE), 0.0, 2e-12, EXACT)
    displacements = (("turned by 90 degrees", 1, 1, STEP), ("floor in 3 pieces", 0, 3, STEP))
    for name, turns, pieces, step in (*displacements, ("steps of 2.5 ms", 0, 1, 2.5e-3)):
        other = along(pulled(trial.variant, turns, pieces, step), "winch", turns)
        trial.relative(f"R, {name}", "N/m", float(other[-1, 0]), FRICTION, 1e-5, PASSED)
    corners = np.array([0.0, EASE, EASE, END])
    exact = np.array([FRICTION + PUSH, FRICTION + PUSH, FRICTION, FRICTION])
    chart = trial.chart("reaction of the winch", "time, s", "force, kN/m")
    chart.exact("μ N + m a", corners, 1e-3 * exact)
    chart.computed(time[1::4], 1e-3 * winch[1::4, 0])
