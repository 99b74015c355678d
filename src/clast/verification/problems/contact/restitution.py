"""Impacts rebound with the restitution asked for."""

from dataclasses import replace

import numpy as np

from clast.verification.problems import InputBuilder, Model, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, Variant

YOUNG, DENSITY, GRAVITY = 5e9, 2500.0, 9.8
SPEED = 1.0
"""Speed at which squares meet, m/s."""
RESTITUTIONS = (0.0, 0.3, 0.5, 0.8, 1.0)
FIXED = np.inf
"""Mass of a fixed block."""
MASSES = (FIXED, 1.0, 1e-3, 1e3)
"""Mass of the block that is hit, in units of the other."""
STIFFNESSES = (1e-3, 0.1, 10.0)
"""p/E."""
STEPS = (2e-5, 1e-3, 1e-2)
"""Steps h, s."""
ARRIVALS = np.arange(10) / 10.0
"""Shares of a step at which they meet."""
ASKED = "asked for: 0.03; round-off is what it comes to"
ROW = 5
"""Squares in the row."""


def two_squares(gap: float = 0.1, mass: float = 1.0) -> Model:
    """Return a square that flies at another one, ``gap``, m, away and ``mass`` times as heavy."""
    builder = InputBuilder(title="Restitution", gravity=(0.0, 0.0))
    builder.add_rock("rock", young=YOUNG, poisson=0.2, density=DENSITY)
    density = DENSITY if mass == FIXED else mass * DENSITY
    builder.add_rock("other", young=YOUNG, poisson=0.2, density=density)
    flying = box(-1, 0, 0, 1)
    builder.block(name="flying", rock="rock", vertices=flying, velocity=(SPEED, 0.0, 0.0))
    hit = box(gap, 0, 1 + gap, 1)
    builder.block(name="hit", rock="other", vertices=hit, fixed=mass == FIXED)
    builder.measured_point("flying", (-0.5, 0.5), block="flying")
    builder.measured_point("hit", (gap + 0.5, 0.5), block="hit")
    return builder.build()


def rebounding(variant: Variant, restitution: float) -> Variant:
    """Return the variant with a restitution."""
    return replace(variant, process={**variant.process, "restitution": restitution})


def parting(
    variant: Variant, restitution: float, mass: float, stiffness: float, step: float, arrival: float
) -> float:
    """Return the speed at which two squares part, in units of that at which they meet."""
    model = two_squares(SPEED * step * (1.0 + arrival), mass)
    # Steps of which springs have the time to show themselves
    run = rebounding(variant, restitution).run(
        model, step=step, end=(20 + 2) * step, p=stiffness * YOUNG, max_displacement=0.1
    )
    flying, hit = (run.history(name).velocity[-1, 0] for name in ("flying", "hit"))
    return float(hit - flying) / SPEED


def height(variant: Variant, restitution: float, stiffness: float, step: float) -> float:
    """Return how high a square rebounds that falls from 1 m, m."""
    builder = new_model("Fall", gravity=GRAVITY, young=YOUNG, density=DENSITY)
    builder.block(name="ground", vertices=box(-3, -0.5, 3, 0), fixed=True)
    builder.block(name="square", vertices=box(-0.5, 1, 0.5, 2))
    builder.measured_point("square", (0.0, 1.5), block="square")
    fall = float(np.sqrt(2.0 / GRAVITY))
    end, p = (1.5 + restitution) * fall, stiffness * YOUNG
    bouncing = rebounding(variant, restitution)
    run = bouncing.run(builder.build(), step=step, end=end, p=p, max_displacement=0.1)
    history = run.history("square")
    landed = history.time > 1.02 * fall
    return float(1.0 + history.displacement[landed, 1].max())


def last_of_row(variant: Variant, gap: float) -> float:
    """Return the speed of the last square of a row that one hits with e = 1, as a share of its."""
    builder = new_model("Newton's cradle", young=YOUNG, density=DENSITY)
    for k in range(ROW + 1):
        x = k * (1.0 + gap) + (0.0 if k == 0 else 0.003)
        corners = box(x, 0, x + 1, 1)
        speed = SPEED if k == 0 else 0.0
        builder.block(name=str(k), vertices=corners, velocity=(speed, 0.0, 0.0))
        builder.measured_point(str(k), (x + 0.5, 0.5), block=str(k))
    run = rebounding(variant, 1.0).run(
        builder.build(), step=1e-3, end=0.05, p=YOUNG, max_displacement=0.1
    )
    return float(run.history(str(ROW)).velocity[-1, 0]) / SPEED


@problem(set_up=two_squares, variants=(CONVEX,), few=((FIXED, 1e3), STEPS[::2], (0.0, 0.55)))
def restitution(
    trial: Trial,
    masses: tuple[float, ...] = MASSES,
    steps: tuple[float, ...] = STEPS,
    arrivals: tuple[float, ...] = tuple(ARRIVALS),
) -> None:
    """Restitution.

    Squares of 1 m meet at 1 m/s without gravity: one hits a fixed one, or a free one of a mass from
    1/1000 to 1000 times its own; p from E/1000 to 10 E, h from 0.02 to 10 ms, ten moments of a
    step. One falls from 1 m, and one hits a row of five, in touch and apart.

    Exact: speed after = e x speed before; height of the rebound e^2 x 1 m; the last of the row
    leaves with the speed of the first (e = 1).
    Source: definition of the restitution; exchange of momentum between equal masses.
    Not run with: modified and open-close: they know no restitution, but rebound from their springs
    as in the problem bounce.
    """
    speeds_of: dict[float, list[float]] = {e: [] for e in RESTITUTIONS}
    for mass in masses:
        other = "a fixed square" if mass == FIXED else f"a free square, masses 1:{mass:g}"
        for e in RESTITUTIONS:
            speeds = np.array(
                [
                    parting(trial.variant, e, mass, stiffness, step, arrival)
                    for stiffness in STIFFNESSES
                    for step in steps
                    for arrival in arrivals
                ]
            )
            speeds_of[e].extend(speeds)
            worst = float(speeds[np.argmax(np.abs(speeds - e))])
            quantity = f"restitution {e:g}, {other}: the worst"
            trial.absolute(quantity, "", worst, e, 1e-6, ASKED)
    for e in (0.5, 1.0):
        heights = [
            height(trial.variant, e, stiffness, 1e-2)
            for stiffness in (STIFFNESSES[0], STIFFNESSES[-1])
        ]
        worst = max(heights, key=lambda one, e=e: abs(one - e**2))  # type: ignore[misc]
        reason = "heights are known at the ends of steps"
        trial.absolute(f"rebound from 1 m with {e:g}", "m", worst, e**2, 5e-3, reason)
    for gap in (0.0, 1e-4):
        quantity = f"speed of the last of {ROW} in a row, {1e3 * gap:g} mm apart"
        trial.absolute(quantity, "", last_of_row(trial.variant, gap), 1.0, 1e-6, "round-off")
    asked = np.repeat(RESTITUTIONS, [len(speeds_of[e]) for e in RESTITUTIONS])
    chart = trial.chart("speed of parting", "restitution", "speed after / speed before")
    chart.exact("e", (0.0, 1.0), (0.0, 1.0))
    chart.computed(asked, np.concatenate([speeds_of[e] for e in RESTITUTIONS]))
