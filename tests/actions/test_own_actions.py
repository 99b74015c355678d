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
    energy_of_springs,
)
from clast.contact.clipped_spring import Clipped, table
from clast.errors import CaseError, ModelError
from clast.model.model import Model
from clast.model.state import Ledger

RATE = 40.0


@dataclass(frozen=True)
class Thrust:
    """A force that grows with time, at the centroid of a block; it remembers what it has done."""

    block: str
    slope: tuple[float, float]

    def begin(self, model: Model) -> float:
        return 0.0

    def contribution(self, start: StepStart, state: float) -> Contribution:
        force = np.zeros((1, 6))
        force[0, :2] = start.end * np.array(self.slope)
        return Contribution(block=np.array([start.model.block_name.index(self.block)]), force=force)

    def finish(
        self, start: StepStart, state: float, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        work = float(np.sum(contribution.force * solution.displacement[contribution.block]))
        return ActionResult(work=work, ledger=Ledger(loads=work), state=state + work)


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


@dataclass(frozen=True)
class Tie:
    """A linear spring between the centroids of two blocks, written out in NumPy."""

    blocks: tuple[str, str]
    stiffness: float

    def begin(self, model: Model) -> float:
        one, other = self._numbers(model)
        outlines = [model.polygon(b).mean(axis=0) for b in (one, other)]
        return float(np.hypot(*(outlines[0] - outlines[1])))

    def contribution(self, start: StepStart, state: float) -> Contribution:
        one, other = self._numbers(start.model)
        way = start.frames.centroid[one] - start.frames.centroid[other]
        length = float(np.hypot(*way))
        normal = Clipped(
            at_zero=np.zeros(1),
            stiffness=np.array([self.stiffness]),
            low=np.array([-np.inf]),
            high=np.array([np.inf]),
        )
        none = Clipped(
            at_zero=np.zeros(1), stiffness=np.zeros(1), low=np.zeros(1), high=np.zeros(1)
        )
        springs, _ = table(
            vertex_block=np.array([one]),
            edge_block=np.array([other]),
            arms=np.array([[*(way / length), 0.0, 0.0, 0.0, 0.0]]),
            gap=np.array([length - state]),
            slip=np.zeros(1),
            normal=normal,
            shear=none,
        )
        return Contribution(springs=springs)

    def finish(
        self, start: StepStart, state: float, contribution: Contribution, solution: Solution
    ) -> ActionResult:
        assert contribution.springs is not None
        work, stored = energy_of_springs(contribution.springs, solution)
        return ActionResult(work=work, ledger=Ledger(actions=stored), state=state)

    def _numbers(self, model: Model) -> tuple[int, int]:
        one, other = (model.block_name.index(name) for name in self.blocks)
        return one, other


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


@pytest.mark.slow
@pytest.mark.parametrize(("process", "stiffness"), PROCESSES)
@pytest.mark.one_in(3)
def test_a_spring_between_two_blocks(process: str, stiffness: float):
    """Boxes that touch nothing of each other swing about their common centre, x = v/w sin(w t)."""
    builder = swinging(Tie(("box", "far"), 0.5 * 2500.0 * RATE**2))
    builder.block(vertices=[(3, 0), (4, 0), (4, 1), (3, 1)], name="far")
    step, end = 1e-4, 0.1
    run = clast.simulate(
        builder,
        end=end,
        step=step,
        process=process,
        contact_law={"name": "penalty", "normal_stiffness": stiffness},
    )
    moved = (run.final.vertices - run.model.vertices)[4:, 0].reshape(2, 4).mean(axis=1)
    assert moved.sum() == pytest.approx(2.0 * end, rel=1e-5)  # momentum
    damping = np.exp(-(RATE**2) * step * end / 4.0)  # forces act as they are at a step's end
    wanted = damping * 2.0 / RATE * np.sin(RATE * end)
    assert moved[0] - moved[1] == pytest.approx(wanted, abs=2e-4)
    assert_closed(run)
    held = 0.25 * 2500.0 * RATE**2 * (moved[0] - moved[1]) ** 2
    assert run.report.ledger.actions == pytest.approx(held, rel=1e-6)


def assert_closed(run: clast.Run) -> None:
    """The ledger explains all energy."""
    energy = run.energy
    stored = ("kinetic", "elastic", "gravity", "contact", "fixed_points", "actions")
    lost = ("friction", "impacts", "numerical")
    total = sum(energy[name] for name in stored + lost) - energy["loads"]
    turned_over = np.abs(energy["kinetic"]).max()
    assert np.abs(total - total[0]).max() < 1e-7 * turned_over
    assert np.abs(energy["unaccounted"]).max() < 1e-7 * turned_over


@pytest.mark.parametrize("nonsense", [3.0, Tether, object()])
def test_what_is_no_action_is_refused(nonsense: object):
    with pytest.raises(ModelError, match="not an action"):
        swinging(nonsense).build()


def test_no_case_file_holds_an_object_of_a_script():
    with pytest.raises(CaseError, match="Thrust is an object of a script"):
        swinging(Thrust("box", (1.0, 0.0))).case()
