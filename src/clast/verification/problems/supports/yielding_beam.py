"""A beam that is clamped at both ends and loaded in the middle collapses where hinges yield."""

from itertools import pairwise

import numpy as np

from clast.verification.problems import Model, Run, Trial, box, new_model, problem
from clast.verification.variants import CONVEX, OPEN_CLOSE, PASSES, Variant

HALF, WIDTH, HEIGHT = 2.0, 0.2, 0.2
"""Length of a half, width of the middle, height, m."""
MOMENT, STIFFNESS = 1e5, 1e8
"""Yield moment, N, and stiffness, N per rad, of each link."""
SPEED = 0.01
COLLAPSE = 4.0 * MOMENT / HALF
REASON = "small rotations; a static step at 10 mm/s has the momentum of the halves to bring up"


def scene(turns: int = 0, pieces: int = 1) -> Model:
    """Return the beam turned by quarter turns; its halves of so many pieces, rigidly linked."""
    builder = new_model(
        "Yielding beam", young=2e11, density=2500.0, poisson=0.0, friction_angle=0.0
    )
    end = 2.0 * HALF + WIDTH
    marks = [*np.linspace(0.0, HALF, pieces + 1), *np.linspace(HALF + WIDTH, end, pieces + 1)]
    builder.block(name="left", vertices=_box(-1.0, 0.0, 5.0, turns), fixed=True)
    names = ["left"]
    for k, (low, high) in enumerate(pairwise(marks)):
        names.append("middle" if k == pieces else f"piece {k}")
        builder.block(name=names[-1], vertices=_box(low, high, 1.0, turns))
    builder.block(name="right", vertices=_box(end, end + 1.0, 5.0, turns), fixed=True)
    names.append("right")
    hinges = {0.0, HALF, HALF + WIDTH, end}
    for k, x in enumerate(marks):
        yields = {"yield_moment": MOMENT} if x in hinges else {}
        at = _turned((x, 0.0), turns)
        free = {} if k == len(marks) - 1 else {"x": "rigid"}
        builder.link(
            at,
            blocks=(names[k + 1], names[k]),
            direction=_turned((1.0, 0.0), turns),
            y="rigid",
            rotation=STIFFNESS if yields else "rigid",
            contacts=False,
            name=f"at {k}",
            **yields,
            **free,
        )
    displacement = _turned((0.0, -SPEED), turns)
    axis = int(np.abs(displacement).argmax())
    builder.motion(name="press", block="middle", ease=0.1, **{"xy"[axis]: displacement[axis]})
    return builder.build()


def pressed(variant: Variant, turns: int = 0, pieces: int = 1) -> Run:
    """Return the run."""
    return variant.static(scene(turns, pieces), step=1e-2, end=1.2, p=1e10, max_displacement=0.01)


def _turned(point: tuple[float, float], turns: int) -> tuple[float, float]:
    """Return a point turned by quarter turns."""
    x, y = point
    for _ in range(turns % 4):
        x, y = -y, x
    return x, y


def _box(low: float, high: float, tall: float, turns: int) -> list[tuple[float, float]]:
    """Return the corners of a piece ``tall`` times as high as the beam, m."""
    y = 0.5 * tall * HEIGHT
    corners = box(low, -y, high, y)
    return [_turned((float(a), float(b)), turns) for a, b in corners]


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE, PASSES))
def yielding_beam(trial: Trial) -> None:
    """A clamped beam whose hinges yield.

    A beam of 4.2 m has links that yield at 100 kN at its ends and both sides of its middle, which
    is pushed down at 10 mm/s; static (dynamic_ratio = 0), h = 10 ms; also turned, and with halves
    of two pieces.

    Exact: P = 4 M_p/l.
    Source: plastic analysis: work of the mechanism.
    """
    runs = {
        "": pressed(trial.variant),
        ", turned": pressed(trial.variant, 1),
        ", in pieces": pressed(trial.variant, 0, 2),
    }
    for name, run in runs.items():
        load = float(np.hypot(*run.reaction("press").force[-1]))
        trial.relative(f"collapse load{name}", "N/m", load, COLLAPSE, 1e-2, REASON)
        moment = abs(float(np.asarray(run.link("at 0").moment)[-1]))
        trial.relative(f"moment at the end{name}", "N", moment, MOMENT, 1e-6, REASON)
    press = runs[""].reaction("press")
    chart = trial.chart("load and displacement of the middle", "displacement, mm", "load, kN/m")
    chart.exact("4 Mₚ/l", np.array([0.0, 11.5]), np.full(2, 1e-3 * COLLAPSE))
    chart.computed(
        1e3 * SPEED * np.maximum(press.time[1::4] - 0.05, 0.0), -1e-3 * press.force[1::4, 1]
    )
