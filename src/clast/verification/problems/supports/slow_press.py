"""Blocks squeezed slowly against a wall without weight: nothing strikes, both feel one force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clast.pictures.verification import curve, exact_curve
from clast.verification.problem import Comparison, Trial, absolute, problem, relative
from clast.verification.problems import InputBuilder, Model, Run
from clast.verification.variants import CONVEX, MIDPOINT, OPEN_CLOSE, Variant

DENSITY, SPEED, EASE, END, LENGTH = 2000.0, 1e-3, 0.02, 0.1, 1.0
INERTIA = "the blocks move, by some ten-thousandths of the force"
SWINGS = (
    "blocks swing after the ease, which nothing damps; forces are those of half a step before, "
    "but of contacts that the longest steps leap over"
)
EXACT = "equations solved to 1e-7"


@dataclass(frozen=True, kw_only=True)
class Case:
    """Blocks in a press, and the steps in which they are squeezed."""

    name: str
    blocks: int = 1
    step: float = 2e-3
    young: float = 1e9
    restitution: float = 0.0

    def force(self, time: float) -> float:
        """Return the force on the press, N/m, once it has its velocity."""
        # the contacts are as stiff as the blocks, E of both
        give = LENGTH / self.young + (self.blocks + 1) / (4.0 * self.young)
        return SPEED * (time - 0.5 * EASE) / give


CASES = (
    Case(name="one block"),
    Case(name="steps of 0.5 ms", step=5e-4),
    Case(name="steps of 20 ms", step=2e-2),
    Case(name="restitution 0.5", restitution=0.5),
    Case(name="three blocks", blocks=3),
    Case(name="stiff", young=1e11),
    Case(name="three soft blocks, restitution 0.5", blocks=3, young=1e8, restitution=0.5),
)


def scene(case: Case = CASES[0]) -> Model:
    """Return press, blocks and wall."""
    builder = InputBuilder(title="Slow press", gravity=(0.0, 0.0))
    builder.add_rock("stone", young=case.young, poisson=0.0, density=DENSITY)
    builder.add_joint("default", friction_angle=30.0, restitution=case.restitution)
    builder.block(name="press", vertices=_box(-1.0, 1.0), fixed=True)
    each = LENGTH / case.blocks
    for k in range(case.blocks):
        builder.block(name=f"block {k}", vertices=_box(k * each, each))
    builder.block(name="wall", vertices=_box(LENGTH, 1.0), fixed=True)
    builder.motion(name="press", block="press", x=SPEED, ease=EASE)
    return builder.build()


def _box(left: float, wide: float) -> list[tuple[float, float]]:
    """Return a block of 1 m height."""
    return [(left, 0.0), (left + wide, 0.0), (left + wide, 1.0), (left, 1.0)]


def pressed(case: Case, variant: Variant) -> Run:
    """Return the run."""
    model = scene(case)
    return variant.run(
        model, step=case.step, end=END, normal_stiffness=case.young, max_displacement=0.01
    )


def rows_of(case: Case, run: Run, variant: Variant) -> list[Comparison]:
    """Return the comparisons of forces and work of a run."""
    press, wall = run.reaction("press").force[-1, 0], run.reaction("fixed blocks").force[-1, 0]
    energy, halfway = run.state.ledger, variant is MIDPOINT
    force = case.force(END - (0.5 * case.step if halfway else 0.0))
    store = 0.5 * case.force(END) * SPEED * (END - 0.5 * EASE)
    left = energy.motions - energy.stored - energy.numerical
    near, why = (0.05, SWINGS) if halfway else (1e-3, INERTIA)
    return [
        relative(f"press, {case.name}", "N/m", float(press), force, near, why),
        relative(f"wall, {case.name}", "N/m", -float(wall), float(press), near, why),
        relative(f"stored, {case.name}", "J/m", energy.stored - energy.kinetic, store, near, why),
        absolute(f"work unaccounted, {case.name}", "J/m", left, 0.0, 1e-7 * store, EXACT),
        absolute(f"lost in impacts, {case.name}", "J/m", energy.impacts, 0.0, 0.0, EXACT),
    ]


@problem(set_up=scene, variants=(CONVEX, MIDPOINT, OPEN_CLOSE), quick=(CONVEX,))
def slow_press(trial: Trial) -> None:
    """A slow press on weightless blocks.

    A press of 1 mm/s, eased over 20 ms, squeezes a block of 1 x 1 m without weight against a wall;
    also three blocks, stiff and soft, with restitution, and in steps of 0.5 to 20 ms.

    Exact: F = v (t - e/2)/(L/(E H) + (n + 1)/(4 p)), of press and wall.
    Source: springs in a row, Newton's third law.
    Not run with: modified: contacts act only where a vertex has invaded before, a step late.
    """
    runs = [(case, pressed(case, trial.variant)) for case in CASES]
    trial.rows += [row for case, run in runs for row in rows_of(case, run, trial.variant)]
    press = runs[0][1].reaction("press")
    times = np.array([EASE, END])
    trial.chart(
        "force on the press",
        "time, s",
        "force, kN/m",
        exact_curve("F(t)", times, np.array([1e-3 * CASES[0].force(t) for t in times])),
        curve(trial.variant.name, press.time[1:], 1e-3 * press.force[1:, 0]),
    )
