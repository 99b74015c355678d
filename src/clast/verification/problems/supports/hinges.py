"""A bar on a hinge, and two in a row: compound and double pendulum.

A bar of length L and height t hinged at the middle of its end has the period

    T = 2 pi sqrt(I/(m g L/2))

of small swings: I/m = (L2 + t2)/12 + (L/2)2 about the hinge.  Two equal bars in a row swing with
the frequencies w of det(K - w2 M) = 0,

    M = m [[L2/3 + L2 + t2/12, L2/2], [L2/2, L2/3 + t2/12]],    K = m g L [[3/2, 0], [0, 1/2]],

in each of which they stay if they begin in it.

Swinging loses no energy.  Bars that are hung up at once swing along themselves, and the first steps
take the energy of that, which is the one that hanging bars keep: a bar is strained evenly, by the
force N at its middle, and the hinge above it by H, so that it is

    sum of N2 L/(2 E A) + H2/(2 k).
"""

from dataclasses import dataclass

import numpy as np

from clast.verification.fixtures import box
from clast.verification.problems import Floats, InputBuilder, Model, Run, Trial, problem
from clast.verification.variants import CONVEX, LAGGED, OPEN_CLOSE, Variant

LENGTH, HEIGHT, GRAVITY, DENSITY = 1.0, 0.1, 9.8, 2500.0
"""Bars, m, m/s2, kg/m3."""
SMALL = 0.02
"""Angle at which they are let go, rad."""
YOUNG, STIFFNESS = 2e11, 1e10
"""Of bars, Pa, and of contacts, N/m per m."""
HUNG = "bars swing by 0.02: the force in them is less by cos r, and more by the spin, 4e-4"
KEPT = "periods are 2e-5 out: the bar is not quite at rest where its energy is compared"
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
    builder.add_rock("steel", young=YOUNG, poisson=0.2, density=DENSITY)
    builder.add_joint("default", friction_angle=0.0)
    builder.block(name="ground", vertices=box(20.0, 0.0, 21.0, 1.0), fixed=True)
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


def hung(bars: int, stiffness: float) -> float:
    """Return the energy that hanging bars and hinges of a stiffness, N/m per m, keep, J/m."""
    weight, below = DENSITY * GRAVITY * LENGTH * HEIGHT, np.arange(bars)
    strained = ((below + 0.5) * weight) ** 2 * LENGTH / (2.0 * YOUNG * HEIGHT)
    return float(np.sum(strained + ((below + 1.0) * weight) ** 2 / (2.0 * stiffness)))


@dataclass(frozen=True, kw_only=True)
class SwingingBars:
    """Bars in a mode, and how they are followed."""

    name: str
    bars: int = 1
    mode: int = 0
    turn: float = 0.0
    swings: int = 4
    steps: int = 200
    """Steps in a swing."""

    @property
    def swing(self) -> float:
        """Period, s."""
        return 2.0 * np.pi / float(frequencies(self.bars)[0][self.mode])

    def run(self, variant: Variant) -> Run:
        """Return the run over the swings, and half of one more."""
        step, end = self.swing / self.steps, (self.swings + 0.5) * self.swing
        model = scene(self.bars, self.mode, self.turn)
        return variant.run(model, step=step, end=end, p=STIFFNESS, max_displacement=0.05)


CASES = (
    SwingingBars(name="one bar"),
    SwingingBars(name="two bars, first mode", bars=2),
    SwingingBars(name="two bars, second mode", bars=2, mode=1),
    SwingingBars(name="one bar, turned", turn=0.7),
    SwingingBars(name="one bar, 400 steps a swing", steps=400),
)


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


def compare(trial: Trial, case: SwingingBars, run: Run) -> None:
    """Compare period and energy of a run."""
    name, lost = case.name, np.asarray(run.energy.numerical)
    first, last = case.steps, case.swings * case.steps
    model = scene(case.bars, case.mode, case.turn)
    hinge = trial.variant.method(model, p=STIFFNESS, max_displacement=0.05).fixed_point_stiffness
    energy, most = hung(case.bars, hinge), float(np.asarray(run.energy.kinetic).max())
    kept = (float(lost[last]) - float(lost[first])) / most
    computed = period(run, case.bars, case.mode)
    trial.relative(f"period, {name}", "s", computed, case.swing, 2e-3, REASON)
    trial.relative(f"lost by hanging, {name}", "J/m", float(lost[first]), energy, 0.02, HUNG)
    trial.absolute(f"lost in {case.swings} swings, {name}", "-", kept, 0.0, 1e-6, KEPT)


@problem(set_up=scene, variants=(CONVEX, OPEN_CLOSE, LAGGED))
def hinges(trial: Trial) -> None:
    """Bars on hinges.

    Bars of 1 x 0.1 m hang on a hinge, one and two in a row, and swing by 0.02, in 200 steps a
    swing; also with everything turned, and in other steps.

    Exact: T = 2 pi sqrt(((L2 + t2)/12 + L2/4)/(g L/2)); det(K - w2 M) = 0; no energy lost.
    Source: mechanics of rigid bodies.
    """
    runs = [case.run(trial.variant) for case in CASES]
    for case, run in zip(CASES, runs, strict=True):
        compare(trial, case, run)
    history = runs[0].history("end 0")
    time, angle = history.time[::20], history.rotation[::20] + SMALL
    exact_angle = SMALL * np.cos(2.0 * np.pi / CASES[0].swing * time)
    chart = trial.chart("angle of one bar", "time, s", "angle, 1/1000")
    chart.exact("cos ω t", time, 1e3 * exact_angle)
    chart.computed(time, 1e3 * angle)
