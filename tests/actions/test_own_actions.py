"""Actions written in plain NumPy, outside of the package: in all processes, the ledger closed."""

from dataclasses import dataclass

import numpy as np
import pytest

import clast
from clast.actions.action import (
    ActionResult,
    Contribution,
    Solution,
    StepStart,
    energy_of_linear,
)
from clast.errors import CaseError, ModelError
from clast.model.model import Model
from clast.model.state import Ledger
from scenes.ledgers import assert_closed

RATE = 40.0


@dataclass(frozen=True)
class Tether:
    """A linear spring from the centroid of a block to where that was at the start."""

    block: str
    stiffness: float

    def begin(self, model: Model) -> None:
        return None

    def contribution(self, start: StepStart, state: None) -> Contribution:
        k, (number, way) = self.stiffness, self._stretched(start)
        force, stiffness = np.zeros((1, 6)), np.zeros((1, 6, 6))
        force[0, :2] = -k * way
        stiffness[0, [0, 1], [0, 1]] = k
        return Contribution(block=np.array([number]), force=force, stiffness=stiffness)

    def finish(
        self, start: StepStart, state: None, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        work, stored = energy_of_linear(contribution, solution.displacement)
        return ActionResult(work=work, ledger=Ledger(actions=stored))

    def _stretched(self, start: StepStart) -> tuple[int, np.ndarray]:
        number = start.model.block_name.index(self.block)
        first = start.model.block_start[number : number + 2]
        outline = start.model.vertices[first[0] : first[1]]
        return number, start.frames.centroid[number] - outline.mean(axis=0)


def swinging(*actions: object, friction_angle: float = 0.0) -> clast.ModelBuilder:
    """A square on a floor."""
    builder = clast.ModelBuilder(gravity=(0.0, -10.0))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=friction_angle, allow_small_friction_angle=True)
    builder.block(vertices=[(-5, -1), (5, -1), (5, 0), (-5, 0)], name="floor", fixed=True)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)], name="box", velocity=(2.0, 0.0, 0.0))
    builder.actions += actions
    return builder


PROCESSES = [("modified", 2e7), ("open-close", 2e7), ("convex", 1e9)]


@pytest.mark.slow
@pytest.mark.parametrize(("process", "stiffness"), PROCESSES)
def test_a_spring_of_ones_own_swings(process: str, stiffness: float):
    """The box slides without friction as a mass on a spring: x = v/w sin(w t)."""
    tether = Tether("box", 2500.0 * RATE**2)
    builder = swinging(tether)
    run = clast.simulate(
        builder,
        end=0.1,
        step=2e-4,
        process=process,
        contact_law={"name": "penalty", "normal_stiffness": stiffness},
    )
    x = run.final.vertices[4, 0] - run.model.vertices[4, 0]
    # forces act as they are at the end of a step, which damps by w^2 h t/4 = 0.8 %
    damping = np.exp(-(RATE**2) * 2e-4 * 0.1 / 4.0)
    assert x == pytest.approx(damping * 2.0 / RATE * np.sin(RATE * 0.1), abs=1e-4)
    assert_closed(run)
    held = 0.5 * tether.stiffness * x**2
    assert run.report.ledger.actions == pytest.approx(held, rel=1e-3)


@pytest.mark.parametrize("nonsense", [3.0, Tether, object()])
def test_what_is_no_action_is_refused(nonsense: object):
    with pytest.raises(ModelError, match="not an action"):
        swinging(nonsense).build()


def test_no_case_file_holds_an_object_of_a_script():
    with pytest.raises(CaseError, match="Tether is an object of a script"):
        swinging(Tether("box", 1.0)).case()
