"""Blocks squeezed slowly against a wall without weight: nothing strikes, both feel one force."""

from dataclasses import dataclass

import numpy as np

from clast.verification.fixtures import box, new_model
from clast.verification.problems import Model, Run, Trial, problem
from clast.verification.variants import CONVEX, MIDPOINT, OPEN_CLOSE

SPEED, EASE, END, LENGTH = 1e-3, 0.02, 0.1, 1.0
INERTIA = "the blocks move, by some ten-thousandths of the force"
SWINGS = (
    "blocks swing after the ease, which nothing damps; forces are those of half a step before, "
    "but of contacts that the longest steps leap over"
)
EXACT = "equations solved to 1e-7"


@dataclass(frozen=True, kw_only=True)
class Squeeze:
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
    Squeeze(name="one block"),
    Squeeze(name="steps of 0.5 ms", step=5e-4),
    Squeeze(name="steps of 20 ms", step=2e-2),
    Squeeze(name="restitution 0.5", restitution=0.5),
    Squeeze(name="three blocks", blocks=3),
    Squeeze(name="stiff", young=1e11),
    Squeeze(name="three soft blocks, restitution 0.5", blocks=3, young=1e8, restitution=0.5),
)


def scene(case: Squeeze = CASES[0]) -> Model:
    """Return press, blocks and wall."""
    builder = new_model("Slow press", young=case.young, density=2000.0, poisson=0.0)
    builder.add_joint(friction_angle=30.0, restitution=case.restitution)
    builder.block(name="press", vertices=box(-1.0, 0.0, 0.0, 1.0), fixed=True)
    each = LENGTH / case.blocks
    for k in range(case.blocks):
        builder.block(name=f"block {k}", vertices=box(k * each, 0.0, k * each + each, 1.0))
    builder.block(name="wall", vertices=box(LENGTH, 0.0, LENGTH + 1.0, 1.0), fixed=True)
    builder.motion(name="press", block="press", x=SPEED, ease=EASE)
    return builder.build()


def compare(trial: Trial, case: Squeeze, run: Run) -> None:
    """Compare forces and work of a run."""
    press, wall = run.reaction("press").force[-1, 0], run.reaction("fixed blocks").force[-1, 0]
    energy, halfway = run.state.ledger, trial.variant is MIDPOINT
    force = case.force(END - (0.5 * case.step if halfway else 0.0))
    store = 0.5 * case.force(END) * SPEED * (END - 0.5 * EASE)
    left = energy.motions - energy.stored - energy.numerical
    near, why = (0.05, SWINGS) if halfway else (1e-3, INERTIA)
    name, stored = case.name, energy.stored - energy.kinetic
    trial.relative(f"press, {name}", "N/m", float(press), force, near, why)
    trial.relative(f"wall, {name}", "N/m", -float(wall), float(press), near, why)
    trial.relative(f"stored, {name}", "J/m", stored, store, near, why)
    trial.absolute(f"work unaccounted, {name}", "J/m", left, 0.0, 1e-7 * store, EXACT)
    trial.absolute(f"lost in impacts, {name}", "J/m", energy.impacts, 0.0, 0.0, EXACT)


@problem(set_up=scene, variants=(CONVEX, MIDPOINT, OPEN_CLOSE))
def slow_press(trial: Trial) -> None:
    """A slow press on weightless blocks.

    A press of 1 mm/s, eased over 20 ms, squeezes a block of 1 x 1 m without weight against a wall;
    also three blocks, stiff and soft, with restitution, and in steps of 0.5 to 20 ms.

    Exact: F = v (t - e/2)/(L/(E H) + (n + 1)/(4 p)), of press and wall.
    Source: springs in a row, Newton's third law.
    Not run with: modified: contacts act only where a vertex has invaded before, a step late.
    """
    runs = [
        trial.variant.run(scene(case), step=case.step, end=END, p=case.young, max_displacement=0.01)
        for case in CASES
    ]
    for case, run in zip(CASES, runs, strict=True):
        compare(trial, case, run)
    press = runs[0].reaction("press")
    times = np.array([EASE, END])
    chart = trial.chart("force on the press", "time, s", "force, kN/m")
    chart.exact("F(t)", times, np.array([1e-3 * CASES[0].force(t) for t in times]))
    chart.computed(press.time[1:], 1e-3 * press.force[1:, 0])
