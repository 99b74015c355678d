"""A bar on a hinge, and two in a row: compound and double pendulum.

A bar of length L and height t hinged at the middle of its end has the period

    T = 2 pi sqrt(I/(m g L/2))

of small swings: I/m = (L2 + t2)/12 + (L/2)2 about the hinge.  Two equal bars in a row swing with
the frequencies w of det(K - w2 M) = 0,

    M = m [[L2/3 + L2 + t2/12, L2/2], [L2/2, L2/3 + t2/12]],    K = m g L [[3/2, 0], [0, 1/2]],

in each of which they stay if they begin in it.  No energy is lost.
"""

from __future__ import annotations

import numpy as np

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model
from clast.pictures.verification import Chart, curve, exact_curve
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import Comparison, Outcome, Problem, absolute, relative
from clast.verification.variants import CONVEX, IMPLICIT, OPEN_CLOSE, Variant

LENGTH, HEIGHT, GRAVITY, DENSITY = 1.0, 0.1, 9.8, 2500.0
"""Bars, m, m/s2, kg/m3."""
SMALL = 0.02
"""Angle at which they are let go, rad."""
STEP, SWINGS = 4e-3, 4
HUNG = "bars hung up at once swing along themselves: W2 L/(6 E A), and the step takes that"
REASON = "small swings: sin r = r - r^3/6, 1e-4; period from passes through 0"


def frequencies(bars: int) -> tuple[Floats, Floats]:
    """Return the circular frequencies (bars,), 1/s, and shapes (bars, bars), one a column."""
    own = LENGTH**2 / 3.0 + HEIGHT**2 / 12.0
    mass, stiffness = np.array([[own]]), np.array([[0.5 * GRAVITY * LENGTH]])
    if bars == 2:
        mass = np.array([[own + LENGTH**2, 0.5 * LENGTH**2], [0.5 * LENGTH**2, own]])
        stiffness = GRAVITY * LENGTH * np.diag([1.5, 0.5])
    squares, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    order = np.argsort(squares)
    return np.sqrt(squares[order]), shapes[:, order]


def scene(bars: int = 1, mode: int = 0, turn: float = 0.0) -> Model:
    """Return hanging bars in the shape of a mode, the whole turned by an angle, rad."""
    shape = frequencies(bars)[1][:, mode]
    angles = SMALL * shape / np.abs(shape).max()
    down = (GRAVITY * np.sin(turn), -GRAVITY * np.cos(turn))
    builder = InputBuilder(title="Hinges", gravity=down)
    builder.add_rock("steel", young=2e11, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=0.0)
    ground = [(20.0, 0.0), (21.0, 0.0), (21.0, 1.0), (20.0, 1.0)]
    builder.block(name="ground", vertices=ground, fixed=True)
    hinge, above = np.zeros(2), "ground"
    for k, angle in enumerate(angles + turn):
        along = np.array([np.sin(angle), -np.cos(angle)])
        across = 0.5 * HEIGHT * np.array([np.cos(angle), np.sin(angle)])
        end = hinge + LENGTH * along
        corners = [hinge - across, end - across, end + across, hinge + across]
        builder.block(name=f"bar {k}", vertices=[tuple(one) for one in corners])
        builder.link(tuple(hinge), blocks=(f"bar {k}", above), x="rigid", y="rigid", contacts=False)
        builder.measured_point(f"end {k}", tuple(end), block=f"bar {k}")
        hinge, above = end, f"bar {k}"
    return builder.build()


def swung(variant: Variant, bars: int, mode: int, turn: float = 0.0, step: float = STEP) -> Run:
    """Return the run over some swings."""
    end = (SWINGS + 0.5) * 2.0 * np.pi / float(frequencies(bars)[0][mode])
    model = scene(bars, mode, turn)
    method = variant.method(model, normal_stiffness=1e10, max_displacement=0.05)
    return simulate(model, method, Schedule(step=step, end=end, every=end))


def period(run: Run, bars: int, mode: int) -> float:
    """Return the mean period, s, from passes of the lowest end through the middle."""
    history = run.history(f"end {bars - 1}")
    shape = frequencies(bars)[1][:, mode]
    start = SMALL * float(shape[-1]) / float(np.abs(shape).max())
    angle, time = history.rotation + start, history.time
    at = np.flatnonzero(np.sign(angle[:-1]) * np.sign(angle[1:]) < 0)
    share = angle[at] / (angle[at] - angle[at + 1])
    passes = time[at] + share * (time[at + 1] - time[at])
    return 2.0 * float(passes[-1] - passes[0]) / (len(passes) - 1)


def examine(variant: Variant) -> Outcome:
    """Compare periods and energy."""
    rows: list[Comparison] = []
    cases = [("one bar", 1, 0, 0.0, STEP), ("two bars, first mode", 2, 0, 0.0, STEP)]
    cases += [("two bars, second mode", 2, 1, 0.0, STEP), ("one bar, turned", 1, 0, 0.7, STEP)]
    run = None
    for name, bars, mode, turn, step in (*cases, ("one bar, steps of 8 ms", 1, 0, 0.0, 8e-3)):
        found = swung(variant, bars, mode, turn, step)
        run = run or found
        exact = 2.0 * np.pi / float(frequencies(bars)[0][mode])
        rows.append(
            relative(f"period, {name}", "s", period(found, bars, mode), exact, 2e-3, REASON)
        )
        moved = float(np.asarray(found.energy.kinetic).max())
        lost = abs(float(np.asarray(found.energy.numerical)[-1])) / moved
        rows.append(absolute(f"energy lost, {name}", "-", lost, 0.0, 1e-3, HUNG))
    angle = run.history("end 0").rotation + SMALL if run else np.zeros(0)
    time = run.history("end 0").time if run else np.zeros(0)
    exact_angle = SMALL * np.cos(frequencies(1)[0][0] * time)
    chart = Chart(
        title="angle of one bar",
        x_label="time, s",
        y_label="angle, 1/1000",
        curves=(
            exact_curve("cos ω t", time, 1e3 * exact_angle),
            curve(variant.name, time[::40], 1e3 * angle[::40]),
        ),
    )
    return Outcome(tuple(rows), (chart,))


PROBLEM = Problem(
    name="hinges",
    title="Bars on hinges",
    text="Bars of 1 x 0.1 m hang on a hinge, one and two in a row, and swing by 0.02; h = 4 ms; "
    "also with everything turned, and in other steps.",
    formula="T = 2 pi sqrt(((L2 + t2)/12 + L2/4)/(g L/2)); det(K - w2 M) = 0",
    source="mechanics of rigid bodies",
    set_up=scene,
    examine=examine,
    variants=(CONVEX, OPEN_CLOSE, IMPLICIT),
    quick=(CONVEX,),
)
